//! All that is sealed against its seal, and each seal against the one before.

use std::collections::BTreeSet;

use super::{Findings, Remarks};
use crate::base::{Base, SqlResult, values};
use crate::id::Id;
use crate::seal::run::RunSays;
use crate::seal::said::{Earlier, EarlierSays, EventSays, earlier, event_digest, note_digest};
use crate::seal::{
    BegunSays, COVERS, PRUNED, PrunedSays, RECOUNTED, RecountedSays, chained, first, hex, own_name,
    run_digest, statement_digest, trace,
};

/// Seals looked at in one go, so that memory stays the same however many there are.
const AT_ONCE: usize = 1_000;

/// A seal as it lies there; the number of what it seals, if that is there.
struct Seal {
    origin: Id,
    ordinal: i64,
    what: String,
    id: Id,
    covers: i64,
    says: String,
    digest: Vec<u8>,
    hash: Vec<u8>,
    row: Option<i64>,
}

/// What is learnt on the way through the chains.
#[derive(Default)]
struct Learnt {
    /// Seals of runs.
    runs: u32,
    /// Of these, sealed by an earlier version.
    by_earlier: u32,
    /// Runs, events and notes that came without a seal.
    found: u32,
    /// Traces, and recordings, whose run is sealed with them and which are not there.
    missing: BTreeSet<(Id, Option<i64>)>,
    /// Those that a seal says were deleted, with their digest.
    pruned: BTreeSet<(Id, Option<i64>, String)>,
    begun: Option<BegunSays>,
}

/// Runs that were looked at.
pub(super) fn check(base: &Base, mut found: Findings<'_>, remarks: &mut Remarks) -> SqlResult<u32> {
    let own = match base {
        Base::File(_) => own_name(base)?,
        Base::Server(_) => None,
    };
    let mut learnt = Learnt::default();
    let mut last: Option<Seal> = None;
    loop {
        let seals = seals_after(base, last.as_ref())?;
        let is_end = seals.len() < AT_ONCE;
        for seal in seals {
            let before = last.as_ref().filter(|last| last.origin == seal.origin);
            if let Some(wrong) = misplaced(&seal, before) {
                found.add(wrong);
            }
            sealed(base, &seal, own, &mut learnt, &mut found, remarks)?;
            last = Some(seal);
        }
        if is_end {
            break;
        }
    }
    if let Base::File(_) = base {
        let told: BTreeSet<_> = learnt.pruned.iter().map(|(id, n, _)| (*id, *n)).collect();
        for (id, recording) in learnt.missing.difference(&told) {
            found.add(match recording {
                None => format!("trace {id} was taken out: no seal says that it was pruned"),
                Some(n) => format!(
                    "recording {n} of run {id} was taken out: no seal says that it was pruned"
                ),
            });
        }
        begun(base, own, &learnt, &mut found, remarks)?;
    }
    loose(base, &mut found)?;
    let Learnt {
        by_earlier,
        found: as_found,
        ..
    } = learnt;
    if by_earlier > 0 {
        let covered = first::COVERED;
        remarks.push(format!(
            "{by_earlier} runs were sealed by an earlier version: covers {covered}"
        ));
    }
    if as_found > 0 {
        remarks.push(format!(
            "{as_found} runs, events and notes came without a seal and were sealed as they were found then"
        ));
    }
    Ok(learnt.runs)
}

/// What a seal stands for against what is there.
fn sealed(
    base: &Base,
    seal: &Seal,
    own: Option<Id>,
    learnt: &mut Learnt,
    found: &mut Findings<'_>,
    remarks: &mut Remarks,
) -> SqlResult<()> {
    let id = seal.id;
    match (&seal.what[..], seal.row) {
        ("run", None) => found.add(format!("{}: its run was taken out", seal.name())),
        ("event", None) => found.add(format!("{}: its event was taken out", seal.name())),
        ("note", None) => found.add(format!("{}: its note was taken out", seal.name())),
        ("run", Some(run)) => {
            learnt.runs += 1;
            learnt.by_earlier += u32::from(seal.covers < COVERS);
            if run_digest(base, run, seal.covers, &seal.says)? != seal.digest[..] {
                found.add(format!("run {id} was changed after it was sealed"));
            }
            if seal.covers == COVERS {
                let says = RunSays::of(&seal.says).unwrap_or_default();
                learnt.found += u32::from(says.found.is_some());
                belongings(base, (id, run), &says, learnt, found)?;
            }
        }
        ("event", Some(event)) => {
            let says = EventSays::of(&seal.says);
            let fits = event_digest(base, event, &seal.says)? == seal.digest[..];
            if !fits || !is_of_its_fault(base, event, says.as_ref())? {
                found.add(format!("event {id} was changed after it was sealed"));
            }
            learnt.found += u32::from(says.is_some_and(|says| says.found.is_some()));
        }
        ("note", Some(note)) => {
            if note_digest(base, note, &seal.says)? != seal.digest[..] {
                found.add(format!("note {id} was changed after it was sealed"));
            }
            learnt.found += u32::from(!seal.says.is_empty());
        }
        (what, _) => {
            if statement_digest(what, id, &seal.says) != seal.digest[..] {
                found.add(format!("{} was changed", seal.name()));
            }
            match what {
                PRUNED => {
                    if let Ok(says) = serde_json::from_str::<PrunedSays>(&seal.says) {
                        learnt.pruned.insert((id, says.recording, says.sha256));
                    }
                }
                "begun" if own == Some(seal.origin) => {
                    learnt.begun = serde_json::from_str(&seal.says).ok();
                }
                RECOUNTED => {
                    if let Ok(says) = serde_json::from_str::<RecountedSays>(&seal.says) {
                        remarks.push(says.text());
                    }
                }
                _ => {}
            }
        }
    }
    Ok(())
}

