//! What the care of the history came to, in words: an exchange with a server, an import, a check.

use fault_db::{
    CheckReport, Difference, MergeCounts, Problem, Refusals, SealHead, StateConflict, SyncOutcome,
    SyncProgress,
};

use crate::naming::event;
use crate::words::{Words, fill};

/// What was done, and what a person should know besides.
pub struct Said {
    /// What was done.
    pub text: String,
    /// What should be looked at.
    pub notes: Vec<String>,
}

/// How far a sync is.
pub fn progress(progress: SyncProgress, words: &Words) -> String {
    fill(
        words.care.phase(progress.phase),
        &[("done", &progress.done), ("total", &progress.total)],
    )
}

/// A sync that is over.
pub fn synced(outcome: &SyncOutcome, words: &Words) -> Said {
    let care = &words.care;
    let text = fill(
        care.synced,
        &[
            ("runs", &outcome.runs),
            ("occurrences", &outcome.occurrences),
            ("events", &outcome.events),
            ("notes", &outcome.notes),
            ("traces", &outcome.traces),
            ("received", &outcome.events_received),
            ("faults", &outcome.faults_changed),
        ],
    );
    let mut notes = Vec::new();
    if outcome.stopped {
        notes.push(care.stopped.to_owned());
    }
    if outcome.waiting > 0 {
        notes.push(fill(care.waiting, &[("n", &outcome.waiting)]));
    }
    if outcome.clocks_differ() {
        let seconds = outcome.clock_offset_us.unsigned_abs() / 1_000_000;
        notes.push(fill(care.clocks_differ, &[("n", &seconds)]));
    }
    notes.extend(different(&outcome.different, words));
    let damaged = outcome.damaged_traces.iter();
    notes.extend(damaged.map(|trace| fill(care.damaged_trace, &[("id", trace)])));
    notes.extend(refused(&outcome.refused, words));
    notes.extend(
        outcome
            .conflicts
            .iter()
            .map(|rivals| conflict(rivals, words)),
    );
    Said { text, notes }
}

/// An import of another file.
pub fn imported(counts: &MergeCounts, conflicts: &[StateConflict], words: &Words) -> Said {
    let text = fill(
        words.care.imported,
        &[
            ("runs", &counts.runs),
            ("steps", &counts.steps),
            ("faults", &counts.faults),
            ("occurrences", &counts.occurrences),
            ("traces", &counts.traces),
        ],
    );
    let copy = counts.copy.as_ref();
    let copy = copy.map(|copy| fill(words.care.copy, &[("file", &copy.file.short())]));
    let mut notes: Vec<_> = copy.into_iter().collect();
    notes.extend(different(&counts.different, words));
    notes.extend(refused(&counts.refused, words));
    notes.extend(conflicts.iter().map(|rivals| conflict(rivals, words)));
    Said { text, notes }
}

/// A check: the problems, and once for each kind what to do.
pub fn checked(report: &CheckReport, words: &Words) -> Said {
    let care = &words.care;
    let text = match report.problems.len() {
        0 => fill(
            care.sound,
            &[("traces", &report.traces), ("runs", &report.runs)],
        ),
        n => fill(care.damaged, &[("n", &n)]),
    };
    let problems = report.problems.iter();
    let mut notes: Vec<_> = problems
        .map(|problem| {
            let Problem { kind, detail, .. } = problem;
            format!("{}: {}", words.problem_kind(*kind), words.damage(detail))
        })
        .collect();
    let mut advice: Vec<_> = report.problems.iter().map(|one| one.advice).collect();
    advice.dedup();
    notes.extend(advice.into_iter().map(|next| words.advice(next).to_owned()));
    notes.extend(report.head.as_ref().map(|head| chain(head, words)));
    Said { text, notes }
}

/// Where the chain of seals ends, to be written down and compared.
pub fn chain(head: &SealHead, words: &Words) -> String {
    let seal = head.seal.to_string();
    fill(
        words.care.chain,
        &[
            ("n", &head.entries),
            ("file", &head.file.short()),
            ("seal", &seal),
        ],
    )
}

fn different<'a>(all: &'a [Difference], words: &'a Words) -> impl Iterator<Item = String> + 'a {
    all.iter().map(|Difference { what, id }| {
        let what = match *what {
            "run" => words.common.run,
            "trace" => words.report.trace,
            _ => words.care.file,
        };
        fill(words.care.different, &[("what", &what), ("id", id)])
    })
}

fn refused(refused: &Refusals, words: &Words) -> Vec<String> {
    let named = refused.named.iter();
    let mut all: Vec<_> = named
        .map(|one| {
            fill(
                words.care.refused,
                &[("what", &words.stored_row(&one.what))],
            )
        })
        .collect();
    let more = refused.count.saturating_sub(refused.named.len() as u64);
    if more > 0 {
        all.push(fill(words.care.refused_more, &[("n", &more)]));
    }
    all
}

/// Two people who did not know of each other's decision.
fn conflict(conflict: &StateConflict, words: &Words) -> String {
    let rivals: Vec<_> = (conflict.rivals.iter())
        .map(|rival| {
            let who = match &*rival.who {
                "" => words.event_kind(&rival.kind),
                who => who,
            };
            let state = words.fault_state(rival.state);
            fill(words.care.says, &[("who", &who), ("state", &state)])
        })
        .collect();
    fill(
        words.care.conflict,
        &[
            ("unit", &conflict.unit),
            ("fault", &event(conflict.code, &conflict.code_name, words)),
            ("rivals", &rivals.join(", ")),
            ("stands", &words.fault_state(conflict.stands)),
        ],
    )
}
