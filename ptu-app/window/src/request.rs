//! The state of requests to the query worker, as a page keeps it from frame to frame.

use eframe::egui::{RichText, Ui};

use super::messages::Messages;
use super::query_worker::Pending;
use super::{DataPaths, PageContext, Palette};
use ptu_report::words::Words;
use ptu_runs::failure::{Failure, Trouble};

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

    /// The response if it has arrived with this call, after which nothing is requested; a failure is told under `failed`.
    pub fn take(&mut self, failed: &str, messages: &mut Messages) -> Option<T> {
        if !self.poll() {
            return None;
        }
        match std::mem::take(self) {
            Self::Ready(value) => return Some(value),
            Self::Failed(why) => messages.trouble(failed, why),
            Self::Idle | Self::Pending(_) => {}
        }
        None
    }

    /// The response; while there is none, shows that it is loading or why it failed.
    pub fn shown(&self, ui: &mut Ui, words: &Words) -> Option<&T> {
        match self {
            Self::Ready(value) => return Some(value),
            Self::Failed(why) => {
                drop(ui.label(RichText::new(&*words.trouble(why)).color(Palette::of(ui).bad)));
            }
            Self::Idle | Self::Pending(_) => drop(ui.label(words.common.loading)),
        }
        None
    }

    /// Shows that the response is still to come, or after a failure `not_done`, the reason and a button to try again;
    /// true when the button was clicked.
    pub fn missing(&self, ui: &mut Ui, words: &Words, not_done: &str) -> bool {
        let Self::Failed(why) = self else {
            ui.label(words.common.loading);
            return false;
        };
        let said = RichText::new(not_done).color(Palette::of(ui).bad);
        ui.label(said.strong());
        ui.label(&*words.trouble(why));
        ui.button(words.common.refresh).clicked()
    }
}

/// Version of the data: see [`PageContext::data_version`].
type DataVersion = (usize, u64);

/// A response that is requested again when the data or the question have changed. The previous response may stay
/// until the newer one has arrived, so that the page's layout does not jump.
pub struct FollowingResponse<K, T> {
    /// The question, and the version of the data when it was asked; no version = it is to be asked again.
    asked: Option<(K, Option<DataVersion>)>,
    shown: Request<T>,
    newer: Request<T>,
}

impl<K, T> Default for FollowingResponse<K, T> {
    fn default() -> Self {
        Self {
            asked: None,
            shown: Request::Idle,
            newer: Request::Idle,
        }
    }
}

impl<K: Clone + PartialEq + Send + 'static, T: Send + 'static> FollowingResponse<K, T> {
    /// Reads `what` if it is not read yet or the data have changed since; true when a response has arrived with this
    /// call. When `what` has changed, the previous response is dropped at once, unless `stays`.
    pub fn keep_up(
        &mut self,
        (what, stays): (K, bool),
        context: &PageContext<'_>,
        read: impl FnOnce(&DataPaths, K) -> Result<T, Failure> + Send + 'static,
    ) -> bool {
        if let Some(is_other) = self.wants(&what, context.data_version()) {
            let pending = context.queries.run(move |paths| read(paths, what));
            self.request(pending, stays || !is_other);
        }
        self.poll()
    }

    /// `None` if the response to `what` is up to date; `Some` if `what` is to be requested: `true` = it has changed,
    /// `false` = first request, or the same `what` again.
    fn wants(&mut self, what: &K, version: DataVersion) -> Option<bool> {
        let before = self.asked.replace((what.clone(), Some(version)));
        match before {
            Some((before, _)) if before != *what => Some(true),
            Some((_, Some(read))) if read == version => None,
            _ => Some(false),
        }
    }
}

impl<K, T> FollowingResponse<K, T> {
    /// Waits for a response; `stays`: the previous response is shown meanwhile.
    fn request(&mut self, pending: Pending<T>, stays: bool) {
        match self.shown {
            Request::Ready(_) if stays => self.newer = Request::Pending(pending),
            _ => (self.shown, self.newer) = (Request::Pending(pending), Request::Idle),
        }
    }

    fn poll(&mut self) -> bool {
        let newer = self.newer.poll();
        if newer {
            self.shown = std::mem::take(&mut self.newer);
        }
        newer || self.shown.poll()
    }

    /// Has the response read again, whether the data have changed or not.
    pub fn read_again(&mut self) {
        if let Some((_, version)) = &mut self.asked {
            *version = None;
        }
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

impl<K, T> FollowingResponse<K, Vec<T>> {
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
        let mut cached = FollowingResponse::<(), u32>::default();
        let (first, pending_response) = pending();
        cached.request(pending_response, true);
        assert!(cached.get().value().is_none() && !cached.is_stale());
        first.send(Ok(1)).expect("heard");
        cached.poll();
        let (second, pending_response) = pending();
        cached.request(pending_response, true);
        cached.poll();
        assert!(cached.get().value() == Some(&1) && cached.is_stale());
        second.send(Ok(2)).expect("heard");
        cached.poll();
        assert!(cached.get().value() == Some(&2) && !cached.is_stale());
        let (third, pending_response) = pending();
        cached.request(pending_response, true);
        third
            .send(Err(Failure::bench(ptu_runs::words::RunTrouble::NoUnit)))
            .expect("heard");
        cached.poll();
        assert!(matches!(cached.get(), Request::Failed(_)));
    }

    #[test]
    fn a_response_to_other_data_is_never_shown() {
        let mut cached = FollowingResponse::<(), u32>::default();
        let (first, pending_response) = pending();
        cached.request(pending_response, true);
        first.send(Ok(1)).expect("heard");
        cached.poll();
        let (same, pending_response) = pending();
        cached.request(pending_response, true);
        let (_other, pending_response) = pending();
        cached.request(pending_response, false);
        assert!(
            same.send(Ok(2)).is_err(),
            "the response is no longer expected"
        );
        cached.poll();
        assert!(cached.get().value().is_none());
    }

    /// Goal: a changed question is told from the same question read again. Method: the same and another question, with
    /// the data unchanged, changed, and to be read again.
    #[test]
    fn something_else_is_told_from_the_same_read_again() {
        let mut following = FollowingResponse::<u8, u8>::default();
        let mut wants = |again: bool, what, version| {
            if again {
                following.read_again();
            }
            following.wants(&what, (0, version))
        };
        assert_eq!(wants(false, 1, 1), Some(false));
        assert_eq!(wants(false, 1, 1), None);
        assert_eq!(wants(false, 1, 2), Some(false));
        assert_eq!(wants(true, 1, 2), Some(false));
        assert_eq!(wants(true, 2, 2), Some(true));
        assert_eq!(wants(false, 3, 3), Some(true));
    }
}
