//! A window of rows as a trace, and one row as a freeze frame.

use btu_rig::procedure::describe::bit_names;
use btu_rig::recorder::{RecordedWindow, Row};
use fault_db::{Channel, ChannelKind, FreezeSample, TraceData};
use protocol::CYCLE;
use protocol::signal::{Kind, Sample, Signal};

/// The rows as a trace. The date `t0_us` is 0: a caller that has a clock fills it in.
pub fn trace_data(cut: &RecordedWindow) -> TraceData {
    let rows = &cut.rows;
    let column = |signal: &Signal| {
        let values = rows.iter().map(|row| row.value(*signal));
        values.map(|value| in_steps(*signal, value)).collect()
    };
    let gap = |row: &Row| row.sample.values().iter().any(|value| value.is_nan());
    TraceData {
        t0_bench_us: rows.first().map_or(0, |row| row.at.as_us() as i64),
        t0_us: 0,
        period_us: CYCLE.as_us() as i64,
        trigger_row: Some(cut.trigger_row as u32),
        partial: cut.partial,
        gaps: rows.iter().any(gap),
        channels: Signal::ALL.iter().map(|signal| channel(*signal)).collect(),
        columns: Signal::ALL.iter().map(column).collect(),
    }
}

/// The value in whole steps of its signal: arithmetic leaves crumbs below the step that mean nothing
/// and would be kept at the price of a floating-point column.
pub fn in_steps(signal: Signal, value: f64) -> f64 {
    match signal.definition().kind {
        // Hundredths are divided, so that 0.3 is written as 0.3.
        Kind::Number { lsb: 0.01 } => (value * 100.0).round() / 100.0,
        Kind::Number { lsb } => (value / lsb).round() * lsb,
        Kind::Enum(_) | Kind::Bit => value,
    }
}

pub fn channel(signal: Signal) -> Channel {
    let definition = signal.definition();
    let kind = match definition.kind {
        Kind::Number { lsb } => ChannelKind::Number { lsb },
        Kind::Bit => ChannelKind::Bit,
        Kind::Enum(labels) => ChannelKind::Enum {
            labels: (0..)
                .zip(labels.iter().map(|label| (*label).to_owned()))
                .collect(),
        },
    };
    Channel {
        name: definition.name.into(),
        unit: definition.unit.into(),
        kind,
    }
}

/// Every signal at one moment.
pub fn freeze_frame(sample: &Sample) -> Vec<FreezeSample> {
    let freeze = |signal: &Signal| {
        let definition = signal.definition();
        let value = sample.get(*signal);
        FreezeSample {
            name: definition.name.into(),
            value,
            unit: definition.unit.into(),
            label: value.and_then(|value| label(*signal, value)),
        }
    };
    Signal::ALL.iter().map(freeze).collect()
}

fn label(signal: Signal, value: f64) -> Option<String> {
    match signal.definition().kind {
        Kind::Number { .. } => bit_names(signal, value as u16),
        Kind::Bit => Some(if value == 0.0 { "off" } else { "on" }.into()),
        Kind::Enum(labels) => labels.get(value as usize).map(|label| (*label).to_owned()),
    }
}
