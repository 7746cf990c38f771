//! A Modbus module, over TCP or RTU: coils that are relays, inputs that are contacts.

use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::time::{Duration, Instant};

use btu_rig::rig::InstrumentFault;
use protocol::signal::Signal;
use rmodbus::client::ModbusRequest;
use rmodbus::guess_response_frame_len;
use rmodbus::{ErrorKind, ModbusProto};

use super::file::Places;
use super::instrument::{Reach, Watchdog};
use super::line::{SharedLine, io_fault};
use super::model::Values;
use super::points::{Point, UnitInput};
use super::worker::{ANSWERS_WITHIN, Instrument, Wanted};
use crate::pool::held;

/// Bytes of an answer that say how many there are, over TCP and RTU.
const HEAD: [usize; 2] = [6, 3];
/// How long a relay and the contact that proves it may differ [default: pull-in, bounce and a poll].
const RELAY_TAKES: Duration = Duration::from_millis(150);

/// A module that was switched off after connecting, with the points of the bench file that it has.
pub(super) struct Module {
    line: SharedLine,
    proto: ModbusProto,
    unit: u8,
    transaction: u16,
    stimuli: Vec<(UnitInput, Point)>,
    readings: Vec<(Signal, Point)>,
    /// Coils as they were last written; `None` if that is not known.
    written: Option<Vec<bool>>,
    /// When the module was last asked, and the time without a question after which it drops its outputs.
    asked: Instant,
    drops_after: Option<Duration>,
    coils: usize,
    inputs: u16,
    /// Count of marker pulses, and the coil that is on for the present pulse with the pulse's end.
    pulses: Option<f64>,
    pulse: Option<(u16, Instant)>,
    /// Since when a relay is not as ordered, by coil.
    astray: BTreeMap<u16, Instant>,
}

impl Module {
    /// Takes a module on its line, starts its watchdog, and switches its coils off.
    pub fn open(places: &Places, name: &str, line: SharedLine) -> Result<Self, InstrumentFault> {
        let entry = &places.instruments[name];
        let (stimuli, readings) = places.points_at(name);
        let coils = stimuli.iter().flat_map(|(_, point)| &point.coils);
        let proofs = stimuli.iter().filter_map(|(_, point)| point.proved_by);
        let inputs = readings.iter().filter_map(|(_, point)| point.input);
        let mut module = Self {
            line,
            proto: match entry.reach() {
                Reach::Tcp(_) => ModbusProto::TcpUdp,
                _ => ModbusProto::Rtu,
            },
            unit: entry.unit,
            transaction: 0,
            coils: coils.max().map_or(0, |last| usize::from(*last) + 1),
            inputs: inputs.chain(proofs).max().map_or(0, |last| last + 1),
            stimuli,
            readings,
            written: None,
            asked: Instant::now(),
            drops_after: entry
                .watchdog
                .map(|watchdog| Duration::from_millis(u64::from(watchdog.ms))),
            pulses: None,
            pulse: None,
            astray: BTreeMap::new(),
        };
        if let Some(Watchdog { register, ms }) = entry.watchdog {
            module.ask(|request, out| request.generate_set_holding(register, ms, out))?;
        }
        module.off()?;
        Ok(module)
    }

    /// One question and its answer.
    fn ask(
        &mut self,
        generate: impl FnOnce(&mut ModbusRequest, &mut Vec<u8>) -> Result<(), ErrorKind>,
    ) -> Result<(ModbusRequest, Vec<u8>), InstrumentFault> {
        self.transaction = self.transaction.wrapping_add(1);
        self.asked = Instant::now();
        let mut request = ModbusRequest::new(self.unit, self.proto);
        request.tr_id = self.transaction;
        let mut out = Vec::new();
        let refused = |request: &ModbusRequest, error: ErrorKind| InstrumentFault::Refused {
            command: format!("{:?} {}+{}", request.func, request.reg, request.count),
            error: error.to_string(),
        };
        generate(&mut request, &mut out).map_err(|error| refused(&request, error))?;
        let mut line = held(&self.line);
        if self.proto == ModbusProto::Rtu {
            line.await_silence();
        }
        line.forget();
        let mut answer = vec![0; HEAD[usize::from(self.proto == ModbusProto::Rtu)]];
        let exchanged = line
            .wait_for(ANSWERS_WITHIN)
            .and_then(|()| line.write_all(&out))
            .and_then(|()| line.read_exact(&mut answer));
        exchanged.map_err(io_fault)?;
        let length = guess_response_frame_len(&answer, self.proto);
        let length = length.map_err(|error| refused(&request, error))?;
        let head = answer.len();
        answer.resize(head.max(length.into()), 0);
        let rest = line.read_exact(&mut answer[head..]);
        rest.map_err(io_fault)?;
        drop(line);
        request
            .parse_ok(&answer)
            .map_err(|error| refused(&request, error))?;
        Ok((request, answer))
    }

