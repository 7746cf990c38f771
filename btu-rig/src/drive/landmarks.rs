//! Landmarks of a run: events with time and position, from its rows and the unit's log.

use std::fmt::{self, Display, Formatter};

use protocol::Instant;
use protocol::event::Event;
use protocol::signal::Signal;

use super::{DrivePlan, Row};
use crate::procedure::finding::LoggedEvent;
use crate::procedure::{EventSource, UnitEvent, event_text};

/// Share of the highest target that counts as reached.
const REACHED: f64 = 0.99;
/// Number of rows (1 s) without a fall of the target after which the target counts as held.
const HOLDS_ROWS: usize = 20;
/// Targets up to this one belong to the approach to the stop point and never count as held, km/h.
const APPROACH_KMH: f64 = 10.0;
/// Difference of speeds up to which the rounding in frames may be the cause, km/h.
const DIFFERS_KMH: f64 = 0.1;

/// An event of a run with time and place, as reports list it.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark {
    /// Time since the train began to move, s.
    pub t_s: f64,
    /// Head of the train in the section, m.
    pub x_m: f64,
    pub what: Mark,
}

/// An event on the way of a train.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A precise-stop marker was passed.
    Psm(usize),
    /// This speed was reached, km/h.
    Reached(f64),
    /// The limit became this, km/h.
    Limit(f64),
    /// The stop curve took over.
    StopCurve,
    Stop,
    /// The unit or TCMS logged an event.
    Logged(LoggedEvent),
}

impl Display for Mark {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Psm(psm) => write!(f, "PSM{psm} passed"),
            Self::Reached(kmh) => write!(f, "{kmh:.0} km/h reached"),
            Self::Limit(kmh) => write!(f, "limit {kmh:.0} km/h"),
            Self::StopCurve => f.write_str("stop curve takes over"),
            Self::Stop => f.write_str("stop"),
            Self::Logged(entry) => {
                let source = match entry.source {
                    EventSource::Unit => "unit",
                    EventSource::Tcms => "TCMS",
                };
                write!(f, "{source}: {}", described(entry.code, entry.parameter))
            }
        }
    }
}

impl Landmark {
    fn at(row: &Row, what: Mark) -> Self {
        Self {
            t_s: row.t_s,
            x_m: row.x_m,
            what,
        }
    }
}

/// Markers, changes of limit, top speed, and the place where the stop curve takes over.
pub fn of_rows(rows: &[Row], plan: &DrivePlan) -> Vec<Landmark> {
    let mut found: Vec<_> = changes_of_limit(rows).collect();
    let offsets_m = plan.conditions.marker_offsets_m;
    for (psm, (place, offset)) in (1..).zip(plan.section.markers_m.iter().zip(offsets_m)) {
        found.extend(passing(rows, place + offset, Mark::Psm(psm)));
    }
    let highest = rows.iter().map(target_kmh).fold(0.0, f64::max);
    let reached = rows
        .iter()
        .find(|row| highest > 0.0 && row.speed_kmh >= REACHED * highest);
    found.extend(reached.map(|row| Landmark::at(row, Mark::Reached(highest))));
    found.extend(stop_curve(rows, plan.below_limit_kmh));
    found
}

fn target_kmh(row: &Row) -> f64 {
    row.value(Signal::Target)
}

fn changes_of_limit(rows: &[Row]) -> impl Iterator<Item = Landmark> {
    rows.windows(2).filter_map(|pair| {
        let [before_kmh, limit_kmh] = [&pair[0], &pair[1]].map(|row| row.value(Signal::Limit));
        let changed = (limit_kmh - before_kmh).abs() > DIFFERS_KMH;
        changed.then(|| Landmark::at(&pair[1], Mark::Limit(limit_kmh)))
    })
}

/// When the head passes `x_m`, between two rows.
fn passing(rows: &[Row], x_m: f64, what: Mark) -> Option<Landmark> {
    let pair = rows
        .windows(2)
        .find(|pair| pair[0].x_m < x_m && pair[1].x_m >= x_m)?;
    let share = (x_m - pair[0].x_m) / (pair[1].x_m - pair[0].x_m);
    let t_s = pair[0].t_s + share * (pair[1].t_s - pair[0].t_s);
    Some(Landmark { t_s, x_m, what })
}

