//! Sentences on repairs before a run that passed.

use ptu_runs::run_diagnosis::RepairProof;

use crate::words::{Words, fill};

/// Proofs of a repair by runs that passed.
#[derive(Clone, Copy, PartialEq)]
enum Group {
    Proven,
    /// Further runs of this kind can prove the repair.
    Claimed,
    /// The fault does not show in such runs.
    NotShown,
}

impl Group {
    fn of(proof: &RepairProof) -> Self {
        match proof.says.more {
            Some(0) => Self::Proven,
            Some(_) => Self::Claimed,
            None => Self::NotShown,
        }
    }
}

/// One sentence for the repairs that are proven, and one for those that are not, by what is missing; empty without any.
/// Several faults share a sentence, which tells the least favourable figures.
pub fn proof_text(proofs: &[RepairProof], words: &Words) -> String {
    let report = &words.report;
    let sentence = |of_group: Group| {
        let wording = match of_group {
            Group::Proven => report.repair_proven,
            Group::Claimed => report.repair_claimed,
            Group::NotShown => report.repair_not_shown,
        };
        let group: Vec<_> = proofs
            .iter()
            .filter(|proof| Group::of(proof) == of_group)
            .collect();
        let first = group.first()?;
        let hidden = group.iter().map(|proof| match of_group {
            Group::Proven => proof.says.hidden,
            Group::Claimed | Group::NotShown => proof.says.hidden_in_last,
        });
        let mut faults = format!("{} {}", first.fault.short(), first.code_name);
        if group.len() > 1 {
            faults += &fill(report.and_others, &[("n", &(group.len() - 1))]);
        }
        let passed = group.iter().map(|proof| proof.passed).min();
        let more = group.iter().filter_map(|proof| proof.says.more).max();
        Some(fill(
            wording,
            &[
                ("fault", &faults),
                ("passed", &passed.unwrap_or_default()),
                (
                    "hidden",
                    &format!("{:.0}", 100.0 * hidden.fold(0.0, f64::max)),
                ),
                ("more", &more.unwrap_or_default()),
            ],
        ))
    };
    let groups = [Group::Proven, Group::Claimed, Group::NotShown];
    let sentences: Vec<_> = groups.into_iter().filter_map(sentence).collect();
    sentences.join("\n")
}

#[cfg(test)]
mod tests {
    use diagnosis::Proof;
    use fault_db::Id;

    use super::*;
    use crate::words::Language;

    #[test]
    fn a_repair_that_is_not_proven_asks_for_more_runs_in_both_languages() {
        let fault: Id = "00000000-0000-0000-0000-000000000001"
            .parse()
            .expect("an id");
        let mut proof = RepairProof {
            fault,
            code_name: "check_failed".into(),
            passed: 1,
            says: Proof {
                hidden: 0.33,
                hidden_in_last: 0.33,
                more: Some(2),
            },
        };
        let english = proof_text(&[proof.clone(), proof.clone()], Language::English.words());
        for part in [
            "check_failed and 1 more",
            "hides in 33 of 100 such runs",
            "needed: 2",
        ] {
            assert!(english.contains(part), "{english}");
        }
        let korean = proof_text(&[proof.clone()], Language::Korean.words());
        for part in ["check_failed", "100회 중 33회", "2회 더"] {
            assert!(korean.contains(part), "{korean}");
        }
        proof.says.more = Some(0);
        let proven = proof_text(&[proof.clone(), proof.clone()], Language::English.words());
        assert!(proven.contains("verified"), "{proven}");
    }
}
