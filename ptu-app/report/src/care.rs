//! Results of maintaining the history, in words: an exchange with a server, an import, a check.

use fault_db::{
    CheckReport, Difference, MergeCounts, Problem, PruneCounts, Refusals, SealHead, StateConflict,
    SyncOutcome, SyncProgress,
};

use crate::naming::event;
use crate::words::{Words, fill};
use ptu_runs::words::noun;

/// Result in words, and notes for the person.
pub struct Said {
    pub text: String,
    /// Notes on what should be looked at.
    pub notes: Vec<String>,
}

pub fn progress(progress: SyncProgress, words: &Words) -> String {
    let SyncProgress { phase, done, total } = progress;
    let phase = words.care.phase(phase);
    match total {
        0 => format!("{phase}: {done}"),
        _ => format!("{phase}: {done} / {total}"),
    }
}

/// A sync that is over.
pub fn synced(outcome: &SyncOutcome, words: &Words) -> Said {
    let care = &words.care;
    let mut text = fill(
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
    if outcome.already_there > 0 {
        text += &fill(care.already_there, &[("n", &outcome.already_there)]);
    }
    let mut notes = Vec::new();
    if outcome.stopped {
        notes.push(care.stopped.to_owned());
    }
    if outcome.waiting > 0 {
        notes.push(fill(care.waiting, &[("n", &outcome.waiting)]));
    }
    if outcome.clocks_differ() {
        let differs = match outcome.clock_offset_us > 0 {
            true => care.clock_ahead,
            false => care.clock_behind,
        };
        let by = span(outcome.clock_offset_us.unsigned_abs());
        notes.push(fill(differs, &[("span", &by)]));
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
    let mut text = fill(
        words.care.imported,
        &[
            ("runs", &counts.runs),
            ("steps", &counts.steps),
            ("faults", &counts.faults),
            ("occurrences", &counts.occurrences),
            ("traces", &counts.traces),
        ],
    );
    if !counts.refused.is_empty() {
        text += &fill(words.care.refused_count, &[("n", &counts.refused.count)]);
    }
    let copy = counts.copy.as_ref().map(|copy| {
        let is = match copy.went_on {
            true => words.care.copy_went_on,
            false => words.care.copy_before,
        };
        fill(is, &[("file", &copy.file.short()), ("n", &copy.after)])
    });
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
            format!("{}: {}", words.problem_kind(*kind), words.trouble(detail))
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

/// A length of time, in its largest unit that says enough.
fn span(us: u64) -> String {
    let s = us / 1_000_000;
    match s {
        0..120 => format!("{s} s"),
        120..7_200 => format!("{} min", s / 60),
        7_200..172_800 => format!("{} h", s / 3_600),
        _ => format!("{} d", s / 86_400),
    }
}

pub fn pruned(counts: &PruneCounts, dry_run: bool, words: &Words) -> String {
    let care = &words.care;
    let (gone, over) = match dry_run {
        true => (care.would_prune, care.would_be_over),
        false => (care.pruned, care.still_over),
    };
    let mut text = fill(
        gone,
        &[
            ("n", &counts.traces),
            ("bytes", &counts.trace_bytes),
            ("kept", &counts.kept_for_faults),
        ],
    );
    if counts.kept_unsent > 0 {
        text += &fill(care.kept_unsent, &[("n", &counts.kept_unsent)]);
    }
    if !dry_run {
        text += &fill(care.freed, &[("bytes", &counts.freed_bytes)]);
    }
    if counts.over_bytes > 0 {
        text += &format!("\n{}", fill(over, &[("bytes", &counts.over_bytes)]));
    }
    text
}

fn different<'a>(all: &'a [Difference], words: &'a Words) -> impl Iterator<Item = String> + 'a {
    all.iter().map(|Difference { what, id }| match *what {
        "chain" => fill(words.care.forked, &[("id", &id.short())]),
        what => {
            let what = words.choose([what, noun(what)]);
            fill(words.care.different, &[("what", &what), ("id", id)])
        }
    })
}

fn refused(refused: &Refusals, words: &Words) -> Vec<String> {
    let named = refused.named.iter();
    let mut all: Vec<_> = named
        .map(|one| {
            fill(
                words.care.refused,
                &[("what", &words.stored_row(&one.what)), ("why", &one.reason)],
            )
        })
        .collect();
    let more = refused.count.saturating_sub(refused.named.len() as u64);
    if more > 0 {
        all.push(fill(words.care.refused_more, &[("n", &more)]));
    }
    all
}

/// Sentence on two people who decided without knowing of each other's decision.
fn conflict(conflict: &StateConflict, words: &Words) -> String {
    let rivals: Vec<_> = (conflict.rivals.iter())
        .map(|rival| {
            let who = match &*rival.who {
                "" => return words.fault_state(rival.state).to_owned(),
                who => who,
            };
            let state = words.fault_state(rival.state);
            fill(words.care.says, &[("who", &who), ("state", &state)])
        })
        .collect();
    fill(
        words.care.conflict,
        &[
            ("id", &conflict.fault.short()),
            ("unit", &conflict.unit),
            ("fault", &event(conflict.code, &conflict.code_name, words)),
            ("rivals", &rivals.join(", ")),
            ("stands", &words.fault_state(conflict.stands)),
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::Language;

    #[test]
    fn a_clock_difference_is_given_as_text() {
        let off_by = |clock_offset_us| {
            let outcome = SyncOutcome {
                clock_offset_us,
                ..SyncOutcome::default()
            };
            synced(&outcome, Language::English.words()).notes.concat()
        };
        assert_eq!(off_by(-2_900_000), "");
        for (us, words) in [
            (4_000_000, "4 s ahead of"),
            (-600_000_000, "10 min behind"),
            (10_800_000_000, "3 h ahead of"),
            (-31_536_000_000_000, "365 d behind"),
        ] {
            let said = off_by(us);
            assert!(said.contains(words), "{said}");
        }
    }
}
