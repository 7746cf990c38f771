//! Messages to the user of the window: trouble and information, with the time of each.

use fault_db::Id;
use ptu_runs::clock;
use ptu_runs::failure::Trouble;

/// The latest messages, oldest first.
#[derive(Debug, Default)]
pub struct Messages {
    /// Oldest first.
    pub all: Vec<Message>,
    /// Step that was undone last.
    taken_back: Option<Written>,
    /// Number of runs that had ended at the last call of [`undoable`](Self::undoable).
    runs_ended: usize,
}

/// Written step of a person about a fault, and so about the fault's case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Written {
    pub fault: Id,
    /// When, µs since 1970.
    pub at_us: i64,
}

/// Subject of a message; when the subject is over, the message is hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum About {
    /// The connection to the unit of this number.
    Connection(u64),
    /// The present or last run of the unit of this number.
    Run(u64),
    Database,
}

#[derive(Debug)]
pub struct Message {
    /// Text, in the language chosen when the message came.
    pub text: String,
    /// Cause of the trouble; empty if the text says everything.
    pub detail: Trouble,
    pub bad: bool,
    /// µs since 1970.
    pub at_us: i64,
    /// Subject of the message; when the subject is over, the message is hidden.
    about: Option<About>,
    /// The subject is over: the message is only listed.
    pub over: bool,
    /// The user has acknowledged the trouble.
    acknowledged: bool,
    /// Step that the message tells of; a button in the message undoes the step for [`UNDO_S`].
    written: Option<Written>,
    /// When the message was first shown, in the window's time, s.
    shown_at_s: Option<f64>,
}

impl Message {
    /// Trouble that still holds and that the user has not acknowledged.
    fn is_unread(&self) -> bool {
        self.bad && !self.over && !self.acknowledged
    }

    /// The message says how a run ended.
    pub fn is_of_run(&self) -> bool {
        matches!(self.about, Some(About::Run(_)))
    }
}

/// Time for which a written step can be undone, s.
pub const UNDO_S: f64 = 10.0;
/// Time for which any other message is shown, s.
const SHOWN_S: f64 = 10.0;
/// Messages kept; older ones are dropped.
const KEPT: usize = 100;

/// Detail of a message as finished text; an empty text is no detail.
pub fn told(words: impl Into<String>) -> Trouble {
    Trouble::Told(words.into())
}

impl Messages {
    /// Adds a message that something went wrong.
    pub fn trouble(&mut self, text: impl Into<String>, detail: impl Into<Trouble>) {
        self.trouble_about(None, text, detail);
    }

    pub fn note(&mut self, text: impl Into<String>) {
        self.note_about(None, text);
    }

    /// As [`trouble`](Self::trouble), but hidden when its subject is over.
    pub fn trouble_about(
        &mut self,
        about: impl Into<Option<About>>,
        text: impl Into<String>,
        detail: impl Into<Trouble>,
    ) {
        self.push(text.into(), detail.into(), true, about.into());
    }

    /// As [`note`](Self::note), but hidden when its subject is over.
    pub fn note_about(&mut self, about: impl Into<Option<About>>, text: impl Into<String>) {
        self.push(text.into(), told(""), false, about.into());
    }

    /// Adds a message that a step was written; the step can be undone for [`UNDO_S`].
    pub fn note_written(&mut self, text: impl Into<String>, written: Written) {
        self.note(text);
        if let Some(message) = self.all.last_mut() {
            message.written = Some(written);
        }
    }

    /// Latest message whose step can be undone now: its index, the step, and the time left, s. `runs_ended` = runs that
    /// have ended in this window; when the number changes, no step can be undone: a run's result may rest on it.
    pub fn undoable(&mut self, now_s: f64, runs_ended: usize) -> Option<(usize, Written, f64)> {
        if std::mem::replace(&mut self.runs_ended, runs_ended) != runs_ended {
            for message in &mut self.all {
                message.written = None;
            }
        }
        for message in &mut self.all {
            message.shown_at_s.get_or_insert(now_s);
        }
        let place = self
            .all
            .iter()
            .rposition(|message| message.written.is_some())?;
        let message = &self.all[place];
        let left_s = message.shown_at_s.unwrap_or(now_s) + UNDO_S - now_s;
        let written = message.written.filter(|_| left_s > 0.0)?;
        Some((place, written, left_s))
    }

    /// Takes away the offer to undo this step, because the step is being undone.
    pub fn take_offer(&mut self, written: Written) {
        for message in &mut self.all {
            if message.written == Some(written) {
                message.written = None;
            }
        }
    }

