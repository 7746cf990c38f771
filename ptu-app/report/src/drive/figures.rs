//! The figures of a run, with the names and units that all reports use.

use btu_rig::conditions::{Conditions, Disturbance};
use btu_rig::drive::{Metrics, Outcome};

use ptu_bench::drive::monte_carlo::Trial;
use ptu_bench::drive::{Case, Driven};

/// A figure of a run.
pub struct Figure {
    /// Key in JSON and CSV, ending in its unit.
    pub key: &'static str,
    /// Name for people.
    pub name: &'static str,
    /// Unit for people.
    pub unit: &'static str,
    /// Decimals for people.
    pub decimals: usize,
    /// Its value.
    pub of: fn(&Metrics) -> f64,
}

const fn figure(
    key: &'static str,
    name: &'static str,
    unit: &'static str,
    decimals: usize,
    of: fn(&Metrics) -> f64,
) -> Figure {
    Figure {
        key,
        name,
        unit,
        decimals,
        of,
    }
}

/// All but the stop error.
pub const FIGURES: [Figure; 9] = [
    figure("run_time_s", "Run time", "s", 1, |m| m.run_time_s),
    figure("peak_speed_kmh", "Greatest speed", "km/h", 1, |m| {
        m.peak_speed_kmh
    }),
    figure(
        "peak_accel_kmh_s",
        "Greatest acceleration",
        "km/h/s",
        2,
        |m| m.peak_accel_kmh_s,
    ),
    figure(
        "peak_decel_kmh_s",
        "Greatest deceleration",
        "km/h/s",
        2,
        |m| m.peak_decel_kmh_s,
    ),
    figure("peak_jerk_m_s3", "Greatest jerk", "m/s³", 2, |m| {
        m.peak_jerk_m_s3
    }),
    figure("rms_jerk_m_s3", "Jerk, rms", "m/s³", 3, |m| {
        m.rms_jerk_m_s3
    }),
    figure(
        "rough_share",
        "Time with jerk above 0.8 m/s³",
        "%",
        2,
        |m| m.rough_share,
    ),
    figure("rms_speed_error_kmh", "Speed error, rms", "km/h", 2, |m| {
        m.rms_speed_error_kmh
    }),
    figure(
        "energy_kwh",
        "Traction energy at the wheels",
        "kWh",
        2,
        |m| m.energy_kwh,
    ),
];

impl Figure {
    /// Its value of a run for people, without unit.
    pub fn shown(&self, metrics: &Metrics) -> String {
        self.told((self.of)(metrics))
    }

    /// A value of it for people, without unit.
    pub fn told(&self, value: f64) -> String {
        let scale = if self.unit == "%" { 100.0 } else { 1.0 };
        format!("{:.*}", self.decimals, value * scale)
    }
}

/// A stop error for people, signed: centimetres, from 1 m on metres.
pub fn off(metres: f64) -> String {
    if metres.abs() < 1.0 {
        format!("{:+.1} cm", metres * 100.0)
    } else {
        format!("{metres:+.2} m")
    }
}

/// Where a run stopped, and why if it was not at its stop point.
pub fn stop(trial: &Trial) -> String {
    match trial.stop_error_m {
        Some(error) if trial.stopped() => off(error),
        Some(error) => format!("{}, {}", trial.ending, off(error)),
        None => trial.ending.to_string(),
    }
}

/// How a run ended, for people.
pub fn ending(run: &Driven) -> String {
    let tolerance_cm = run.case.tolerance_m() * 100.0;
    let Outcome {
        ending,
        stop_error_m,
        ..
    } = &run.outcome;
    match stop_error_m {
        Some(error) => {
            let side = if *error > 0.0 { "past" } else { "before" };
            let verdict = if run.aligned() { "within" } else { "outside" };
            format!(
                "{ending}, {} {side} the stop point, {verdict} ±{tolerance_cm:.0} cm",
                off(error.abs()).trim_start_matches('+')
            )
        }
        None => ending.to_string(),
    }
}

/// Section and controller of a case.
pub fn title(case: &Case) -> String {
    format!(
        "{} section {}, {}",
        case.bench.line.content.name,
        case.plan.section.section,
        case.controller.name()
    )
}

/// Train and day of a run, as names and values for people. What is nominal is not named but for
/// train and load.
pub fn conditions(case: &Case) -> Vec<(&'static str, String)> {
    let plan = &case.plan;
    let nominal = Conditions::default();
    let c = &plan.conditions;
    let mass_kg: f64 = plan.train.cars(plan.load_kg).iter().map(|car| car.1).sum();
    let mut found = vec![
        (
            "Train",
            format!("{}, {:.1} t", plan.train.name(), mass_kg / 1000.0),
        ),
        ("Passengers", format!("{:.1} t", plan.load_kg / 1000.0)),
    ];
    for (name, value, usual, unit, decimals) in [
        (
            "Gradients",
            c.gradient_offset_permille,
            nominal.gradient_offset_permille,
            " ‰ added",
            2,
        ),
        ("Adhesion", c.adhesion, nominal.adhesion, "", 3),
        (
            "Delays",
            c.delay_factor,
            nominal.delay_factor,
            " of nominal",
            3,
        ),
        (
            "Brakes",
            c.brake_factor,
            nominal.brake_factor,
            " of nominal",
            3,
        ),
        (
            "Wheel diameter",
            c.wheel_factor,
            nominal.wheel_factor,
            " of configured",
            4,
        ),
    ] {
        if value != usual {
            found.push((name, format!("{value:.decimals$}{unit}")));
        }
    }
    if c.marker_offsets_m != nominal.marker_offsets_m {
        let offsets = c
            .marker_offsets_m
            .map(|m| format!("{:+.1}", m * 100.0))
            .join(", ");
        found.push(("Markers off by", format!("{offsets} cm")));
    }
    if let Disturbance::Sine {
        amplitude_n_s_per_m,
        hz,
    } = c.disturbance
    {
        found.push((
            "Disturbance",
            format!("{amplitude_n_s_per_m:.0} N·s/m at {hz} Hz"),
        ));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_metres_are_told_in_metres() {
        let told = [-0.015, 0.9994, 1.0, -847.22].map(off);
        assert_eq!(told, ["-1.5 cm", "+99.9 cm", "+1.00 m", "-847.22 m"]);
    }
}
