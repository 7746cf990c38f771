//! The train of a run: its file, its mass, and the parameters the unit is given for it.

use btu_rig::conditions::Conditions;
use btu_rig::drive::Load;
use btu_rig::train::TrainData;
use protocol::config::UnitConfig;

use super::{Fixed, Setting};
use crate::failure::{DriveTrouble, Failure};

/// Least and greatest mass of an ideal train, kg.
const IDEAL_KG: (f64, f64) = (1e4, 2e6);
/// Highest base speed a unit can be given, km/h: for a train without one.
const NO_BASE_SPEED_KMH: f64 = 130.0;
/// Highest jerk a unit can be given, m/s³: for a train without a limit.
const NO_JERK_LIMIT_MPS3: f64 = 100.0;

/// Gives the train a total mass: an ideal train is built to it, a train of cars is loaded to it.
/// Returns the passengers aboard, kg; none if neither mass nor load was given.
///
/// # Errors
/// The train cannot be so heavy, so light or so full.
pub fn load(
    train: &mut TrainData,
    mass_kg: Option<f64>,
    load: Option<Load>,
) -> Result<Option<f64>, Failure> {
    let full_kg = train.full_load_kg();
    let in_range = |what: &str, value: f64, low: f64, high: f64| {
        if (low..=high).contains(&value) {
            return Ok(value);
        }
        let kg = |mass: f64| format!("{mass:.0} kg");
        Err(Failure::usage(DriveTrouble::Outside(
            what.to_owned(),
            kg(value),
            kg(low),
            kg(high),
        )))
    };
    match (mass_kg, train) {
        (Some(mass_kg), TrainData::Ideal(ideal)) => {
            ideal.mass_kg = in_range("--mass", mass_kg, IDEAL_KG.0, IDEAL_KG.1)?;
            Ok(Some(0.0))
        }
        (Some(mass_kg), TrainData::Cars(cars)) => {
            let empty_kg: f64 = cars.cars.iter().map(|car| car.empty_kg).sum();
            let what = format!("--mass of train {}:", cars.name);
            let mass_kg = in_range(&what, mass_kg, empty_kg, empty_kg + full_kg)?;
            Ok(Some(mass_kg - empty_kg))
        }
        (None, _) => match load {
            None => Ok(None),
            Some(Load::Empty) => Ok(Some(0.0)),
            Some(Load::Full) => Ok(Some(full_kg)),
            Some(Load::Passengers(kg)) => in_range("--load", kg, 0.0, full_kg).map(Some),
        },
    }
}

/// Settings by which the unit's configuration fits the train. The configuration is made for the train of cars; the
/// papers' ideal train is another, and the papers' controller knew its parameters.
pub fn told(train: &TrainData) -> Vec<Setting> {
    let TrainData::Ideal(ideal) = train else {
        return Vec::new();
    };
    [
        ("empty_kg", ideal.mass_kg),
        ("rotating_kg", 0.0),
        ("length_m", ideal.length_m),
        ("power_kmh_per_s", ideal.power_kmh_per_s),
        (
            "base_speed_kmh",
            ideal.base_speed_kmh.unwrap_or(NO_BASE_SPEED_KMH),
        ),
        ("brake_kmh_per_s", ideal.service_kmh_per_s),
        ("jerk_mps3", NO_JERK_LIMIT_MPS3),
        ("dead_time_ms", 0.0),
        ("lag_ms", 0.0),
        ("air_dead_time_ms", 0.0),
        ("air_lag_ms", 0.0),
        ("drag_per_s", ideal.drag_per_s),
        ("rolling_kgf_t", 0.0),
        ("curve_kgf_m_t", 0.0),
    ]
    .map(|(key, value)| Setting::new(&format!("ato.train.{key}"), format!("{value:?}")))
    .into()
}

/// Warning of a train whose service brake gives less than ATO counts on.
pub fn brakes_less(train: &TrainData, config: &UnitConfig) -> Option<DriveTrouble> {
    let (brakes, counts_on) = (train.service_kmh_per_s(), config.ato.decel_kmh_per_s);
    (brakes < counts_on)
        .then(|| DriveTrouble::BrakesLess(train.name().to_owned(), brakes, counts_on))
}

/// Refuses conditions that would not act on this train.
///
/// # Errors
/// Names the option, and a train on which it acts.
pub fn check_acts(train: &TrainData, fixed: &Fixed) -> Result<(), Failure> {
    let TrainData::Ideal(ideal) = train else {
        return Ok(());
    };
    let gradient = fixed.gradient_permille.filter(|_| !ideal.gradients);
    for (option, value) in [("--gradient", gradient), ("--adhesion", fixed.adhesion)] {
        if value.is_some() {
            return Err(Failure::usage(DriveTrouble::NoEffect(
                option,
                ideal.name.clone(),
            )));
        }
    }
    Ok(())
}

/// `drawn` with nominal values for conditions that do not act on this train, so that no report
/// names them.
pub fn acting(train: &TrainData, drawn: Conditions) -> Conditions {
    let usual = Conditions::default();
    match train {
        TrainData::Cars(_) => drawn,
        TrainData::Ideal(ideal) => Conditions {
            gradient_offset_permille: if ideal.gradients {
                drawn.gradient_offset_permille
            } else {
                usual.gradient_offset_permille
            },
            adhesion: usual.adhesion,
            delay_factor: usual.delay_factor,
            ..drawn
        },
    }
}

/// Gradients and curves do not act on this train, so its track has none.
pub fn needs_level_track(train: &TrainData) -> bool {
    matches!(train, TrainData::Ideal(ideal) if !ideal.gradients)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mass_is_load_for_cars_and_mass_for_the_ideal_train() {
        let mut cars = TrainData::line6();
        assert_eq!(
            load(&mut cars, Some(300_000.0), None).unwrap(),
            Some(31_193.0)
        );
        for wrong in [268_000.0, 429_000.0, f64::NAN] {
            let failure = load(&mut cars, Some(wrong), None).unwrap_err();
            assert!(
                failure.to_string().contains("268807 kg .. 428807 kg"),
                "{failure}"
            );
        }
        let mut ideal = TrainData::ideal();
        assert_eq!(load(&mut ideal, Some(432_000.0), None).unwrap(), Some(0.0));
        assert!(matches!(&ideal, TrainData::Ideal(data) if data.mass_kg == 432_000.0));
        let told: Vec<_> = told(&ideal).iter().map(ToString::to_string).collect();
        assert!(
            told.contains(&"ato.train.empty_kg=432000.0".into()),
            "{told:?}"
        );
    }
}
