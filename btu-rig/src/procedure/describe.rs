//! Text of a plan: what a technician reads before a unit is driven, and in messages afterwards.

use std::fmt::{self, Display, Formatter};

use protocol::event::Event;
use protocol::message::{Refusals, SelfTest, WordSpec};
use protocol::signal::{Kind, Sample, Signal};

use super::names::{Name, Part};
use super::plan::{
    Action, Comparison, Condition, Connection, Expectation, Measure, Operand, Procedure, Step,
    TimeFrom, What,
};
use crate::stimulus::text::number;
use crate::tcms::{EbSources, Lamps, PowerCuts, names_of};

/// What is said of a unit's clock that is faster than the tester's by this number of thousandths; below 0 = slower.
pub fn clock_wrong(by_permille: i32) -> String {
    let way = if by_permille > 0 { "fast" } else { "slow" };
    let percent = f64::from(by_permille.abs()) / 10.0;
    format!("the unit's clock goes {percent:.1} % too {way} by the tester's")
}

impl Procedure {
    /// The whole plan, one line for each thing done, expected or measured.
    pub fn describe(&self) -> Vec<String> {
        let needs = match self.needs {
            Connection::Btu => "bench",
            Connection::Ptu => "on the train, through the TEST board",
        };
        let mut lines = vec![
            format!("{}: {}", self.id, self.title),
            format!("  needs: {needs}; at most {}", self.worst_case()),
        ];
        if let Some(lacks) = &self.lacks {
            lines.push(format!("  skipped {lacks}"));
        }
        for (what, actions) in [("setup", &self.setup), ("clean-up", &self.cleanup)] {
            if !actions.is_empty() {
                lines.push(format!("  {what}"));
                lines.extend(actions.iter().map(|action| format!("    do      {action}")));
            }
        }
        for (i, step) in self.steps.iter().enumerate() {
            lines.push(format!("  {:>3}. {}", i + 1, step.heading()));
            lines.extend(step.describe());
        }
        lines
    }
}

impl Step {
    fn heading(&self) -> String {
        let times = match self.repeat {
            1 => String::new(),
            n => format!(", {n} times"),
        };
        format!(
            "{} (line {}, at most {}{times})",
            self.name, self.line, self.worst_case
        )
    }

    /// The step's parts, one line each.
    pub fn describe(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(note) = &self.note {
            lines.push(format!("    note    {note}"));
        }
        if let Some(lacks) = &self.lacks {
            lines.push(format!("    skipped {lacks}"));
        }
        if let Some(when) = &self.when {
            lines.push(format!("    only if {when}"));
        }
        lines.extend(self.actions.iter().map(|a| format!("    do      {a}")));
        lines.extend(self.expectations.iter().map(|e| format!("    expect  {e}")));
        lines.extend(
            self.origin
                .text()
                .map(|source| format!("            [{source}]")),
        );
        for measure in &self.measures {
            lines.push(format!("    measure {measure}"));
            let source = measure.origin.text();
            lines.extend(source.map(|source| format!("            [{source}]")));
        }
        if !self.provokes.is_empty() {
            let names: Vec<_> = self.provokes.iter().map(|e| e.definition().name).collect();
            lines.push(format!("    provokes {}", names.join(", ")));
        }
        lines
    }
}

impl Display for Condition {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let said = f.alternate();
        match self {
            Self::Compare {
                signal,
                comparison,
                operand,
            } => {
                let name = Part(Name(signal.name()), said);
                if let (true, Operand::Literal(bits)) = (comparison.is_bits(), operand) {
                    let bits = *bits as u16;
                    let bits = bit_names(*signal, bits).unwrap_or(format!("bits {bits:#b}"));
                    let bits = Part(Name(&bits), said);
                    return write!(f, "{name} {} {bits}", sign(*comparison));
                }
                let operand = value(*signal, operand);
                let operand = Part(Name(&operand), said);
                write!(f, "{name} {} {operand}", sign(*comparison))?;
                if let Comparison::Near { tolerance } = comparison {
                    write!(f, " ± {}", number(*tolerance))?;
                }
                Ok(())
            }
            Self::All(parts) => group(f, parts, " and "),
            Self::Any(parts) => group(f, parts, " or "),
        }
    }
}