    /// The coils that have to be on now.
    fn ordered(&mut self, wanted: &Wanted) -> Vec<bool> {
        let mut coils = vec![false; self.coils];
        for (name, point) in &self.stimuli {
            let values = wanted.get(name);
            let value = |key| values.and_then(|values: &Values| values.get(key)).copied();
            let on = match *name {
                UnitInput::Marker => {
                    let count = value("count");
                    let before = std::mem::replace(&mut self.pulses, count);
                    if let (Some(count), Some(before), Some(psm)) = (count, before, value("psm"))
                        && count != before
                        && let Some(coil) = point.coils.get((psm - 1.0) as usize)
                    {
                        let until = Instant::now() + Duration::from_millis(point.pulse_ms);
                        self.pulse = Some((*coil, until));
                    }
                    self.pulse = self.pulse.filter(|(_, until)| Instant::now() < *until);
                    self.pulse.map(|(coil, _)| coil)
                }
                UnitInput::ModeSwitch => value("position")
                    .and_then(|position| point.coils.get(position as usize))
                    .copied(),
                _ => (point.coils.first().copied()).filter(|_| value("on") == Some(1.0)),
            };
            if let Some(on) = on {
                coils[usize::from(on)] = true;
            }
        }
        coils
    }

    /// Checks the proofs of relays: one that is not where it was ordered in time is stuck.
    fn prove(&mut self, ordered: &[bool], inputs: &[bool]) -> Result<(), InstrumentFault> {
        for (name, point) in &self.stimuli {
            let (Some(coil), Some(proof)) = (point.coils.first(), point.proved_by) else {
                continue;
            };
            let is = ordered.get(usize::from(*coil)).copied().unwrap_or(false);
            if inputs.get(usize::from(proof)) == Some(&is) {
                self.astray.remove(coil);
            } else if self
                .astray
                .entry(*coil)
                .or_insert_with(Instant::now)
                .elapsed()
                > RELAY_TAKES
            {
                return Err(InstrumentFault::Stuck {
                    contact: name.name().to_owned(),
                    ordered: u8::from(is),
                });
            }
        }
        Ok(())
    }
}

impl Instrument for Module {
    fn cycle(
        &mut self,
        wanted: &Wanted,
        read: &mut BTreeMap<Signal, f64>,
    ) -> Result<bool, InstrumentFault> {
        let ordered = self.ordered(wanted);
        // A module that was not asked for so long has dropped its outputs itself.
        let dropped = |after: Duration| self.asked.elapsed() >= after;
        let known = self.inputs > 0 && !self.drops_after.is_some_and(dropped);
        let written = self.written.as_ref().filter(|_| known);
        let sets = self.coils > 0 && written != Some(&ordered);
        if sets {
            self.ask(|request, out| request.generate_set_coils_bulk(0, &ordered, out))?;
            self.written = Some(ordered.clone());
        }
        if self.inputs == 0 {
            return Ok(sets);
        }
        let count = self.inputs;
        let (request, answer) =
            self.ask(|request, out| request.generate_get_discretes(0, count, out))?;
        let mut inputs = Vec::new();
        let parsed = request.parse_bool(&answer, &mut inputs);
        if parsed.is_err() || inputs.len() < usize::from(count) {
            return Err(InstrumentFault::NoAnswer {
                asked: format!("{count} inputs"),
                found: format!("{answer:02x?}"),
            });
        }
        for (signal, point) in &self.readings {
            let input = point.input.map(usize::from).and_then(|at| inputs.get(at));
            if let Some(closed) = input {
                read.insert(*signal, f64::from(*closed != point.inverted));
            }
        }
        self.prove(&ordered, &inputs).map(|()| true)
    }

    fn proved(&self) -> bool {
        self.astray.is_empty()
    }

    fn off(&mut self) -> Result<(), InstrumentFault> {
        self.written = None;
        let nothing = vec![false; self.coils];
        if self.coils > 0 {
            self.ask(|request, out| request.generate_set_coils_bulk(0, &nothing, out))?;
            self.written = Some(nothing);
        }
        self.pulses = None;
        self.pulse = None;
        Ok(())
    }
}
