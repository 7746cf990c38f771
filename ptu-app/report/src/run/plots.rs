//! Plots of a trace: speeds, and the switched signals that changed nearest to the trigger.

use std::collections::BTreeMap;

use fault_db::{Channel, ChannelKind, TraceData};

use crate::plot::{AxisMark, Note, Plot, Series, Style};
use crate::words::Words;

/// Recorded speed signals, each with its colour; a speed that is not known in any row is left out.
const SPEEDS: [(&str, usize, Style); 4] = [
    ("limit", 1, Style::Dashed),
    ("target", 2, Style::Dashed),
    ("train_speed", 4, Style::Line),
    ("speed", 0, Style::Line),
];
/// Most switched signals that are drawn below each other.
const LANES: usize = 8;
/// Reach of a close-up on each side of the trigger, and its greatest number of lanes.
const CLOSE_US: i64 = 2_000_000;
const CLOSE_LANES: usize = 5;
/// Height of a lane, and of all that is around them, in units of the drawing.
const LANE: f64 = 26.0;
const AROUND: f64 = 96.0;
/// Height of a switched signal in its lane.
const SWING: f64 = 0.62;
/// Height of the base line of words in a lane, as a share of `SWING`.
const WORDS: f64 = 0.24;
/// Room for names of signals.
const BESIDE: f64 = 120.0;

/// The trace with those of its channels alone that are drawn.
pub fn drawn_channels(trace: TraceData) -> TraceData {
    with_lanes(trace, LANES)
}

/// Plot of the signals that changed close to the trigger, or else of the speeds there.
pub fn close_up(trace: &TraceData, words: &Words) -> Option<Plot> {
    let trigger = trace.trigger_row.unwrap_or(0) as usize;
    let reach = usize::try_from(CLOSE_US / trace.period_us.max(1)).unwrap_or(usize::MAX);
    let from = trigger.saturating_sub(reach);
    let to = trigger.saturating_add(reach + 1).min(trace.rows());
    let cut = |column: &Vec<f64>| column.get(from..to).map(<[f64]>::to_vec);
    let near = TraceData {
        columns: trace.columns.iter().map(cut).collect::<Option<_>>()?,
        trigger_row: u32::try_from(trigger - from).ok(),
        ..trace.clone()
    };
    plots(&with_lanes(near, CLOSE_LANES), words).pop()
}

fn with_lanes(trace: TraceData, most: usize) -> TraceData {
    let trigger = trace.trigger_row.unwrap_or(0) as usize;
    let pairs = || trace.channels.iter().zip(&trace.columns);
    let mut switched: Vec<(usize, &str)> = pairs()
        .filter(|(channel, _)| !matches!(channel.kind, ChannelKind::Number { .. }))
        .filter_map(|(channel, column)| {
            Some((nearest_change(column, trigger)?, channel.name.as_str()))
        })
        .collect();
    switched.sort_by_key(|(distance, _)| *distance);
    let kept: Vec<String> = SPEEDS
        .iter()
        .map(|speed| speed.0)
        .chain(switched.iter().take(most).map(|lane| lane.1))
        .map(str::to_owned)
        .collect();
    let (channels, columns) = trace
        .channels
        .into_iter()
        .zip(trace.columns)
        .filter(|(channel, _)| kept.contains(&channel.name))
        .unzip();
    TraceData {
        channels,
        columns,
        ..trace
    }
}

/// Rows between the trigger and the nearest change of the column; `None` if the column never changes.
fn nearest_change(column: &[f64], trigger: usize) -> Option<usize> {
    let changed = |pair: &[f64]| pair[0] != pair[1] && !(pair[0].is_nan() && pair[1].is_nan());
    let rows = column.windows(2).enumerate();
    rows.filter(|(_, pair)| changed(pair))
        .map(|(row, _)| (row + 1).abs_diff(trigger))
        .min()
}

/// Plots of the trace over the time from its trigger.
pub fn plots(trace: &TraceData, words: &Words) -> Vec<Plot> {
    let report = &words.report;
    let rows = trace.rows();
    if rows < 2 {
        return Vec::new();
    }
    let trigger = f64::from(trace.trigger_row.unwrap_or(0));
    let time = |row: usize| (row as f64 - trigger) * trace.period_us as f64 / 1e6;
    let plot = |title: &str, y_label: &str| Plot {
        title: title.to_owned(),
        x_label: report.from_trigger.into(),
        y_label: y_label.to_owned(),
        x_range: Some((time(0), time(rows - 1))),
        places: vec![AxisMark {
            x: 0.0,
            name: report.trigger.into(),
        }],
        ..Plot::default()
    };
    let mut all = Vec::new();
    let series = speeds(trace, &time, words);
    if !series.is_empty() {
        all.push(Plot {
            y_reach: Some((0.0, 1.0)),
            height: Some(230.0),
            series,
            ..plot(report.speeds, "km/h")
        });
    }
    let lanes: Vec<_> = trace
        .channels
        .iter()
        .zip(&trace.columns)
        .filter(|(channel, _)| !matches!(channel.kind, ChannelKind::Number { .. }))
        .collect();
    if !lanes.is_empty() {
        let mut drawing = Plot {
            y_reach: Some((0.0, lanes.len() as f64)),
            height: Some(AROUND + LANE * lanes.len() as f64),
            ..plot(report.changes, "")
        };
        for (place, (channel, column)) in lanes.iter().rev().enumerate() {
            lane(&mut drawing, (place, channel, column), &time, words);
        }
        all.push(drawing);
    }
    // The plots stand below each other, with the same time at the same place.
    let left = all.iter().map(Plot::left).fold(BESIDE, f64::max);
    for plot in &mut all {
        plot.beside = Some(left);
    }
    all
}