fn sign(comparison: Comparison) -> &'static str {
    match comparison {
        Comparison::Equal => "=",
        Comparison::NotEqual => "≠",
        Comparison::Below => "<",
        Comparison::AtMost => "≤",
        Comparison::Above => ">",
        Comparison::AtLeast => "≥",
        Comparison::Near { .. } => "≈",
        Comparison::Has => "with",
        Comparison::Lacks => "without",
    }
}

fn group(f: &mut Formatter<'_>, parts: &[Condition], word: &str) -> fmt::Result {
    let said = f.alternate();
    let parts = parts.iter().map(|part| Part(part, said).to_string());
    write!(f, "({})", parts.collect::<Vec<_>>().join(word))
}

/// Bits of a signal by their names: causes, lamps, cars. `None` if the signal is no set of bits, or if no bit that
/// is set has a name.
pub fn bit_names(signal: Signal, bits: u16) -> Option<String> {
    let names = match signal {
        Signal::PowerCutCauses => names_of::<PowerCuts>(bits),
        Signal::EbSources => names_of::<EbSources>(bits),
        Signal::Lamps => names_of::<Lamps>(bits),
        Signal::NotReleased => {
            let cars = (1..).zip(0..u16::BITS);
            let named = cars.filter(|(_, bit)| bits & 1 << bit != 0);
            named
                .map(|(car, _): (u32, _)| format!("car {car}"))
                .collect()
        }
        Signal::SelfTest => words_of(&SelfTest::SPEC, bits),
        Signal::Refusals => words_of(&Refusals::SPEC, bits),
        _ => return None,
    };
    match (bits, names.is_empty()) {
        (0, _) => Some("none".into()),
        (_, true) => None,
        _ => Some(names.join(" + ")),
    }
}

/// Meanings of the bits that are set in a word of the wire.
pub fn meanings(word: &WordSpec, bits: u16) -> String {
    let found = words_of(word, bits);
    if found.is_empty() {
        return "nothing".into();
    }
    found.join("; ")
}

/// Meaning of each bit that is set in a word of the wire.
fn words_of(word: &WordSpec, bits: u16) -> Vec<String> {
    let meaning = |bit: u8| {
        let known = word.entries.iter().find(|entry| entry.0 == bit);
        known.map_or_else(
            || format!("bit {bit}"),
            |entry| entry.2.trim_end_matches('.').to_owned(),
        )
    };
    let set = (0..16).filter(|bit| bits & 1 << bit != 0);
    set.map(meaning).collect()
}

/// An operand as the signal's reader knows it: a label, on or off, a number with its unit.
fn value(signal: Signal, operand: &Operand) -> String {
    let definition = signal.definition();
    match (definition.kind, operand) {
        (Kind::Enum(labels), Operand::Literal(v)) => match labels.get(*v as usize) {
            Some(label) => (*label).into(),
            None => number(*v),
        },
        (Kind::Bit, Operand::Literal(v)) => if *v == 0.0 { "off" } else { "on" }.into(),
        (Kind::Number { .. }, Operand::Literal(v)) => {
            bit_names(signal, *v as u16).unwrap_or_else(|| with_unit(operand, definition.unit))
        }
        _ => with_unit(operand, definition.unit),
    }
}

fn with_unit(operand: &Operand, unit: &str) -> String {
    format!("{operand} {unit}").trim_end().into()
}

impl Display for Operand {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Literal(value) => f.write_str(&number(*value)),
            Self::Measured { name, offset, .. } if *offset == 0.0 => {
                write!(f, "measured \"{name}\"")
            }
            Self::Measured { name, offset, .. } => {
                let sign = if *offset < 0.0 { '-' } else { '+' };
                write!(f, "measured \"{name}\" {sign} {}", number(offset.abs()))
            }
        }
    }
}

impl Display for Action {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stimulus(stimulus) => stimulus.fmt(f),
            Self::Wait(span) => write!(f, "wait {span}"),
            Self::Until { condition, within } => write!(f, "until {condition} within {within}"),
            Self::Settle { within } => write!(f, "until finished, within {within}"),
            Self::Prompt { text, within } => {
                write!(f, "ask the operator \"{text}\" within {within}")
            }
            Self::OnBench(action) => write!(f, "on a bench: {action}"),
            Self::OnTrain(action) => write!(f, "on a train: {action}"),
        }
    }
}

