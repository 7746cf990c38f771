//! A plan in words: what a technician reads before anything is driven, and in messages after.

use std::fmt::{self, Display, Formatter};

use protocol::signal::{Kind, Signal};

use super::plan::{
    Action, Comparison, Condition, Connection, Expectation, Measure, Operand, Procedure, Step,
    TimeFrom, What,
};
use crate::stimulus::{CutOut, Stimulus};
use crate::tcms::{EbSources, Lamps, PowerCuts};

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
        if let Some(when) = &self.when {
            lines.push(format!("    only if {when}"));
        }
        lines.extend(self.actions.iter().map(|a| format!("    do      {a}")));
        lines.extend(self.expectations.iter().map(|e| format!("    expect  {e}")));
        lines.extend(self.measures.iter().map(|m| format!("    measure {m}")));
        if !self.provokes.is_empty() {
            let names: Vec<_> = self.provokes.iter().map(|e| e.definition().name).collect();
            lines.push(format!("    provokes {}", names.join(", ")));
        }
        lines
    }
}

impl Display for Condition {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Compare {
                signal,
                comparison,
                operand,
            } => {
                if let (true, Operand::Literal(bits)) = (comparison.is_bits(), operand) {
                    let bits = *bits as u16;
                    let bits = bit_names(*signal, bits).unwrap_or(format!("bits {bits:#b}"));
                    return write!(f, "{} {} {bits}", signal.name(), sign(*comparison));
                }
                let operand = value(*signal, operand);
                write!(f, "{} {} {operand}", signal.name(), sign(*comparison))?;
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
    let parts: Vec<_> = parts.iter().map(ToString::to_string).collect();
    write!(f, "({})", parts.join(word))
}

/// Bits of a signal by their names: causes, lamps, cars. `None` for a signal that is no set, or
/// bits without a name.
pub fn bit_names(signal: Signal, bits: u16) -> Option<String> {
    fn of<T: Copy>(bits: u16, all: &[(T, &str)], bit: impl Fn(T) -> u16) -> Vec<String> {
        let named = all.iter().filter(|(one, _)| bits & bit(*one) != 0);
        named.map(|(_, name)| (*name).to_owned()).collect()
    }
    let names = match signal {
        Signal::PowerCutCauses => of(bits, PowerCuts::ALL, PowerCuts::bits),
        Signal::EbSources => of(bits, EbSources::ALL, EbSources::bits),
        Signal::Lamps => of(bits, Lamps::ALL, Lamps::bits),
        Signal::NotReleased => {
            let cars = (1..).zip(0..u16::BITS);
            let named = cars.filter(|(_, bit)| bits & 1 << bit != 0);
            named
                .map(|(car, _): (u32, _)| format!("car {car}"))
                .collect()
        }
        _ => return None,
    };
    match (bits, names.is_empty()) {
        (0, _) => Some("none".into()),
        (_, true) => None,
        _ => Some(names.join(" + ")),
    }
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
            Self::Stimulus(stimulus) => f.write_str(&stimulus_text(stimulus)),
            Self::Wait(span) => write!(f, "wait {span}"),
            Self::Until { condition, within } => write!(f, "until {condition} within {within}"),
            Self::Settle { within } => write!(f, "until finished, within {within}"),
            Self::Prompt { text, within } => {
                write!(f, "ask the operator \"{text}\" within {within}")
            }
        }
    }
}

impl Display for Expectation {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Becomes { condition, within } => write!(f, "{condition} within {within}"),
            Self::Holds {
                condition,
                duration,
            } => write!(f, "{condition} held for {duration}"),
            Self::Never { condition } => write!(f, "never {condition}"),
            Self::Logs { event, within } => {
                write!(f, "log entry {} within {within}", event.definition().name)
            }
            Self::NeverLogs { event } => write!(f, "no log entry {}", event.definition().name),
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
        }
        let unit = self.unit();
        match (&self.low, &self.high) {
            (None, None) => Ok(()),
            (Some(low), None) => write!(f, ", at least {}", with_unit(low, unit)),
            (None, Some(high)) => write!(f, ", at most {}", with_unit(high, unit)),
            (Some(low), Some(high)) => write!(f, ", {low} to {}", with_unit(high, unit)),
        }
    }
}

/// Limits in words.
pub(super) fn limits(low: Option<f64>, high: Option<f64>) -> String {
    match (low, high) {
        (None, None) => "anything".into(),
        (Some(low), None) => format!("at least {}", number(low)),
        (None, Some(high)) => format!("at most {}", number(high)),
        (Some(low), Some(high)) => format!("{} to {}", number(low), number(high)),
    }
}

/// A number without the noise of binary fractions.
pub(super) fn number(value: f64) -> String {
    let rounded = (value * 1e3).round() / 1e3;
    // Also turns -0 into 0.
    format!("{}", rounded + 0.0)
}

