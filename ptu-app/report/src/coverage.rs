//! How much of what was chosen was run, in words: a verdict of a part of the suite says so in its first line.

use ptu_runs::coverage::Coverage;

use crate::words::{Words, fill};

/// What was run, if that is not all that was chosen.
pub fn coverage_text(coverage: &Coverage, words: &Words) -> Option<String> {
    let (report, skipped) = (&words.report, coverage.skipped());
    if skipped == 0 || coverage.run == 0 {
        return None;
    }
    let wording = match coverage.run == coverage.passed {
        true => report.part_passed,
        false => report.part_not_passed,
    };
    let mut text = fill(
        wording,
        &[
            ("run", &coverage.run),
            ("of", &coverage.of),
            ("n", &(coverage.run - coverage.passed)),
            ("skipped", &skipped),
        ],
    );
    if coverage.need_bench > 0 {
        let folders: Vec<_> = coverage.on_bench.iter().map(String::as_str).collect();
        text += &fill(
            report.needs_bench,
            &[("n", &coverage.need_bench), ("what", &folders.join(", "))],
        );
    }
    Some(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::words::Language;

    #[test]
    fn a_part_of_the_suite_says_what_it_left_out_in_both_languages() {
        let mut coverage = Coverage {
            of: 466,
            run: 80,
            passed: 80,
            need_bench: 386,
            on_bench: ["ato", "atp"].map(String::from).into(),
        };
        let said = |coverage: &Coverage, language: Language| {
            coverage_text(coverage, language.words()).expect("a part")
        };
        assert_eq!(
            said(&coverage, Language::English),
            "80 of 466 steps run, all passed; 386 skipped; 386 need the bench harness: ato, atp"
        );
        assert_eq!(
            said(&coverage, Language::Korean),
            "466개 단계 중 80개 수행, 모두 합격; 386개 건너뜀; 386개는 시험대 하네스 필요: ato, atp"
        );
        coverage.passed = 79;
        assert!(
            said(&coverage, Language::English).starts_with("80 of 466 steps run, 1 did not pass")
        );
        coverage.run = 466;
        assert_eq!(coverage_text(&coverage, Language::English.words()), None);
    }
}