/// An event's name, and the limits of its parameter where it has any.
pub(super) fn logged_text(event: Event, [low, high]: [i32; 2], said: bool) -> String {
    let mut text = Part(Name(event.definition().name), said).to_string();
    let least = (low != i32::MIN).then(|| low.to_string());
    let most = (high != i32::MAX).then(|| high.to_string());
    if least.is_some() || most.is_some() {
        let what = event.definition().parameter;
        text.push_str(&format!(" ({what}: {})", limits(least, most)));
    }
    text
}

impl Display for Expectation {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let said = f.alternate();
        match self {
            Self::Becomes { condition, within } => {
                write!(f, "{} within {within}", Part(condition, said))
            }
            Self::Holds {
                condition,
                duration,
            } => write!(f, "{} held for {duration}", Part(condition, said)),
            Self::Never { condition } => write!(f, "never {}", Part(condition, said)),
            Self::Logs {
                event,
                parameter,
                within,
            } => write!(
                f,
                "log entry {} within {within}",
                logged_text(*event, *parameter, said)
            ),
            Self::NeverLogs { event } => write!(
                f,
                "no log entry {}",
                Part(Name(event.definition().name), said)
            ),
        }
    }
}

impl Display for Measure {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.name)?;
        match &self.what {
            What::Time { from, to } => {
                let from = match from {
                    TimeFrom::StepStart => "the step's start".to_owned(),
                    TimeFrom::ActionsEnd => "the end of the actions".to_owned(),
                    TimeFrom::Condition(condition) => condition.to_string(),
                };
                write!(f, "time from {from} to {to}")?;
            }
            What::Value(signal) => write!(f, "{} at the end", signal.name())?,
            What::At { signal, when } => write!(f, "{} as soon as {when}", signal.name())?,
            What::Maximum(signal) => write!(f, "greatest {}", signal.name())?,
            What::Minimum(signal) => write!(f, "least {}", signal.name())?,
            What::Change(signal) => write!(f, "change of {}", signal.name())?,
            What::SelfTest { bit } => {
                let item = meanings(&SelfTest::SPEC, 1 << bit);
                write!(f, "{item}, by the unit's own limits")?;
            }
        }
        let unit = self.unit();
        let limit = |limit: &Operand| match limit {
            Operand::Literal(newtons) if unit == "N" => force(*newtons),
            other => with_unit(other, unit),
        };
        let low = self.low.as_ref().map(|low| match self.high {
            Some(_) if unit != "N" => low.to_string(),
            _ => limit(low),
        });
        match (low, self.high.as_ref().map(limit)) {
            (None, None) => Ok(()),
            (low, high) => write!(f, ", {}", limits(low, high)),
        }
    }
}

/// Limits in words.
pub(super) fn limits(low: Option<String>, high: Option<String>) -> String {
    match (low, high) {
        (None, None) => "anything".into(),
        (Some(low), None) => format!("at least {low}"),
        (None, Some(high)) => format!("at most {high}"),
        (Some(low), Some(high)) => format!("{low} to {high}"),
    }
}

/// A force as people say it: kN with one digit, small ones in N.
fn force(newtons: f64) -> String {
    if newtons.abs() < 1000.0 {
        return format!("{} N", newtons.round() + 0.0);
    }
    format!("{:.1} kN", newtons / 1000.0)
}

/// The bits of the signal that a condition looks at, if the signal is a set of bits.
pub(super) fn bits_seen(condition: &Condition, sample: &Sample) -> Option<u16> {
    let Condition::Compare { signal, .. } = condition else {
        return None;
    };
    let bits = sample.get(*signal)? as u16;
    bit_names(*signal, bits).map(|_| bits)
}

#[cfg(test)]
mod tests {
    use super::force;

    #[test]
    fn forces_are_told_in_the_size_they_have() {
        for (newtons, words) in [
            (-0.4, "0 N"),
            (999.4, "999 N"),
            (1000.0, "1.0 kN"),
            (-54_022.468, "-54.0 kN"),
        ] {
            assert_eq!(force(newtons), words);
        }
    }
}
