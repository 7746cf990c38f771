//! Outcome of a run for the technician: a word, a headline, and what to do next. The run decides; a diagnosis adds a
//! part to one that failed.

use btu_rig::procedure::Verdict;
use diagnosis::{Conclusion, Diagnosis};
use eframe::egui::Color32;
use egui_material_icons::MaterialIcon;
use egui_material_icons::icons::{
    ICON_CANCEL, ICON_CHECK_CIRCLE, ICON_DO_NOT_DISTURB_ON, ICON_HELP, ICON_WARNING,
};
use protocol::LruId;

use crate::Palette;
use ptu_report::words::Case;

/// Result of a case, as the page tells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    /// A check failed, and the diagnosis found the failed part.
    Part,
    /// A check failed; one of a few parts has failed, the first with a probability over 0.5.
    Few,
    /// A check failed; more than one part may have failed.
    Unsure,
    /// A check failed, and no part explains it.
    NoPart,
    /// All steps that were run passed, and some were not run.
    NotAll,
    NotTested,
    Stopped,
    NoFault,
}

/// Next action after a result, which the accent button offers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    Repair,
    Check,
    ShowFailed,
    WholeSuite,
    RunAgain,
    Sheet,
}

impl Told {
    /// Verdict of a run, with the diagnosis of one that failed.
    pub fn of(run: Verdict, said: Option<&Conclusion>) -> Self {
        match run {
            Verdict::Failed => match said {
                Some(Conclusion::Found { .. }) => Self::Part,
                Some(Conclusion::OneOf { parts, .. })
                    if parts.first().is_some_and(|first| first.probability > 0.5) =>
                {
                    Self::Few
                }
                Some(said) if !said.parts().is_empty() => Self::Unsure,
                _ => Self::NoPart,
            },
            Verdict::Inconclusive | Verdict::Skipped => Self::NotAll,
            Verdict::Error => Self::NotTested,
            Verdict::Aborted => Self::Stopped,
            Verdict::Passed => Self::NoFault,
        }
    }

    pub fn is_failed(self) -> bool {
        matches!(self, Self::Part | Self::Few | Self::Unsure | Self::NoPart)
    }

    /// The action to offer first; `all` = every step was run.
    pub fn next(self, all: bool) -> Next {
        match self {
            Self::Part | Self::Few => Next::Repair,
            // A single next check is not offered here: its run would not be the run of the case.
            Self::Unsure if !all => Next::WholeSuite,
            Self::Unsure | Self::NoPart => Next::ShowFailed,
            Self::NotAll => Next::WholeSuite,
            Self::NotTested | Self::Stopped => Next::RunAgain,
            Self::NoFault => Next::Sheet,
        }
    }

    pub fn word(self, words: &Case) -> &'static str {
        match self {
            Self::Part | Self::Few | Self::NoPart => words.is_failed,
            Self::Unsure => words.is_unsure,
            Self::NotAll => words.is_not_found,
            Self::NotTested => words.is_not_tested,
            Self::Stopped => words.is_stopped,
            Self::NoFault => words.is_passed,
        }
    }

    /// Headline below the word; parts, steps and reasons complete it.
    pub fn headline(self, words: &Case) -> &'static str {
        match self {
            Self::Part => words.replace,
            Self::Few | Self::Unsure => words.probably,
            Self::NoPart => words.no_part_explains,
            Self::NotAll => words.not_everything,
            Self::NotTested => "{why}",
            Self::Stopped => words.stopped_at,
            Self::NoFault => words.no_fault,
        }
    }

    pub fn icon(self) -> MaterialIcon {
        match self {
            Self::Part | Self::Few | Self::NoPart => ICON_CANCEL,
            Self::Unsure | Self::NotAll => ICON_HELP,
            Self::NotTested => ICON_WARNING,
            Self::Stopped => ICON_DO_NOT_DISTURB_ON,
            Self::NoFault => ICON_CHECK_CIRCLE,
        }
    }

    pub fn colour(self, palette: &Palette) -> Color32 {
        match self {
            Self::Part | Self::Few | Self::NoPart => palette.bad,
            Self::Unsure | Self::NotAll | Self::NotTested | Self::Stopped => palette.warn,
            Self::NoFault => palette.good,
        }
    }
}

/// The part that a headline names: the one to replace, or the likeliest.
pub fn named(diagnosis: &Diagnosis) -> Vec<LruId> {
    let mut parts = diagnosis.conclusion.parts();
    parts.truncate(1);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use diagnosis::{Measure, PartProbability};
    use ptu_report::words::Language;

    /// Goal: no diagnosis turns a failed run into a sound unit, or names a part after any other run. Method: every pair
    /// of a run's verdict and a diagnosis's conclusion, against the table of the design.
    #[test]
    fn the_run_decides_and_a_diagnosis_adds_a_part_to_one_that_failed() {
        let words = &Language::English.words().case;
        let part: LruId = "eb_relay".parse().unwrap();
        let probability = 0.9;
        let parts = |n| {
            let lru = part.clone();
            vec![PartProbability { lru, probability }; n]
        };
        let cannot_tell = |n| Conclusion::CannotTell {
            likely: parts(n),
            is_unlike_any: false,
        };
        let one_of = |first: f64| {
            let mut parts = parts(2);
            parts[0].probability = first;
            Conclusion::OneOf {
                parts,
                measure: Measure::default(),
            }
        };
        let found = Conclusion::Found {
            part: part.clone(),
            probability,
        };
        let said = [
            (None, 2),
            (Some(found), 0),
            (
                Some(Conclusion::OfBench {
                    part: part.clone(),
                    probability,
                }),
                1,
            ),
            (Some(one_of(0.4)), 1),
            (Some(one_of(0.9)), 3),
            (Some(cannot_tell(3)), 1),
            (Some(cannot_tell(0)), 2),
            (Some(Conclusion::NoFault { probability }), 2),
            (Some(Conclusion::NothingSeen { made: 1, of: 2 }), 2),
            (Some(Conclusion::BrokenOff), 2),
            (Some(Conclusion::NotWeighed), 2),
        ];
        let failed = [
            ("Failed", "Replace {part}", Next::Repair),
            ("Not certain yet", "Probably {part}", Next::WholeSuite),
            ("Failed", "No single part explains it", Next::ShowFailed),
            ("Failed", "Probably {part}", Next::Repair),
        ];
        let others = [
            (
                Verdict::Inconclusive,
                "Nothing found",
                "Not everything was run",
                Next::WholeSuite,
            ),
            (
                Verdict::Skipped,
                "Nothing found",
                "Not everything was run",
                Next::WholeSuite,
            ),
            (
                Verdict::Error,
                "Could not be tested",
                "{why}",
                Next::RunAgain,
            ),
            (
                Verdict::Aborted,
                "Stopped",
                "Stopped at step {n} of {all}",
                Next::RunAgain,
            ),
            (Verdict::Passed, "Passed", "No fault found", Next::Sheet),
        ];
        for (said, row) in &said {
            let says = |run| {
                let told = Told::of(run, said.as_ref());
                (told.word(words), told.headline(words), told.next(false))
            };
            assert_eq!(says(Verdict::Failed), failed[*row], "{said:?}");
            for (run, word, headline, next) in others {
                assert_eq!(says(run), (word, headline, next), "{run} {said:?}");
            }
        }
        assert_eq!(Told::Unsure.next(true), Next::ShowFailed);
    }
}
