//! A trace, or a part of it, as a table.

use std::io::{self, Write};
use std::ops::Range;

use fault_db::TraceData;

use super::Axis;
use crate::trace_io::csv::{put_headings, put_row};

/// Writes the time in seconds from the trigger, the way in metres where one is asked for, then a column a channel; an
/// unknown sample is empty.
///
/// # Errors
/// `out` fails.
pub fn csv(
    out: &mut impl Write,
    trace: &TraceData,
    channels: &[usize],
    rows: Range<usize>,
    distance: Option<&Axis>,
) -> io::Result<()> {
    let signal = |place: &usize| Some((trace.channels.get(*place)?, trace.columns.get(*place)?));
    let known = || channels.iter().filter_map(signal);
    put_headings(out, distance.is_some(), known().map(|(channel, _)| channel))?;
    let trigger = i64::from(trace.trigger_row.unwrap_or(0));
    for row in rows.start..rows.end.min(trace.rows()) {
        let time_us = (row as i64 - trigger) * trace.period_us;
        let distance_m = distance.map(|axis| axis.at(row));
        let samples = known().map(|(channel, column)| (channel, column[row]));
        put_row(out, (time_us, trace.period_us), distance_m, samples)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::tests::trace;
    use super::*;

    #[test]
    fn a_part_has_its_rows_and_channels_and_unknown_is_empty() {
        let mut data = trace(&[
            ("speed", &[1.0, 2.5, f64::NAN, 4.0]),
            ("train_position", &[0.0, 1.0, 2.0, 3.0]),
        ]);
        data.trigger_row = Some(2);
        data.channels[0].unit = "km/h".into();
        let axis = Axis::distance(&data, 2);
        let text = |channels: &[usize], rows, distance| {
            let mut text = Vec::new();
            csv(&mut text, &data, channels, rows, distance).expect("written");
            String::from_utf8(text).expect("text")
        };
        let expected = "\u{feff}time_s,speed_kmh\n-0.050,2.5\n0.000,\n";
        assert_eq!(text(&[0], 1..3, None), expected);
        let expected = "\u{feff}time_s,distance_m,train_position,speed_kmh\n0.050,1.00,3,4\n";
        assert_eq!(text(&[1, 0], 3..9, axis.as_ref()), expected);
        assert_eq!(text(&[], 0..0, None), "\u{feff}time_s\n");
    }
}
