//! A thread that runs queries on the database and on files, so that drawing a frame never waits for a disk.

use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};

use super::data_paths::DataPaths;
use ptu_runs::bench_worker::Wake;
use ptu_runs::failure::{Asked, Failure, RunTrouble};

type Query = Box<dyn FnOnce(&DataPaths) + Send>;

/// Handle of the thread, with the queue of its queries; the thread ends when the handle is dropped.
pub struct QueryWorker {
    queries: Sender<Query>,
    pub wake: Wake,
    pub paths: DataPaths,
}

impl QueryWorker {
    /// Starts the thread; `wake` is called after each response.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(paths: DataPaths, wake: Wake) -> Result<Self, Failure> {
        let (queries, receiver) = mpsc::channel::<Query>();
        let own = paths.clone();
        std::thread::Builder::new()
            .name("queries".into())
            .spawn(move || receiver.iter().for_each(|query| query(&own)))
            .map_err(|error| Failure::bench(RunTrouble::NoThread(error.to_string())))?;
        Ok(Self {
            queries,
            wake,
            paths,
        })
    }

    /// Queues a query. Queries run in the order they are queued.
    pub fn run<T: Send + 'static>(
        &self,
        query: impl FnOnce(&DataPaths) -> Result<T, Failure> + Send + 'static,
    ) -> Pending<T> {
        let (sender, receiver) = mpsc::channel();
        let wake = self.wake.clone();
        let query: Query = Box::new(move |paths| {
            // The page may have dropped its request.
            let _ = sender.send(query(paths));
            wake();
        });
        // The receiver lives as long as this sender.
        let _ = self.queries.send(query);
        Pending(receiver)
    }
}

/// The response of one query.
pub struct Pending<T>(Receiver<Result<T, Failure>>);

impl<T> Pending<T> {
    /// The response, once; `None` until it arrives.
    pub fn take(&self) -> Option<Result<T, Failure>> {
        match self.0.try_recv() {
            Ok(answer) => Some(answer),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(Failure::bench(Asked::NotAnswered))),
        }
    }
}

#[cfg(test)]
impl<T> Pending<T> {
    /// A response that a test sends.
    pub(super) fn from_receiver(receiver: Receiver<Result<T, Failure>>) -> Self {
        Self(receiver)
    }
}