    /// Adds a message that the step was undone.
    pub fn tell_taken_back(&mut self, text: impl Into<String>, written: Written) {
        self.note(text);
        self.taken_back = Some(written);
    }

    /// Whether this step was the last that was undone.
    pub fn was_taken_back(&self, written: Written) -> bool {
        self.taken_back == Some(written)
    }

    /// Ends the messages about this subject.
    pub fn over(&mut self, about: About) {
        for message in &mut self.all {
            message.over |= message.about == Some(about);
        }
    }

    /// The latest trouble that the user has not acknowledged.
    pub fn unread_trouble(&self) -> Option<&Message> {
        let mut latest = self.all.iter().rev();
        latest.find(|message| message.is_unread())
    }

    /// The newest message, for [`SHOWN_S`]; none if it is trouble, or over, or the message at index `but`.
    pub fn latest_note(&self, but: Option<usize>, now_s: f64) -> Option<&Message> {
        let place = self
            .all
            .len()
            .checked_sub(1)
            .filter(|place| Some(*place) != but);
        let last = self.all.get(place?);
        let is_new = |message: &&Message| {
            let shown_at_s = message.shown_at_s.unwrap_or(now_s);
            now_s - shown_at_s < SHOWN_S
        };
        last.filter(|message| !message.bad && !message.over)
            .filter(is_new)
    }

    /// Marks the trouble that is shown, and its repetitions, as acknowledged.
    pub fn acknowledge(&mut self) {
        let what = |message: &Message| (message.text.clone(), message.detail.to_string());
        if let Some(shown) = self.unread_trouble().map(what) {
            let repeated = self.all.iter_mut().filter(|message| what(message) == shown);
            repeated.for_each(|message| message.acknowledged = true);
        }
    }

    /// Hides the latest message; it stays listed.
    pub fn note_seen(&mut self) {
        if let Some(last) = self.all.last_mut() {
            last.over = true;
        }
    }

    pub fn clear(&mut self) {
        self.all.clear();
    }

    fn push(&mut self, text: String, detail: Trouble, bad: bool, about: Option<About>) {
        if self.all.len() == KEPT {
            self.all.remove(0);
        }
        self.all.push(Message {
            text,
            detail,
            bad,
            at_us: clock::now_us(),
            about,
            over: false,
            acknowledged: false,
            written: None,
            shown_at_s: None,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: trouble that nobody has acknowledged is not hidden for good by later trouble.
    #[test]
    fn earlier_trouble_comes_back_when_later_trouble_is_acknowledged_or_over() {
        let mut messages = Messages::default();
        let shown = |messages: &Messages| messages.unread_trouble().map(|said| said.text.clone());
        messages.trouble("outputs not confirmed safe", told(""));
        for disk in ["full", "write-protected", "write-protected"] {
            messages.trouble("not saved", told(disk));
        }
        messages.trouble_about(About::Connection(1), "connection lost", told(""));
        messages.over(About::Connection(1));
        for _ in ["write-protected", "full"] {
            assert_eq!(shown(&messages).as_deref(), Some("not saved"));
            messages.acknowledge();
        }
        assert_eq!(
            shown(&messages).as_deref(),
            Some("outputs not confirmed safe")
        );
        messages.acknowledge();
        assert_eq!(shown(&messages), None);
    }

    /// Goal: an undo is offered only while it is possible, and hides no newer message. Method: a written step, a note
    /// after it, and the end of a run whose result may rest on the step.
    #[test]
    fn an_undo_hides_no_newer_message_and_ends_with_the_next_run() {
        let (fault, at_us) = (Id::from_bytes([1; 16]), 7);
        let written = Written { fault, at_us };
        let mut messages = Messages::default();
        messages.note_written("repaired", written);
        assert_eq!(messages.undoable(1.0, 3), None, "runs ended meanwhile");
        messages.note_written("repaired", written);
        let offered = messages.undoable(1.0, 3);
        assert_eq!(offered, Some((1, written, UNDO_S)));
        let newer = |messages: &Messages| {
            messages
                .latest_note(Some(1), 1.0)
                .map(|said| said.text.clone())
        };
        assert_eq!(newer(&messages), None);
        messages.note("connected");
        assert_eq!(newer(&messages).as_deref(), Some("connected"));
        assert!(messages.undoable(2.0, 3).is_some());
        assert_eq!(messages.undoable(2.0, 4), None);
    }
}
