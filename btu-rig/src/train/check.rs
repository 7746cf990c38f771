//! Reads a train's file: ranges of its data, and what must fit together.

use protocol::check_ranges;
use protocol::config::{ConfigError, within};
use serde::Deserialize;

use super::MAX_CARS;
use super::actuator::MAX_TIME_S;
use super::data::{CarData, CarsData, DoorData, IdealData, Role, TrainData};

/// The one key all models have.
#[derive(Deserialize, schemars::JsonSchema)]
struct Kind {
    model: String,
}

impl TrainData {
    /// Reads and checks a train file.
    ///
    /// # Errors
    /// The first thing wrong: syntax with line and column, or a train that cannot be.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        let Kind { model } = parse(text)?;
        let data = match model.as_str() {
            "ideal" => Self::Ideal(parse(text)?),
            "cars" => Self::Cars(parse(text)?),
            _ => {
                return Err(ConfigError::Conflict(format!(
                    "model \"{model}\" must be ideal or cars"
                )));
            }
        };
        match &data {
            Self::Ideal(ideal) => check_ideal(ideal)?,
            Self::Cars(cars) => check_cars(cars)?,
        }
        Ok(data)
    }
}

fn parse<T: serde::de::DeserializeOwned>(text: &str) -> Result<T, ConfigError> {
    toml::from_str(text).map_err(|e| ConfigError::Syntax(e.to_string()))
}

/// Checks values that the unit is told against the ranges of `ato.train` in its configuration, so that an error names the
/// train's file.
fn check_ideal(data: &IdealData) -> Result<(), ConfigError> {
    check_ranges! { data, "";
        mass_kg: 1e3, 1e7;
        full_load_kg: 0.0, 1e6;
        length_m: 5.0, 500.0;
        drag_per_s: 0.0, 0.1;
        power_kmh_per_s: 0.5, 6.0;
        service_kmh_per_s: 0.5, 6.0;
        emergency_kmh_per_s: 0.1, 10.0;
        holding_share: 0.0, 1.0;
        parking_share: 0.0, 1.0;
    }
    check_doors(&data.doors)?;
    let base_kmh = data.base_speed_kmh.unwrap_or(40.0);
    within("base_speed_kmh", base_kmh, 5.0, 130.0)?;
    data.tcms.check()
}

fn check_cars(data: &CarsData) -> Result<(), ConfigError> {
    ranges(data)?;
    check_doors(&data.doors)?;
    let electric = &data.electric_brake;
    if electric.fade_to_kmh >= electric.fade_from_kmh
        || electric.fade_from_kmh > electric.full_to_kmh
    {
        return Err(ConfigError::Conflict(format!(
            "electric_brake: fade_to_kmh {} < fade_from_kmh {} <= full_to_kmh {} is needed",
            electric.fade_to_kmh, electric.fade_from_kmh, electric.full_to_kmh
        )));
    }
    check_efforts(data)?;
    let count = data.cars.len();
    within("cars", count as f64, 1.0, MAX_CARS as f64)?;
    within(
        "tachometer_car",
        data.tachometer_car as f64,
        1.0,
        count as f64,
    )?;
    for (i, car) in data.cars.iter().enumerate() {
        check_car(i + 1, car)?;
    }
    if !data.cars.iter().any(|car| car.role == Role::Motor) {
        return Err(ConfigError::Conflict(
            "cars: a train needs a motor car".to_owned(),
        ));
    }
    check_pairs(data)?;
    check_air(data)?;
    data.tcms.check()
}

/// Checks the list of efforts by speed that stands in place of `base_speed_kmh`.
fn check_efforts(data: &CarsData) -> Result<(), ConfigError> {
    let count = data.traction.efforts.as_ref().map_or(1, Vec::len);
    within("traction.efforts", count as f64, 1.0, 1_000.0)?;
    let mut last_kmh = -1.0;
    for (i, effort) in data.traction.efforts.iter().flatten().enumerate() {
        let key = format!("traction.efforts {}", i + 1);
        within(
            &format!("{key}: n"),
            effort.n,
            0.0,
            data.traction.full_load_n,
        )?;
        // Beyond the last point the power is that of the last.
        let least_kmh = if i + 1 == count { 1.0 } else { 0.0_f64 };
        let least_kmh = least_kmh.max(last_kmh + 1.0);
        within(&format!("{key}: kmh"), effort.kmh, least_kmh, 300.0)?;
        last_kmh = effort.kmh;
    }
    let Some(davis) = &data.resistance.davis else {
        return Ok(());
    };
    check_ranges! { davis, "resistance.davis.";
        a_n: 0.0, 1e6;
        b_n_per_kmh: 0.0, 1e4;
        c_n_per_kmh2: 0.0, 1e3;
    }
    let r = &data.resistance;
    match r.rolling_kgf_t + r.rolling_kgf_t_per_kmh + r.air_kgf_per_kmh2 == 0.0 {
        true => Ok(()),
        false => Err(ConfigError::Conflict(
            "resistance.davis: rolling_kgf_t, rolling_kgf_t_per_kmh and air_kgf_per_kmh2 must be 0 beside it".to_owned(),
        )),
    }
}

