//! Sequence files: TOML, checked line by line.

use serde::Deserialize;
use toml::Spanned;

use super::action::REVERSER;
use super::{Action, Load, Sequence, SequenceError, Step, When, Wrong};
use crate::lever::Lever;
use crate::stimulus::{CutOut, TrainSwitch};

/// Steps a sequence may have.
pub const MAX_STEPS: usize = 1000;
/// Longest time between two steps, s: that of the longest run.
pub const MAX_AFTER_S: f64 = 3600.0;
/// Highest speed a step may wait for, km/h.
const MAX_KMH: f64 = 150.0;
/// Steepest gradient, ‰.
const MAX_PERMILLE: f64 = 50.0;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFile {
    title: String,
    line: Option<String>,
    section: Option<u16>,
    load: Option<Spanned<RawLoad>>,
    code: Option<String>,
    gradient_permille: Option<Spanned<f64>>,
    end_after_s: Option<Spanned<f64>>,
    #[serde(default)]
    steps: Vec<Spanned<RawStep>>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum RawLoad {
    Kg(f64),
    Name(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawStep {
    after_s: Option<Spanned<f64>>,
    at_kmh: Option<Spanned<f64>>,
    at_standstill: Option<Spanned<bool>>,
    lever: Option<Spanned<String>>,
    reverser: Option<Spanned<String>>,
    doors_closed: Option<bool>,
    brake_cut_out: Option<u8>,
    brake_cut_in: Option<u8>,
    inverter_cut_out: Option<u8>,
    inverter_cut_in: Option<u8>,
    other_active: Option<bool>,
    dead_man: Option<bool>,
    emergency_button: Option<bool>,
    emergency_button_2: Option<bool>,
    eb_cut_out: Option<bool>,
    main_reservoir_low: Option<bool>,
    security_brake: Option<bool>,
    parking_brake: Option<bool>,
    forced_release: Option<bool>,
    turn_back: Option<bool>,
    regeneration: Option<bool>,
}

/// A text whose places are told as lines.
struct Lines<'a>(&'a str);

impl Lines<'_> {
    /// Line of a byte, counted from 1.
    fn of(&self, byte: usize) -> usize {
        let before = self.0.as_bytes().iter().take(byte);
        1 + before.filter(|letter| **letter == b'\n').count()
    }

    fn at(&self, byte: usize, wrong: Wrong) -> SequenceError {
        let line = self.of(byte);
        SequenceError { line, wrong }
    }

    fn in_range(
        &self,
        key: &'static str,
        value: &Spanned<f64>,
        (low, high): (f64, f64),
    ) -> Result<f64, SequenceError> {
        let number = *value.get_ref();
        if (low..=high).contains(&number) {
            return Ok(number);
        }
        Err(self.at(
            value.span().start,
            Wrong::OutOfRange {
                key,
                value: number.to_string(),
                low: low.to_string(),
                high: high.to_string(),
            },
        ))
    }
}

impl Sequence {
    /// Reads and checks a sequence file.
    ///
    /// # Errors
    /// The first thing wrong, with its line.
    pub fn from_toml(text: &str) -> Result<Self, SequenceError> {
        let lines = Lines(text);
        let raw: RawFile = toml::from_str(text).map_err(|error| {
            let byte = error.span().map_or(0, |span| span.start);
            lines.at(byte, Wrong::Syntax(error.message().to_owned()))
        })?;
        let gradient_permille = match &raw.gradient_permille {
            Some(value) => {
                lines.in_range("gradient_permille", value, (-MAX_PERMILLE, MAX_PERMILLE))?
            }
            None => 0.0,
        };
        let end_after_s = raw.end_after_s.as_ref();
        let end_after_s = end_after_s
            .map(|value| lines.in_range("end_after_s", value, (0.0, MAX_AFTER_S)))
            .transpose()?;
        let load = raw.load.map_or(Ok(Load::Empty), |raw| load(raw, &lines))?;
        let end = text.len();
        match raw.steps.len() {
            0 => return Err(lines.at(end, Wrong::NoSteps)),
            count if count > MAX_STEPS => return Err(lines.at(end, Wrong::TooManySteps)),
            _ => {}
        }
        let mut steps = Vec::new();
        for raw in raw.steps {
            steps.push(step(raw, &lines)?);
        }
        // On a gradient a train may roll off by itself.
        if gradient_permille == 0.0 {
            in_order(&steps)?;
        }
        Ok(Self {
            title: raw.title,
            line: raw.line,
            section: raw.section,
            load,
            code: raw.code,
            gradient_permille,
            steps,
            end_after_s,
        })
    }
}

fn load(raw: Spanned<RawLoad>, lines: &Lines<'_>) -> Result<Load, SequenceError> {
    let at = raw.span().start;
    match raw.into_inner() {
        RawLoad::Kg(kg) if kg.is_finite() && kg >= 0.0 => Ok(Load::Kg(kg)),
        RawLoad::Kg(kg) => Err(lines.at(at, Wrong::NoLoad(kg.to_string()))),
        RawLoad::Name(name) => match name.as_str() {
            "empty" => Ok(Load::Empty),
            "full" => Ok(Load::Full),
            _ => Err(lines.at(at, Wrong::NoLoad(name))),
        },
    }
}

fn step(raw: Spanned<RawStep>, lines: &Lines<'_>) -> Result<Step, SequenceError> {
    let at = raw.span().start;
    let raw = raw.into_inner();
    let when = when(&raw, lines, at)?;
    let actions = actions(&raw, lines)?;
    if actions.is_empty() {
        return Err(lines.at(at, Wrong::NoAction));
    }
    Ok(Step {
        line: lines.of(at),
        when,
        actions,
    })
}

fn when(raw: &RawStep, lines: &Lines<'_>, at: usize) -> Result<When, SequenceError> {
    let given = [
        ("after_s", raw.after_s.is_some()),
        ("at_kmh", raw.at_kmh.is_some()),
        ("at_standstill", raw.at_standstill.is_some()),
    ];
    let named: Vec<_> = given.iter().filter(|key| key.1).map(|key| key.0).collect();
    if named.len() > 1 {
        return Err(lines.at(at, Wrong::TwoConditions(named.join(" and "))));
    }
    match (&raw.after_s, &raw.at_kmh, &raw.at_standstill) {
        (Some(value), ..) => {
            let seconds = lines.in_range("after_s", value, (0.0, MAX_AFTER_S))?;
            Ok(When::After(seconds))
        }
        (_, Some(value), _) => {
            let kmh = lines.in_range("at_kmh", value, (0.1, MAX_KMH))?;
            Ok(When::AtKmh(kmh))
        }
        (_, _, Some(value)) if *value.get_ref() => Ok(When::AtStandstill),
        (_, _, Some(value)) => Err(lines.at(value.span().start, Wrong::NotAtStandstill)),
        _ => Err(lines.at(at, Wrong::NoCondition)),
    }
}

/// What is cut out or switched comes before the lever, so that one step can do both.
fn actions(raw: &RawStep, lines: &Lines<'_>) -> Result<Vec<Action>, SequenceError> {
    let mut actions = Vec::new();
    for (what, car, out) in [
        (CutOut::Brake, raw.brake_cut_out, true),
        (CutOut::Brake, raw.brake_cut_in, false),
        (CutOut::Inverter, raw.inverter_cut_out, true),
        (CutOut::Inverter, raw.inverter_cut_in, false),
    ] {
        actions.extend(car.map(|car| Action::CutOut { what, car, out }));
    }
    for (switch, on) in [
        (TrainSwitch::OtherCab, raw.other_active),
        (TrainSwitch::DeadMan, raw.dead_man),
        (TrainSwitch::Button1, raw.emergency_button),
        (TrainSwitch::Button2, raw.emergency_button_2),
        (TrainSwitch::EbCutOut, raw.eb_cut_out),
        (TrainSwitch::MainReservoirLow, raw.main_reservoir_low),
        (TrainSwitch::SecurityBrake, raw.security_brake),
        (TrainSwitch::ParkingBrake, raw.parking_brake),
        (TrainSwitch::ForcedRelease, raw.forced_release),
        (TrainSwitch::TurnBack, raw.turn_back),
        (TrainSwitch::Regeneration, raw.regeneration),
    ] {
        actions.extend(on.map(|on| Action::Switch(switch, on)));
    }
    actions.extend(raw.doors_closed.map(|closed| Action::Doors { closed }));
    if let Some(name) = &raw.reverser {
        let known = REVERSER.iter().find(|(_, known)| known == name.get_ref());
        let wrong = || Wrong::NoReverser(name.get_ref().clone());
        let (position, _) = known.ok_or_else(|| lines.at(name.span().start, wrong()))?;
        actions.push(Action::Reverser(*position));
    }
    if let Some(name) = &raw.lever {
        let wrong = || Wrong::NoLever(name.get_ref().clone());
        let lever =
            Lever::from_name(name.get_ref()).ok_or_else(|| lines.at(name.span().start, wrong()))?;
        actions.push(Action::Lever(lever));
    }
    Ok(actions)
}

/// A step that waits for motion comes after one that powers.
fn in_order(steps: &[Step]) -> Result<(), SequenceError> {
    for step in steps {
        if !matches!(step.when, When::After(_)) {
            let (line, wrong) = (step.line, Wrong::NothingMoves(step.when.to_string()));
            return Err(SequenceError { line, wrong });
        }
        if step.actions.iter().any(|action| action.powers()) {
            return Ok(());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"title = "one \"stop\""
load = "full"
code = "75"

[[steps]]
after_s = 1
lever = "P4"

[[steps]]
at_kmh = 40.5
regeneration = false
brake_cut_out = 4
lever = "b7"

[[steps]]
at_standstill = true
emergency_button_2 = true
"#;

    #[test]
    fn a_file_is_read_and_written_back() {
        let sequence = Sequence::from_toml(GOOD).unwrap();
        assert_eq!(sequence.load, Load::Full);
        let steps: Vec<_> = sequence.steps.iter().map(|s| (s.line, s.when)).collect();
        assert_eq!(
            steps,
            [
                (5, When::After(1.0)),
                (9, When::AtKmh(40.5)),
                (15, When::AtStandstill)
            ]
        );
        let words: Vec<_> = sequence.steps[1]
            .actions
            .iter()
            .map(ToString::to_string)
            .collect();
        assert_eq!(
            words,
            ["brake of car 4 cut out", "regeneration cut-out", "B7"]
        );
        let mut again = Sequence::from_toml(&sequence.to_toml()).unwrap();
        for (step, before) in again.steps.iter_mut().zip(&sequence.steps) {
            step.line = before.line;
        }
        assert_eq!(again, sequence);
    }

    /// Every action is written with a key that is read again as the same.
    #[test]
    fn every_action_comes_back_from_its_own_words() {
        let switches = super::super::action::SWITCHES;
        let switched = switches
            .iter()
            .map(|(switch, _)| Action::Switch(*switch, false));
        let levers = Lever::ALL.into_iter().map(Action::Lever);
        let reverser = [1, 0, -1].map(Action::Reverser);
        let cut = |what, out| Action::CutOut { what, car: 3, out };
        let others = [
            Action::Doors { closed: false },
            cut(CutOut::Brake, true),
            cut(CutOut::Brake, false),
            cut(CutOut::Inverter, true),
            cut(CutOut::Inverter, false),
        ];
        for action in switched.chain(levers).chain(reverser).chain(others) {
            let text = format!("title = \"x\"\n[[steps]]\nafter_s = 0\n{}\n", action.toml());
            let sequence = Sequence::from_toml(&text).unwrap();
            assert_eq!(sequence.steps[0].actions, [action], "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        let replaced = |from: &str, to: &str| {
            assert!(GOOD.contains(from), "{from}");
            GOOD.replacen(from, to, 1)
        };
        for (text, line, words) in [
            (replaced("\"P4\"", "\"P5\""), 7, "no lever position \"P5\""),
            (replaced("after_s = 1\n", ""), 5, "says not when"),
            (
                replaced("at_kmh = 40.5", "at_kmh = 40.5\nafter_s = 2"),
                9,
                "after_s and at_kmh",
            ),
            (
                replaced("after_s = 1", "after_s = -1"),
                6,
                "after_s = -1 is outside 0 .. 3600",
            ),
            (replaced("after_s = 1", "after_s = nan"), 6, "after_s = NaN"),
            (replaced("40.5", "900"), 10, "at_kmh = 900 is outside"),
            (replaced("40.5", "-3"), 10, "at_kmh = -3 is outside"),
            (
                replaced("at_standstill = true", "at_standstill = false"),
                16,
                "can only be true",
            ),
            (
                replaced("emergency_button_2 = true", ""),
                15,
                "does nothing",
            ),
            (replaced("\"P4\"", "\"N\""), 9, "no step before it powers"),
            (replaced("lever = \"P4\"", "levr = \"P4\""), 7, "levr"),
            (replaced("\"full\"", "\"half\""), 2, "no load \"half\""),
            (replaced("\"full\"", "-4"), 2, "no load \"-4\""),
            (
                replaced("brake_cut_out = 4", "brake_cut_out = 400"),
                12,
                "400",
            ),
            (
                replaced("lever = \"b7\"", "reverser = \"up\""),
                13,
                "\"up\"",
            ),
            (replaced("title", "tilte"), 1, "tilte"),
            ("title = \"x\"\n".into(), 2, "no [[steps]]"),
            ("title = ".into(), 1, ""),
        ] {
            let error = Sequence::from_toml(&text).unwrap_err();
            assert_eq!(error.line, line, "{error}\n{text}");
            assert!(error.to_string().contains(words), "{error}\n{text}");
        }
    }

    /// A train that stands on a gradient may roll by itself.
    #[test]
    fn on_a_gradient_a_step_may_wait_for_a_train_nobody_powers() {
        let rolls =
            "title = \"x\"\ngradient_permille = 35\n[[steps]]\nat_kmh = 3\nlever = \"B7\"\n";
        assert!(Sequence::from_toml(rolls).is_ok());
    }

    #[test]
    fn there_is_an_end_to_steps() {
        let step = "[[steps]]\nafter_s = 0\nlever = \"N\"\n";
        let text = format!("title = \"x\"\n{}", step.repeat(MAX_STEPS + 1));
        let error = Sequence::from_toml(&text).unwrap_err();
        assert_eq!(error.wrong, Wrong::TooManySteps);
    }
}
