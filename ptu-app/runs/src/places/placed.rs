//! Between rig and unit: signals that have a place are taken out of the frames, and readings of instruments are put in.

use std::sync::Arc;
use std::time::{Duration, Instant as Clock};

use btu_rig::rig::{InstrumentFault, LinkTrouble};
use protocol::link::{End, Link};
use protocol::message::{Channel, IoInput, IoOutput, Message, ModeSwitch, Outputs};
use protocol::signal::Signal;
use protocol::{Instant, Speed};

use super::by_sound::{BySound, try_sound};
use super::file::{Places, READINGS};
use super::instrument::{Kind, SAFE_WITHIN};
use super::line::Lines;
use super::modbus::Module;
use super::model::{Values, code_values};
use super::points::{Place, UnitInput};
use super::relay::{Relay, send};
use super::scpi::Scpi;
use super::worker::{Instrument, Timing, Wanted, Worker, span, trouble};

/// Periods without a pulse after which a wheel stands.
const STANDS_AFTER: u64 = 2;
/// A frequency that differs by less is not set again.
const SAME_HZ: f64 = 0.001;

/// The instruments of a bench at work.
pub struct Placed {
    places: Arc<Places>,
    workers: Vec<Worker>,
    sound: Option<BySound>,
    /// Open until the workers have ended.
    lines: Lines,
    to_unit: Relay,
    from_unit: Relay,
    pulses: [PulseRate; 2],
    wanted: Wanted,
    /// Outputs as the unit's last frame has them.
    outputs: IoOutput,
    /// Sender of outputs that no frame of the unit carries.
    link: Link,
}

/// An instrument that was tried: its name, and how long it takes to act and to read, ms, or what is wrong.
pub type Checked = (String, Result<f64, InstrumentFault>);

fn open(
    places: &Places,
    name: &str,
    lines: &mut Lines,
) -> Result<Box<dyn Instrument>, InstrumentFault> {
    let entry = &places.instruments[name];
    let line = lines.to(&entry.reach())?;
    Ok(match entry.kind() {
        Kind::Modbus => Box::new(Module::open(places, name, line)?),
        Kind::Scpi | Kind::Sound => Box::new(Scpi::open(places, name, line)?),
    })
}

impl Placed {
    /// Connects, checks and switches off each instrument, and reads each once.
    ///
    /// # Errors
    /// Fault of the first instrument that does not do its part.
    pub fn open(places: &Arc<Places>) -> Result<Self, LinkTrouble> {
        let lines = Lines::of(places).map_err(|(name, fault)| trouble(&name, fault))?;
        let mut placed = Self {
            places: places.clone(),
            workers: Vec::new(),
            sound: BySound::open(places)?,
            lines,
            to_unit: Relay::default(),
            from_unit: Relay::default(),
            pulses: Default::default(),
            wanted: Wanted::new(),
            outputs: IoOutput::default(),
            link: Link::new(End::Unit),
        };
        // A unit without its supply says nothing to which frames could be sent.
        if let Some(supply) = places.stimuli.get(&UnitInput::Supply) {
            let volts = supply.volts.unwrap_or_default();
            let on = Values::from([("on", 1.0), ("volts", volts)]);
            placed.wanted.insert(UnitInput::Supply, on);
        }
        for (place, name) in (0..).zip(&places.safe) {
            let entry = &places.instruments[name];
            if entry.kind() == Kind::Sound {
                continue;
            }
            let timing = Timing {
                poll: Duration::from_millis(entry.poll_ms),
                uncertainty: Duration::from_millis(entry.uncertainty_ms),
                place,
            };
            let instrument = open(places, name, &mut placed.lines);
            let instrument = instrument.map_err(|fault| trouble(name, fault))?;
            placed
                .workers
                .push(Worker::start(name.clone(), timing, instrument));
        }
        for worker in &placed.workers {
            let read = worker.has_read(SAFE_WITHIN);
            read.map_err(|fault| trouble(&worker.name, fault))?;
        }
        Ok(placed)
    }

