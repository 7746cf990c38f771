//! `ptu trace export`: a trace as a table.

use std::fmt::Write as _;

use fault_db::TraceData;

/// Time in seconds from the trigger, then a column a channel; an unknown sample is empty.
pub fn csv(trace: &TraceData) -> String {
    let mut text = String::from("time_s");
    for channel in &trace.channels {
        let unit = channel.unit.replace('/', "");
        let _ = match unit.as_str() {
            "" => write!(text, ",{}", channel.name),
            unit => write!(text, ",{}_{unit}", channel.name),
        };
    }
    let trigger = i64::from(trace.trigger_row.unwrap_or(0));
    for row in 0..trace.rows() {
        let time_us = (row as i64 - trigger) * trace.period_us;
        let _ = write!(text, "\n{:.3}", time_us as f64 / 1e6);
        for column in &trace.columns {
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
