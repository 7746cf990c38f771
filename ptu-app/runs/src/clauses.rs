//! Proofs of the steps (`scripts/clauses.toml`): clauses of papers, standards and specifications, the steps that
//! prove each, and the injected faults by which it was seen that these steps can fail.

use std::collections::BTreeSet;

use diagnosis::{Dictionary, Mode};
use glob::Pattern;
use protocol::Verdict;
use serde::{Deserialize, Serialize};

use crate::data::ScriptsDirectory;
use crate::failure::{Failure, FileTrouble};

/// Path of the proofs' file in the scripts directory.
pub const FILE: &str = "clauses.toml";

/// A clause.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Clause {
    /// Name of the clause.
    pub id: String,
    /// Paper, standard or specification, with its section.
    pub source: String,
    /// Demand of the clause.
    pub text: String,
    /// The text in Korean.
    #[serde(default)]
    pub text_ko: String,
    /// Globs of the steps that prove the clause, `procedure: step`.
    pub steps: Vec<String>,
}

#[derive(Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Written {
    clause: Vec<Clause>,
}

/// A clause with its proof.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClauseProof {
    /// Name of the clause.
    pub clause: String,
    /// Source of the clause.
    pub source: String,
    /// Demand of the clause.
    pub text: String,
    /// The text in Korean.
    pub text_ko: String,
    /// Steps that prove the clause, `procedure: step`.
    pub steps: Vec<String>,
    /// Fault modes that made one of these steps fail.
    pub faults: Vec<String>,
    /// Steps that no fault mode made fail: nothing has shown that they can.
    pub unproved: Vec<String>,
}

/// The matrix: clauses with their proofs, and what is open.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Matrix {
    /// In the order of the file.
    pub clauses: Vec<ClauseProof>,
    /// Clauses that no step of the suite proves.
    pub clauses_without_step: Vec<String>,
    /// Steps of the suite that cite no clause.
    pub steps_without_clause: Vec<String>,
    /// Steps of the suite.
    pub steps: usize,
    /// Steps that no fault mode made fail.
    pub steps_without_fault: usize,
}

/// The clauses of a scripts directory, in the order of their file.
///
/// # Errors
/// The file cannot be read, or is wrong: a name given twice, or a glob that is not one.
pub fn load(directory: &ScriptsDirectory) -> Result<Vec<Clause>, Failure> {
    let wrong = |error: String| Failure::usage(FileTrouble::wrong(directory.shown(FILE), error));
    let written: Written =
        toml::from_str(&directory.text(FILE)?).map_err(|error| wrong(error.to_string()))?;
    for (place, clause) in written.clause.iter().enumerate() {
        let before = &written.clause[..place];
        if before.iter().any(|other| other.id == clause.id) {
            return Err(wrong(format!("there are two clauses \"{}\"", clause.id)));
        }
        for pattern in &clause.steps {
            Pattern::new(pattern).map_err(|error| wrong(format!("{}: {error}", clause.id)))?;
        }
    }
    Ok(written.clause)
}

/// Holds clauses against the steps of a dictionary, and against what its fault modes did to these.
pub fn matrix(clauses: &[Clause], dictionary: &Dictionary) -> Matrix {
    let names: Vec<String> = dictionary.checks.iter().map(ToString::to_string).collect();
    let failing: Vec<BTreeSet<&str>> = (0..names.len())
        .map(|place| faults_that_fail(dictionary, place))
        .collect();
    let mut cited = vec![false; names.len()];
    let mut proofs = Vec::new();
    for clause in clauses {
        let globs: Vec<_> = (clause.steps.iter())
            .filter_map(|pattern| Pattern::new(pattern).ok())
            .collect();
        let places: Vec<usize> = (0..names.len())
            .filter(|place| globs.iter().any(|glob| glob.matches(&names[*place])))
            .collect();
        places.iter().for_each(|place| cited[*place] = true);
        let faults: BTreeSet<&str> = places
            .iter()
            .flat_map(|place| failing[*place].clone())
            .collect();
        let unproved = places.iter().filter(|place| failing[**place].is_empty());
        proofs.push(ClauseProof {
            clause: clause.id.clone(),
            source: clause.source.clone(),
            text: clause.text.clone(),
            text_ko: clause.text_ko.clone(),
            faults: faults.into_iter().map(str::to_owned).collect(),
            unproved: unproved.map(|place| names[*place].clone()).collect(),
            steps: places.iter().map(|place| names[*place].clone()).collect(),
        });
    }
    let without_step = proofs.iter().filter(|proof| proof.steps.is_empty());
    let uncited = names.iter().zip(&cited).filter(|(_, cited)| !**cited);
    Matrix {
        clauses_without_step: without_step.map(|proof| proof.clause.clone()).collect(),
        steps_without_clause: uncited.map(|(name, _)| name.clone()).collect(),
        steps: names.len(),
        steps_without_fault: failing.iter().filter(|faults| faults.is_empty()).count(),
        clauses: proofs,
    }
}

/// Fault modes under which a step failed in one run at least.
fn faults_that_fail(dictionary: &Dictionary, place: usize) -> BTreeSet<&str> {
    let fails = |mode: &&Mode| {
        let mut cells = mode
            .columns
            .iter()
            .filter_map(|column| column.cells.get(&place));
        cells.any(|cell| cell.count(Verdict::Failed) > 0)
    };
    (dictionary.modes.iter().filter(fails))
        .map(|mode| mode.name.id.as_str())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run_diagnosis::choose;
    use crate::test_support::scripts;
    use btu_rig::procedure::plan::Connection;

    /// Goal: every default step cites a clause, every clause has steps that an injected fault makes fail, and what is not
    /// cited or not proved is named. Method: the shipped clauses and dictionary, whole and with a clause left out.
    #[test]
    fn each_default_step_cites_a_clause_and_what_is_open_is_named() {
        let scripts = scripts();
        let dictionary = choose(None, &scripts, Connection::Btu)
            .expect("a dictionary")
            .dictionary;
        let mut clauses = load(&scripts).expect("clauses");
        let whole = matrix(&clauses, &dictionary);
        assert_eq!(whole.steps_without_clause, Vec::<String>::new());
        assert_eq!(whole.clauses_without_step, Vec::<String>::new());
        for proof in &whole.clauses {
            assert!(!proof.faults.is_empty(), "{}", proof.clause);
            assert!(!proof.text_ko.is_ascii(), "{}", proof.clause);
        }
        let left_out = clauses.remove(0);
        clauses.push(Clause {
            id: "none".into(),
            steps: vec!["no/such: step".into()],
            ..left_out
        });
        let open = matrix(&clauses, &dictionary);
        assert!(
            open.steps_without_clause
                .iter()
                .all(|step| step.contains("limit_speed"))
        );
        assert!(!open.steps_without_clause.is_empty());
        assert_eq!(open.clauses_without_step, ["none"]);
    }
}
