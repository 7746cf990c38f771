//! Values of command line options: sections, loads, disturbances, and quantities held fixed.

use std::str::FromStr;

use btu_rig::conditions::{Conditions, Disturbance};
use protocol::line::Line;

use crate::failure::{DriveTrouble, Failure, Unknown};

/// Sections to drive through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SectionChoice {
    /// Every section of the line.
    All,
    One(u16),
    /// From one section to another, both included.
    Range(u16, u16),
}

impl FromStr for SectionChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| {
            let wrong = || format!("\"{text}\" is no section: use a number, A-B or all");
            text.trim().parse::<u16>().map_err(|_| wrong())
        };
        match text.split_once('-') {
            None if text == "all" => Ok(Self::All),
            None => number(text).map(Self::One),
            Some((from, to)) => match (number(from)?, number(to)?) {
                (from, to) if from > to => {
                    Err(format!("\"{text}\" runs backward: use {to}-{from}"))
                }
                (from, to) => Ok(Self::Range(from, to)),
            },
        }
    }
}

impl SectionChoice {
    /// Numbers of the chosen sections on `line`, in running order.
    ///
    /// # Errors
    /// The line does not have the section, or one end of the range.
    pub fn numbers(self, line: &Line) -> Result<Vec<u16>, Failure> {
        let all = line.sections.iter().map(|section| section.section);
        let (from, to) = match self {
            Self::All => return Ok(all.collect()),
            Self::One(number) => (number, number),
            Self::Range(from, to) => (from, to),
        };
        for end in [from, to] {
            if line.section(end).is_none() {
                let known: Vec<_> = all.map(|number| number.to_string()).collect();
                return Err(Failure::usage(Unknown::SectionOf(
                    line.name.clone(),
                    end,
                    known.join(", "),
                )));
            }
        }
        Ok(all.filter(|number| (from..=to).contains(number)).collect())
    }
}

/// The disturbance of [S1].
pub const S1: Disturbance = Disturbance::Sine {
    amplitude_n_s_per_m: 2e4,
    hz: 1.0,
};

/// Force against the train by its name: `none`, `s1` [S1: 2e4 N·s/m at 1 Hz] or AMP@HZ.
///
/// # Errors
/// The text is no such name, or a number is out of range.
pub fn disturbance(text: &str) -> Result<Disturbance, String> {
    let (amplitude, hz) = match text {
        "none" => return Ok(Disturbance::None),
        "s1" => return Ok(S1),
        _ => text
            .split_once('@')
            .ok_or_else(|| format!("\"{text}\" is no disturbance: use none, s1 or AMP@HZ"))?,
    };
    let number = |name: &str, text: &str, most: f64| match text.parse::<f64>() {
        Ok(value) if (0.0..=most).contains(&value) => Ok(value),
        _ => Err(format!(
            "{name} \"{text}\" of the disturbance must be from 0 to {most}"
        )),
    };
    Ok(Disturbance::Sine {
        amplitude_n_s_per_m: number("amplitude", amplitude, 1e6)?,
        hz: number("frequency", hz, 20.0)?,
    })
}

/// Values given on the command line, held where the rest is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fixed {
    /// Passengers, kg.
    pub load_kg: Option<f64>,
    /// Added to every gradient, ‰.
    pub gradient_permille: Option<f64>,
    /// Adhesion coefficient.
    pub adhesion: Option<f64>,
    /// True wheel diameter over the configured one.
    pub wheel_factor: Option<f64>,
    /// Disturbing force.
    pub disturbance: Option<Disturbance>,
}

impl Fixed {
    /// Refuses what no train or track can have.
    ///
    /// # Errors
    /// Names the option.
    pub fn check(&self) -> Result<(), Failure> {
        for (option, value, low, high) in [
            ("--gradient", self.gradient_permille, -50.0, 50.0),
            ("--adhesion", self.adhesion, 0.02, 0.6),
            ("--wheel", self.wheel_factor, 0.9, 1.1),
        ] {
            if let Some(value) = value.filter(|value| !(low..=high).contains(value)) {
                return Err(Failure::usage(DriveTrouble::Outside(
                    option.to_owned(),
                    value.to_string(),
                    low.to_string(),
                    high.to_string(),
                )));
            }
        }
        Ok(())
    }

    /// `load_kg` and `conditions` with what is held fixed in their place.
    pub fn hold(&self, load_kg: f64, conditions: Conditions) -> (f64, Conditions) {
        let c = conditions;
        let gradient = self.gradient_permille.unwrap_or(c.gradient_offset_permille);
        let conditions = Conditions {
            gradient_offset_permille: gradient,
            adhesion: self.adhesion.unwrap_or(c.adhesion),
            wheel_factor: self.wheel_factor.unwrap_or(c.wheel_factor),
            disturbance: self.disturbance.unwrap_or(c.disturbance),
            ..c
        };
        (self.load_kg.unwrap_or(load_kg), conditions)
    }
}
