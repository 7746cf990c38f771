//! Whether the bench harness is there, as shown by what the unit sends, or as the user says.
//!
//! A unit at a harness sends `IoOutput` every 10 ms. One on a train is heard at its maintenance port alone, and
//! there it takes nothing but the tester's frames: whatever else a bench sends would be refused, and a bench must not
//! play a train beside the real one.

use protocol::message::Channel;
use protocol::{Duration, Instant};
use serde::{Deserialize, Serialize};

/// Time for which only the maintenance channel is heard, after which the unit counts as one without harness.
const ALONE: Duration = Duration::from_ms(500);

/// Whether the bench harness is connected, as the user says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Harness {
    /// Whether there is a harness follows from what the unit says.
    #[default]
    Auto,
    /// Only the maintenance channel.
    None,
    Bench,
}

impl Harness {
    /// What the command line calls each.
    pub const WORDS: [(&'static str, Self); 3] = [
        ("auto", Self::Auto),
        ("none", Self::None),
        ("bench", Self::Bench),
    ];
}

impl std::str::FromStr for Harness {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let known = Self::WORDS.into_iter().find(|(word, _)| *word == text);
        known
            .map(|(_, harness)| harness)
            .ok_or_else(|| "a harness is `auto`, `none` or `bench`".into())
    }
}

/// Presence of the harness, as far as it is known.
#[derive(Debug)]
pub struct HarnessWatch {
    /// Whether there is one, once it is known.
    pub found: Option<bool>,
    /// Since when only the maintenance channel is heard.
    alone_since: Option<Instant>,
}

impl HarnessWatch {
    pub fn new(asked: Harness) -> Self {
        Self {
            found: match asked {
                Harness::Auto => None,
                Harness::None => Some(false),
                Harness::Bench => Some(true),
            },
            alone_since: None,
        }
    }

    /// Whether the harness is connected, as far as is known.
    pub fn is_there(&self) -> bool {
        self.found == Some(true)
    }

    /// Takes note of a frame of the unit.
    pub fn note_frame(&mut self, now: Instant, channel: Channel) {
        if self.found.is_some() {
            return;
        }
        match channel {
            Channel::Io => self.found = Some(true),
            Channel::Ptu => {
                let since = *self.alone_since.get_or_insert(now);
                self.found = (now.since(since) >= ALONE).then_some(false);
            }
            Channel::Tcms | Channel::Twc => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_unit_says_shows_whether_there_is_a_harness() {
        let at = Instant::from_ms;
        let mut watch = HarnessWatch::new(Harness::Auto);
        watch.note_frame(at(100), Channel::Ptu);
        watch.note_frame(at(590), Channel::Ptu);
        assert_eq!(watch.found, None);
        watch.note_frame(at(600), Channel::Ptu);
        assert_eq!(watch.found, Some(false));
        watch.note_frame(at(610), Channel::Io);
        assert_eq!(watch.found, Some(false), "found once");

        let mut watch = HarnessWatch::new(Harness::Auto);
        watch.note_frame(at(100), Channel::Ptu);
        watch.note_frame(at(110), Channel::Io);
        assert_eq!(watch.found, Some(true));
    }

    #[test]
    fn what_the_user_says_stands() {
        for (asked, found) in [(Harness::None, false), (Harness::Bench, true)] {
            let mut watch = HarnessWatch::new(asked);
            watch.note_frame(Instant::ZERO, Channel::Io);
            watch.note_frame(Instant::from_ms(900), Channel::Ptu);
            assert_eq!(watch.found, Some(found));
        }
    }
}
