//! A trace, or a part of it, as a table.

use std::fmt::Write as _;
use std::ops::Range;

use super::Axis;
use fault_db::TraceData;

/// Time in seconds from the trigger, the way in metres where one is asked for, then a column a channel;
/// an unknown sample is empty.
pub fn csv(
    trace: &TraceData,
    channels: &[usize],
    rows: Range<usize>,
    distance: Option<&Axis>,
) -> String {
    let mut text = String::from("time_s");
    if distance.is_some() {
        text.push_str(",distance_m");
    }
    let known = || {
        channels
            .iter()
            .filter(|place| **place < trace.columns.len())
    };
    for channel in known().map(|place| &trace.channels[*place]) {
        let unit = channel.unit.replace('/', "");
        let _ = match unit.as_str() {
            "" => write!(text, ",{}", channel.name),
            unit => write!(text, ",{}_{unit}", channel.name),
        };
    }
    let trigger = i64::from(trace.trigger_row.unwrap_or(0));
    for row in rows.start..rows.end.min(trace.rows()) {
        let time_us = (row as i64 - trigger) * trace.period_us;
        let _ = write!(text, "\n{:.3}", time_us as f64 / 1e6);
        if let Some(axis) = distance {
            let _ = write!(text, ",{:.2}", axis.at(row));
        }
        for column in known().map(|place| &trace.columns[*place]) {
            let value = column[row];
            let _ = if value.is_nan() {
                write!(text, ",")
            } else {
                write!(text, ",{value}")
            };
        }
    }
    text.push('\n');
    text
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
        let expected = "time_s,speed_kmh\n-0.050,2.5\n0.000,\n";
        assert_eq!(csv(&data, &[0], 1..3, None), expected);
        let expected = "time_s,distance_m,train_position,speed_kmh\n0.050,1.00,3,4\n";
        assert_eq!(csv(&data, &[1, 0], 3..9, axis.as_ref()), expected);
        assert_eq!(csv(&data, &[], 0..0, None), "time_s\n");
    }
}
