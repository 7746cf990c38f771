//! What happened where on a run.

use protocol::Instant;
use protocol::event::Event;
use protocol::message::Mode;

use super::Row;
use crate::procedure::UnitEvent;

/// Share of the highest target that counts as reached.
const REACHED: f64 = 0.99;
/// Target this far below what the limit allows belongs to the stop, km/h.
const BELOW_KMH: f64 = 0.1;

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

/// Markers, changes of limit, top speed, stop curve and standstill; `below_limit_kmh` is how far
/// below the limit ATO runs.
pub fn of_rows(rows: &[Row], below_limit_kmh: f64) -> Vec<Landmark> {
    let mut found = Vec::new();
    for pair in rows.windows(2) {
        let (before, row) = (&pair[0], &pair[1]);
        if row.marker != before.marker && row.marker != 0 {
            found.push(Landmark::at(row, format!("PSM{} passed", row.marker)));
        }
        if row.limit_kmh.is_finite() && (row.limit_kmh - before.limit_kmh).abs() > BELOW_KMH {
            found.push(Landmark::at(
                row,
                format!("limit {:.0} km/h", row.limit_kmh),
            ));
        }
    }
    let highest = rows.iter().map(|row| row.target_kmh).fold(0.0, f64::max);
    let reached = rows
        .iter()
        .find(|row| highest > 0.0 && row.speed_kmh >= REACHED * highest);
    found.extend(reached.map(|row| Landmark::at(row, format!("{highest:.0} km/h reached"))));
    let cruises = |row: &Row| row.target_kmh >= row.limit_kmh - below_limit_kmh - BELOW_KMH;
    let leaves = rows.iter().rposition(cruises).and_then(|i| rows.get(i + 1));
    found.extend(leaves.map(|row| Landmark::at(row, "stop curve takes over".into())));
    if let Some(last) = rows.iter().rposition(|row| row.speed_kmh > 0.0)
        && let Some(row) = rows.get(last + 1)
    {
        found.push(Landmark::at(row, "stop".into()));
    }
    found
}

/// What the unit logged from the start on, at the unit's own time. The unit's clock is the bench's
/// less the shortest time an entry took to be read.
pub fn of_log(log: &[(Instant, UnitEvent)], zero_s: f64, rows: &[Row]) -> Vec<Landmark> {
    let own = |event: &UnitEvent| f64::from(event.at_ms) / 1000.0;
    let ahead_s = log
        .iter()
        .map(|(read, event)| read.as_secs() - own(event))
        .fold(f64::INFINITY, f64::min);
    let Some(first) = rows.first() else {
        return Vec::new();
    };
    log.iter()
        .map(|(_, event)| {
            let t_s = own(event) + ahead_s - zero_s;
            let row = &rows[rows
                .partition_point(|row| row.t_s < t_s)
                .min(rows.len() - 1)];
            Landmark {
                t_s,
                x_m: row.x_m,
                what: described(event),
            }
        })
        .filter(|landmark| landmark.t_s >= first.t_s)
        .collect()
}

fn described(event: &UnitEvent) -> String {
    let Some(known) = Event::from_code(event.code) else {
        return format!("unit: event {} ({})", event.code, event.parameter);
    };
    let definition = known.definition();
    if known == Event::ModeChanged {
        let mode = Mode::from_code(event.parameter as u8);
        return format!("unit: mode {}", mode.label());
    }
    if definition.parameter.is_empty() {
        return format!("unit: {}", definition.name);
    }
    format!(
        "unit: {} ({} {})",
        definition.name, definition.parameter, event.parameter
    )
}
