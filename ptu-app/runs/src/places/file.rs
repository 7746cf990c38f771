//! The bench file, `benches/NAME.toml`.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use protocol::message::{Coil, Outputs};
use protocol::signal::Signal;
use serde::Deserialize;
use thiserror::Error;
use toml::Spanned;

use super::model::Model;
use super::placed::SAFE_WITHIN;
use super::points::{UnitInput, check_reading};
use crate::signal::FULL_SCALE_MV;
use crate::sound::TAKES_MS;

/// Why a bench file or a driver is refused.
#[derive(Debug, Error)]
pub enum PlacesError {
    /// It is not as TOML, or has another key.
    #[error("{0}")]
    Toml(#[from] toml::de::Error),
    /// A value of the file does not fit.
    #[error("line {line}: {why}")]
    Wrong {
        /// Counted from 1.
        line: usize,
        /// What is wrong there.
        why: String,
    },
}

/// What an instrument speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Coils and inputs, over TCP or RTU.
    Modbus,
    /// Lines of text.
    Scpi,
    /// Samples of a sound card.
    Sound,
}

/// Where an instrument is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reach {
    /// `HOST:PORT`
    Tcp(String),
    /// Serial port and its rate, 8 bits without parity.
    Serial(String, u32),
    /// The system's device of a USB instrument.
    Usb(String),
}

impl Reach {
    fn of(text: &str) -> Option<Self> {
        if let Some((path, baud)) = text.rsplit_once('@') {
            let baud = baud.parse().ok().filter(|_| !path.is_empty());
            return Some(Self::Serial(path.to_owned(), baud?));
        }
        if text.starts_with(USB) {
            return Some(Self::Usb(text.to_owned()));
        }
        let port = text.rsplit_once(':')?.1.parse::<u16>();
        port.is_ok().then(|| Self::Tcp(text.to_owned()))
    }
}

impl fmt::Display for Reach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tcp(at) | Self::Usb(at) => f.write_str(at),
            Self::Serial(path, baud) => write!(f, "{path}@{baud}"),
        }
    }
}

/// Devices of USB instruments (USBTMC) on Linux.
const USB: &str = "/dev/usbtmc";

/// An instrument as the bench file has it.
#[derive(Clone, Debug, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InstrumentEntry {
    /// `modbus:` or `scpi:`, and `HOST:PORT`, `SERIALPORT@BAUD` or `/dev/usbtmcN`; or `sound:DEVICE`.
    at: String,
    /// Number of the Modbus unit.
    #[serde(default = "first_unit")]
    pub unit: u8,
    /// Driver of a SCPI instrument, `instruments/NAME.toml`.
    pub model: Option<String>,
    /// Serial number, by which it is registered.
    pub serial: String,
    /// Time between two readings, ms.
    #[serde(default = "poll_ms")]
    pub poll_ms: u64,
    /// How late it may act and read, ms: what limits are widened by.
    pub uncertainty_ms: u64,
    /// Register into which a time in ms is written, after which the module drops its outputs by itself.
    pub watchdog: Option<Watchdog>,
    /// What is to be switched off by hand if the program was killed.
    pub by_hand: Option<String>,
}

/// The watchdog of a module.
#[derive(Clone, Copy, Debug, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Watchdog {
    /// Its holding register.
    pub register: u16,
    /// What is written there: ms until outputs drop.
    pub ms: u16,
}

fn first_unit() -> u8 {
    1
}

fn poll_ms() -> u64 {
    10
}

/// One stimulus or reading.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// `frames`, `none`, `operator` or the name of an instrument.
    at: String,
    /// Coils of a module, of which one is on: as many as the point has positions.
    #[serde(default)]
    pub coils: Vec<u16>,
    /// How long a pulse lasts, ms.
    #[serde(default)]
    pub pulse_ms: u64,
    /// Input of a module that proves the coil's relay.
    pub proved_by: Option<u16>,
    /// Input of a module that is read.
    pub input: Option<u16>,
    /// The input is closed where the signal's contact is open.
    #[serde(default)]
    pub inverted: bool,
    /// Channel of the instrument, put into its commands.
    #[serde(default)]
    pub channel: u8,
    /// Name of the driver's question for the reading.
    pub read: Option<String>,
    /// Signal per unit of what is read.
    pub scale: Option<f64>,
    /// Voltage of the unit's supply, V.
    pub volts: Option<f64>,
    /// Expanded uncertainty of the reading, in the unit of the signal.
    #[serde(default)]
    pub uncertainty: f64,
    /// Time allowed to a person, s.
    pub within_s: Option<u64>,
}