fn speeds(trace: &TraceData, time: &impl Fn(usize) -> f64, words: &Words) -> Vec<Series> {
    let known = |name: &str| {
        let column = trace.column(name)?;
        column.iter().any(|value| !value.is_nan()).then_some(column)
    };
    SPEEDS
        .iter()
        .filter_map(|(name, colour, style)| {
            // The ends of each stretch draw the same line as all of its rows.
            let ends = stretches(known(name)?).into_iter();
            let ends = ends.flat_map(|(first, last, value)| [(first, value), (last, value)]);
            let mut points: Vec<_> = ends.map(|(row, value)| (time(row), value)).collect();
            points.dedup_by_key(|point| point.0);
            Some(Series {
                name: words.signal(name).into_owned(),
                colour: *colour,
                style: *style,
                points,
            })
        })
        .collect()
}

/// A switched signal in its lane: two states as a line with steps, more of them as a box each, with
/// words where there is room.
fn lane(
    drawing: &mut Plot,
    (place, channel, column): (usize, &Channel, &[f64]),
    time: &impl Fn(usize) -> f64,
    words: &Words,
) {
    let base = place as f64 + 0.12;
    let no_labels = BTreeMap::new();
    let labels = match &channel.kind {
        ChannelKind::Enum { labels } => labels,
        ChannelKind::Bit | ChannelKind::Number { .. } => &no_labels,
    };
    let boxes = labels.len() > 2;
    let mut points = Vec::new();
    for (first, last, value) in stretches(column) {
        let (from, to) = (time(first), time((last + 1).min(column.len() - 1)));
        if value.is_nan() {
            points.push((from, value));
            continue;
        }
        let high = base
            + if boxes {
                SWING
            } else {
                value.clamp(0.0, 1.0) * SWING
            };
        points.extend([(from, high), (to, high)]);
        if boxes {
            points.extend([(to, base), (from, base), (from, high), (from, f64::NAN)]);
        }
        if let Some(label) = labels.get(&(value as i64)) {
            drawing.notes.push(Note {
                at: (from, base + SWING * WORDS),
                until: to,
                text: words.state(&channel.name, label).into_owned(),
            });
        }
    }
    let name = words.signal(&channel.name).into_owned();
    drawing.names.push((place as f64 + 0.35, name));
    drawing.series.push(Series {
        name: String::new(),
        colour: place,
        style: Style::Line,
        points,
    });
}

/// First and last row and value of each stretch over which a column stays the same.
fn stretches(column: &[f64]) -> Vec<(usize, usize, f64)> {
    let mut all = Vec::new();
    let mut row = 0;
    // Compared by their bits: from NaN (unknown) to NaN is no change.
    for same in column.chunk_by(|a, b| a.to_bits() == b.to_bits()) {
        all.push((row, row + same.len() - 1, same[0]));
        row += same.len();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::Language;

    fn trace() -> TraceData {
        let channel = |name: &str, kind| Channel {
            name: name.into(),
            unit: String::new(),
            kind,
        };
        let labels = [(0, "off".to_owned()), (1, "manual".to_owned())].into();
        TraceData {
            period_us: 50_000,
            trigger_row: Some(2),
            gaps: true,
            channels: vec![
                channel("speed", ChannelKind::Number { lsb: 0.1 }),
                channel("tacho", ChannelKind::Number { lsb: 0.1 }),
                channel("eb", ChannelKind::Bit),
                channel("alarm", ChannelKind::Bit),
                channel("mode", ChannelKind::Enum { labels }),
            ],
            columns: vec![
                vec![1.0, 1.0, 1.0, 2.0],
                vec![1.0; 4],
                vec![0.0, 0.0, 1.0, 1.0],
                vec![0.0; 4],
                vec![f64::NAN, f64::NAN, 0.0, 1.0],
            ],
            ..TraceData::default()
        }
    }

    #[test]
    fn speeds_and_what_changed_are_kept_and_drawn() {
        let trace = drawn_channels(trace());
        let names: Vec<_> = trace.channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["speed", "eb", "mode"]);
        let plots = plots(&trace, Language::English.words());
        assert_eq!(plots.len(), 2);
        assert_eq!(plots[0].x_range, Some((-0.1, 0.05)));
        let names: Vec<_> = plots[1].names.iter().map(|n| n.1.as_str()).collect();
        assert_eq!(names, ["mode", "eb"], "the first lane is on top");
        let notes: Vec<_> = plots[1].notes.iter().map(|n| n.text.as_str()).collect();
        assert_eq!(notes, ["off", "manual"]);
    }

    #[test]
    fn an_empty_trace_gives_no_plot() {
        let mut trace = trace();
        trace.columns.iter_mut().for_each(Vec::clear);
        assert!(plots(&drawn_channels(trace), Language::Korean.words()).is_empty());
    }
}
