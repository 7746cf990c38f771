//! What a bench file may place: inputs of the unit and what its outputs show, where each can be, and what it has to state
//! there.

use std::collections::BTreeMap;

use protocol::message::{ModeSwitch, TrainLines};

use serde::Deserialize;

use super::instrument::{InstrumentEntry, Kind};
use super::model::Model;

/// One stimulus or reading.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// `frames`, `none`, `operator` or the name of an instrument.
    pub(super) at: String,
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
    /// Factor from what is read to the signal.
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

    /// Refuses numbers that are beyond reason.
    pub(super) fn check(&self) -> Result<(), String> {
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
/// Greatest times that a bench file may state: of a pulse, ms, and for a person, s.
const MOST_MS: u64 = 60_000;
const MOST_S: u64 = 3_600;
/// Last coil or input, counted from 0: as many coils as one request writes (Modbus application protocol 6.11).
const LAST_TERMINAL: u16 = 1967;

/// The instrument at which a point is, and its driver.
pub(super) type Named<'a> = (Option<&'a InstrumentEntry>, Option<&'a Model>);

macro_rules! inputs {
    ($($name:ident $key:literal,)*) => {
        /// An input of the unit: what a bench file places as a stimulus.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum UnitInput { $(#[doc = $key] $name,)* }

        impl UnitInput {
            /// All inputs: train lines first, by their bits.
            pub const ALL: &[Self] = &[$(Self::$name,)*];

            /// Key of the input in a bench file.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$name => $key,)* }
            }
        }
    };
}

// Train lines first, by their bits.
inputs! {
    DoorsClosed "doors_closed", Hcr "hcr", MaintenanceKey "maintenance_key", Acknowledge "acknowledge", Start "start",
    EbLoop "eb_loop", Forward "forward", Backward "backward", EbLoopFed "eb_loop_fed", DoorsBySide "doors_by_side",
    LeftClosed "left_closed", LeftLocked "left_locked", RightClosed "right_closed", RightLocked "right_locked",
    Code "code", Crosstalk "crosstalk", Tacho1 "tacho1", Tacho2 "tacho2", Marker "marker", ModeSwitch "mode_switch",
    Controller "controller", Entries "entries", Twc "twc", Supply "supply",
}

impl UnitInput {
    /// The input of this key.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|known| known.name() == name)
    }

    pub(super) fn lines() -> impl Iterator<Item = (Self, TrainLines)> {
        let bits = (0..).map(|bit| TrainLines::from_bits_retain(1 << bit));
        let lines = Self::ALL.iter().copied();
        lines
            .take_while(|input| *input <= Self::RightLocked)
            .zip(bits)
    }

    /// Act of a SCPI instrument that drives the input.
    pub(super) const fn act(self) -> Option<&'static str> {
        match self {
            Self::Code => Some("code"),
            Self::Tacho1 | Self::Tacho2 => Some("pulses"),
            Self::Supply => Some("supply"),
            _ => None,
        }
    }

    /// Number of relays that make this input; 0 = relays cannot.
    const fn coils(self) -> usize {
        match self {
            Self::ModeSwitch => ModeSwitch::ALL.len(),
            Self::Marker => 4,
            Self::Code | Self::Tacho1 | Self::Tacho2 => 0,
            Self::Controller | Self::Entries | Self::Twc | Self::Crosstalk => 0,
            _ => 1,
        }
    }

    /// Whether the frame with all inputs of a scan carries this input.
    pub(super) const fn is_in_inputs(self) -> bool {
        !matches!(
            self,
            Self::Crosstalk | Self::Entries | Self::Twc | Self::Supply
        )
    }

    /// A person is quick enough to drive the input.
    const fn is_by_hand(self) -> bool {
        !matches!(
            self,
            Self::Code | Self::Crosstalk | Self::Tacho1 | Self::Tacho2 | Self::Marker | Self::Twc
        )
    }

    /// Checks that a point states what this input needs at its place.
    pub(super) fn check(self, point: &Point, (entry, model): Named<'_>) -> Result<(), String> {
        let Place::Instrument(instrument) = point.place() else {
            return match point.place() {
                _ if self == Self::Supply => Err("an instrument switches it".into()),
                Place::Operator(_) if matches!(self, Self::EbLoop | Self::EbLoopFed) => {
                    Err("no step moves it, so no person is asked for it".into())
                }
                Place::Operator(_) if !self.is_by_hand() => {
                    Err("no person is quick enough for it".into())
                }
                _ => Ok(()),
            };
        };
        let Some(entry) = entry else {
            return Err(format!("no instrument {instrument}"));
        };
        match (entry.kind(), self.act(), self.coils()) {
            (Kind::Scpi, Some(act), _) => {
                let Some(model) = model.filter(|model| model.acts.contains_key(act)) else {
                    return Err(format!("the model of {instrument} has no act {act}"));
                };
                if self == Self::Supply && point.volts.is_none() {
                    return Err("volts = the unit's supply".into());
                }
                let volts = point.volts.map(|volts| ("volts", volts));
                let beyond = model.out_of_range(&volts.into_iter().collect::<BTreeMap<_, _>>());
                beyond.map_or(Ok(()), |beyond| Err(beyond.to_string()))
            }
            (Kind::Sound, ..) if matches!(self, Self::Code | Self::Twc | Self::Marker) => Ok(()),
            (Kind::Sound, ..) => Err("a sound card carries code, twc and marker".into()),
            (Kind::Modbus, None, 0) => Err("a module has no contacts for it".into()),
            (Kind::Modbus, _, coils) if coils > 0 => {
                if coils != 1 && point.proved_by.is_some() {
                    return Err("proved_by is for a stimulus of one relay".into());
                }
                if self == Self::Marker && point.pulse_ms == 0 {
                    return Err("pulse_ms is at least 1".into());
                }
                match point.coils.len() {
                    n if n == coils => Ok(()),
                    n => Err(format!("it takes {coils} coils, not {n}")),
                }
            }
            _ => Err(format!("{instrument} is no instrument for it")),
        }
    }
}

pub(super) fn check_reading(
    is_contact: bool,
    point: &Point,
    (entry, model): Named<'_>,
) -> Result<(), String> {
    let Place::Instrument(instrument) = point.place() else {
        return Ok(());
    };
    match entry.map(InstrumentEntry::kind) {
        None => Err(format!("no instrument {instrument}")),
        Some(Kind::Sound) => Err("a sound card reads nothing".into()),
        Some(Kind::Modbus) if !is_contact => Err("an input is no display".into()),
        Some(Kind::Scpi) if is_contact => Err("a contact is read by an input".into()),
        Some(Kind::Modbus) if point.input.is_some() => Ok(()),
        Some(Kind::Modbus) => Err("which input?".into()),
        Some(Kind::Scpi) => {
            let read = point.read.as_deref().unwrap_or_default();
            match model.is_some_and(|model| model.reads.contains_key(read)) {
                true => Ok(()),
                false => Err(format!("the model of {instrument} reads no \"{read}\"")),
            }
        }
    }
}