/// Where a point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place<'a> {
    /// In the frames, as without a bench file.
    Frames,
    /// Nowhere: the bench does not have it.
    None,
    /// A person does it, in so many seconds.
    Operator(u64),
    /// The instrument of this name.
    Instrument(&'a str),
}

impl Point {
    /// What the word of `at` means.
    pub fn place(&self) -> Place<'_> {
        match self.at.as_str() {
            "frames" => Place::Frames,
            "none" => Place::None,
            "operator" => Place::Operator(self.within_s.unwrap_or(OPERATOR_S)),
            name => Place::Instrument(name),
        }
    }

    /// No number of it is beyond reason.
    fn check(&self) -> Result<(), String> {
        let terminals = self.coils.iter().copied();
        let terminals = terminals.chain(self.proved_by).chain(self.input);
        if terminals.max() > Some(LAST_TERMINAL) {
            return Err(format!("coils and inputs are 0 to {LAST_TERMINAL}"));
        }
        if self.pulse_ms > MOST_MS {
            return Err(format!("pulse_ms is at most {MOST_MS}"));
        }
        if !(1..=MOST_S).contains(&self.within_s.unwrap_or(OPERATOR_S)) {
            return Err(format!("within_s is 1 to {MOST_S}"));
        }
        if !(self.uncertainty.is_finite() && self.uncertainty >= 0.0) {
            return Err("uncertainty is a number, and not negative".into());
        }
        if self
            .volts
            .is_some_and(|volts| !(volts.is_normal() && volts > 0.0))
        {
            return Err("volts is a number above 0".into());
        }
        match self.scale.is_none_or(|scale| scale.is_normal()) {
            true => Ok(()),
            false => Err("scale is a number, and not 0".into()),
        }
    }
}

/// Time a person has, s [default].
const OPERATOR_S: u64 = 60;
/// Greatest times that a bench file may state.
const MOST_MS: u64 = 60_000;
const MOST_S: u64 = 3_600;
/// As many coils as one request writes (Modbus application protocol 6.11), counted from 0.
const LAST_TERMINAL: u16 = 1967;

/// A bench file as it is written.
#[derive(Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Written {
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, InstrumentEntry>")]
    instruments: BTreeMap<String, Spanned<InstrumentEntry>>,
    #[schemars(with = "Vec<String>")]
    safe: Spanned<Vec<String>>,
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, Point>")]
    stimuli: BTreeMap<String, Spanned<Point>>,
    #[serde(default)]
    #[schemars(with = "BTreeMap<String, Point>")]
    readings: BTreeMap<String, Spanned<Point>>,
}

/// A bench file that was checked.
#[derive(Clone, Debug)]
pub struct Places {
    /// As runs and notes call the bench.
    pub name: String,
    /// SHA-256 of its text.
    pub sha256: String,
    /// Instruments by name.
    pub instruments: BTreeMap<String, InstrumentEntry>,
    /// Drivers of SCPI instruments, by the name of the instrument.
    pub models: BTreeMap<String, Arc<Model>>,
    /// Instruments in the order in which their outputs are switched off.
    pub safe: Vec<String>,
    /// Stimuli that are not in the frames.
    pub stimuli: BTreeMap<UnitInput, Point>,
    /// Readings that are not in the frames.
    pub readings: BTreeMap<Signal, Point>,
    /// What the sound card makes of a whole sample of each channel, mV.
    pub full_scale_mv: [f64; 2],
}

/// Signals that the unit's contacts and displays show, and the contact.
pub(super) const READINGS: [(Signal, Outputs); 17] = [
    (Signal::Eb, Outputs::EB_RELAY),
    (Signal::Fsb, Outputs::FSB),
    (Signal::PowerCut, Outputs::POWER_CUT),
    (Signal::Alarm, Outputs::ALARM),
    (Signal::HoldingBrake, Outputs::HOLDING_BRAKE),
    (Signal::DoorEnableLeft, Outputs::DOOR_ENABLE_LEFT),
    (Signal::DoorEnableRight, Outputs::DOOR_ENABLE_RIGHT),
    (Signal::CodeValid, Outputs::CODE_VALID),
    (Signal::Standstill, Outputs::STANDSTILL),
    (Signal::Healthy, Outputs::HEALTHY),
    (Signal::DoorOrderLeft, Outputs::OPEN_LEFT),
    (Signal::DoorOrderRight, Outputs::OPEN_RIGHT),
    (Signal::DoorOrderClose, Outputs::CLOSE_DOORS),
    (Signal::Limit, Outputs::empty()),
    (Signal::Speed, Outputs::empty()),
    (Signal::Marker, Outputs::empty()),
    (Signal::MarkerCount, Outputs::empty()),
];

