//! Questions to the database and to files, answered on a thread of their own.

use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};

use fault_db::{Store, StoreError};

use crate::clock;
use crate::data::ScriptsDirectory;
use crate::failure::Failure;
use crate::private;
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
        private::folder_of(&self.database)?;
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

/// Something asked for again and again: what is there stays until the newer answer has come, so that a
/// page does not jump.
pub struct Kept<T> {
    shown: Asked<T>,
    newer: Asked<T>,
}

impl<T> Default for Kept<T> {
    fn default() -> Self {
        Self {
            shown: Asked::Not,
            newer: Asked::Not,
        }
    }
}

impl<T> Kept<T> {
    /// Asked once more for the same.
    pub fn ask(&mut self, pending: Pending<T>) {
        match self.shown {
            Asked::There(_) => self.newer = Asked::Pending(pending),
            _ => self.shown = Asked::Pending(pending),
        }
    }

    /// Asked for something else: what is there is no answer to it.
    pub fn ask_other(&mut self, pending: Pending<T>) {
        self.newer = Asked::Not;
        self.shown = Asked::Pending(pending);
    }

    /// Takes the answer if it has come.
    pub fn poll(&mut self) {
        self.shown.poll();
        if self.newer.poll() {
            self.shown = std::mem::take(&mut self.newer);
        }
    }

    /// The latest there is.
    pub fn get(&self) -> &Asked<T> {
        &self.shown
    }

    /// A newer answer is under way.
    pub fn is_stale(&self) -> bool {
        !self.newer.is_not()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pending() -> (Sender<Result<u32, Failure>>, Pending<u32>) {
        let (sender, receiver) = mpsc::channel();
        (sender, Pending(receiver))
    }

    #[test]
    fn what_is_there_stays_until_the_newer_answer_has_come() {
        let mut kept = Kept::default();
        let (first, asked) = pending();
        kept.ask(asked);
        assert!(kept.get().value().is_none() && !kept.is_stale());
        first.send(Ok(1)).expect("heard");
        kept.poll();
        let (second, asked) = pending();
        kept.ask(asked);
        kept.poll();
        assert!(kept.get().value() == Some(&1) && kept.is_stale());
        second.send(Ok(2)).expect("heard");
        kept.poll();
        assert!(kept.get().value() == Some(&2) && !kept.is_stale());
        let (third, asked) = pending();
        kept.ask(asked);
        third.send(Err(Failure::bench("gone"))).expect("heard");
        kept.poll();
        assert!(matches!(kept.get(), Asked::Failed(_)));
    }

    #[test]
    fn an_answer_to_something_else_is_never_shown() {
        let mut kept = Kept::default();
        let (first, asked) = pending();
        kept.ask(asked);
        first.send(Ok(1)).expect("heard");
        kept.poll();
        let (again, asked) = pending();
        kept.ask(asked);
        let (_other, asked) = pending();
        kept.ask_other(asked);
        assert!(again.send(Ok(2)).is_err(), "nobody wants to know any more");
        kept.poll();
        assert!(kept.get().value().is_none());
    }
}