/// The traces and recordings of a run, against those it is sealed with.
fn belongings(
    base: &Base,
    (id, run): (Id, i64),
    says: &RunSays,
    learnt: &mut Learnt,
    found: &mut Findings<'_>,
) -> SqlResult<()> {
    let traces = base.select(
        "SELECT seq, id, recording FROM trace WHERE run = ?1",
        &values![run],
        |row| {
            Ok((
                row.get::<i64>(0)?,
                row.get::<Id>(1)?,
                row.get::<Option<i64>>(2)?,
            ))
        },
    )?;
    for said in &says.traces {
        let Ok(of) = said.id.parse::<Id>() else {
            continue;
        };
        match traces.iter().find(|(_, trace, _)| *trace == of) {
            None => {
                learnt.missing.insert((of, None));
            }
            Some((seq, _, recording)) => {
                if hex(&trace::digest(base, *seq)?) != said.sha256 || *recording != said.recording {
                    found.add(format!("trace {of} was changed after its run was sealed"));
                }
            }
        }
    }
    for (_, of, _) in &traces {
        if !says.traces.iter().any(|said| said.id == of.to_string()) {
            found.add(format!(
                "trace {of} was put into run {id} after it was sealed"
            ));
        }
    }
    let recordings = trace::recordings(base, run)?;
    for said in &says.recordings {
        let ordinal = said.ordinal;
        if !recordings.contains(&ordinal) {
            learnt.missing.insert((id, Some(ordinal)));
        } else if hex(&trace::recording_digest(base, run, ordinal)?) != said.sha256 {
            found.add(format!(
                "recording {ordinal} of run {id} was changed after it was sealed"
            ));
        }
    }
    for ordinal in recordings {
        if !says.recordings.iter().any(|said| said.ordinal == ordinal) {
            found.add(format!(
                "recording {ordinal} was put into run {id} after it was sealed"
            ));
        }
    }
    Ok(())
}

/// Whether an event lies with the fault it was said of, and no more was seen of that then than is said.
fn is_of_its_fault(base: &Base, event: i64, says: Option<&EventSays>) -> SqlResult<bool> {
    let Some((says, of)) = says.and_then(|says| Some((says, says.fault.parse::<Id>().ok()?)))
    else {
        return Ok(false);
    };
    let same = base.first(
        "SELECT 1 FROM fault_event e JOIN fault f ON f.seq = e.fault
         WHERE e.seq = ?1 AND e.seen <= ?3
            AND (f.id = ?2 OR EXISTS (SELECT 1 FROM fault_alias a WHERE a.id = ?2 AND a.fault = f.seq))",
        &values![event, of, says.seen],
        |_| Ok(()),
    )?;
    Ok(same.is_some())
}

/// What was there before it was sealed one by one.
fn begun(
    base: &Base,
    own: Option<Id>,
    learnt: &Learnt,
    found: &mut Findings<'_>,
    remarks: &mut Remarks,
) -> SqlResult<()> {
    let Some(begun) = &learnt.begun else {
        let copied = "SELECT 1 FROM seal WHERE origin = ?1 AND what = 'copied' AND ordinal = 1";
        let is_copy = match own {
            Some(own) => base.first(copied, &values![own], |_| Ok(()))?.is_some(),
            None => false,
        };
        if !is_copy {
            found.add(
                "the beginning of this file's own chain of seals is not there: it was taken out"
                    .into(),
            );
        }
        // Which events and notes were there before is told by the chain that the file was copied with.
        return Ok(());
    };
    let rows = [
        ("events", Earlier::Events, &begun.events, EVENTS_LOOSE),
        ("notes", Earlier::Notes, &begun.notes, NOTES_LOOSE),
    ];
    for (name, what, said, loose) in rows {
        let now = earlier(base, what, said.last)?;
        if now != *said && (said.count > 0 || now.count > 0) {
            found.add(format!(
                "the {name} from before the fifth schema are not what they were when the file was brought up to date"
            ));
        }
        base.each(loose, &values![said.last], |row| {
            let id = row.get::<Id>(0)?;
            found.add(format!("one of the {name}, {id}, has no seal: it was put in by hand, or its seal was taken out"));
            Ok(())
        })?;
    }
    let EarlierSays { count: events, .. } = begun.events;
    let EarlierSays { count: notes, .. } = begun.notes;
    if events + notes > 0 {
        remarks.push(format!(
            "{events} events and {notes} notes were here before this file was brought up to date (schema {}): \
             they are covered as they were then",
            begun.schema
        ));
    }
    Ok(())
}