impl Places {
    /// Reads a bench file; `model` reads the driver of that name.
    ///
    /// # Errors
    /// It is wrong, in a line that is named.
    pub fn from_toml(
        text: &str,
        mut model: impl FnMut(&str) -> Result<Model, String>,
    ) -> Result<Self, PlacesError> {
        let read: Written = toml::from_str(text)?;
        let wrong = |at: &Range<usize>, why: String| PlacesError::Wrong {
            line: 1 + text[..at.start].matches('\n').count(),
            why,
        };
        let mut models = BTreeMap::new();
        let mut instruments = BTreeMap::new();
        let switches = |name: &str| (read.stimuli.values()).any(|point| point.get_ref().at == name);
        for (name, entry) in &read.instruments {
            let refuse = |why| wrong(&entry.span(), format!("instrument {name}: {why}"));
            let entry = entry.get_ref();
            entry
                .check(switches(name), read.instruments.len())
                .map_err(refuse)?;
            if let Some(driver) = &entry.model {
                models.insert(name.clone(), Arc::new(model(driver).map_err(refuse)?));
            }
            instruments.insert(name.clone(), entry.clone());
        }
        let ordered = read.safe.get_ref();
        let missing = instruments.keys().find(|name| !ordered.contains(name));
        let unknown = ordered.iter().find(|name| !instruments.contains_key(*name));
        if let Some(name) = missing.or(unknown) {
            let why = format!(
                "safe names each instrument once, in the order in which they are switched off: see {name}"
            );
            return Err(wrong(&read.safe.span(), why));
        }
        let cards = instruments
            .values()
            .filter(|entry: &&InstrumentEntry| entry.kind() == Kind::Sound);
        if cards.count() > 1 {
            return Err(wrong(
                &read.safe.span(),
                "there is one sound card at most".into(),
            ));
        }
        for (place, (name, entry)) in read.instruments.iter().enumerate() {
            let mut before = read.instruments.iter().take(place);
            if let Some((other, _)) =
                before.find(|(_, other)| entry.get_ref().is_in_the_way_of(other.get_ref()))
            {
                let why = format!(
                    "instrument {name}: {other} is at its address, too, which Modbus modules alone may share"
                );
                return Err(wrong(&entry.span(), why));
            }
        }
        let of = |name: &str| (instruments.get(name), models.get(name).map(|m| &**m));
        let mut stimuli_at = BTreeMap::new();
        let mut taken = BTreeSet::new();
        for (name, point) in &read.stimuli {
            let refuse = |why| wrong(&point.span(), format!("stimulus {name}: {why}"));
            let known = UnitInput::from_name(name);
            let known = known.ok_or_else(|| refuse("there is no such stimulus".into()))?;
            let place = point.get_ref().place();
            point.get_ref().check().map_err(refuse)?;
            known
                .check(point.get_ref(), of(&point.get_ref().at))
                .map_err(refuse)?;
            if let Place::Instrument(instrument) = place {
                let coils = point.get_ref().coils.iter();
                let mut twice = coils.filter(|coil| !taken.insert((instrument, **coil)));
                if let Some(coil) = twice.next() {
                    return Err(refuse(format!("coil {coil} has another use")));
                }
            }
            if place != Place::Frames {
                stimuli_at.insert(known, point.get_ref().clone());
            }
        }
        let mut readings_at = BTreeMap::new();
        for (name, point) in &read.readings {
            let refuse = |why| wrong(&point.span(), format!("reading {name}: {why}"));
            let known = READINGS.iter().find(|(known, _)| known.name() == name);
            let (known, contact) =
                *known.ok_or_else(|| refuse("no contact or display of the unit".into()))?;
            point.get_ref().check().map_err(refuse)?;
            check_reading(
                !contact.is_empty(),
                point.get_ref(),
                of(&point.get_ref().at),
            )
            .map_err(refuse)?;
            if point.get_ref().place() != Place::Frames {
                readings_at.insert(known, point.get_ref().clone());
            }
        }
        Ok(Self {
            name: String::new(),
            sha256: String::new(),
            instruments,
            models,
            safe: ordered.clone(),
            stimuli: stimuli_at,
            readings: readings_at,
            full_scale_mv: [FULL_SCALE_MV; 2],
        })
    }

    /// The sound card, by its name in the file, and its device.
    pub fn sound_card(&self) -> Option<(&String, String)> {
        self.instruments
            .iter()
            .find(|(_, entry)| entry.kind() == Kind::Sound)
            .map(|(name, entry)| (name, entry.reach().to_string()))
    }

