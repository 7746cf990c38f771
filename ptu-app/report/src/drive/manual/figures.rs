//! The figures of a run by hand under the names and in the units all its reports use.

use btu_rig::drive::manual::Figures;

use ptu_bench::drive::manual::ManualRun;

/// A figure.
pub struct Figure {
    /// Key in JSON, ending in its unit.
    pub key: &'static str,
    /// Name for people.
    pub name: &'static str,
    /// Unit for people.
    pub unit: &'static str,
    /// What a value is multiplied by for people, and with how many decimals it is shown.
    shown: (f64, usize),
    /// Its value, if the run shows it.
    pub of: fn(&Figures) -> Option<f64>,
}

const fn kmh_s(key: &'static str, name: &'static str, of: fn(&Figures) -> Option<f64>) -> Figure {
    figure(key, name, "km/h/s", (1.0, 3), of)
}

const fn kilonewtons(
    key: &'static str,
    name: &'static str,
    of: fn(&Figures) -> Option<f64>,
) -> Figure {
    figure(key, name, "kN", (1e-3, 2), of)
}

const fn percent(key: &'static str, name: &'static str, of: fn(&Figures) -> Option<f64>) -> Figure {
    figure(key, name, "%", (100.0, 2), of)
}

const fn figure(
    key: &'static str,
    name: &'static str,
    unit: &'static str,
    shown: (f64, usize),
    of: fn(&Figures) -> Option<f64>,
) -> Figure {
    Figure {
        key,
        name,
        unit,
        shown,
        of,
    }
}

/// All of them.
pub const FIGURES: [Figure; 18] = [
    kmh_s(
        "accel_0_35_kmh_s",
        "Acceleration at P4, 0 to 35 km/h",
        |f| f.accel_0_35_kmh_s,
    ),
    kmh_s(
        "accel_5_35_kmh_s",
        "Acceleration at P4, 5 to 35 km/h",
        |f| f.accel_5_35_kmh_s,
    ),
    kmh_s(
        "decel_60_20_kmh_s",
        "Deceleration at B7, 60 to 20 km/h",
        |f| f.decel_60_20_kmh_s,
    ),
    kmh_s("brake_60_20_kmh_s", "Of it by the brakes alone", |f| {
        f.brake_60_20_kmh_s
    }),
    figure("peak_speed_kmh", "Greatest speed", "km/h", (1.0, 1), |f| {
        Some(f.peak_speed_kmh)
    }),
    figure("peak_jerk_m_s3", "Greatest jerk", "m/s³", (1.0, 2), |f| {
        Some(f.peak_jerk_m_s3)
    }),
    kilonewtons("max_te_n", "Greatest TE, train", |f| Some(f.max_te_n)),
    kilonewtons("max_te_pair1_n", "Greatest TE, MT pair 1", |f| {
        Some(f.max_te_pair1_n)
    }),
    kilonewtons("full_service_n", "Full service of the car table", |f| {
        Some(f.full_service_n)
    }),
    kilonewtons("max_brake_demand_n", "Greatest brake demand", |f| {
        Some(f.max_brake_demand_n)
    }),
    kilonewtons(
        "max_electric_pair1_n",
        "Greatest electric brake, MT pair 1",
        |f| Some(f.max_electric_pair1_n),
    ),
    kilonewtons(
        "max_air_t_pair1_n",
        "Greatest air on T cars, MT pair 1",
        |f| Some(f.max_air_t_pair1_n),
    ),
    kilonewtons(
        "max_air_m_pair1_n",
        "Greatest air on M cars, MT pair 1",
        |f| Some(f.max_air_m_pair1_n),
    ),
    percent("electric_share", "Brake work by the electric brake", |f| {
        f.electric_share
    }),
    percent("air_share", "Brake work by air", |f| f.air_share),
    percent(
        "max_deviation_share",
        "Brake off its demand, outside transients",
        |f| f.max_deviation,
    ),
    percent(
        "max_deviation_electric_share",
        "The same before the electric brake fades",
        |f| f.max_deviation_electric,
    ),
    figure(
        "max_deviation_t_s",
        "Greatest of it at",
        "s",
        (1.0, 2),
        |f| f.max_deviation_t_s,
    ),
];

impl Figure {
    /// Its value for people, without unit.
    pub fn shown(&self, figures: &Figures) -> String {
        let (scale, decimals) = self.shown;
        (self.of)(figures).map_or("–".into(), |value| {
            format!("{:.decimals$}", value * scale)
        })
    }
}

/// Names and values of what was driven on what.
pub fn facts(run: &ManualRun) -> Vec<(&'static str, String)> {
    let plan = &run.case.plan;
    let cars = &plan.train.cars;
    let empty_kg: f64 = cars.iter().map(|car| car.empty_kg).sum();
    let mut facts = vec![
        (
            "Train",
            format!(
                "{}, {:.1} t",
                plan.train.name,
                (empty_kg + plan.load_kg) / 1000.0
            ),
        ),
        ("Passengers", format!("{:.1} t", plan.load_kg / 1000.0)),
        (
            "Line",
            format!("{} section {}", run.case.line, plan.section.section),
        ),
        (
            "Speed code",
            format!("{}, {:.0} km/h", plan.code, plan.limit_kmh),
        ),
    ];
    let added = plan.conditions.gradient_offset_permille;
    if added != 0.0 {
        facts.push(("Gradient", format!("{added:+.1} ‰ added")));
    }
    facts
}
