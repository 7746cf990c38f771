//! Symptoms that are reported with a unit (`scripts/symptoms.toml`): weak signs of the parts that they may come from.

use protocol::LruId;
use protocol::injection::Lru;
use serde::Deserialize;

use crate::data::ScriptsDirectory;
use crate::failure::{Failure, FileTrouble, Unknown, did_you_mean};

/// Path of the symptoms' file in the scripts directory.
pub const FILE: &str = "symptoms.toml";

/// A symptom.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Symptom {
    /// Name of the symptom in commands and in the database.
    pub id: String,
    /// Name for people.
    pub name: String,
    /// Parts that it may come from.
    pub parts: Vec<LruId>,
}

#[derive(Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Written {
    symptoms: Vec<Symptom>,
}

/// The symptoms of a scripts directory, in the order of its file; `parts` are those of its catalogue.
///
/// # Errors
/// The file cannot be read, or is wrong: a name given twice, a part that is not among `parts`.
pub fn load(directory: &ScriptsDirectory, parts: &[Lru]) -> Result<Vec<Symptom>, Failure> {
    of_toml(&directory.text(FILE)?, parts)
        .map_err(|error| Failure::usage(FileTrouble::wrong(directory.shown(FILE), error)))
}

fn of_toml(text: &str, parts: &[Lru]) -> Result<Vec<Symptom>, String> {
    let written: Written = toml::from_str(text).map_err(|error| error.to_string())?;
    for (place, symptom) in written.symptoms.iter().enumerate() {
        let id = &symptom.id;
        if written.symptoms[..place]
            .iter()
            .any(|other| other.id == *id)
        {
            return Err(format!("there are two symptoms \"{id}\""));
        }
        let known = |part: &&LruId| parts.iter().any(|lru| lru.id == **part);
        if let Some(part) = symptom.parts.iter().find(|part| !known(part)) {
            return Err(format!("symptom \"{id}\": no part \"{part}\""));
        }
    }
    Ok(written.symptoms)
}

/// The symptom of this name.
///
/// # Errors
/// There is none, or the file cannot be read.
pub fn find(directory: &ScriptsDirectory, parts: &[Lru], id: &str) -> Result<Symptom, Failure> {
    let mut symptoms = load(directory, parts)?;
    let found = symptoms.iter().position(|symptom| symptom.id == id);
    let found = found.ok_or_else(|| {
        let known = symptoms.iter().map(|symptom| symptom.id.as_str());
        Failure::usage(Unknown::Symptom(id.to_owned(), did_you_mean(id, known)))
    })?;
    Ok(symptoms.swap_remove(found))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support;

    #[test]
    fn the_file_names_parts_of_the_catalogue() {
        let scripts = test_support::scripts();
        let parts = scripts.faults().expect("a catalogue").lrus;
        let symptoms = load(&scripts, &parts).expect("symptoms");
        assert!(symptoms.iter().any(|symptom| symptom.id == "brakes_late"));
    }

    #[test]
    fn an_unknown_part_and_a_name_given_twice_are_told() {
        let parts = test_support::scripts().faults().expect("a catalogue").lrus;
        let one = |id: &str, part: &str| {
            format!("[[symptoms]]\nid = \"{id}\"\nname = \"-\"\nparts = [\"{part}\"]\n")
        };
        let wrong = |text: String| of_toml(&text, &parts).expect_err("wrong");
        let said = wrong(one("a", "eb_rely"));
        assert_eq!(said, "symptom \"a\": no part \"eb_rely\"");
        let said = wrong(one("a", "eb_relay") + &one("a", "tra"));
        assert_eq!(said, "there are two symptoms \"a\"");
    }
}