const EVENTS_LOOSE: &str = "SELECT e.id FROM fault_event e WHERE e.seq > ?1
    AND NOT EXISTS (SELECT 1 FROM seal s WHERE s.id = e.id AND s.what = 'event') ORDER BY e.seq";
const NOTES_LOOSE: &str = "SELECT n.id FROM run_note n WHERE n.seq > ?1
    AND NOT EXISTS (SELECT 1 FROM seal s WHERE s.id = n.id AND s.what = 'note') ORDER BY n.seq";

/// Runs and seals that do not go together.
fn loose(base: &Base, found: &mut Findings<'_>) -> SqlResult<()> {
    let loose = [
        (
            "was finished and has no seal: its seal was taken out, or it was put in by hand",
            "SELECT id FROM run WHERE verdict IS NOT NULL
                AND NOT EXISTS (SELECT 1 FROM seal s WHERE s.id = run.id AND s.what = 'run') ORDER BY seq",
        ),
        (
            "has a seal and no verdict: the verdict was taken away",
            "SELECT id FROM run WHERE verdict IS NULL
                AND EXISTS (SELECT 1 FROM seal s WHERE s.id = run.id AND s.what = 'run') ORDER BY seq",
        ),
    ];
    for (what, sql) in loose {
        base.each(sql, &[], |row| {
            found.add(format!("run {} {what}", row.get::<Id>(0)?));
            Ok(())
        })?;
    }
    let Base::File(_) = base else {
        return Ok(());
    };
    // Whoever cuts off the end takes the last runs with their seals; what waits for a server still names
    // them.
    let told = "SELECT count(*) FROM outbox o WHERE o.what = 'run'
        AND NOT EXISTS (SELECT 1 FROM run WHERE run.seq = o.row)";
    let gone = base.first(told, &[], |row| row.get::<i64>(0))?.unwrap_or(0);
    if gone > 0 {
        found.add(format!(
            "{gone} runs that were recorded here are not there any more"
        ));
    }
    Ok(())
}

/// What is wrong with a seal's place, if anything; `before` is the one before it of the same file.
fn misplaced(seal: &Seal, before: Option<&Seal>) -> Option<String> {
    let expected = before.map_or(1, |before| before.ordinal + 1);
    if seal.ordinal != expected {
        let last = seal.ordinal - 1;
        let missing = if last > expected {
            format!("{expected} to {last}")
        } else {
            expected.to_string()
        };
        return Some(format!(
            "{}: before it seals were taken out, number {missing}",
            seal.name()
        ));
    }
    let hash = chained(before.map(|before| &before.hash[..]), &seal.digest);
    (hash != seal.hash[..]).then(|| {
        format!(
            "{} ({} {}) does not fit the one before: it was changed",
            seal.name(),
            seal.what,
            seal.id
        )
    })
}

impl Seal {
    fn name(&self) -> String {
        format!("seal {} of file {}", self.ordinal, self.origin.short())
    }
}

fn seals_after(base: &Base, last: Option<&Seal>) -> SqlResult<Vec<Seal>> {
    let (origin, ordinal) = last.map_or((&[][..], 0), |last| {
        (&last.origin.as_bytes()[..], last.ordinal)
    });
    let sql = format!(
        "SELECT s.origin, s.ordinal, s.what, s.id, s.covers, s.says, s.digest, s.hash,
            CASE s.what WHEN 'run' THEN (SELECT r.seq FROM run r WHERE r.id = s.id)
                WHEN 'event' THEN (SELECT e.seq FROM fault_event e WHERE e.id = s.id)
                WHEN 'note' THEN (SELECT n.seq FROM run_note n WHERE n.id = s.id) END
         FROM seal s WHERE (s.origin, s.ordinal) > (?1, ?2) ORDER BY s.origin, s.ordinal LIMIT {AT_ONCE}"
    );
    base.select(&sql, &values![origin, ordinal], |row| {
        Ok(Seal {
            origin: row.get(0)?,
            ordinal: row.get(1)?,
            what: row.get(2)?,
            id: row.get(3)?,
            covers: row.get(4)?,
            says: row.get(5)?,
            digest: row.get(6)?,
            hash: row.get(7)?,
            row: row.get(8)?,
        })
    })
}
