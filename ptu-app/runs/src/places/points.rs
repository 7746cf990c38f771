//! What a stimulus or a reading can be at, and what it has to state there.

use protocol::message::ModeSwitch;
use protocol::signal::Signal;

use super::file::{At, InstrumentEntry, Place, Places, Point};
use super::model::Model;

/// The instrument at which a point is, and its driver.
pub(super) type Named<'a> = (Option<&'a InstrumentEntry>, Option<&'a Model>);

/// Stimuli and readings of an instrument.
pub(super) type PointsAt = (Vec<(&'static str, Point)>, Vec<(Signal, Point)>);

impl Places {
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
}

pub(super) fn check_stimulus(
    name: &str,
    point: &Point,
    (entry, model): Named<'_>,
) -> Result<(), String> {
    let Place::Instrument(instrument) = point.place() else {
        let cab = !["code", "crosstalk", "tacho1", "tacho2", "marker", "twc"].contains(&name);
        return match point.place() {
            Place::Operator(_) if name.starts_with("eb_loop") => {
                Err("no step moves it, so no person is asked for it".into())
            }
            Place::Operator(_) if !cab => Err("no person is quick enough for it".into()),
            _ => Ok(()),
        };
    };
    let act = act_of(name);
    match (entry.map(InstrumentEntry::at), act) {
        (None, _) => Err(format!("no instrument {instrument}")),
        (Some(At::Scpi(_)), Some(act)) => {
            match model.is_some_and(|model| model.acts.contains_key(act)) {
                true => Ok(()),
                false => Err(format!("the model of {instrument} has no act {act}")),
            }
        }
        (Some(At::Sound(_)), _) => match name {
            "code" | "twc" | "marker" => Ok(()),
            _ => Err("a sound card carries code, twc and marker".into()),
        },
        (Some(At::Modbus(..)), None) => {
            let coils = match name {
                "mode_switch" => ModeSwitch::ALL.len(),
                "marker" => 4,
                "controller" | "entries" | "twc" | "crosstalk" => 0,
                _ => 1,
            };
            if coils != 1 && point.proved_by.is_some() {
                return Err("proved_by is for a stimulus of one relay".into());
            }
            if name == "marker" && point.pulse_ms == 0 {
                return Err("pulse_ms is at least 1".into());
            }
            match point.coils.len() {
                n if n == coils && n > 0 => Ok(()),
                _ if coils == 0 => Err("a module has no contacts for it".into()),
                n => Err(format!("it takes {coils} coils, not {n}")),
            }
        }
        _ => Err(format!("{instrument} is no instrument for it")),
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
    match entry.map(InstrumentEntry::at) {
        None => Err(format!("no instrument {instrument}")),
        Some(At::Sound(_)) => Err("a sound card reads nothing".into()),
        Some(At::Modbus(..)) if !is_contact => Err("an input is no display".into()),
        Some(At::Scpi(_)) if is_contact => Err("a contact is read by an input".into()),
        Some(At::Modbus(..)) if point.input.is_some() => Ok(()),
        Some(At::Modbus(..)) => Err("which input?".into()),
        Some(At::Scpi(_)) => {
            let read = point.read.as_deref().unwrap_or_default();
            match model.is_some_and(|model| model.reads.contains_key(read)) {
                true => Ok(()),
                false => Err(format!("the model of {instrument} reads no \"{read}\"")),
            }
        }
    }
}

/// What a SCPI instrument does for a stimulus.
pub(super) fn act_of(stimulus: &str) -> Option<&'static str> {
    match stimulus {
        "code" => Some("code"),
        "tacho1" | "tacho2" => Some("pulses"),
        _ => None,
    }
}
