//! What happened where on a run.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::Mode;

use super::{DrivePlan, Row};
use crate::procedure::UnitEvent;

/// Share of the highest target that counts as reached.
const REACHED: f64 = 0.99;
/// Difference of speeds that is more than how frames round, km/h.
const DIFFERS_KMH: f64 = 0.1;

/// Something that happened.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmark {
    /// Time since the train began to move, s.
    pub t_s: f64,
    /// Head of the train in the section, m.
    pub x_m: f64,
    /// What.
    pub what: String,
}

impl Landmark {
    fn at(row: &Row, what: String) -> Self {
        Self {
            t_s: row.t_s,
            x_m: row.x_m,
            what,
        }
    }
}

/// Markers, changes of limit, top speed and where the stop begins to govern.
pub fn of_rows(rows: &[Row], plan: &DrivePlan) -> Vec<Landmark> {
    let mut found: Vec<_> = changes_of_limit(rows).collect();
    let offsets_m = plan.conditions.marker_offsets_m;
    for (psm, (place, offset)) in (1..).zip(plan.section.markers_m.iter().zip(offsets_m)) {
        found.extend(passing(rows, place + offset, format!("PSM{psm} passed")));
    }
    let highest = rows.iter().map(|row| row.target_kmh).fold(0.0, f64::max);
    let reached = rows
        .iter()
        .find(|row| highest > 0.0 && row.speed_kmh >= REACHED * highest);
    found.extend(reached.map(|row| Landmark::at(row, format!("{highest:.0} km/h reached"))));
    found.extend(stop_curve(rows, plan.below_limit_kmh));
    found
}

fn changes_of_limit(rows: &[Row]) -> impl Iterator<Item = Landmark> {
    rows.windows(2).filter_map(|pair| {
        let changed = (pair[1].limit_kmh - pair[0].limit_kmh).abs() > DIFFERS_KMH;
        changed.then(|| Landmark::at(&pair[1], format!("limit {:.0} km/h", pair[1].limit_kmh)))
    })
}

/// When the head passes `x_m`, between two rows.
fn passing(rows: &[Row], x_m: f64, what: String) -> Option<Landmark> {
    let pair = rows
        .windows(2)
        .find(|pair| pair[0].x_m < x_m && pair[1].x_m >= x_m)?;
    let share = (x_m - pair[0].x_m) / (pair[1].x_m - pair[0].x_m);
    let t_s = pair[0].t_s + share * (pair[1].t_s - pair[0].t_s);
    Some(Landmark { t_s, x_m, what })
}

/// Where the target leaves what the limit allows, less `below_limit_kmh`, for good.
fn stop_curve(rows: &[Row], below_limit_kmh: f64) -> Option<Landmark> {
    let cruises = |row: &Row| row.target_kmh >= row.limit_kmh - below_limit_kmh - DIFFERS_KMH;
    let last = rows.iter().rposition(cruises)?;
    let row = rows.get(last + 1).filter(|row| row.speed_kmh > 0.0)?;
    Some(Landmark::at(row, "stop curve takes over".into()))
}

/// What the unit logged from the first row on, at the unit's own time. The unit's clock is the
/// bench's less the shortest time an entry took to be read.
pub fn of_log(log: &[(Instant, UnitEvent)], zero_s: f64, rows: &[Row]) -> Vec<Landmark> {
    let own_s = |event: &UnitEvent| f64::from(event.at_ms) / 1000.0;
    let ahead_s = log
        .iter()
        .map(|(read, event)| read.as_secs() - own_s(event))
        .fold(f64::INFINITY, f64::min);
    let Some(first) = rows.first() else {
        return Vec::new();
    };
    log.iter()
        .map(|(_, event)| {
            let t_s = own_s(event) + ahead_s - zero_s;
            let row = &rows[rows
                .partition_point(|row| row.t_s < t_s)
                .min(rows.len() - 1)];
            Landmark {
                t_s,
                x_m: row.x_m,
                what: format!("unit: {}", described(event)),
            }
        })
        .filter(|landmark| landmark.t_s >= first.t_s)
        .collect()
}

fn described(event: &UnitEvent) -> String {
    let Some(known) = Event::from_code(event.code) else {
        return format!("event {}, parameter {}", event.code, event.parameter);
    };
    let definition = known.definition();
    if known == Event::ModeChanged {
        return format!("mode {}", Mode::from_code(event.parameter as u8).label());
    }
    if definition.parameter.is_empty() {
        return definition.name.into();
    }
    format!(
        "{}, {} = {}",
        definition.name, definition.parameter, event.parameter
    )
}

#[cfg(test)]
mod tests {
    use super::super::metrics::tests::triangle;
    use super::*;

    #[test]
    fn places_are_found_between_rows() {
        let rows = triangle();
        let half = passing(&rows, 50.0, "half".into()).unwrap();
        assert!((half.t_s - 10.0).abs() < 1e-9, "{half:?}");
        let late = passing(&rows, 99.92, "late".into()).unwrap();
        assert!((late.t_s - 19.6).abs() < 1e-6, "{late:?}");
        assert_eq!(passing(&rows, 100.5, "beyond".into()), None);
    }

    /// The target is the limit less 5 km/h until braking begins at 10 s.
    #[test]
    fn the_stop_curve_begins_where_the_target_leaves_the_limit() {
        let rows = triangle();
        let begins = stop_curve(&rows, 5.0).unwrap();
        assert!((begins.t_s - 10.05).abs() < 0.051, "{begins:?}");
        assert_eq!(stop_curve(&rows, 0.0), None, "never at the limit itself");
    }
}
