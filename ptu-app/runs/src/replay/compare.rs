//! Compares two traces signal by signal.

use std::collections::BTreeMap;
use std::ops::Range;

use fault_db::{Channel, ChannelKind, TraceData};

use super::path;
use crate::failure::{Failure, RecordTrouble, Unknown, did_you_mean};

/// Quantities without a unit of measurement. All other such signals are numbers of things, bits or codes, in which any
/// difference counts.
const PLAIN_QUANTITIES: [&str; 2] = ["effort", "tcms_value"];

/// Rows by which a value may come sooner or later where a unit runs by a clock of its own.
const CLOCK_ROWS: usize = 2;

/// Tolerances by unit of measurement, where a unit runs by a clock of its own: twice the largest difference between two
/// runs of one good unit on a port.
const CLOCK_TOLERANCES: [(&str, f64); 6] = [
    ("km/h", 1.0),
    ("m", 1.0),
    ("V", 0.1),
    ("Hz", 0.1),
    ("mV", 2.0),
    ("%", 0.1),
];
/// Units of measurement of signals that are left out where a unit runs by a clock of its own: efforts and accelerations
/// lag behind what the train was asked for before the procedure began, and jump with every late frame. The orders of
/// TCMS are compared.
const CLOCK_LEFT_OUT: [&str; 3] = ["N", "m/s²", "m/s³"];
/// Tolerance of `PLAIN_QUANTITIES` (efforts of 1 024) where a unit runs by a clock of its own.
const CLOCK_TOLERANCE_PLAIN: f64 = 30.0;

/// Rows at the beginning of a procedure in which the earlier state of the bench still shows.
const LEFT_ROWS: i64 = 20;

/// Signals that go on counting from power-up: only what was added since the procedure began is compared.
const COUNTERS: [&str; 3] = ["train_position", "position", "marker_count"];
/// Counts of frames, which are left out where one of the units is on a wire: each end sends at its own
/// times, and a busy line loses some.
const FRAME_COUNTS: [&str; 4] = ["rejected_frames", "twc_received", "twc_answers", "twc_sent"];

/// Rule of a comparison. Numbers deviate if they differ by more than their smallest step and the tolerance, words and
/// bits if they differ at all; a known value deviates from an unknown one always.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// Rows by which a value may come sooner or later.
    slack_rows: usize,
    /// A unit runs by a clock of its own: numbers have its tolerances, and of counters only the increase is compared.
    wall_clock: bool,
    /// First row compared, from the trigger.
    from_row: i64,
    /// Rows by which the second trace is laid later than its trigger says.
    shift_rows: i64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    pub signal: String,
    pub channel: Channel,
    /// First row that differs, counted in the first trace.
    pub row: usize,
    pub first: Difference,
    /// Largest difference of a number; the first one of a word or bit.
    pub largest: Difference,
    /// Number of rows that differ.
    pub rows: usize,
    /// These rows, as ranges of rows of the first trace.
    pub stretches: Vec<Range<usize>>,
}

/// Two values at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Seconds from the trigger.
    pub at_s: f64,
    /// Value of the first trace; `None` = not known.
    pub value: Option<f64>,
    pub expected: Option<f64>,
}

/// Two traces compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Signals that differ, in the order in which they began to.
    pub deviations: Vec<Deviation>,
    /// Signals the first trace lacks.
    pub missing: Vec<String>,
    /// Signals the second one lacks.
    pub missing_expected: Vec<String>,
    /// Seconds from the trigger to the first and last row compared.
    pub window_s: (f64, f64),
}

impl Comparison {
    /// Deviations that say something of the unit: counts of frames alone are none, because they depend on when each
    /// end of a link began to send.
    pub fn evidence(&self) -> usize {
        let of_link = |deviation: &&Deviation| !FRAME_COUNTS.contains(&deviation.signal.as_str());
        self.deviations.iter().filter(of_link).count()
    }
}

impl Rule {
    /// Two benches in virtual time: the same stimuli give the same samples, to the last bit.
    pub const fn exact() -> Self {
        Self {
            slack_rows: 0,
            wall_clock: false,
            from_row: i64::MIN,
            shift_rows: 0,
        }
    }

    /// Two benches, one of them paced by the wall clock.
    pub const fn wall_clock() -> Self {
        Self {
            slack_rows: CLOCK_ROWS,
            wall_clock: true,
            from_row: i64::MIN,
            shift_rows: 0,
        }
    }

    /// Rule for one trace paced by the wall clock, on a bench that had been in use: rows are compared from one second
    /// after `began_row`, in which the procedure began, counted from the trigger.
    pub const fn after_begin(began_row: i64) -> Self {
        Self {
            from_row: began_row.saturating_add(LEFT_ROWS),
            ..Self::wall_clock()
        }
    }