/// Where the target begins to fall for good, below the limit less `below_limit_kmh`: from this row on, the target
/// neither rises nor holds any more. A target still on its way up to the limit does not begin the stop curve, nor does
/// a slow-down to a speed that is then held, as to the speed for PSM1; a slow-down that goes over into the stop
/// without being held does begin the stop curve.
fn stop_curve(rows: &[Row], below_limit_kmh: f64) -> Option<Landmark> {
    let cruises =
        |row: &Row| target_kmh(row) >= row.value(Signal::Limit) - below_limit_kmh - DIFFERS_KMH;
    // From each row on, the highest target still to come: equal to the value a second later where the target holds,
    // and where the target only dips before it rises again.
    let mut highest = 0.0;
    let mut to_come: Vec<f64> = rows
        .iter()
        .rev()
        .map(|row| {
            highest = target_kmh(row).max(highest);
            highest
        })
        .collect();
    to_come.reverse();
    let holds =
        |pair: &[f64]| pair[HOLDS_ROWS] > APPROACH_KMH && pair[0] - pair[HOLDS_ROWS] <= DIFFERS_KMH;
    let held = to_come.windows(HOLDS_ROWS + 1).rposition(holds)? + HOLDS_ROWS;
    let last = rows
        .iter()
        .rposition(cruises)
        .map_or(held, |at| at.max(held));
    let row = rows.get(last + 1).filter(|row| row.speed_kmh > 0.0)?;
    Some(Landmark::at(row, Mark::StopCurve))
}

/// Entries that unit and TCMS logged from the first row on, at their own times since the run's zero, s. The offset of
/// the unit's clock from the bench's is the least difference between reading an entry and the entry's own time.
pub(super) fn of_log(log: &[(Instant, UnitEvent)], zero_s: f64, rows: &[Row]) -> Vec<Landmark> {
    let own_s = |event: &UnitEvent| f64::from(event.at_ms) / 1000.0;
    let ahead_s = log
        .iter()
        .filter(|(_, event)| event.source == EventSource::Unit)
        .map(|(read, event)| read.as_secs() - own_s(event))
        .fold(f64::INFINITY, f64::min);
    let Some(first) = rows.first() else {
        return Vec::new();
    };
    log.iter()
        .map(|(_, event)| {
            let clock_s = match event.source {
                EventSource::Unit => ahead_s,
                EventSource::Tcms => 0.0,
            };
            let t_s = own_s(event) + clock_s - zero_s;
            let row = &rows[rows
                .partition_point(|row| row.t_s < t_s)
                .min(rows.len() - 1)];
            Landmark {
                t_s,
                x_m: row.x_m,
                what: Mark::Logged(event.into()),
            }
        })
        .filter(|landmark| landmark.t_s >= first.t_s)
        .collect()
}

/// An entry of the unit's log: its name, and what its parameter says.
fn described(event: u16, number: i32) -> String {
    let Some(known) = Event::from_code(event) else {
        return format!("event {event}, parameter {number}");
    };
    let said = event_text::parameter(known, number);
    match known {
        Event::ModeChanged => format!("mode {said}"),
        _ if said.is_empty() => known.definition().name.into(),
        _ => format!("{}: {said}", known.definition().name),
    }
}

#[cfg(test)]
mod tests {
    use super::super::metrics::tests::triangle;
    use super::*;

    #[test]
    fn places_are_found_between_rows() {
        let rows = triangle();
        let half = passing(&rows, 50.0, Mark::Stop).unwrap();
        assert!((half.t_s - 10.0).abs() < 1e-9, "{half:?}");
        let late = passing(&rows, 99.92, Mark::Stop).unwrap();
        assert!((late.t_s - 19.6).abs() < 1e-6, "{late:?}");
        assert_eq!(passing(&rows, 100.5, Mark::Stop), None);
    }

    /// The target is the limit less 5 km/h until braking begins at 10 s.
    #[test]
    fn the_stop_curve_begins_where_the_target_leaves_the_limit() {
        let rows = triangle();
        let begins = stop_curve(&rows, 5.0).unwrap();
        assert!((begins.t_s - 10.05).abs() < 0.051, "{begins:?}");
    }

    /// The limit rises from 41 to 61 km/h at 4 s, so that the target of 36 lies far below it; from
    /// 6 s on it is 30, held until 13 s when the train runs 7 m/s. Neither is the stop.
    #[test]
    fn a_rising_limit_and_a_slow_down_that_is_held_are_not_the_stop() {
        let mut rows = triangle();
        for row in &mut rows {
            let low_kmh = target_kmh(row).min(25.2);
            if row.t_s > 4.0 {
                row.signals.sample.set(Signal::Limit, 61.0);
            }
            if row.t_s > 6.0 {
                row.signals.sample.set(Signal::Target, low_kmh);
            }
        }
        let begins = stop_curve(&rows, 5.0).unwrap();
        assert!((begins.t_s - 13.0).abs() < 0.11, "{begins:?}");
    }

    #[test]
    fn an_entry_is_its_name_and_what_its_parameter_says() {
        for (event, parameter, words) in [
            (Event::AtoFailed, 7, "ato_failed: not following"),
            (Event::ModeChanged, 4, "mode automatic_run"),
            (Event::PowerUp, 0, "power_up"),
        ] {
            assert_eq!(described(event.definition().code, parameter), words);
        }
        assert_eq!(described(9999, 3), "event 9999, parameter 3");
    }
}
