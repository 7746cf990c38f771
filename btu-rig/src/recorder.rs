//! The 50 ms row: every signal at the end of a cycle, the ring that keeps the latest rows, and the recorder that
//! cuts windows around triggers out of it. A pure state machine: rows and triggers in, windows out.

use std::collections::VecDeque;

use protocol::signal::{Sample, Signal};
use protocol::{CYCLE, Duration, Instant};

/// Time recorded before a trigger, at least.
pub const BEFORE: Duration = Duration::from_ms(10_000);
/// Time recorded after a trigger.
pub const AFTER: Duration = Duration::from_ms(5_000);
/// A slow fault's window begins with its step, but not longer before the trigger than this.
const LONGEST_BEFORE: Duration = Duration::from_ms(120_000);
/// Later faults extend an open window up to this length, then begin their own.
const LONGEST_WINDOW: Duration = Duration::from_ms(180_000);

/// Every signal at the end of one cycle.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Bench time at the end of the cycle.
    pub at: Instant,
    /// Value of every signal at that time.
    pub sample: Sample,
}

impl Row {
    /// Value of a signal; NaN when it was not known.
    pub fn value(&self, signal: Signal) -> f64 {
        self.sample.values()[signal.index()]
    }
}

/// Number of rows in a time.
pub const fn rows_of(span: Duration) -> usize {
    (span.as_us() / CYCLE.as_us()) as usize
}

/// The latest `ROWS` rows, oldest first.
#[derive(Clone, Debug, Default)]
pub struct Ring<const ROWS: usize> {
    rows: VecDeque<Row>,
}

impl<const ROWS: usize> Ring<ROWS> {
    /// Rows, at most `ROWS`, one a cycle, oldest first.
    pub fn rows(&self) -> &VecDeque<Row> {
        &self.rows
    }

    /// Takes a row in place of the oldest; a row older than the last one empties the ring first.
    pub fn push(&mut self, row: Row) {
        if self.rows.back().is_some_and(|last| row.at < last.at) {
            self.rows.clear();
        }
        if self.rows.len() == ROWS {
            self.rows.pop_front();
        }
        self.rows.push_back(row);
    }
}

/// A window that is still being recorded.
#[derive(Debug)]
struct Open {
    faults: Vec<usize>,
    from: Instant,
    trigger: Instant,
    until: Instant,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RecordedWindow {
    /// Faults in the window, by their number in the procedure.
    pub faults: Vec<usize>,
    /// Rows of the window; at least one.
    pub rows: Vec<Row>,
    /// The row at which it was triggered.
    pub trigger_row: usize,
    /// The window ends before its time was over.
    pub partial: bool,
}

/// Keeps rows, and cuts a window around each trigger.
#[derive(Debug, Default)]
pub struct Recorder {
    ring: Ring<{ rows_of(LONGEST_WINDOW) + 1 }>,
    open: Option<Open>,
}

impl Recorder {
    /// Takes one row; returns the window it completes.
    pub fn record(&mut self, now: Instant, sample: &Sample) -> Option<RecordedWindow> {
        self.ring.push(Row {
            at: now,
            sample: sample.clone(),
        });
        let over = |open: &Open| now >= open.until;
        self.open
            .as_ref()
            .is_some_and(over)
            .then(|| self.close(false))?
    }

    /// Opens a window around `now`, in a step that began at `step_began`; `fault` is the number of a fault, `None` for
    /// another trigger. A trigger within an open window extends it; if the window would be too long, it ends and is
    /// returned.
    pub fn trigger(
        &mut self,
        now: Instant,
        step_began: Instant,
        fault: impl Into<Option<usize>>,
    ) -> Option<RecordedWindow> {
        let fault = fault.into();
        let until = now + AFTER;
        if let Some(open) = &mut self.open
            && until.since(open.from) <= LONGEST_WINDOW
        {
            open.until = until;
            open.faults.extend(fault);
            return None;
        }
        let done = self.close(true);
        let earliest = now.back(LONGEST_BEFORE);
        self.open = Some(Open {
            faults: fault.into_iter().collect(),
            from: now.back(BEFORE).min(step_began.max(earliest)),
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
    pub fn close(&mut self, partial: bool) -> Option<RecordedWindow> {
        let open = self.open.take()?;
        let faults = open.faults;
        let cut = self.cut(open.from, open.trigger, partial)?;
        Some(RecordedWindow { faults, ..cut })
    }

    /// All rows from `from` on; none without a row.
    pub fn cut(&self, from: Instant, trigger: Instant, partial: bool) -> Option<RecordedWindow> {
        let rows = &self.ring.rows;
        let rows: Vec<_> = rows.iter().filter(|row| row.at >= from).cloned().collect();
        let last = rows.len().checked_sub(1)?;
        let trigger_row = rows.iter().position(|row| row.at >= trigger);
        Some(RecordedWindow {
            faults: Vec::new(),
            rows,
            trigger_row: trigger_row.unwrap_or(last),
            partial,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(recorder: &mut Recorder, from_ms: u64, to_ms: u64) -> Option<RecordedWindow> {
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
        assert_eq!(cut.rows[0].at, Instant::from_ms(20_000));
        assert_eq!(cut.rows.len(), 301);
        assert_eq!(cut.trigger_row, 200);
        assert!(!cut.partial);
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
        assert_eq!(cut.rows[0].at, Instant::from_ms(20_000));
        assert_eq!(cut.rows.len(), 961, "20 s to 68 s");
    }

    #[test]
    fn an_incomplete_window_is_marked_partial() {
        let mut recorder = Recorder::default();
        run(&mut recorder, 0, 5_000);
        recorder.trigger(Instant::from_ms(5_000), Instant::ZERO, 0);
        assert!(recorder.close(true).expect("cut").partial);
    }

    #[test]
    fn a_ring_keeps_the_latest_rows_of_one_time() {
        let mut ring = Ring::<3>::default();
        let times = |ring: &Ring<3>| {
            ring.rows
                .iter()
                .map(|row| row.at.as_us() / 1000)
                .collect::<Vec<_>>()
        };
        for ms in [0, 50, 100, 150] {
            let (at, sample) = (Instant::from_ms(ms), Sample::default());
            ring.push(Row { at, sample });
        }
        assert_eq!(times(&ring), [50, 100, 150]);
        let (at, sample) = (Instant::from_ms(10), Sample::default());
        ring.push(Row { at, sample });
        assert_eq!(times(&ring), [10], "a bench that was rebuilt");
    }
}
