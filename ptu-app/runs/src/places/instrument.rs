//! An instrument as the bench file has it: its protocol, where it is, and what it has to state.

use std::fmt;
use std::time::Duration;

use serde::Deserialize;

use crate::sound::TAKES_MS;

/// Time in which all outputs of a bench are off, on every end.
pub(super) const SAFE_WITHIN: Duration = Duration::from_secs(1);

/// Protocol of an instrument.
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
    /// Serial number by which the instrument is registered.
    pub serial: String,
    /// Time between two readings, ms.
    #[serde(default = "poll_ms")]
    pub poll_ms: u64,
    /// How late the instrument may act and read, ms: limits are widened by this.
    pub uncertainty_ms: u64,
    /// Register into which a time in ms is written, after which the module drops its outputs by itself.
    pub watchdog: Option<Watchdog>,
    /// Input at which the sound card is heard, to measure the time that sound takes.
    pub heard_at: Option<String>,
    /// What is to be switched off by hand if the program was killed.
    pub by_hand: Option<String>,
}

/// The watchdog of a module.
#[derive(Clone, Copy, Debug, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Watchdog {
    /// Holding register of the module that sets the watchdog.
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

impl InstrumentEntry {
    /// Protocol by which the instrument is reached.
    pub(super) fn kind(&self) -> Kind {
        match self.at.split_once(':') {
            Some(("modbus", _)) => Kind::Modbus,
            Some(("sound", _)) => Kind::Sound,
            _ => Kind::Scpi,
        }
    }

    /// Where the instrument is.
    pub(super) fn reach(&self) -> Reach {
        let at = self.at.split_once(':').map_or("", |(_, at)| at);
        Reach::of(at).unwrap_or_else(|| Reach::Tcp(at.to_owned()))
    }

    /// Whether both instruments are at one address, and do not take turns there.
    pub(super) fn is_in_the_way_of(&self, other: &Self) -> bool {
        let port = |reach: Reach| match reach {
            Reach::Serial(path, _) => path,
            Reach::Tcp(at) | Reach::Usb(at) => at,
        };
        let take_turns = [self, other].map(Self::kind) == [Kind::Modbus; 2];
        port(self.reach()) == port(other.reach()) && !(take_turns && self.reach() == other.reach())
    }

    pub(super) fn check(&self, switches: bool, instruments: usize) -> Result<(), String> {
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
        if !is_sound && self.heard_at.is_some() {
            return Err("heard_at is of a sound card".into());
        }
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
