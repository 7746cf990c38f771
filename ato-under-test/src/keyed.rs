//! Values keyed in at the cab: a value counts once several frames in a row have said it.

use protocol::{Duration, Instant};

/// Silence after which what is keyed in is a new entry.
pub const ENTRY_OVER: Duration = Duration::from_ms(300);

/// Value of the last frames that agree, their number, and the time of the last one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Keyed(Option<(u16, u8, Instant)>);

impl Keyed {
    /// Takes a frame; whether it is the last of `frames` in a row with one value.
    pub fn hear(&mut self, now: Instant, value: u16, frames: u8) -> bool {
        let alike = self
            .0
            .filter(|(before, _, at)| *before == value && now.since(*at) < ENTRY_OVER);
        let count = alike.map_or(0, |(_, count, _)| count).saturating_add(1);
        self.0 = Some((value, count, now));
        count == frames
    }
}
