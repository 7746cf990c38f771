//! Sentences on repairs before a run that passed.

use ptu_runs::run_diagnosis::RepairProof;

use crate::words::{Words, fill};

/// One sentence on the proven repairs, and one for each way in which repairs are not proven; empty without a repair.
/// Several faults share a sentence, which tells the least favourable figures.
pub fn proof_text(proofs: &[RepairProof], words: &Words) -> String {
    let report = &words.report;
    let sentence = |wording: &str, is_of_group: fn(Option<u32>) -> bool| {
        let group = proofs.iter().filter(|proof| is_of_group(proof.says.more));
        let group: Vec<_> = group.collect();
        let first = group.first()?;
        let hidden = group.iter().map(|proof| match proof.says.more {
            Some(0) => proof.says.hidden,
            _ => proof.says.hidden_in_last,
        });
        let hidden = format!("{:.0}", 100.0 * hidden.fold(0.0, f64::max));
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
                ("hidden", &hidden),
                ("more", &more.unwrap_or_default()),
            ],
        ))
    };
    // The last sentence is for faults that do not show in runs of this kind, however many runs there are.
    let sentences = [
        sentence(report.repair_proven, |more| more == Some(0)),
        sentence(report.repair_claimed, |more| {
            more.is_some_and(|more| more > 0)
        }),
        sentence(report.repair_not_shown, |more| more.is_none()),
    ];
    let sentences: Vec<_> = sentences.into_iter().flatten().collect();
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