fn check_doors(data: &DoorData) -> Result<(), ConfigError> {
    check_ranges! { data, "doors.";
        opening_s: 0.1, 60.0;
        closing_s: 0.1, 60.0;
    }
    Ok(())
}

fn check_car(number: usize, car: &CarData) -> Result<(), ConfigError> {
    for (key, value, low, high) in [
        ("pair", car.pair as f64, 1.0, MAX_CARS as f64),
        ("length_m", car.length_m, 5.0, 40.0),
        ("empty_kg", car.empty_kg, 1e3, 2e5),
        ("bogies_kg", car.bogies_kg, 0.0, car.empty_kg),
        ("rotating_kg", car.rotating_kg, 1.0, 5e4),
        ("full_load_kg", car.full_load_kg, 0.0, 1e5),
        ("air_n", car.air_n, 0.0, 1e6),
    ] {
        let key = format!("cars {number} ({}): {key}", car.name);
        within(&key, value, low, high)?;
    }
    Ok(())
}

/// Pairs are numbered without a gap, and each has a motor car.
fn check_pairs(data: &CarsData) -> Result<(), ConfigError> {
    let last = data.cars.iter().map(|car| car.pair).max().unwrap_or(0);
    for pair in 1..=last {
        let mut cars = data.cars.iter().filter(|car| car.pair == pair);
        if !cars.any(|car| car.role == Role::Motor) {
            return Err(ConfigError::Conflict(format!(
                "pair {pair}: a pair needs a motor car"
            )));
        }
    }
    Ok(())
}

/// Air alone must be able to give full service braking of a full train.
fn check_air(data: &CarsData) -> Result<(), ConfigError> {
    for pair in 1..=MAX_CARS {
        let cars = || data.cars.iter().filter(|car| car.pair == pair);
        let needs_n =
            cars().map(CarData::full_inertia_kg).sum::<f64>() * data.service_brake.kmh_per_s / 3.6;
        let has_n = cars().map(|car| car.air_n).sum::<f64>();
        // S3's table is rounded to newtons.
        if has_n < 0.999 * needs_n {
            return Err(ConfigError::Conflict(format!(
                "pair {pair}: air_n of {has_n:.0} N in all is less than full service of the full train, {needs_n:.0} N"
            )));
        }
    }
    Ok(())
}

fn ranges(data: &CarsData) -> Result<(), ConfigError> {
    check_ranges! { data, "";
        traction.full_load_n: 1e3, 1e7;
        traction.base_speed_kmh: 1.0, 200.0;
        traction.jerk_mps3: 0.1, 100.0;
        traction.dead_time_s: 0.0, MAX_TIME_S;
        traction.lag_s: 0.0, MAX_TIME_S;
        electric_brake.adhesion_limit: 0.0, 0.5;
        electric_brake.full_to_kmh: 1.0, 200.0;
        electric_brake.fade_from_kmh: 0.1, 200.0;
        electric_brake.fade_to_kmh: 0.0, 200.0;
        service_brake.kmh_per_s: 0.1, 10.0;
        service_brake.holding_share: 0.0, 1.0;
        service_brake.security_share: 0.5, 1.3;
        service_brake.parking_share: 0.0, 1.0;
        service_brake.dead_time_s: 0.0, MAX_TIME_S;
        service_brake.build_up_s: 0.0, MAX_TIME_S;
        service_brake.release_s: 0.0, MAX_TIME_S;
        emergency_brake.kmh_per_s: 0.1, 10.0;
        emergency_brake.dead_time_s: 0.0, MAX_TIME_S;
        emergency_brake.build_up_s: 0.0, MAX_TIME_S;
        emergency_brake.release_s: 0.0, MAX_TIME_S;
        resistance.starting_kgf_t: 0.0, 50.0;
        resistance.starting_kmh: 0.0, 20.0;
        resistance.rolling_kgf_t: 0.0, 50.0;
        resistance.rolling_kgf_t_per_kmh: 0.0, 1.0;
        resistance.air_kgf_per_kmh2: 0.0, 10.0;
        resistance.tunnel_kgf_t: 0.0, 20.0;
        resistance.curve_kgf_m_t: 0.0, 5000.0;
        wheels.sliding_share: 0.1, 1.0;
        wheels.protection_mps: 0.05, 20.0;
        wheels.release_s: 0.01, 10.0;
        wheels.restore_s: 0.01, 60.0;
    }
    Ok(())
}