    /// Tries each instrument by itself, in so many rounds. In each round a relay that has a proof is switched on, and
    /// the round is over when it is proved. The slowest round counts, with the time until the next reading.
    pub fn check(places: &Places, rounds: u32) -> Vec<Checked> {
        let mut lines = match Lines::of(places) {
            Ok(lines) => lines,
            // Another program works with an instrument: nothing is touched.
            Err((name, fault)) => return vec![(name, Err(fault))],
        };
        let mut tried = |name: &String| {
            if places.instruments[name].kind() == Kind::Sound {
                return try_sound(places, name, rounds);
            }
            let mut instrument = open(places, name, &mut lines)?;
            let (stimuli, _) = places.points_at(name);
            let proved = stimuli
                .iter()
                .filter(|(_, point)| point.proved_by.is_some());
            let on = proved.map(|(input, _)| (*input, Values::from([("on", 1.0)])));
            let on = on.collect();
            let mut round = || {
                let began = Clock::now();
                instrument.off()?;
                instrument.cycle(&on, &mut Default::default())?;
                while !instrument.proved() {
                    instrument.cycle(&on, &mut Default::default())?;
                }
                Ok(began.elapsed())
            };
            let slowest = (0..rounds).try_fold(Duration::ZERO, |slowest, _| {
                round().map(|took| slowest.max(took))
            });
            // Where one relay is stuck, others may be closed still.
            let off = instrument.off();
            let slowest = slowest?;
            let poll_ms = places.instruments[name].poll_ms as f64;
            off.map(|()| slowest.as_secs_f64() * 1000.0 + poll_ms)
        };
        let names = places.safe.iter();
        names.map(|name| (name.clone(), tried(name))).collect()
    }

    /// Passes on what the unit gets as frames of the rig's bytes; orders the rest from the instruments.
    pub fn take(&mut self, now: Instant, bytes: &[u8], out: &mut Vec<u8>) {
        self.to_unit.push(bytes);
        while let Some((mut header, message)) = self.to_unit.next(out) {
            if header.channel == Channel::Io {
                let left_out = self.sound.as_ref().map_or(0, |sound| sound.left_out);
                header.seq = header.seq.wrapping_sub(left_out);
            }
            let placed = |input| self.places.stimuli.contains_key(&input);
            match message {
                Message::CoilSamples(part)
                    if (self.sound.as_ref()).is_some_and(|sound| sound.carries(part.coil)) =>
                {
                    self.sound.iter_mut().for_each(|sound| sound.take(&part));
                }
                Message::IoInput(input) => {
                    self.sound.iter_mut().for_each(BySound::play);
                    let left = self.place(now, input);
                    if !self.places.leaves_no_input() {
                        send(&header, &left.into(), out);
                    }
                }
                Message::Crosstalk(_) if placed(UnitInput::Crosstalk) => {}
                Message::CabEntries(_) | Message::WheelEntry(_) if placed(UnitInput::Entries) => {}
                _ if header.channel == Channel::Twc && placed(UnitInput::Twc) => {}
                other => send(&header, &other, out),
            }
        }
        self.workers
            .iter()
            .for_each(|worker| worker.feed(&self.wanted));
    }

    /// Puts what instruments read into the bytes of the unit.
    ///
    /// # Errors
    /// An instrument does not do its part; all outputs are off then.
    pub fn give(
        &mut self,
        now: Instant,
        bytes: &[u8],
        out: &mut Vec<u8>,
    ) -> Result<(), LinkTrouble> {
        self.from_unit.push(bytes);
        while let Some((header, message)) = self.from_unit.next(out) {
            match message {
                Message::IoOutput(_) if self.places.leaves_no_output() => {}
                Message::IoOutput(output) => {
                    self.outputs = output;
                    send(&header, &self.read().into(), out);
                }
                other => send(&header, &other, out),
            }
        }
        if self.places.leaves_no_output() {
            let read = self.read().into();
            self.link.send(now, &read, out);
        }
        let heard = self
            .sound
            .iter()
            .find_map(|sound| Some(trouble(&sound.name, sound.fault()?)));
        let faulty = self.workers.iter().find_map(|worker| {
            let fault = worker.readings(|_, _| {}).err()?;
            Some(trouble(&worker.name, fault))
        });
        match heard.or(faulty) {
            Some(faulty) => {
                self.release();
                Err(faulty)
            }
            None => Ok(()),
        }
    }

    /// How late the latest instrument was since this was last asked.
    pub fn take_late(&mut self) -> protocol::Duration {
        let sound = self
            .sound
            .iter_mut()
            .map(|sound| span(std::mem::take(&mut sound.late)));
        let late = self.workers.iter().map(Worker::take_late);
        late.chain(sound).max().unwrap_or(protocol::Duration::ZERO)
    }

    /// Switches all outputs off, in the order of the bench file.
    pub fn release(&mut self) {
        self.sound.iter_mut().for_each(|sound| sound.stream.end());
        // An instrument that does not answer takes no time from the others.
        let each = SAFE_WITHIN / (self.workers.len() as u32).max(1);
        self.workers.iter_mut().for_each(|worker| worker.end(each));
    }

