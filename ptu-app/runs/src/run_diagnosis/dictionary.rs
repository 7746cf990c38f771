//! Which dictionary a run is compared with: one made by a campaign on this machine, or the one that
//! comes with the scripts.

use btu_rig::procedure::plan::Connection;
use diagnosis::{Basis, Dictionary};
use fault_db::Store;

use super::basis::Contents;
use crate::campaign::known_on;
use crate::data::ScriptsDirectory;
use crate::failure::{DiagnosisTrouble, Failure, FileTrouble};
use crate::words::{Differs, Warning};

/// The dictionary that comes with the scripts, in their directory: of units on a bench, and of units reached by their
/// maintenance port alone.
const SHIPPED: &str = "dictionary.zst";
const SHIPPED_PTU: &str = "dictionary_ptu.zst";
/// Longest dictionary, packed, bytes.
const LONGEST_PACKED: u64 = 64 << 20;

/// Where a dictionary is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The dictionary came with the scripts.
    Scripts,
    /// A campaign on this machine.
    Campaign,
}

/// A dictionary, and what is to be said of it.
pub struct Chosen {
    pub dictionary: Dictionary,
    pub from: Origin,
    /// The dictionary was made of what the scripts directory holds now.
    pub current: bool,
    /// Why the dictionary may mislead: it was made of other files than there are now, or does not know all checks.
    pub warnings: Vec<Warning>,
}

/// The best dictionary there is: made on this connection, of what the scripts directory holds now, on this machine or
/// shipped with it; else a stale one. Of several the one that knows the most, and was made of the most runs.
///
/// # Errors
/// There is none, or a file cannot be read.
pub fn choose(
    store: Option<&Store>,
    directory: &ScriptsDirectory,
    connection: Connection,
) -> Result<Chosen, Failure> {
    let contents = Contents::read(directory)?;
    let now = contents.basis(connection, |_| true);
    let is_current = |basis: &Basis| contents.hold(basis, connection);
    let own = match store {
        Some(store) => store
            .dictionary(&now.sha256)?
            .map(|data| Dictionary::from_bytes(&data))
            .transpose()
            .map_err(|what| {
                let file = store.path().display().to_string();
                Failure::bench(DiagnosisTrouble::Damaged(file, what.to_string()))
            })?,
        None => None,
    };
    let modes = |dictionary: &Dictionary| {
        let same_connection = dictionary.basis.connection == now.connection;
        let current = is_current(&dictionary.basis);
        let size = dictionary.modes.len();
        (same_connection, current, size, dictionary.healthy.runs)
    };
    let of_files = match connection {
        Connection::Ptu => [
            shipped(directory, SHIPPED_PTU)?,
            shipped(directory, SHIPPED)?,
        ],
        Connection::Btu => [shipped(directory, SHIPPED)?, None],
    };
    let [of_file, of_bench] = of_files;
    let candidates = [
        of_bench.map(|dictionary| (dictionary, Origin::Scripts)),
        of_file.map(|dictionary| (dictionary, Origin::Scripts)),
        own.map(|dictionary| (dictionary, Origin::Campaign)),
    ];
    let best = candidates
        .into_iter()
        .flatten()
        .max_by_key(|(dictionary, _)| modes(dictionary));
    let Some((dictionary, from)) = best else {
        return Err(Failure::usage(DiagnosisTrouble::NoDictionary));
    };
    let mut warnings = Vec::new();
    let current = is_current(&dictionary.basis);
    let same_connection = dictionary.basis.connection == now.connection;
    let how = match connection {
        Connection::Ptu => " --harness none",
        Connection::Btu => "",
    };
    if !same_connection {
        warnings.push(Warning::OtherConnection(how));
    } else if !current {
        let differs = differences(&dictionary.basis, &now);
        warnings.push(Warning::Stale(differs, how));
    }
    let known = known_on(&directory.faults()?, connection).count();
    if dictionary.modes.len() < known {
        warnings.push(Warning::KnowsPart(dictionary.modes.len(), known));
    }
    Ok(Chosen {
        dictionary,
        from,
        current,
        warnings,
    })
}

fn shipped(directory: &ScriptsDirectory, name: &str) -> Result<Option<Dictionary>, Failure> {
    if !directory.has(name) {
        return Ok(None);
    }
    let wrong = |what: String| Failure::usage(FileTrouble::wrong(directory.shown(name), what));
    let packed = directory.bytes(name, LONGEST_PACKED)?;
    Dictionary::from_bytes(&packed).map(Some).map_err(wrong)
}

fn differences(made_of: &Basis, now: &Basis) -> Differs {
    let is_changed = |(name, sum): &(&String, &String)| {
        now.procedures.get(*name).is_some_and(|there| there != *sum)
    };
    let changed = made_of.procedures.iter().filter(is_changed);
    let changed: Vec<_> = changed.map(|(name, _)| name.as_str()).collect();
    let gone = made_of
        .procedures
        .keys()
        .filter(|name| !now.procedures.contains_key(*name))
        .count();
    if changed.is_empty() && gone == 0 {
        return Differs::Configuration;
    }
    let shown = changed
        .iter()
        .take(3)
        .copied()
        .collect::<Vec<_>>()
        .join(", ");
    match changed.len() {
        0 => Differs::Gone(gone),
        n if n > 3 => Differs::ManyChanged(shown, n - 3),
        _ => Differs::Changed(shown),
    }
}

#[cfg(test)]
mod tests {
    use diagnosis::{ModeName, Observation};

    use super::*;

    /// Goal: a dictionary that was kept can be read here, where another crate makes JSON's numbers texts
    /// of any length, which not every way of reading them survives.
    #[test]
    fn a_saved_dictionary_is_read_back() {
        let mode = ModeName {
            id: "eb_relay.slow".into(),
            lru: protocol::LruId::from_static("eb_relay"),
            text: "drops late".into(),
            kind: "degraded".into(),
            unsafe_: true,
            weight: 0.75,
        };
        let mut dictionary = Dictionary::new(Basis::default(), vec![1, 2], Vec::new());
        dictionary.add(&mode, "0.4".into(), &[Observation::default()]);
        let kept = dictionary.to_bytes().expect("packed");
        assert_eq!(Dictionary::from_bytes(&kept), Ok(dictionary));
    }
}