/// Each stimulus in words; long because it is a table.
fn stimulus_text(stimulus: &Stimulus) -> String {
    let on_off = |on: bool| if on { "on" } else { "off" };
    let way = |backward: bool| if backward { "backward" } else { "forward" };
    match *stimulus {
        Stimulus::Code {
            carrier_hz,
            rate_hz,
            level_mv,
        } => format!("antenna signal {carrier_hz} Hz, code rate {rate_hz} Hz, {level_mv} mV"),
        Stimulus::CodeDrift {
            rate_hz_per_s,
            level_mv_per_s,
        } => format!("antenna signal drifts {rate_hz_per_s} Hz/s, {level_mv_per_s} mV/s"),
        Stimulus::CodeOff => "antenna signal off".into(),
        Stimulus::Speed { to, accel_mps2 } => {
            format!("speed to {to} at {} m/s²", number(accel_mps2))
        }
        Stimulus::Travel {
            distance_m, speed, ..
        } => format!("travel {} m at {speed}", number(distance_m)),
        Stimulus::Direction { backward } => format!("wheels turn {}", way(backward)),
        Stimulus::Tacho { channel, condition } => format!("tachometer {channel}: {condition:?}"),
        Stimulus::CodesAlong { on } => format!("speed codes along the way {}", on_off(on)),
        Stimulus::TrainDriven { on } => format!("train model {}", on_off(on)),
        Stimulus::Adhesion {
            coefficient: Some(coefficient),
        } => format!("adhesion {}", number(coefficient)),
        Stimulus::Adhesion { coefficient: None } => "adhesion as always".into(),
        Stimulus::Marker { psm } => format!("pulse of marker PSM{psm}"),
        Stimulus::MarkerMoved { psm, by_m: None } => format!("PSM{psm} is missing"),
        Stimulus::MarkerMoved {
            psm,
            by_m: Some(by_m),
        } => format!("PSM{psm} lies {} m beyond its place", number(by_m)),
        Stimulus::MarkersAlong { section: Some(n) } => {
            format!("markers of section {n} along the way")
        }
        Stimulus::MarkersAlong { section: None } => "no markers along the way".into(),
        Stimulus::Station(data) => format!("wayside sends {}", station_text(&data)),
        Stimulus::Wayside(condition) => format!("TWC wayside {condition:?}").to_lowercase(),
        Stimulus::Doors { closed } => format!("doors {}", if closed { "closed" } else { "open" }),
        Stimulus::Hcr { on } => format!("cab active (HCR) {}", on_off(on)),
        Stimulus::MaintenanceKey { on } => format!("maintenance key {}", on_off(on)),
        Stimulus::ModeSwitch(mode) => format!("mode switch to {}", mode.label()),
        Stimulus::Controller { lever } => format!("master controller to {lever}"),
        Stimulus::ControllerVolts { volts: Some(volts) } => {
            format!("master controller gives {} V", number(volts))
        }
        Stimulus::ControllerVolts { volts: None } => "master controller's own voltage".into(),
        Stimulus::ControllerContacts {
            contacts: Some((power, brake)),
        } => format!(
            "master controller contacts P {}, B {}",
            on_off(power),
            on_off(brake)
        ),
        Stimulus::ControllerContacts { contacts: None } => {
            "master controller's own contacts".into()
        }
        Stimulus::Switch { switch, on } => format!("{} {}", switch.label(), on_off(on)),
        Stimulus::CutOut { what, car, on } => {
            let part = match what {
                CutOut::Brake => "brake",
                CutOut::Inverter => "inverter",
            };
            format!("{part} of car {car} cut {}", if on { "out" } else { "in" })
        }
        Stimulus::Gradient {
            permille: Some(permille),
        } => format!("gradient {} ‰", number(permille)),
        Stimulus::Gradient { permille: None } => "gradient as always".into(),
        Stimulus::Reverser { position } => format!("reverser to {position}"),
        Stimulus::Acknowledge => "press acknowledge".into(),
        Stimulus::Start => "press ATO start".into(),
        Stimulus::Tcms(condition) => format!("TCMS link {condition:?}").to_lowercase(),
        Stimulus::AtoEnable { on } => format!("TCMS permits ATO: {}", on_off(on)),
        Stimulus::Load { passengers_kg } => format!("load {passengers_kg} kg"),
        Stimulus::PtuArm => "arm the unit".into(),
        Stimulus::PtuDisarm => "disarm the unit".into(),
        Stimulus::PtuSilent { on } => format!("tester silent: {}", on_off(on)),
        Stimulus::PtuCode {
            carrier_hz,
            rate_hz,
            level_mv,
        } => format!("test code {carrier_hz} Hz, code rate {rate_hz} Hz, {level_mv} mV"),
        Stimulus::PtuSpeed {
            channels,
            backward,
            to,
            ..
        } => {
            let inputs = ["none", "1", "2", "1 and 2"][usize::from(channels & 3)];
            format!("test speed {to} {} on input {inputs}", way(backward))
        }
        Stimulus::PtuMarker { psm } => format!("pulse of test marker PSM{psm}"),
        Stimulus::PtuTwc(data) => format!("test TWC frame {}", station_text(&data)),
        Stimulus::PtuRelease => "take test signals away".into(),
        Stimulus::PtuClearLog => "clear the event log".into(),
    }
}

fn station_text(data: &crate::stimulus::StationData) -> String {
    let speed = data
        .fixed_speed_kmh
        .map_or(String::new(), |v| format!(", fixed speed {v} km/h"));
    format!(
        "section {}, station {}, next {}, loop {}, {}, doors {}, departure {}, train {}{speed}",
        data.section,
        data.station,
        data.next_station,
        data.loop_id,
        data.running_mode.label(),
        data.door_side.label(),
        if data.departure { "given" } else { "not given" },
        data.train_number,
    )
}
