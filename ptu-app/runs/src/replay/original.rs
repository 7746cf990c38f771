//! Reads a stored trace together with the recording it belongs to.

use fault_db::{Id, Store, TraceData};
use protocol::Instant;

use super::Rule;
use crate::failure::{Failure, RecordTrouble};
use crate::run::{BenchContents, Stimuli, Window};

/// Rule for comparing two stored traces: to the last bit where both come from benches in virtual
/// time.
///
/// # Errors
/// The database fails.
pub fn rule_between(store: &Store, a: Id, b: Id) -> Result<Rule, Failure> {
    // Not known without a recording: it counts as virtual time.
    let on_port = |trace| match store.recording(trace)? {
        Some(recording) => Ok::<_, Failure>(BenchContents::read(&recording)?.0.on_port()),
        None => Ok(false),
    };
    Ok(if on_port(a)? || on_port(b)? {
        Rule::wall_clock()
    } else {
        Rule::exact()
    })
}

/// A stored trace whose stimuli are recorded, so that it can be made again.
#[derive(Debug)]
pub struct Original {
    /// The trace's id.
    pub id: Id,
    /// Run in which the trace was recorded.
    pub run_id: Id,
    pub procedure: String,
    pub trace: TraceData,
    pub made: BenchContents,
    /// Stimuli of the procedure.
    pub stimuli: Stimuli,
    /// Bench time of the run at which the bench's clock was 0, µs.
    t0_bench_us: i64,
}

/// Longest time that a recording may state, µs: a procedure takes minutes, and one of any length would be replayed for
/// ever.
const LONGEST_US: i64 = 24 * 3_600_000_000;

/// Checks the times of a trace against the clock of its recording, because an imported file may name any.
fn check_times(trace: &TraceData, t0_bench_us: i64) -> Option<()> {
    let near = |us: i64| (-LONGEST_US..=LONGEST_US).contains(&us).then_some(us);
    let row_us = |row: usize| {
        let later_us = i64::try_from(row).ok()?.checked_mul(trace.period_us)?;
        near(
            trace
                .t0_bench_us
                .checked_sub(t0_bench_us)?
                .checked_add(later_us)?,
        )
    };
    let trigger = trace.trigger_row.map_or(0, |row| row as usize);
    let is_in = trace.period_us > 0 && trigger < trace.rows();
    row_us(0)?;
    row_us(trace.rows() - 1)?;
    // A place in the trace is told in the run's bench time, which must not overflow.
    is_in
        .then(|| trace.t0_bench_us.checked_add(LONGEST_US))
        .flatten()
        .map(|_| ())
}

impl Original {
    /// Reads a trace with its recording.
    ///
    /// # Errors
    /// There is no such trace, or its stimuli cannot be played again.
    pub fn read(store: &Store, id: Id) -> Result<Self, Failure> {
        let trace = store.trace(id)?;
        let recording = store
            .recording(id)?
            .ok_or_else(|| Failure::usage(RecordTrouble::NoRecording(id)))?;
        let (made, stimuli) = BenchContents::read(&recording)?;
        if trace.rows() == 0 {
            return Err(Failure::usage(RecordTrouble::NoRows(id)));
        }
        check_times(&trace, recording.t0_bench_us)
            .ok_or_else(|| Failure::usage(RecordTrouble::NoTimes(id)))?;
        Ok(Self {
            id,
            run_id: recording.run_id,
            procedure: recording.procedure,
            trace,
            made,
            stimuli,
            t0_bench_us: recording.t0_bench_us,
        })
    }

    /// Time on the bench's own clock at which a row was recorded, µs.
    fn row_us(&self, row: usize) -> i64 {
        self.trace.t0_bench_us - self.t0_bench_us + row as i64 * self.trace.period_us
    }

    pub fn trigger_row(&self) -> usize {
        self.trace.trigger_row.unwrap_or(0) as usize
    }

    /// Window of the trace on a clock that runs `shift_us` ahead of the bench's own.
    pub(crate) fn window(&self, shift_us: i64) -> Window {
        let at = |row| Instant::from_us((self.row_us(row) + shift_us).max(0) as u64);
        Window {
            from: at(0),
            trigger: at(self.trigger_row()),
            until: at(self.trace.rows() - 1),
        }
    }

    /// Rows from the trigger to where the procedure began; negative when that was earlier.
    pub fn began_row(&self) -> i64 {
        let began_us = i64::try_from(self.stimuli.began_us).unwrap_or(i64::MAX);
        let since_us = began_us - self.row_us(self.trigger_row());
        // The first row at or after the beginning.
        -(-since_us).div_euclid(self.trace.period_us)
    }

    /// Seconds from the trigger to a bench time of the run, µs.
    pub(crate) fn at_s(&self, bench_us: i64) -> f64 {
        let trigger_us = self.trace.t0_bench_us + self.trigger_row() as i64 * self.trace.period_us;
        (bench_us - trigger_us) as f64 / 1e6
    }
}
