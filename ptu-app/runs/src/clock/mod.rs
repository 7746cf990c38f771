//! The only reader of the system clock and of the system's random numbers: wall time and new identities.

mod span;

use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use chrono::{DateTime, Datelike, Local, SecondsFormat, Timelike, Utc};
use fault_db::{IdSource, OpenOptions};

pub use span::{Span, months};

/// Greatest error of a time that a unit is sent, ms, a value of this program: a laptop that is set by the network
/// now and then, and the way to the unit.
pub const UNCERTAINTY_MS: u16 = 500;
/// The uncertainty of a time whose error is unknown.
pub const NOT_KNOWN_MS: u16 = u16::MAX;

/// Where systemd-timesyncd says whether it has set the clock.
const TIMESYNC: &str = "/run/systemd/timesync";

/// Whether the computer's clock is kept right by others, as its system says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClockState {
    /// The network has set the clock since the computer was started.
    Synchronised,
    NotSynchronised,
    /// The system does not say.
    Unknown,
}

impl ClockState {
    /// State of the system's clock now.
    pub fn now() -> Self {
        Self::said_in(Path::new(TIMESYNC))
    }

    fn said_in(folder: &Path) -> Self {
        match (folder.join("synchronized").exists(), folder.exists()) {
            (true, _) => Self::Synchronised,
            (false, true) => Self::NotSynchronised,
            (false, false) => Self::Unknown,
        }
    }

    /// Greatest error of a time of this clock, ms.
    pub fn uncertainty_ms(self) -> u16 {
        match self {
            Self::Synchronised => UNCERTAINTY_MS,
            Self::NotSynchronised | Self::Unknown => NOT_KNOWN_MS,
        }
    }
}

/// Microseconds since 1970, UTC.
pub fn now_us() -> i64 {
    let since = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    i64::try_from(since.as_micros()).unwrap_or(i64::MAX)
}

/// New identities: the time, and ten bytes from the system.
pub fn ids() -> IdSource {
    IdSource::new(|| {
        let mut random = [0; 10];
        // Without a random source the time and the process keep two writers apart.
        if getrandom::fill(&mut random).is_err() {
            random[..4].copy_from_slice(&std::process::id().to_be_bytes());
            random[4..8].copy_from_slice(&(now_us() as u32).to_be_bytes());
        }
        (now_us() as u64 / 1000, random)
    })
}

/// How the program opens a database for writing.
pub fn open_options() -> OpenOptions {
    OpenOptions::new(ids())
}

/// RFC 3339 in UTC, for JSON and reports.
pub fn rfc3339(at_us: i64) -> String {
    let shown = |at: DateTime<Utc>| at.to_rfc3339_opts(SecondsFormat::Millis, true);
    date(at_us).map_or_else(|| no_date(at_us), shown)
}

/// Year, and month, day, hour, minute and second, in UTC.
pub fn utc_fields(at_us: i64) -> (u16, [u8; 5]) {
    let at = date(at_us).unwrap_or_default();
    let fields = [at.month(), at.day(), at.hour(), at.minute(), at.second()];
    (
        u16::try_from(at.year()).unwrap_or_default(),
        fields.map(|field| field as u8),
    )
}

/// Local date and time, for tables.
pub fn local(at_us: i64) -> String {
    local_as(at_us, "%Y-%m-%d %H:%M:%S")
}

/// Local date and time with its distance from UTC, for documents.
pub fn local_zoned(at_us: i64) -> String {
    local_as(at_us, "%Y-%m-%d %H:%M:%S UTC%:z")
}

/// Local date and time to the minute, for tables with little room.
pub fn local_minute(at_us: i64) -> String {
    local_as(at_us, "%Y-%m-%d %H:%M")
}

/// Year and month in UTC, of what is counted by UTC days.
pub fn utc_month(at_us: i64) -> String {
    utc_as(at_us, "%Y-%m")
}

/// Date in UTC, of what is counted by UTC days.
pub fn utc_day(at_us: i64) -> String {
    utc_as(at_us, "%Y-%m-%d")
}

/// Local date, for sentences.
pub fn local_day(at_us: i64) -> String {
    local_as(at_us, "%Y-%m-%d")
}

fn local_as(at_us: i64, format: &str) -> String {
    let shown = |at: DateTime<Utc>| at.with_timezone(&Local).format(format).to_string();
    date(at_us).map_or_else(|| no_date(at_us), shown)
}

fn utc_as(at_us: i64, format: &str) -> String {
    date(at_us).map_or_else(|| no_date(at_us), |at| at.format(format).to_string())
}

/// `None` beyond the years 1 to 9999: a damaged file may name any time, and local time in a far year takes for ever to
/// work out.
fn date(at_us: i64) -> Option<DateTime<Utc>> {
    let at = DateTime::<Utc>::from_timestamp_micros(at_us)?;
    (1..=9999).contains(&at.year()).then_some(at)
}

fn no_date(at_us: i64) -> String {
    format!("no date ({at_us} µs)")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_is_right_only_if_the_system_says_so() {
        let folder = tempfile::tempdir().expect("a folder");
        let said = |name: &str| ClockState::said_in(&folder.path().join(name));
        assert_eq!(said("none"), ClockState::Unknown);
        std::fs::create_dir(folder.path().join("timesync")).expect("made");
        assert_eq!(said("timesync"), ClockState::NotSynchronised);
        std::fs::write(folder.path().join("timesync/synchronized"), "").expect("written");
        assert_eq!(said("timesync"), ClockState::Synchronised);
        assert_eq!(ClockState::Unknown.uncertainty_ms(), NOT_KNOWN_MS);
    }
}