    /// This rule with the second trace laid `shift_rows` later; negative: sooner.
    pub const fn shifted(self, shift_rows: i64) -> Self {
        Self { shift_rows, ..self }
    }

    fn tolerance(&self, channel: &Channel) -> Option<f64> {
        let ChannelKind::Number { lsb } = channel.kind else {
            return None;
        };
        let plain = channel.unit.is_empty();
        if plain && !PLAIN_QUANTITIES.contains(&channel.name.as_str()) {
            return None;
        }
        let tolerance = if !self.wall_clock {
            0.0
        } else if plain {
            CLOCK_TOLERANCE_PLAIN
        } else {
            let known = CLOCK_TOLERANCES
                .iter()
                .find(|(unit, _)| *unit == channel.unit);
            known.map_or(0.0, |(_, tolerance)| *tolerance)
        };
        // A little more, so that values exactly one step apart do not deviate.
        Some(lsb.max(tolerance) * 1.000_001)
    }
}

/// Compares the trace `came` with the `expected` one, aligned at their triggers: the signals named in `signals`, or all
/// if it is empty.
///
/// # Errors
/// Rows of another period, no row in common, or a signal in neither.
pub fn compare(
    came: &TraceData,
    expected: &TraceData,
    rule: &Rule,
    signals: &[String],
) -> Result<Comparison, Failure> {
    if came.period_us != expected.period_us {
        return Err(Failure::usage(RecordTrouble::Periods(
            came.period_us / 1000,
            expected.period_us / 1000,
        )));
    }
    let rows = Rows::of(came, expected, rule)?;
    let wanted = |channel: &Channel| {
        let name = channel.name.as_str();
        let loose = FRAME_COUNTS.contains(&name) || CLOCK_LEFT_OUT.contains(&channel.unit.as_str());
        let left_out = path::LEFT_OUT.contains(&name) || (rule.wall_clock && loose);
        !left_out && (signals.is_empty() || signals.iter().any(|signal| signal == name))
    };
    let theirs: BTreeMap<&str, &[f64]> = expected
        .channels
        .iter()
        .zip(&expected.columns)
        .map(|(channel, column)| (channel.name.as_str(), column.as_slice()))
        .collect();
    for signal in signals {
        let in_came = came.column(signal).is_some();
        if !in_came && !theirs.contains_key(signal.as_str()) {
            let known = came.channels.iter().map(|channel| channel.name.as_str());
            let near = did_you_mean(signal, known.chain(theirs.keys().copied()));
            return Err(Failure::usage(Unknown::Signal(signal.clone(), near)));
        }
    }
    let mut deviations = Vec::new();
    let mut missing_expected = Vec::new();
    for (channel, column) in came.channels.iter().zip(&came.columns) {
        if !wanted(channel) {
            continue;
        }
        match theirs.get(channel.name.as_str()) {
            None => missing_expected.push(channel.name.clone()),
            Some(theirs) => deviations.extend(rows.deviation(channel, column, theirs, rule)),
        }
    }
    let missing = expected
        .channels
        .iter()
        .filter(|channel| wanted(channel) && came.column(&channel.name).is_none())
        .map(|channel| channel.name.clone())
        .collect();
    in_order(&mut deviations);
    Ok(Comparison {
        deviations,
        missing,
        missing_expected,
        window_s: (rows.at_s(rows.from), rows.at_s(rows.last)),
    })
}

/// Sorts deviations by time, and within one report of the unit by their place on the way through
/// the unit.
fn in_order(deviations: &mut [Deviation]) {
    deviations.sort_by_key(|deviation| deviation.row);
    let mut from = 0;
    while from < deviations.len() {
        let report = deviations[from].row + path::REPORT_ROWS;
        let rest = &deviations[from..];
        let together = rest.iter().take_while(|d| d.row <= report).count();
        deviations[from..from + together].sort_by_key(|d| (path::place(&d.signal), d.row));
        from += together;
    }
}

/// Rows that both traces have, counted in the first.
struct Rows {
    first: usize,
    /// First row that is compared; rows before it only serve as neighbours, within the slack.
    from: usize,
    last: usize,
    /// Row number in the second trace less row number in the first.
    shift: i64,
    trigger: i64,
    period_us: i64,
}

