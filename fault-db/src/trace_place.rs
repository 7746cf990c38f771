//! A place in a trace, as a note on it names it.
//!
//! A note at a place is a note on the run of the trace, and its text begins with the place: so it is sealed, searched,
//! merged and synced as any note is, also by a server and by programs that know no places.

use std::str::FromStr;

use serde::Serialize;

use crate::id::Id;

/// Where in which trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct TracePlace {
    /// The trace.
    pub trace: Id,
    /// Time from its trigger, or from its first row where it has none.
    pub at_us: i64,
}

impl TracePlace {
    /// The text of a note at this place, as it is stored.
    pub(crate) fn before(self, text: &str) -> String {
        let Self { trace, at_us } = self;
        format!("[trace {trace} at {at_us} us] {text}")
    }

    /// The place a stored text begins with, and what is said there.
    pub(crate) fn split(stored: &str) -> Option<(Self, &str)> {
        let (place, text) = stored.strip_prefix("[trace ")?.split_once("] ")?;
        let (trace, at) = place.split_once(" at ")?;
        let place = Self {
            trace: Id::from_str(trace).ok()?,
            at_us: at.strip_suffix(" us")?.parse().ok()?,
        };
        Some((place, text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_read_back_and_what_only_looks_like_one_is_text() {
        let place = TracePlace {
            trace: Id::from_bytes([7; 16]),
            at_us: -350_000,
        };
        let stored = place.before("here] it [sticks");
        assert_eq!(
            TracePlace::split(&stored),
            Some((place, "here] it [sticks"))
        );
        let id = place.trace.to_string();
        for text in [
            "",
            "[trace ",
            "[trace x at 1 us] y",
            &format!("[trace {id} at one us] y"),
            &format!("[trace {id} at 99999999999999999999 us] y"),
            &format!("see [trace {id} at 1 us] y"),
        ] {
            assert_eq!(TracePlace::split(text), None, "{text}");
        }
    }
}
