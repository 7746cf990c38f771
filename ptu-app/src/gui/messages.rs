//! Messages to the user of the window: trouble and information, with the time of each.

use ptu_bench::clock;

/// The latest messages, oldest first.
#[derive(Debug, Default)]
pub struct Messages {
    all: Vec<Message>,
    /// Index of the latest trouble, until the user acknowledges it.
    unread: Option<usize>,
}

#[derive(Debug)]
pub struct Message {
    /// In the language chosen when it happened.
    pub text: String,
    /// Technical detail, not translated.
    pub detail: String,
    /// Whether it reports trouble.
    pub bad: bool,
    /// µs since 1970.
    pub at_us: i64,
}

/// Messages kept; older ones are dropped.
const KEPT: usize = 100;

impl Messages {
    /// Adds a message that something went wrong.
    pub fn trouble(&mut self, text: impl Into<String>, detail: impl Into<String>) {
        self.push(text.into(), detail.into(), true);
    }

    pub fn note(&mut self, text: impl Into<String>) {
        self.push(text.into(), String::new(), false);
    }

    /// Oldest first.
    pub fn all(&self) -> &[Message] {
        &self.all
    }

    /// The latest trouble that the user has not acknowledged.
    pub fn unread_trouble(&self) -> Option<&Message> {
        self.all.get(self.unread?)
    }

    /// Marks the latest trouble as acknowledged.
    pub fn acknowledge(&mut self) {
        self.unread = None;
    }

    pub fn clear(&mut self) {
        self.all.clear();
        self.unread = None;
    }

    fn push(&mut self, text: String, detail: String, bad: bool) {
        if self.all.len() == KEPT {
            self.all.remove(0);
            self.unread = self.unread.and_then(|place| place.checked_sub(1));
        }
        if bad {
            self.unread = Some(self.all.len());
        }
        self.all.push(Message {
            text,
            detail,
            bad,
            at_us: clock::now_us(),
        });
    }
}
