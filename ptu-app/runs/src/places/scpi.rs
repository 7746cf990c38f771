//! A SCPI instrument over TCP: lines out, lines in, its error queue after each command.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::Instant;

use btu_rig::rig::InstrumentFault;
use protocol::signal::Signal;
use toml::Spanned;

use super::file::{Places, Point};
use super::modbus::{connect, io_fault};
use super::model::{Model, filled};
use super::points::act_of;
use super::worker::{ANSWERS_WITHIN, Instrument, Values, Wanted, span};

/// Number of the error that says that its queue is full (SCPI-99 21.8.11).
const QUEUE_OVERFLOW: i32 = -350;

/// Infinities and what is no number are answered as this and more (SCPI-99 7.2.1.4 and 7.2.1.5).
const OVERLOAD: f64 = 9.9e37;
/// Longest answer, bytes.
const LONGEST: usize = 4096;

/// An instrument whose model was checked, with the points of the bench file that it has.
pub(super) struct Scpi {
    stream: BufReader<TcpStream>,
    model: Arc<Model>,
    stimuli: Vec<(&'static str, Point)>,
    readings: Vec<(Signal, Point)>,
    set: Wanted,
}

impl Scpi {
    /// Connects and checks: the model, and an error queue that is empty.
    pub fn open(places: &Places, name: &str, address: &str) -> Result<Self, InstrumentFault> {
        let (stimuli, readings) = places.points_at(name);
        let missing = || InstrumentFault::NotThere {
            at: address.to_owned(),
            why: "no driver".into(),
        };
        let mut scpi = Self {
            stream: BufReader::new(connect(address)?),
            model: places.models.get(name).cloned().ok_or_else(missing)?,
            stimuli,
            readings,
            set: Wanted::new(),
        };
        let found = scpi.ask("*IDN?")?;
        if !found.contains(&scpi.model.idn) {
            return Err(InstrumentFault::OtherModel {
                found,
                expected: scpi.model.idn.clone(),
            });
        }
        for command in scpi.model.clone().begin.iter() {
            scpi.command(command)?;
        }
        scpi.off()?;
        Ok(scpi)
    }

    fn say(&mut self, line: &str) -> Result<(), InstrumentFault> {
        let sent = self
            .stream
            .get_mut()
            .write_all(format!("{line}\n").as_bytes());
        sent.map_err(|error| io_fault(&error))
    }

    fn ask(&mut self, question: &str) -> Result<String, InstrumentFault> {
        self.say(question)?;
        self.answer(question, Instant::now() + ANSWERS_WITHIN)
    }

    /// A line, whole until then, however its bytes come.
    fn answer(&mut self, question: &str, until: Instant) -> Result<String, InstrumentFault> {
        let mut answer = Vec::new();
        while !answer.ends_with(b"\n") {
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(InstrumentFault::Silent(span(ANSWERS_WITHIN)));
            }
            let came = self.stream.get_ref().set_read_timeout(Some(left));
            let came = came.and_then(|()| self.stream.fill_buf());
            let came = came.map_err(|error| io_fault(&error))?;
            if came.is_empty() {
                return Err(InstrumentFault::Disconnected(question.to_owned()));
            }
            let end = came.iter().position(|byte| *byte == b'\n');
            let end = end.map_or(came.len(), |end| end + 1);
            answer.extend_from_slice(&came[..end]);
            self.stream.consume(end);
            if answer.len() > LONGEST {
                return Err(InstrumentFault::NoAnswer {
                    asked: question.to_owned(),
                    found: format!("{} bytes", answer.len()),
                });
            }
        }
        Ok(String::from_utf8_lossy(&answer).trim().to_owned())
    }

    /// Sends a command, and asks whether it was taken.
    fn command(&mut self, command: &str) -> Result<(), InstrumentFault> {
        self.say(command)?;
        self.taken(command)
    }

    fn taken(&mut self, command: &str) -> Result<(), InstrumentFault> {
        let asked = self.model.error.clone();
        let error = self.ask(&asked)?;
        let number = error.split(',').next().unwrap_or_default().trim();
        match number.parse::<i32>() {
            Ok(0) => Ok(()),
            Ok(QUEUE_OVERFLOW) => Err(InstrumentFault::QueueFull(error)),
            Ok(_) => Err(InstrumentFault::Refused {
                command: command.to_owned(),
                error,
            }),
            Err(_) => Err(InstrumentFault::NoAnswer {
                asked,
                found: error,
            }),
        }
    }

    fn act(&mut self, stimulus: &str, channel: u8, values: &Values) -> Result<(), InstrumentFault> {
        let model = self.model.clone();
        let act = act_of(stimulus).and_then(|act| model.acts.get(act));
        let act = act.map(Spanned::get_ref);
        let Some(act) = act else {
            return Ok(());
        };
        let value = |name| values.get(name).copied();
        let is_off = value("level_mv") == Some(0.0) || value("hz") == Some(0.0);
        let commands = match (is_off, value("rate_hz")) {
            (true, _) => &act.off,
            (false, Some(0.0)) => &act.unmodulated,
            _ => &act.on,
        };
        if commands.is_empty() && !is_off {
            return Err(InstrumentFault::Refused {
                command: format!("{stimulus}, unmodulated"),
                error: "its driver has no commands for it".into(),
            });
        }
        let mut values = values.clone();
        values.insert("channel", f64::from(channel));
        if !is_off && let Some(fault) = model.out_of_range(&values) {
            return Err(fault);
        }
        commands
            .iter()
            .try_for_each(|command| self.command(&filled(command.get_ref(), &values)))
    }
}

impl Instrument for Scpi {
    fn cycle(
        &mut self,
        wanted: &Wanted,
        read: &mut BTreeMap<Signal, f64>,
    ) -> Result<bool, InstrumentFault> {
        let mut did = !self.readings.is_empty();
        for (name, point) in self.stimuli.clone() {
            let Some(values) = wanted
                .get(name)
                .filter(|values| self.set.get(name) != Some(values))
            else {
                continue;
            };
            self.act(name, point.channel, values)?;
            self.set.insert(name, values.clone());
            did = true;
        }
        for (signal, point) in self.readings.clone() {
            let model = self.model.clone();
            let Some(asked) = point.read.as_ref().and_then(|read| model.reads.get(read)) else {
                continue;
            };
            let found = self.ask(&asked.ask)?;
            let field = found.split(',').nth(asked.field).unwrap_or_default();
            let value = field.trim().parse::<f64>().ok();
            let Some(value) = value.filter(|value| value.abs() < OVERLOAD) else {
                return Err(InstrumentFault::NoAnswer {
                    asked: asked.ask.clone(),
                    found,
                });
            };
            read.insert(signal, value * point.scale.unwrap_or(1.0));
        }
        Ok(did)
    }

    fn off(&mut self) -> Result<(), InstrumentFault> {
        self.set.clear();
        let commands = self.model.off.clone();
        // All are sent before one is asked for, so that no old error and no late answer keeps an output on.
        commands.iter().try_for_each(|command| self.say(command))?;
        match commands.is_empty() {
            true => Ok(()),
            false => self.taken(&commands.join(", ")),
        }
    }
}