    /// The coils whose waveforms go to the sound card.
    pub fn coils_by_sound(&self) -> Vec<Coil> {
        let Some((card, _)) = self.sound_card() else {
            return Vec::new();
        };
        let coils = [
            (UnitInput::Code, Coil::AtpAntenna),
            (UnitInput::Twc, Coil::TwcAntenna),
            (UnitInput::Marker, Coil::MarkerAntenna),
        ];
        let there = |input| self.stimuli.get(&input).map(Point::place);
        let by_sound = coils
            .into_iter()
            .filter(|(name, _)| there(*name) == Some(Place::Instrument(card)));
        by_sound.map(|(_, coil)| coil).collect()
    }

    /// The instrument proves a relay or reads, so that its check times more than that it switches off.
    pub fn times_more_than_off(&self, instrument: &str) -> bool {
        let (stimuli, readings) = self.points_at(instrument);
        !readings.is_empty() || (stimuli.iter()).any(|(_, point)| point.proved_by.is_some())
    }

    /// Everything that frames to the unit's inputs carry has another place.
    pub(super) fn leaves_no_input(&self) -> bool {
        (UnitInput::ALL.iter())
            .all(|input| !input.is_in_inputs() || self.stimuli.contains_key(input))
    }

    /// Everything that frames of the unit's outputs carry has another place.
    pub(super) fn leaves_no_output(&self) -> bool {
        (READINGS.iter()).all(|(signal, _)| self.readings.contains_key(signal))
    }
}

impl InstrumentEntry {
    /// What it speaks.
    pub(super) fn kind(&self) -> Kind {
        match self.at.split_once(':') {
            Some(("modbus", _)) => Kind::Modbus,
            Some(("sound", _)) => Kind::Sound,
            _ => Kind::Scpi,
        }
    }

    /// Where it is.
    pub(super) fn reach(&self) -> Reach {
        let at = self.at.split_once(':').map_or("", |(_, at)| at);
        Reach::of(at).unwrap_or_else(|| Reach::Tcp(at.to_owned()))
    }

    /// They are at one address, and do not take turns there.
    fn is_in_the_way_of(&self, other: &Self) -> bool {
        let port = |reach: Reach| match reach {
            Reach::Serial(path, _) => path,
            Reach::Tcp(at) | Reach::Usb(at) => at,
        };
        let take_turns = [self, other].map(Self::kind) == [Kind::Modbus; 2];
        port(self.reach()) == port(other.reach()) && !(take_turns && self.reach() == other.reach())
    }

    fn check(&self, switches: bool, instruments: usize) -> Result<(), String> {
        let (kind, at) = self.at.split_once(':').unwrap_or_default();
        let is_wrong = match Reach::of(at) {
            _ if kind == "sound" => at.is_empty(),
            None => true,
            Some(Reach::Usb(_)) => kind != "scpi",
            Some(_) => !["modbus", "scpi"].contains(&kind),
        };
        if is_wrong {
            return Err(format!(
                "at is modbus:HOST:PORT, modbus:SERIALPORT@BAUD, scpi:HOST:PORT, scpi:SERIALPORT@BAUD, scpi:{USB}0 or sound:DEVICE, not \"{}\"",
                self.at
            ));
        }
        if (self.kind() == Kind::Scpi) != self.model.is_some() {
            return Err("a SCPI instrument has a model, and no other has one".into());
        }
        if self.poll_ms == 0 || self.uncertainty_ms <= self.poll_ms {
            return Err("uncertainty_ms is more than poll_ms, and that at least 1".into());
        }
        let most_ms = SAFE_WITHIN.as_millis() as u64 / instruments as u64;
        if self.uncertainty_ms > most_ms {
            return Err(format!(
                "uncertainty_ms is at most {most_ms}: all {instruments} are off within 1 s"
            ));
        }
        if let Some(watchdog) = self.watchdog
            && u64::from(watchdog.ms) <= self.poll_ms
        {
            return Err("the watchdog waits longer than poll_ms".into());
        }
        let is_sound = self.kind() == Kind::Sound;
        if is_sound && self.uncertainty_ms <= TAKES_MS {
            return Err(format!(
                "sound is on its way for {TAKES_MS} ms: uncertainty_ms is more"
            ));
        }
        // A card falls silent by itself.
        if switches && !is_sound && self.watchdog.is_none() && self.by_hand.is_none() {
            return Err("it drives outputs: give its watchdog, or say in by_hand what is to be switched off if the program is killed".into());
        }
        Ok(())
    }
}
