//! Ends of chains of seals, of this file and of others, as they were seen once: a chain that is rewritten or cut later
//! lacks the end that was seen. A sync brings the ends of all laptops, an import those that the other file has seen.

use super::{copied_from, hash_of};
use crate::backend::{Backend, SqlResult, from_row, values};
use crate::error::Damage;
use crate::id::Id;

/// An entry of a chain as it was seen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct KnownHead {
    pub origin: Id,
    pub ordinal: i64,
    pub hash: Vec<u8>,
    pub seen_at_us: i64,
}

/// Stores the end of a chain; of each chain the longest is kept.
pub(crate) fn keep(file: &Backend, head: &KnownHead) -> SqlResult<()> {
    file.execute(
        "INSERT INTO chain_head(origin, ordinal, hash, seen_at_us) VALUES (?1, ?2, ?3, ?4)
         ON CONFLICT (origin) DO UPDATE SET ordinal = excluded.ordinal, hash = excluded.hash,
            seen_at_us = excluded.seen_at_us WHERE excluded.ordinal > chain_head.ordinal",
        &values![head.origin, head.ordinal, &head.hash[..], head.seen_at_us],
    )?;
    Ok(())
}

/// Ends of chains that a file has seen.
pub(crate) fn of_file(file: &Backend) -> SqlResult<Vec<KnownHead>> {
    let sql = "SELECT origin, ordinal, hash, seen_at_us FROM chain_head ORDER BY origin";
    file.select(sql, &[], |row| {
        Ok(from_row!(row => KnownHead: origin, ordinal, hash, seen_at_us))
    })
}

/// Ends of chains that a file has seen, and of the chains of other files that it holds by import, with the time 0.
pub(crate) fn seen_by(file: &Backend) -> SqlResult<Vec<KnownHead>> {
    let sql = "SELECT origin, max(ordinal), hash FROM seal
        WHERE origin IS NOT (SELECT value FROM about WHERE key = 'file_id') GROUP BY origin";
    let mut seen = of_file(file)?;
    let held = file.select(sql, &[], |row| {
        Ok(from_row!(row => KnownHead:
            origin, ordinal, hash;
            seen_at_us: 0
        ))
    })?;
    for head in held {
        let is_known =
            |known: &KnownHead| known.origin == head.origin && known.ordinal >= head.ordinal;
        if !seen.iter().any(is_known) {
            seen.push(head);
        }
    }
    Ok(seen)
}

/// Ends of the chains of all laptops on a server.
pub(crate) fn of_server(server: &Backend, seen_at_us: i64) -> SqlResult<Vec<KnownHead>> {
    let sql =
        "SELECT l.file_id, s.ordinal, s.hash FROM laptop l JOIN seal s ON s.origin = l.file_id
            AND s.ordinal = (SELECT max(x.ordinal) FROM seal x WHERE x.origin = l.file_id)
         ORDER BY l.file_id";
    server.select(sql, &[], |row| {
        Ok(from_row!(row => KnownHead:
            origin, ordinal, hash;
            seen_at_us
        ))
    })
}

/// Chains of a store that lack the end which was seen of them. The store must have the chain `own` as a whole; of other
/// chains it may have a part.
pub(crate) fn broken(
    store: &Backend,
    known: &[KnownHead],
    own: Option<Id>,
) -> SqlResult<Vec<(Id, Damage)>> {
    let mut found = Vec::new();
    for head in known {
        let (origin, ordinal) = (head.origin, head.ordinal);
        // A copy that got an id of its own kept the entries made before, and recorded where it parted.
        if copied_from(store, origin)?.is_some_and(|after| ordinal > after) {
            continue;
        }
        let seen = head.seen_at_us;
        match hash_of(store, origin, ordinal)? {
            Some(hash) if hash == head.hash => {}
            Some(_) => found.push((origin, Damage::Rewritten(origin, ordinal, seen))),
            None if own == Some(origin) => {
                found.push((origin, Damage::Cut(origin, ordinal, seen)));
            }
            None => {}
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{IdSource, OpenOptions, Store};

    fn open(path: &Path, first: u64) -> Store {
        let mut ms = first;
        let ids = IdSource::new(move || {
            ms += 1;
            (ms, [first as u8; 10])
        });
        Store::open(path, OpenOptions::new(ids)).expect("opens")
    }

    fn statement(store: &Store) {
        store
            .register_instrument(&crate::Instrument {
                serial_no: "B-1".to_owned(),
                ..crate::Instrument::default()
            })
            .expect("registered");
    }

    fn seen(of: &Store) -> KnownHead {
        let head = of.head().expect("read").expect("a chain");
        let (_, hash) = super::super::head_of(&of.backend, head.file)
            .expect("read")
            .expect("a chain");
        KnownHead {
            origin: head.file,
            ordinal: head.entries,
            hash,
            seen_at_us: 1_772_323_200_000_000,
        }
    }

    /// Goal: a chain that was cut, or rewritten with other entries, is named in the file itself and by whoever has seen it.
    #[test]
    fn a_chain_that_was_cut_or_rewritten_is_named_by_who_has_seen_it() {
        let dir = tempfile::tempdir().expect("a directory");
        let (own, other) = (
            open(&dir.path().join("a.db"), 1_000),
            open(&dir.path().join("b.db"), 9_000),
        );
        statement(&own);
        statement(&own);
        let head = seen(&own);
        keep(&own.backend, &head).expect("kept");
        keep(&other.backend, &head).expect("kept");
        assert_eq!(own.check().expect("checked").problems, []);
        assert_eq!(other.seen_otherwise(&own).expect("compared"), [""; 0]);
        other.merge_from(&own).expect("merged");

        let cut = "DELETE FROM seal WHERE origin = ?1 AND ordinal = ?2";
        own.backend
            .execute(cut, &values![head.origin, head.ordinal])
            .expect("cut");
        let said = &own.check().expect("checked").problems[0].detail.to_string();
        assert!(said.contains("was cut: entry 3"), "{said}");
        assert_eq!(
            other.seen_otherwise(&own).expect("compared"),
            std::slice::from_ref(said)
        );
        // The cut chain goes on with another entry: it is whole by itself.
        own.register_instrument(&crate::Instrument {
            serial_no: "B-2".to_owned(),
            ..crate::Instrument::default()
        })
        .expect("registered");
        let said = own.check().expect("checked").problems[0].detail.to_string();
        assert!(said.contains("was rewritten: entry 3"), "{said}");
        assert_eq!(other.seen_otherwise(&own).expect("compared"), [said]);
        let third = open(&dir.path().join("c.db"), 20_000);
        keep(&third.backend, &head).expect("kept");
        assert!(third.merge_from(&own).is_err());
    }

    #[test]
    fn of_one_chain_the_longest_end_counts() {
        let dir = tempfile::tempdir().expect("a directory");
        let own = open(&dir.path().join("a.db"), 1_000);
        let short = seen(&own);
        statement(&own);
        let long = seen(&own);
        for head in [&long, &short] {
            keep(&own.backend, head).expect("kept");
        }
        assert_eq!(of_file(&own.backend).expect("read"), [long]);
    }
}
