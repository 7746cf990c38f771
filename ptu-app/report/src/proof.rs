//! What a passing run says of the repairs made before it, in words.

use ptu_bench::run_diagnosis::RepairProof;

use crate::words::{Words, fill};

/// One sentence: that the repair is proven, or what is missing.
pub fn proof_text(proof: &RepairProof, words: &Words) -> String {
    let report = &words.report;
    let wording = match (proof.is_proven, proof.says.more) {
        (true, _) => report.repair_proven,
        (false, Some(_)) => report.repair_claimed,
        (false, None) => report.repair_not_shown,
    };
    let hidden = match proof.is_proven {
        true => proof.says.hidden,
        false => proof.says.hidden_in_last,
    };
    fill(
        wording,
        &[
            (
                "fault",
                &format!("{} {}", proof.fault.short(), proof.code_name),
            ),
            ("passed", &proof.passed),
            ("hidden", &format!("{:.0}", 100.0 * hidden)),
            ("more", &proof.says.more.unwrap_or_default()),
        ],
    )
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
            is_proven: false,
        };
        let english = proof_text(&proof, Language::English.words());
        for part in ["check_failed", "hides in 33 of 100 such runs", "2 more"] {
            assert!(english.contains(part), "{english}");
        }
        let korean = proof_text(&proof, Language::Korean.words());
        for part in ["check_failed", "100회 중 33회", "2회 더"] {
            assert!(korean.contains(part), "{korean}");
        }
        proof.is_proven = true;
        let proven = proof_text(&proof, Language::English.words());
        assert!(proven.contains("verified"), "{proven}");
    }
}
