//! Reads sequence files (TOML); an error names the line of the file.

#[cfg(test)]
mod tests;

use serde::Deserialize;
use toml::Spanned;

use super::action::{REVERSER, powers};
use super::{Load, Sequence, SequenceError, Step, When, Wrong};
use crate::lever::Lever;
use crate::stimulus::{CutOut, Stimulus, TrainSwitch};

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
fn actions(raw: &RawStep, lines: &Lines<'_>) -> Result<Vec<Stimulus>, SequenceError> {
    let mut actions = Vec::new();
    for (what, car, out) in [
        (CutOut::Brake, raw.brake_cut_out, true),
        (CutOut::Brake, raw.brake_cut_in, false),
        (CutOut::Inverter, raw.inverter_cut_out, true),
        (CutOut::Inverter, raw.inverter_cut_in, false),
    ] {
        actions.extend(car.map(|car| Stimulus::CutOut { what, car, on: out }));
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
        actions.extend(on.map(|on| Stimulus::Switch { switch, on }));
    }
    actions.extend(raw.doors_closed.map(|closed| Stimulus::Doors { closed }));
    if let Some(name) = &raw.reverser {
        let known = REVERSER.iter().find(|(_, known)| known == name.get_ref());
        let wrong = || Wrong::NoReverser(name.get_ref().clone());
        let (position, _) = *known.ok_or_else(|| lines.at(name.span().start, wrong()))?;
        actions.push(Stimulus::Reverser { position });
    }
    if let Some(name) = &raw.lever {
        let wrong = || Wrong::NoLever(name.get_ref().clone());
        let lever =
            Lever::from_name(name.get_ref()).ok_or_else(|| lines.at(name.span().start, wrong()))?;
        actions.push(Stimulus::Controller { lever });
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
        if step.actions.iter().any(powers) {
            return Ok(());
        }
    }
    Ok(())
}
