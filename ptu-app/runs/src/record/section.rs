//! The section that a recorded run went through: the record has places from the section's start, and no number.

use fault_db::TraceData;
use protocol::line::{Line, Section};
use protocol::signal::Signal;

use super::compare::RESTS_KMH;
use crate::failure::{Failure, RecordTrouble};

/// Greatest difference of a marker's place, or of the stop, that is still of this section, m.
const NEAR_M: f64 = 30.0;

/// The number of the section of `line` whose markers and stop are where the run found them.
///
/// # Errors
/// No section fits, or several fit alike: which.
pub fn find_section(line: &Line, trace: &TraceData) -> Result<u16, Failure> {
    let seen = places(trace);
    if seen.is_empty() {
        return Err(Failure::usage(RecordTrouble::NoMarkers));
    }
    let mut matches: Vec<_> = line
        .sections
        .iter()
        .filter_map(|section| Some((off_m(section, &seen)?, section.section)))
        .collect();
    matches.sort_by(|a, b| a.0.total_cmp(&b.0));
    match &matches[..] {
        [] => Err(Failure::usage(RecordTrouble::NoSectionFits(
            line.name.clone(),
        ))),
        [(best_m, _), (other_m, _), ..] if *other_m < 2.0 * best_m + 1.0 => {
            let near = (matches.iter()).filter(|(off_m, _)| *off_m < 2.0 * best_m + 1.0);
            let near: Vec<_> = near.map(|(_, section)| section.to_string()).collect();
            Err(Failure::usage(RecordTrouble::SectionsAlike(
                near.join(", "),
            )))
        }
        [(_, best), ..] => Ok(*best),
    }
}

/// Places of markers by number, and with number 0 where the train stopped.
fn places(trace: &TraceData) -> Vec<(usize, f64)> {
    let column = |signal: Signal| trace.column(signal.definition().name).unwrap_or_default();
    let (position, count) = (column(Signal::Position), column(Signal::MarkerCount));
    let (marker, speed) = (column(Signal::Marker), column(Signal::Speed));
    let mut seen = Vec::new();
    for row in 1..trace.rows() {
        if count[row] > count[row - 1] && position[row].is_finite() {
            seen.push((marker[row] as usize, position[row]));
        }
    }
    let moved = speed.iter().any(|kmh| *kmh > 0.0);
    // The record ends when ATO has arrived.
    let stands = |row: &usize| speed[*row] <= RESTS_KMH;
    let last = (0..trace.rows()).rev().find(|row| !speed[*row].is_nan());
    seen.extend(
        last.filter(|row| moved && stands(row))
            .map(|row| (0, position[row])),
    );
    seen
}

/// Root mean square of the differences of markers and stop from those of a section, m; none if one is too far off.
fn off_m(section: &Section, seen: &[(usize, f64)]) -> Option<f64> {
    let mut sum = 0.0;
    for (marker, at_m) in seen {
        let place_m = match marker {
            0 => section.stop_m,
            1..=4 => section.markers_m[marker - 1],
            _ => continue,
        };
        let off_m = at_m - place_m;
        if off_m.abs() > NEAR_M {
            return None;
        }
        sum += off_m * off_m;
    }
    Some((sum / seen.len() as f64).sqrt())
}
