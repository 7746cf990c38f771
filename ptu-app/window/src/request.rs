//! The state of requests to the query worker, as a page keeps it from frame to frame.

use ptu_runs::failure::Trouble;

use super::query_worker::Pending;

/// The state of one request to the query worker.
#[derive(Default)]
pub enum Request<T> {
    #[default]
    Idle,
    /// The query worker has not answered yet.
    Pending(Pending<T>),
    Ready(T),
    Failed(Trouble),
}

impl<T> Request<T> {
    /// Takes the response if it has arrived; true when it has arrived with this call.
    pub fn poll(&mut self) -> bool {
        let Self::Pending(pending) = self else {
            return false;
        };
        match pending.take() {
            None => false,
            Some(Ok(value)) => {
                *self = Self::Ready(value);
                true
            }
            Some(Err(failure)) => {
                *self = Self::Failed(failure.message);
                true
            }
        }
    }

    /// The response, if it has arrived without failure.
    pub fn value(&self) -> Option<&T> {
        match self {
            Self::Ready(value) => Some(value),
            _ => None,
        }
    }

    pub fn is_idle(&self) -> bool {
        matches!(self, Self::Idle)
    }
}

/// A response that is requested again and again. The previous response stays until the newer one has
/// arrived, so that the page's layout does not jump.
pub struct CachedResponse<T> {
    shown: Request<T>,
    newer: Request<T>,
}

impl<T> Default for CachedResponse<T> {
    fn default() -> Self {
        Self {
            shown: Request::Idle,
            newer: Request::Idle,
        }
    }
}

impl<T> CachedResponse<T> {
    /// Requests the same data again and keeps the previous response meanwhile.
    pub fn request(&mut self, pending: Pending<T>) {
        match self.shown {
            Request::Ready(_) => self.newer = Request::Pending(pending),
            _ => self.shown = Request::Pending(pending),
        }
    }

    /// Requests other data: the previous response does not apply to it and is dropped.
    pub fn request_other(&mut self, pending: Pending<T>) {
        self.newer = Request::Idle;
        self.shown = Request::Pending(pending);
    }

    /// Takes the response if it has arrived; true when it has arrived with this call.
    pub fn poll(&mut self) -> bool {
        let newer = self.newer.poll();
        if newer {
            self.shown = std::mem::take(&mut self.newer);
        }
        newer || self.shown.poll()
    }

    /// The latest response or the state of its request.
    pub fn get(&self) -> &Request<T> {
        &self.shown
    }

    /// Whether a newer response is still to come.
    pub fn is_stale(&self) -> bool {
        !self.newer.is_idle()
    }
}

impl<T> CachedResponse<Vec<T>> {
    /// Entries of the latest response; empty before there is one.
    pub fn items(&self) -> &[T] {
        self.shown.value().map(Vec::as_slice).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{self, Sender};

    use super::*;
    use ptu_runs::failure::Failure;

    fn pending() -> (Sender<Result<u32, Failure>>, Pending<u32>) {
        let (sender, receiver) = mpsc::channel();
        (sender, Pending::from_receiver(receiver))
    }

    #[test]
    fn the_previous_response_stays_until_the_newer_one_arrives() {
        let mut cached = CachedResponse::default();
        let (first, pending_response) = pending();
        cached.request(pending_response);
        assert!(cached.get().value().is_none() && !cached.is_stale());
        first.send(Ok(1)).expect("heard");
        cached.poll();
        let (second, pending_response) = pending();
        cached.request(pending_response);
        cached.poll();
        assert!(cached.get().value() == Some(&1) && cached.is_stale());
        second.send(Ok(2)).expect("heard");
        cached.poll();
        assert!(cached.get().value() == Some(&2) && !cached.is_stale());
        let (third, pending_response) = pending();
        cached.request(pending_response);
        third
            .send(Err(Failure::bench(ptu_runs::words::RunTrouble::NoUnit)))
            .expect("heard");
        cached.poll();
        assert!(matches!(cached.get(), Request::Failed(_)));
    }

    #[test]
    fn a_response_to_other_data_is_never_shown() {
        let mut cached = CachedResponse::default();
        let (first, pending_response) = pending();
        cached.request(pending_response);
        first.send(Ok(1)).expect("heard");
        cached.poll();
        let (same, pending_response) = pending();
        cached.request(pending_response);
        let (_other, pending_response) = pending();
        cached.request_other(pending_response);
        assert!(
            same.send(Ok(2)).is_err(),
            "the response is no longer expected"
        );
        cached.poll();
        assert!(cached.get().value().is_none());
    }
}
