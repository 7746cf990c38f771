//! A sequence of notches and switches: each step's condition and actions, and the train's load.

use std::fmt::{self, Write};

use super::action::toml;
use crate::stimulus::Stimulus;

/// Passengers aboard.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Load {
    /// Nobody.
    #[default]
    Empty,
    /// As many as the train carries.
    Full,
    /// So many, kg.
    Kg(f64),
}

/// What a step waits for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum When {
    /// So long after the step before, or after the beginning, s.
    After(f64),
    /// The train reaches a speed, rising or falling, km/h.
    AtKmh(f64),
    /// The train stands after having moved.
    AtStandstill,
}

impl fmt::Display for When {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::After(seconds) => write!(f, "{seconds} s after the step before"),
            Self::AtKmh(kmh) => write!(f, "{kmh} km/h"),
            Self::AtStandstill => f.write_str("standstill"),
        }
    }
}

/// A step.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Line of its file, counted from 1; 0 = driven by hand.
    pub line: usize,
    /// What it waits for.
    pub when: When,
    /// What is done then, in this order.
    pub actions: Vec<Stimulus>,
}

/// A sequence, checked as far as it can be without train and unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sequence {
    /// What it shows.
    pub title: String,
    /// Line it is made for; none = any.
    pub line: Option<String>,
    /// Section of that line.
    pub section: Option<u16>,
    /// Passengers.
    pub load: Load,
    /// Speed code in the antenna; none = the highest.
    pub code: Option<String>,
    /// Added to the track's gradients, ‰, uphill positive.
    pub gradient_permille: f64,
    /// Steps in order.
    pub steps: Vec<Step>,
    /// So long after the last step the run is over, s; none = when the train has stood for 2 s.
    pub end_after_s: Option<f64>,
}

impl Sequence {
    /// As a file, which [`Sequence::from_toml`] takes back.
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        // Writing to a text cannot fail.
        let _ = writeln!(text, "title = {}", quoted(&self.title));
        if let Some(line) = &self.line {
            let _ = writeln!(text, "line = {}", quoted(line));
        }
        if let Some(section) = self.section {
            let _ = writeln!(text, "section = {section}");
        }
        let _ = match self.load {
            Load::Empty => writeln!(text, "load = \"empty\""),
            Load::Full => writeln!(text, "load = \"full\""),
            Load::Kg(kg) => writeln!(text, "load = {kg:?}"),
        };
        if let Some(code) = &self.code {
            let _ = writeln!(text, "code = {}", quoted(code));
        }
        let _ = writeln!(text, "gradient_permille = {:?}", self.gradient_permille);
        if let Some(end_after_s) = self.end_after_s {
            let _ = writeln!(text, "end_after_s = {end_after_s:?}");
        }
        for step in &self.steps {
            let when = match step.when {
                When::After(seconds) => format!("after_s = {seconds:?}"),
                When::AtKmh(kmh) => format!("at_kmh = {kmh:?}"),
                When::AtStandstill => "at_standstill = true".into(),
            };
            let _ = writeln!(text, "\n[[steps]]\n{when}");
            for action in &step.actions {
                let _ = writeln!(text, "{}", toml(action));
            }
        }
        text
    }
}

/// A text as a basic string of TOML.
fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            letter if letter.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", letter as u32);
            }
            letter => quoted.push(letter),
        }
    }
    quoted.push('"');
    quoted
}
