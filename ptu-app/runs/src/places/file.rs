//! The bench file, `benches/NAME.toml`.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use protocol::message::{Coil, Outputs};
use protocol::signal::Signal;
use serde::Deserialize;
use toml::Spanned;

use super::error::PlacesError;
use super::instrument::{InstrumentEntry, Kind};
use super::model::Model;
use super::points::{Named, Place, Point, UnitInput, check_reading};
use crate::signal::FULL_SCALE_MV;

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

/// Stimuli and readings of an instrument.
type PointsAt = (Vec<(UnitInput, Point)>, Vec<(Signal, Point)>);
type Drivers = BTreeMap<String, Arc<Model>>;

impl Written {
    /// Instruments and their drivers, checked: each instrument has what its protocol needs and its own address, and stands in
    /// `safe`.
    fn instruments(
        &self,
        text: &str,
        model: &mut impl FnMut(&str) -> Result<Model, String>,
    ) -> Result<(BTreeMap<String, InstrumentEntry>, Drivers), PlacesError> {
        let (mut instruments, mut models) = (BTreeMap::new(), Drivers::new());
        let switches = |name: &str| (self.stimuli.values()).any(|point| point.get_ref().at == name);
        for (place, (name, entry)) in self.instruments.iter().enumerate() {
            let refuse = |why: String| {
                PlacesError::at(text, &entry.span(), format!("instrument {name}: {why}"))
            };
            let entry = entry.get_ref();
            let checked = entry.check(switches(name), self.instruments.len());
            checked.map_err(refuse)?;
            if let Some(driver) = &entry.model {
                models.insert(name.clone(), Arc::new(model(driver).map_err(refuse)?));
            }
            let mut before = self.instruments.iter().take(place);
            if let Some((other, _)) =
                before.find(|(_, other)| entry.is_in_the_way_of(other.get_ref()))
            {
                let why =
                    format!("{other} is at its address, too, which Modbus modules alone may share");
                return Err(refuse(why));
            }
            instruments.insert(name.clone(), entry.clone());
        }
        let ordered = self.safe.get_ref();
        let missing = instruments.keys().find(|name| !ordered.contains(name));
        let unknown = ordered.iter().find(|name| !instruments.contains_key(*name));
        if let Some(name) = missing.or(unknown) {
            let why = format!(
                "safe names each instrument once, in the order in which they are switched off: see {name}"
            );
            return Err(PlacesError::at(text, &self.safe.span(), why));
        }
        let cards = instruments
            .values()
            .filter(|entry| entry.kind() == Kind::Sound);
        match cards.count() {
            0 | 1 => Ok((instruments, models)),
            _ => Err(PlacesError::at(
                text,
                &self.safe.span(),
                "there is one sound card at most",
            )),
        }
    }

    /// Stimuli that are not in the frames.
    fn stimuli<'a>(
        &self,
        text: &str,
        of: &impl Fn(&str) -> Named<'a>,
    ) -> Result<BTreeMap<UnitInput, Point>, PlacesError> {
        let (mut stimuli, mut taken) = (BTreeMap::new(), BTreeSet::new());
        for (name, point) in &self.stimuli {
            let refuse = |why: String| {
                PlacesError::at(text, &point.span(), format!("stimulus {name}: {why}"))
            };
            let known = UnitInput::from_name(name);
            let known = known.ok_or_else(|| refuse("there is no such stimulus".into()))?;
            let point = point.get_ref();
            point.check().map_err(refuse)?;
            known.check(point, of(&point.at)).map_err(refuse)?;
            if let Place::Instrument(instrument) = point.place() {
                let mut twice = point
                    .coils
                    .iter()
                    .filter(|coil| !taken.insert((instrument, **coil)));
                if let Some(coil) = twice.next() {
                    return Err(refuse(format!("coil {coil} has another use")));
                }
            }
            if point.place() != Place::Frames {
                stimuli.insert(known, point.clone());
            }
        }
        Ok(stimuli)
    }

    /// Readings that are not in the frames.
    fn readings<'a>(
        &self,
        text: &str,
        of: &impl Fn(&str) -> Named<'a>,
    ) -> Result<BTreeMap<Signal, Point>, PlacesError> {
        let mut readings = BTreeMap::new();
        for (name, point) in &self.readings {
            let refuse = |why: String| {
                PlacesError::at(text, &point.span(), format!("reading {name}: {why}"))
            };
            let known = READINGS.iter().find(|(known, _)| known.name() == name);
            let (known, contact) =
                *known.ok_or_else(|| refuse("no contact or display of the unit".into()))?;
            let point = point.get_ref();
            point.check().map_err(refuse)?;
            check_reading(!contact.is_empty(), point, of(&point.at)).map_err(refuse)?;
            if point.place() != Place::Frames {
                readings.insert(known, point.clone());
            }
        }
        Ok(readings)
    }
}

/// A bench file that was checked.
#[derive(Clone, Debug)]
pub struct Places {
    /// Name of the bench in runs and notes.
    pub name: String,
    /// SHA-256 of the bench file's text.
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
    /// Voltage of a full-scale sample on each channel of the sound card, mV.
    pub full_scale_mv: [f64; 2],
}

/// Signals that the unit's contacts and displays show, each with its contact; a display has none.
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
    /// The file is wrong, in a line that is named.
    pub fn from_toml(
        text: &str,
        mut model: impl FnMut(&str) -> Result<Model, String>,
    ) -> Result<Self, PlacesError> {
        let read: Written = toml::from_str(text)?;
        let (instruments, models) = read.instruments(text, &mut model)?;
        let of = |name: &str| {
            (
                instruments.get(name),
                models.get(name).map(|model| &**model),
            )
        };
        let stimuli = read.stimuli(text, &of)?;
        let readings = read.readings(text, &of)?;
        Ok(Self {
            name: String::new(),
            sha256: String::new(),
            instruments,
            models,
            safe: read.safe.into_inner(),
            stimuli,
            readings,
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

    /// The stimuli and readings that this instrument has.
    pub(super) fn points_at(&self, instrument: &str) -> PointsAt {
        let here = |point: &Point| point.place() == Place::Instrument(instrument);
        let stimuli = self.stimuli.iter().filter(|(_, point)| here(point));
        let readings = self.readings.iter().filter(|(_, point)| here(point));
        (
            stimuli.map(|(at, point)| (*at, point.clone())).collect(),
            readings.map(|(at, point)| (*at, point.clone())).collect(),
        )
    }

    /// Whether a check of the instrument times more than switching off, because it proves a relay or reads.
    pub fn times_more_than_off(&self, instrument: &str) -> bool {
        let (stimuli, readings) = self.points_at(instrument);
        !readings.is_empty() || (stimuli.iter()).any(|(_, point)| point.proved_by.is_some())
    }

    /// Whether everything that frames carry to the unit's inputs has another place.
    pub(super) fn leaves_no_input(&self) -> bool {
        (UnitInput::ALL.iter())
            .all(|input| !input.is_in_inputs() || self.stimuli.contains_key(input))
    }

    /// Whether everything that frames carry from the unit's outputs has another place.
    pub(super) fn leaves_no_output(&self) -> bool {
        (READINGS.iter()).all(|(signal, _)| self.readings.contains_key(signal))
    }
}
