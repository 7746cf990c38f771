//! A SCPI instrument: lines out, lines in, its error queue after each command.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::sync::Arc;
use std::time::Instant;

use btu_rig::rig::InstrumentFault;
use protocol::signal::Signal;
use toml::Spanned;

use super::file::Places;
use super::line::{LONGEST, SharedLine, io_fault};
use super::model::{Model, Values, filled};
use super::points::{Point, UnitInput};
use super::worker::{ANSWERS_WITHIN, Instrument, Wanted, span};
use crate::pool::held;

/// Number of the error that says that its queue is full (SCPI-99 21.8.11).
const QUEUE_OVERFLOW: i32 = -350;

/// Infinities and what is no number are answered as this and more (SCPI-99 7.2.1.4 and 7.2.1.5).
const OVERLOAD: f64 = 9.9e37;

/// An instrument whose model was checked, with the points of the bench file that it has.
pub(super) struct Scpi {
    line: SharedLine,
    /// Bytes that were read and are not a whole answer yet.
    came: Vec<u8>,
    model: Arc<Model>,
    stimuli: Vec<(UnitInput, Point)>,
    readings: Vec<(Signal, Point)>,
    set: Wanted,
}

impl Scpi {
    /// Connects and checks: the model, its serial number, and an error queue that is empty.
    pub fn open(places: &Places, name: &str, line: SharedLine) -> Result<Self, InstrumentFault> {
        let (stimuli, readings) = places.points_at(name);
        let mut scpi = Self {
            line,
            came: Vec::new(),
            model: places.models[name].clone(),
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
        let expected = &places.instruments[name].serial;
        match serial_of(&found) {
            Some(serial) if !serial.eq_ignore_ascii_case(expected) => {
                return Err(InstrumentFault::OtherSerial {
                    found: serial.to_owned(),
                    expected: expected.clone(),
                });
            }
            _ => {}
        }
        for command in scpi.model.clone().begin.iter() {
            scpi.command(command)?;
        }
        scpi.off()?;
        Ok(scpi)
    }

    fn say(&self, text: &str) -> Result<(), InstrumentFault> {
        let sent = held(&self.line).write_all(format!("{text}\n").as_bytes());
        sent.map_err(io_fault)
    }

    fn ask(&mut self, question: &str) -> Result<String, InstrumentFault> {
        held(&self.line).forget();
        self.say(question)?;
        self.answer(question, Instant::now() + ANSWERS_WITHIN)
    }

    /// The next line.
    fn answer(&mut self, question: &str, until: Instant) -> Result<String, InstrumentFault> {
        let mut line = held(&self.line);
        let end = loop {
            if let Some(end) = self.came.iter().position(|byte| *byte == b'\n') {
                break end;
            }
            if self.came.len() > LONGEST {
                let found = format!("{} bytes", self.came.len());
                let asked = question.to_owned();
                return Err(InstrumentFault::NoAnswer { asked, found });
            }
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(InstrumentFault::Silent(span(ANSWERS_WITHIN)));
            }
            let mut chunk = [0; LONGEST];
            let count = line.wait_for(left).and_then(|()| line.read(&mut chunk));
            match count.map_err(io_fault)? {
                0 => return Err(InstrumentFault::Closed),
                count => self.came.extend_from_slice(&chunk[..count]),
            }
        };
        let answer: Vec<u8> = self.came.drain(..=end).collect();
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

    fn act(
        &mut self,
        input: UnitInput,
        channel: u8,
        values: &Values,
    ) -> Result<(), InstrumentFault> {
        let model = self.model.clone();
        let act = input.act().and_then(|act| model.acts.get(act));
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
            return Err(InstrumentFault::NoUnmodulated);
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

/// The serial number in an answer to `*IDN?`: maker, model, serial number, version; 0 = it does not tell (IEEE 488.2 10.14).
fn serial_of(idn: &str) -> Option<&str> {
    let serial = idn.split(',').nth(2)?.trim();
    (!["", "0"].contains(&serial)).then_some(serial)
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
                .get(&name)
                .filter(|values| self.set.get(&name) != Some(values))
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
        // All commands are sent before the error queue is asked, so that no old error and no late answer keeps an
        // output on.
        commands.iter().try_for_each(|command| self.say(command))?;
        match commands.is_empty() {
            true => Ok(()),
            false => self.taken(&commands.join(", ")),
        }
    }
}