impl Rows {
    fn of(came: &TraceData, expected: &TraceData, rule: &Rule) -> Result<Self, Failure> {
        let trigger = |trace: &TraceData| i64::from(trace.trigger_row.unwrap_or(0));
        let shift = (trigger(expected) - trigger(came)).saturating_sub(rule.shift_rows);
        let begin = 0.max(-shift);
        let from = begin.max(rule.from_row.saturating_add(trigger(came)));
        let end = (came.rows() as i64 - 1).min(expected.rows() as i64 - 1 - shift);
        if end - (rule.slack_rows as i64) < from {
            return Err(Failure::usage(RecordTrouble::NoCommonTime));
        }
        Ok(Self {
            first: begin as usize,
            from: from as usize,
            last: end as usize,
            shift,
            trigger: trigger(came),
            period_us: came.period_us,
        })
    }

    fn at_s(&self, row: usize) -> f64 {
        ((row as i64 - self.trigger) * self.period_us) as f64 / 1e6
    }

    fn deviation(
        &self,
        channel: &Channel,
        came: &[f64],
        expected: &[f64],
        rule: &Rule,
    ) -> Option<Deviation> {
        let shifted = self.first.saturating_add_signed(self.shift as isize);
        let came = came.get(self.first..=self.last)?;
        let expected = expected.get(shifted..=shifted + (self.last - self.first))?;
        let tolerance = rule.tolerance(channel);
        // A counter begins at the first row where both traces know it.
        let counts = rule.wall_clock && COUNTERS.contains(&channel.name.as_str());
        let begun = self.from - self.first;
        let both = came[begun..]
            .iter()
            .zip(&expected[begun..])
            .find(|(a, b)| !a.is_nan() && !b.is_nan());
        let offset = both.filter(|_| counts).map_or(0.0, |(a, b)| a - b);
        let pair = Pair {
            came,
            expected,
            offset,
            tolerance,
            slack: rule.slack_rows,
        };
        // At the end of a trace nothing tells whether a value came a little later.
        let compared = begun..came.len().saturating_sub(rule.slack_rows);
        let mut apart = compared.filter(|row| pair.apart(*row)).peekable();
        let first = *apart.peek()?;
        let difference = |row: usize| Difference {
            at_s: self.at_s(self.first + row),
            value: known(came[row] - offset),
            expected: known(expected[row]),
        };
        let (mut rows, mut largest) = (0, first);
        let mut stretches: Vec<Range<usize>> = Vec::new();
        for row in apart {
            rows += 1;
            let at = self.first + row;
            match stretches.last_mut() {
                Some(last) if last.end == at => last.end += 1,
                _ => stretches.push(at..at + 1),
            }
            if tolerance.is_some() && pair.size(row) > pair.size(largest) {
                largest = row;
            }
        }
        Some(Deviation {
            signal: channel.name.clone(),
            channel: channel.clone(),
            row: self.first + first,
            first: difference(first),
            largest: difference(largest),
            rows,
            stretches,
        })
    }
}

/// Two columns of the same rows.
struct Pair<'a> {
    came: &'a [f64],
    expected: &'a [f64],
    /// Value that is subtracted from the value that came.
    offset: f64,
    /// `None`: any difference counts.
    tolerance: Option<f64>,
    slack: usize,
}

impl Pair<'_> {
    /// Whether the values of a row deviate: in the rows around, the expected one did not come, or the one that came was
    /// not expected.
    fn apart(&self, row: usize) -> bool {
        let same = |a: f64, b: f64| match self.tolerance {
            _ if a.is_nan() || b.is_nan() => a.is_nan() && b.is_nan(),
            None => a == b,
            Some(tolerance) => (a - b).abs() <= tolerance,
        };
        let value = self.came[row] - self.offset;
        if same(value, self.expected[row]) {
            return false;
        }
        if self.slack == 0 {
            return true;
        }
        let near = row.saturating_sub(self.slack)..=(row + self.slack).min(self.came.len() - 1);
        let came = |other: usize| self.came[other] - self.offset;
        let is_near = near.clone().any(|other| same(value, self.expected[other]))
            && near
                .clone()
                .any(|other| same(came(other), self.expected[row]));
        // A signal that moves fast takes the value between two rows.
        let passes = |value: f64, column: &dyn Fn(usize) -> f64| {
            let (low, high) = near
                .clone()
                .map(column)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(value), high.max(value))
                });
            low <= value && value <= high
        };
        let between = self.tolerance.is_some()
            && passes(value, &|other| self.expected[other])
            && passes(self.expected[row], &came);
        !is_near && !between
    }

    fn size(&self, row: usize) -> f64 {
        let size = (self.came[row] - self.offset - self.expected[row]).abs();
        if size.is_nan() { 0.0 } else { size }
    }
}

fn known(value: f64) -> Option<f64> {
    (!value.is_nan()).then_some(value)
}

#[cfg(test)]
mod tests;
