//! Debouncing of marker pulses: the contact of TRA that closes more than once for one marker.
//!
//! The same marker again within the debounce time is the same edge. No line has two markers of one number so close that
//! a train hears both within [`MarkerConfig::bounce_ms`]: a later pulse within that time is TRA's bounce, and no marker
//! out of order. The first edge gives the position.

use protocol::config::MarkerConfig;
use protocol::event::Event;
use protocol::{Duration, Instant};

use crate::kernel::EventLog;
use crate::signals::MarkerPulse;
use crate::timer::ms;

/// Markers of a section.
const MARKERS: usize = 4;

/// The edges of each marker's contact.
#[derive(Clone, Debug, Default)]
pub struct Debounce {
    contacts: [Option<Contact>; MARKERS],
}

#[derive(Clone, Copy, Debug)]
struct Contact {
    /// When its first edge came, and its last.
    first: Instant,
    last: Instant,
    reported: bool,
}

impl Debounce {
    /// One scan: returns the pulse if it is a marker's first edge. Unless the debouncing `works`, every edge counts.
    pub fn take(
        &mut self,
        now: Instant,
        pulse: Option<MarkerPulse>,
        works: bool,
        config: &MarkerConfig,
        log: &mut EventLog,
    ) -> Option<MarkerPulse> {
        let pulse = pulse?;
        let number = usize::from(pulse.marker).checked_sub(1);
        let contact = number.and_then(|number| self.contacts.get_mut(number));
        let (Some(contact), true) = (contact, works) else {
            return Some(pulse);
        };
        let at = now.back(Duration::from_us(u64::from(pulse.age_us)));
        let Some(known) = contact
            .as_mut()
            .filter(|known| at.since(known.last) <= ms(config.bounce_ms))
        else {
            *contact = Some(Contact {
                first: at,
                last: at,
                reported: false,
            });
            return Some(pulse);
        };
        known.last = at;
        let late = at.since(known.first);
        if late > ms(config.debounce_ms) && !known.reported {
            known.reported = true;
            log.push(now, Event::TraBounces, late.as_ms() as i32);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;
    use crate::for_tests::{logged, sg100};

    /// Edges as (time in ms, marker): the edges that count, and the parameters of the events that blame TRA.
    fn counted(edges: &[(u64, u8)]) -> (Vec<(u64, u8)>, Vec<i32>) {
        let config = sg100().marker;
        let (mut debounce, mut log) = (Debounce::default(), EventLog::default());
        let take = |&&(ms, marker): &&(u64, u8)| {
            let pulse = Some(MarkerPulse { marker, age_us: 0 });
            let now = Instant::from_ms(5_000 + ms);
            debounce.take(now, pulse, true, &config, &mut log).is_some()
        };
        let first = edges.iter().filter(take).copied().collect();
        let told = logged(&log);
        assert!(
            told.iter()
                .all(|(code, _)| *code == Event::TraBounces.definition().code)
        );
        (
            first,
            told.into_iter().map(|(_, parameter)| parameter).collect(),
        )
    }

    #[test]
    fn an_edge_counts_once_and_what_bounces_longer_is_reported_once() {
        assert_eq!(
            counted(&[(0, 1), (10, 1), (100, 1)]),
            (alloc::vec![(0, 1)], alloc::vec![])
        );
        let hangs = [(0, 1), (110, 1), (500, 1), (900, 1)];
        assert_eq!(counted(&hangs), (alloc::vec![(0, 1)], alloc::vec![110]));
        let again = [(0, 1), (250, 1), (800, 1), (1_000, 1)];
        let (first, told) = counted(&again);
        assert_eq!(first, [(0, 1), (800, 1)]);
        assert_eq!(told, [250, 200]);
    }

    #[test]
    fn another_marker_is_no_bounce() {
        let mixed = [(0, 1), (20, 2), (40, 1), (60, 3), (300, 2)];
        let (first, told) = counted(&mixed);
        assert_eq!(first, [(0, 1), (20, 2), (60, 3)]);
        assert_eq!(told, [280]);
    }
}
