//! Names of parts.

use std::sync::LazyLock;

use protocol::injection::{FaultCatalogue, Lru};

/// The parts of the catalogue that is built in; one that only a depot's own catalogue has goes by its identifier here.
static PARTS: LazyLock<Vec<Lru>> = LazyLock::new(|| {
    let catalogue = include_str!("../../../../scripts/units/faults.toml");
    FaultCatalogue::from_toml(catalogue).map_or_else(|_| Vec::new(), |all| all.lrus)
});

/// Name of a part in English and Korean.
pub(super) fn part(id: &str) -> [&str; 2] {
    let known = PARTS.iter().find(|part| part.id == id);
    known.map_or([id; 2], |part| [&part.name, &part.name_ko])
}

/// The text with a small first letter, unless its first word is in capitals.
pub(super) fn within_a_sentence(text: &str) -> String {
    let mut letters = text.chars();
    match (letters.next(), letters.clone().next()) {
        (Some(first), Some(second)) if second.is_lowercase() => {
            first.to_lowercase().chain(letters).collect()
        }
        _ => text.to_owned(),
    }
}
