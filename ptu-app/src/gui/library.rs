//! Questions to the database and to files, answered on a thread of their own.

use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};

use fault_db::{Store, StoreError};

use crate::clock;
use crate::data::ScriptsDirectory;
use crate::failure::Failure;
use crate::station::Wake;

type Question = Box<dyn FnOnce(&Shelf) + Send>;

/// Where things are kept.
#[derive(Clone, Debug)]
pub struct Shelf {
    /// The database file.
    pub database: PathBuf,
    /// Procedures, lines, units.
    pub scripts: ScriptsDirectory,
}

impl Shelf {
    /// The database, to be written to; made if it is not there.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn open(&self) -> Result<Store, Failure> {
        if let Some(folder) = self.database.parent().filter(|f| !f.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(|error| {
                Failure::bench(format!("cannot make {}: {error}", folder.display()))
            })?;
        }
        Ok(Store::open(&self.database, clock::open_options())?)
    }

    /// The database, to be read; one that is not there yet is made, one of an older schema is copied
    /// and brought up to date.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn read(&self) -> Result<Store, Failure> {
        if !self.database.exists() {
            self.open()?.close()?;
        }
        match Store::open_read_only(&self.database) {
            Err(StoreError::OlderSchema { .. }) => {
                self.open()?.close()?;
                Ok(Store::open_read_only(&self.database)?)
            }
            opened => Ok(opened?),
        }
    }
}

/// The thread and the way to it.
pub struct Library {
    questions: Sender<Question>,
    wake: Wake,
    shelf: Shelf,
}

impl Library {
    /// Begins its thread; `wake` is called when an answer is there.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(shelf: Shelf, wake: Wake) -> Result<Self, Failure> {
        let (questions, receiver) = mpsc::channel::<Question>();
        let own = shelf.clone();
        std::thread::Builder::new()
            .name("library".into())
            .spawn(move || receiver.iter().for_each(|question| question(&own)))
            .map_err(|error| Failure::bench(format!("cannot start a thread: {error}")))?;
        Ok(Self {
            questions,
            wake,
            shelf,
        })
    }

    /// Asks; the answer comes later. Questions are answered in the order they are asked.
    pub fn ask<T: Send + 'static>(
        &self,
        question: impl FnOnce(&Shelf) -> Result<T, Failure> + Send + 'static,
    ) -> Pending<T> {
        let (sender, receiver) = mpsc::channel();
        let wake = self.wake.clone();
        let question: Question = Box::new(move |shelf| {
            // Nobody may want to know any more.
            let _ = sender.send(question(shelf));
            wake();
        });
        // Its thread ends with the library only.
        let _ = self.questions.send(question);
        Pending(receiver)
    }

    /// Where things are kept.
    pub fn shelf(&self) -> &Shelf {
        &self.shelf
    }

    /// Wakes the window.
    pub fn wake(&self) -> &Wake {
        &self.wake
    }
}

/// An answer that may still be under way.
pub struct Pending<T>(Receiver<Result<T, Failure>>);

impl<T> Pending<T> {
    /// The answer, once; nothing while it is under way.
    pub fn take(&self) -> Option<Result<T, Failure>> {
        match self.0.try_recv() {
            Ok(answer) => Some(answer),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err(Failure::bench("the question was not answered")))
            }
        }
    }
}

/// Something asked for, under way, there, or not to be had.
#[derive(Default)]
pub enum Asked<T> {
    /// Not asked yet.
    #[default]
    Not,
    /// Under way.
    Pending(Pending<T>),
    /// There.
    There(T),
    /// Not to be had, and why.
    Failed(String),
}

impl<T> Asked<T> {
    /// Takes the answer if it has come; true when it has just come.
    pub fn poll(&mut self) -> bool {
        let Self::Pending(pending) = self else {
            return false;
        };
        match pending.take() {
            None => false,
            Some(Ok(value)) => {
                *self = Self::There(value);
                true
            }
            Some(Err(failure)) => {
                *self = Self::Failed(failure.message);
                true
            }
        }
    }

    /// What is there.
    pub fn value(&self) -> Option<&T> {
        match self {
            Self::There(value) => Some(value),
            _ => None,
        }
    }

    /// Nothing was asked yet.
    pub fn is_not(&self) -> bool {
        matches!(self, Self::Not)
    }
}