    /// Takes the stimuli that have a place out of the inputs.
    fn place(&mut self, now: Instant, mut input: IoInput) -> IoInput {
        let placed = |input| self.places.stimuli.contains_key(&input);
        let mut want = |input, values: Values| {
            self.wanted.insert(input, values);
        };
        for (line_input, line) in UnitInput::lines().filter(|(input, _)| placed(*input)) {
            want(
                line_input,
                Values::from([("on", f64::from(input.lines.contains(line)))]),
            );
            input.lines.remove(line);
        }
        if placed(UnitInput::Code) {
            let values = code_values(
                f64::from(input.carrier_hz),
                f64::from(input.code_rate_chz) / 100.0,
                f64::from(input.level_mv),
            );
            want(UnitInput::Code, values);
            (input.carrier_hz, input.code_rate_chz, input.level_mv) = (0, 0, 0);
        }
        let tachos = [
            (
                UnitInput::Tacho1,
                &mut input.tacho1_count,
                &mut input.tacho1_edge_us,
            ),
            (
                UnitInput::Tacho2,
                &mut input.tacho2_count,
                &mut input.tacho2_edge_us,
            ),
        ];
        for (channel, (input_of, count, age_us)) in tachos.into_iter().enumerate() {
            if placed(input_of) {
                let backward = input.tacho_backward >> channel & 1;
                let hz = self.pulses[channel].step(now, *count, *age_us);
                want(
                    input_of,
                    Values::from([("hz", hz), ("backward", f64::from(backward))]),
                );
                input.tacho_backward &= !(1 << channel);
                (*count, *age_us) = (0, 0);
            }
        }
        if placed(UnitInput::Marker) {
            let (psm, count) = (f64::from(input.marker), f64::from(input.marker_edges));
            want(
                UnitInput::Marker,
                Values::from([("psm", psm), ("count", count)]),
            );
            (input.marker, input.marker_edges, input.marker_edge_us) = (0, 0, 0);
        }
        if placed(UnitInput::ModeSwitch) {
            want(
                UnitInput::ModeSwitch,
                Values::from([("position", f64::from(input.mode_switch.code()))]),
            );
            input.mode_switch = ModeSwitch::Off;
        }
        if placed(UnitInput::Controller) {
            input.controller = 0;
        }
        input
    }

    /// Contacts and displays as they are read.
    fn read(&self) -> IoOutput {
        let mut output = self.outputs;
        for (signal, point) in &self.places.readings {
            if let Place::None | Place::Operator(_) = point.place() {
                set(&mut output, *signal, f64::from(*signal == Signal::Eb));
            }
        }
        for worker in &self.workers {
            // A fault is told at the end of the scan.
            let _ = worker.readings(|signal, value| set(&mut output, signal, value));
        }
        output
    }
}

impl Drop for Placed {
    fn drop(&mut self) {
        self.release();
    }
}

fn set(output: &mut IoOutput, signal: Signal, value: f64) {
    let cms = || Speed::from_kmh(value).to_cms();
    match signal {
        // A brake that is applied is a relay that is not energised.
        Signal::Eb => output.outputs.set(Outputs::EB_RELAY, value == 0.0),
        Signal::Limit => output.limit_cms = cms(),
        Signal::Speed => output.speed_cms = cms(),
        Signal::Marker => output.marker = value as u8,
        Signal::MarkerCount => output.marker_count = value as u8,
        _ => {
            let row = READINGS.iter().find(|(known, _)| *known == signal);
            let contact = row.map_or(Outputs::empty(), |(_, contact)| *contact);
            output.outputs.set(contact, value == 1.0);
        }
    }
}

/// Frequency of pulses, from their count and the age of the last one.
#[derive(Debug, Default)]
pub(super) struct PulseRate {
    last: Option<(u16, u64)>,
    period_us: u64,
    hz: f64,
    told: f64,
}

impl PulseRate {
    pub fn step(&mut self, now: Instant, count: u16, age_us: u16) -> f64 {
        let now_us = now.as_us();
        let edge_us = now_us.saturating_sub(u64::from(age_us));
        match self.last {
            Some((before, at_us)) if before == count => {
                let since_us = now_us.saturating_sub(at_us);
                // While a pulse does not come, the frequency is at most one in the time since the last; after two
                // periods, the wheel stands.
                self.hz = match since_us > STANDS_AFTER * self.period_us {
                    true => 0.0,
                    false => self.hz.min(1e6 / since_us.max(1) as f64),
                };
            }
            Some((before, at_us)) => {
                let pulses = u64::from(count.wrapping_sub(before));
                self.period_us = (edge_us.saturating_sub(at_us) / pulses).max(1);
                self.hz = 1e6 * pulses as f64 / edge_us.saturating_sub(at_us).max(1) as f64;
                self.last = Some((count, edge_us));
            }
            None => self.last = Some((count, edge_us)),
        }
        if (self.hz - self.told).abs() > SAME_HZ * self.hz || self.hz == 0.0 {
            self.told = self.hz;
        }
        self.told
    }
}
