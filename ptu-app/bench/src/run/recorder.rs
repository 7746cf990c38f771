//! A ring of sample rows, and the traces cut from it around faults.

use std::collections::VecDeque;

use btu_rig::procedure::describe::bit_names;
use fault_db::{Channel, ChannelKind, FreezeSample, TraceData};
use protocol::signal::{Kind, Sample, Signal};
use protocol::{CYCLE, Duration, Instant};

/// Recorded before a trigger at least.
pub const BEFORE: Duration = Duration::from_ms(10_000);
/// Recorded after a trigger.
pub const AFTER: Duration = Duration::from_ms(5_000);
/// A slow fault's window begins with its step, but not longer before the trigger than this.
const LONGEST_BEFORE: Duration = Duration::from_ms(120_000);
/// Later faults extend an open window up to this length, then begin their own.
const LONGEST_WINDOW: Duration = Duration::from_ms(180_000);
/// Rows kept: the longest window.
const RING_ROWS: usize = (LONGEST_WINDOW.as_us() / CYCLE.as_us()) as usize + 1;

/// One row: when, and every signal.
struct Row {
    at: Instant,
    values: [f64; Signal::COUNT],
}

/// A window that is still being recorded.
struct Window {
    faults: Vec<usize>,
    from: Instant,
    trigger: Instant,
    until: Instant,
}

/// A window that is complete.
#[derive(Clone, Debug)]
pub struct Cut {
    /// Faults it shows, by their number in the procedure.
    pub faults: Vec<usize>,
    /// The samples; `t0_us` is left for the edge to fill in.
    pub trace: TraceData,
}

/// Records every signal every 50 ms.
#[derive(Default)]
pub struct Recorder {
    rows: VecDeque<Row>,
    open: Option<Window>,
}

impl Recorder {
    /// Takes one row; returns the window it completes.
    pub fn record(&mut self, now: Instant, sample: &Sample) -> Option<Cut> {
        if self.rows.len() == RING_ROWS {
            self.rows.pop_front();
        }
        self.rows.push_back(Row {
            at: now,
            values: *sample.values(),
        });
        self.open
            .as_ref()
            .is_some_and(|window| now >= window.until)
            .then(|| self.close(false))?
    }

    /// Fault number `fault` happened now, in a step that began at `step_began`. Inside an open
    /// window it extends and shares that.
    pub fn trigger(&mut self, now: Instant, step_began: Instant, fault: usize) -> Option<Cut> {
        if let Some(window) = &mut self.open
            && (now + AFTER).since(window.from) <= LONGEST_WINDOW
        {
            window.until = now + AFTER;
            window.faults.push(fault);
            return None;
        }
        let done = self.close(true);
        let earliest = now.back(LONGEST_BEFORE);
        let from = now.back(BEFORE).min(step_began.max(earliest));
        let until = now + AFTER;
        self.open = Some(Window {
            faults: vec![fault],
            from,
            trigger: now,
            until,
        });
        done
    }

    /// A window is being recorded.
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Ends the open window; `partial` when its time is not over.
    pub fn close(&mut self, partial: bool) -> Option<Cut> {
        let window = self.open.take()?;
        let trace = self.trace(window.from, window.trigger, partial)?;
        Some(Cut {
            faults: window.faults,
            trace,
        })
    }

    /// All rows from `from` on as a trace.
    pub fn trace(&self, from: Instant, trigger: Instant, partial: bool) -> Option<TraceData> {
        let rows: Vec<&Row> = self.rows.iter().filter(|row| row.at >= from).collect();
        let first = rows.first()?.at;
        let trigger_row = rows.iter().position(|row| row.at >= trigger);
        let column = |signal: &Signal| {
            let values = rows.iter().map(|row| row.values[signal.index()]);
            values.map(|value| in_steps(*signal, value)).collect()
        };
        Some(TraceData {
            t0_bench_us: first.as_us() as i64,
            t0_us: 0,
            period_us: CYCLE.as_us() as i64,
            trigger_row: Some(trigger_row.unwrap_or(rows.len() - 1) as u32),
            partial,
            gaps: rows
                .iter()
                .any(|row| row.values.iter().any(|value| value.is_nan())),
            channels: Signal::ALL.iter().map(|signal| channel(*signal)).collect(),
            columns: Signal::ALL.iter().map(column).collect(),
        })
    }
}

/// The value in whole steps of its signal: arithmetic leaves crumbs below the step that mean nothing
/// and would be kept at the price of a floating-point column.
fn in_steps(signal: Signal, value: f64) -> f64 {
    match signal.definition().kind {
        // Hundredths are divided, so that 0.3 is written as 0.3.
        Kind::Number { lsb: 0.01 } => (value * 100.0).round() / 100.0,
        Kind::Number { lsb } => (value / lsb).round() * lsb,
        Kind::Enum(_) | Kind::Bit => value,
    }
}

fn channel(signal: Signal) -> Channel {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn run(recorder: &mut Recorder, from_ms: u64, to_ms: u64) -> Option<Cut> {
        (from_ms..to_ms)
            .step_by(50)
            .find_map(|ms| recorder.record(Instant::from_ms(ms), &Sample::default()))
    }

    #[test]
    fn a_window_has_ten_seconds_before_and_five_after() {
        let mut recorder = Recorder::default();
        run(&mut recorder, 0, 30_000);
        assert!(
            recorder
                .trigger(Instant::from_ms(30_000), Instant::from_ms(29_000), 0)
                .is_none()
        );
        let cut = run(&mut recorder, 30_000, 60_000).expect("window");
        assert_eq!(cut.trace.t0_bench_us, 20_000_000);
        assert_eq!(cut.trace.columns[0].len(), 301);
        assert_eq!(cut.trace.trigger_row, Some(200));
        assert!(!cut.trace.partial);
    }

    #[test]
    fn a_slow_fault_begins_with_its_step_and_a_later_one_shares_the_window() {
        let mut recorder = Recorder::default();
        run(&mut recorder, 0, 60_000);
        recorder.trigger(Instant::from_ms(60_000), Instant::from_ms(20_000), 0);
        run(&mut recorder, 60_000, 63_000);
        recorder.trigger(Instant::from_ms(63_000), Instant::from_ms(20_000), 1);
        let cut = run(&mut recorder, 63_000, 90_000).expect("window");
        assert_eq!(cut.faults, [0, 1]);
        assert_eq!(cut.trace.t0_bench_us, 20_000_000);
        assert_eq!(cut.trace.columns[0].len(), 961, "20 s to 68 s");
    }

    #[test]
    fn an_incomplete_trace_is_marked_partial() {
        let mut recorder = Recorder::default();
        run(&mut recorder, 0, 5_000);
        recorder.trigger(Instant::from_ms(5_000), Instant::ZERO, 0);
        assert!(recorder.close(true).expect("cut").trace.partial);
    }
}
