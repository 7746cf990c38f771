//! Runs against their seals, and each seal against the one before.

use super::Findings;
use crate::base::{Base, SqlResult, values};
use crate::id::Id;
use crate::seal::{chained, digest};

/// Seals looked at in one go, so that memory stays the same however many there are.
const AT_ONCE: usize = 1_000;

/// A seal as it lies there; the run's id, if the run is there.
struct Seal {
    origin: Id,
    ordinal: i64,
    run: i64,
    digest: Vec<u8>,
    hash: Vec<u8>,
    id: Option<Id>,
}

/// Runs that were looked at.
pub(super) fn check(base: &Base, mut found: Findings<'_>) -> SqlResult<u32> {
    let mut last: Option<Seal> = None;
    let mut runs = 0;
    loop {
        let seals = seals_after(base, last.as_ref())?;
        let is_end = seals.len() < AT_ONCE;
        for seal in seals {
            runs += 1;
            let before = last.as_ref().filter(|last| last.origin == seal.origin);
            if let Some(wrong) = misplaced(&seal, before) {
                found.add(wrong);
            }
            match seal.id {
                None => found.add(format!("{}: its run was taken out", seal.name())),
                Some(id) if digest(base, seal.run)? != seal.digest[..] => {
                    found.add(format!("run {id} was changed after it was sealed"));
                }
                Some(_) => {}
            }
            last = Some(seal);
        }
        if is_end {
            break;
        }
    }
    let loose = [
        (
            "was finished and has no seal: its seal was taken out, or it was put in by hand",
            "SELECT id FROM run WHERE verdict IS NOT NULL
                AND NOT EXISTS (SELECT 1 FROM seal WHERE seal.run = run.seq) ORDER BY seq",
        ),
        (
            "has a seal and no verdict: the verdict was taken away",
            "SELECT id FROM run WHERE verdict IS NULL
                AND EXISTS (SELECT 1 FROM seal WHERE seal.run = run.seq) ORDER BY seq",
        ),
    ];
    for (what, sql) in loose {
        base.each(sql, &[], |row| {
            found.add(format!("run {} {what}", row.get::<Id>(0)?));
            Ok(())
        })?;
    }
    if let Base::Server(_) = base {
        return Ok(runs);
    }
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
    Ok(runs)
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
            "{}: before it runs were taken out, number {missing}",
            seal.name()
        ));
    }
    let hash = chained(before.map(|before| &before.hash[..]), &seal.digest);
    (hash != seal.hash[..]).then(|| {
        let run = seal.id.map_or(String::new(), |id| format!(" (run {id})"));
        format!(
            "{}{run} does not fit the one before: it was changed",
            seal.name()
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
        "SELECT s.origin, s.ordinal, s.run, s.digest, s.hash, r.id
         FROM seal s LEFT JOIN run r ON r.seq = s.run
         WHERE (s.origin, s.ordinal) > (?1, ?2) ORDER BY s.origin, s.ordinal LIMIT {AT_ONCE}"
    );
    base.select(&sql, &values![origin, ordinal], |row| {
        Ok(Seal {
            origin: row.get(0)?,
            ordinal: row.get(1)?,
            run: row.get(2)?,
            digest: row.get(3)?,
            hash: row.get(4)?,
            id: row.get(5)?,
        })
    })
}
