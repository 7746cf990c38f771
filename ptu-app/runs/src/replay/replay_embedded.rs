//! Repeats recorded stimuli on a freshly built embedded unit.

use btu_rig::recorded::StimulusPlayer;
use btu_rig::rig::UnitLink;
use fault_db::TraceData;
use protocol::{CYCLE, Instant};

use super::{Original, Rule};
use crate::data::ScriptsDirectory;
use crate::failure::{Failure, RecordTrouble, Trouble};
use crate::run::bench_setup::SWITCHED_OFF;
use crate::run::{BenchSetup, RecordedStimuli, Session};
use crate::run::{READY_WITHIN, settled};
use crate::stop::Stop;

#[derive(Debug)]
pub(super) struct EmbeddedReplay {
    pub trace: TraceData,
    /// Rule for comparing the trace with the original.
    pub rule: Rule,
    /// The stimuli that were played, on the clock of this bench.
    pub recorded: RecordedStimuli,
    /// Stimuli that this bench refused.
    pub refused: Vec<String>,
}

/// The trace that the recorded stimuli give on an embedded unit without a fault, and how to compare it.
///
/// # Errors
/// A file the bench was built from is no longer available.
pub fn good_twin(
    original: &Original,
    directory: &ScriptsDirectory,
) -> Result<(TraceData, Rule), Failure> {
    let setup = original.made.setup(directory)?;
    let again = on_embedded(original, &setup, &Stop::default())?;
    Ok((again.trace, again.rule))
}

/// Plays the recorded stimuli on the embedded unit of `setup`.
pub(super) fn on_embedded(
    original: &Original,
    setup: &BenchSetup,
    stop: &Stop,
) -> Result<EmbeddedReplay, Failure> {
    let mut session = setup.sim_session(&original.procedure, stop);
    if !original.made.on_port() {
        return play(original, &mut session, 0, Rule::exact());
    }
    // The unit on the port had been running for an unknown time: the embedded one is made ready, too.
    let (ready, _) = session.judge_bring_up(SWITCHED_OFF + READY_WITHIN, settled());
    if !ready {
        return Err(Failure::bench(RecordTrouble::NotReady));
    }
    from_here(original, &mut session)
}

/// Plays the recorded stimuli on a bench whose unit is ready, from now on.
pub(super) fn from_here<L: UnitLink>(
    original: &Original,
    session: &mut Session<L>,
) -> Result<EmbeddedReplay, Failure> {
    let began_us = original.stimuli.began_us;
    // Rows of original and replay lie at whole cycles of their clocks.
    session.idle(
        CYCLE,
        |_, _, _| {},
        |bench| bench.now().as_us() % CYCLE.as_us() == began_us % CYCLE.as_us(),
    );
    let shift_us = session.now().since(Instant::ZERO).as_us() as i64 - began_us as i64;
    play(
        original,
        session,
        shift_us,
        Rule::after_begin(original.began_row()),
    )
}

fn play<L: UnitLink>(
    original: &Original,
    session: &mut Session<L>,
    shift_us: i64,
    rule: Rule,
) -> Result<EmbeddedReplay, Failure> {
    let record = &original.stimuli.record;
    let mut refused = Vec::new();
    let window = original.window(shift_us);
    let trace = session.play(StimulusPlayer::new(record, shift_us), window, &mut refused);
    let trace = trace.ok_or_else(|| {
        Failure::bench(
            session
                .link_error()
                .map_or_else(|| RecordTrouble::Stopped.into(), Trouble::Link),
        )
    })?;
    let mut record = record.clone();
    for entry in &mut record.entries {
        entry.at_us = entry.at_us.saturating_add_signed(shift_us);
    }
    let began = Instant::from_us(original.stimuli.began_us.saturating_add_signed(shift_us));
    Ok(EmbeddedReplay {
        trace,
        rule,
        recorded: RecordedStimuli { began, record },
        refused,
    })
}
