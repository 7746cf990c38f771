//! Sentences of reports on a run: its end, on which train and bench, under which conditions.

use btu_rig::conditions::{Conditions, Disturbance};

use ptu_runs::drive::monte_carlo::Trial;
use ptu_runs::drive::{Case, Driven};

use crate::words::{Language, Words, fill};

/// A name and its value.
pub type Fact = (&'static str, String);

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

/// Sentence that says how a drive ended, in English.
pub fn ending(run: &Driven) -> String {
    let ending = &run.outcome.ending;
    match run.outcome.stop_error_m {
        Some(_) => format!("{ending}, {}", standing(run, Language::English.words())),
        None => ending.to_string(),
    }
}

/// Where the train stands, before or past the stop point.
pub fn standing(run: &Driven, words: &Words) -> String {
    let said = &words.drive;
    let Some(error) = run.outcome.stop_error_m else {
        return said.did_not_stop.to_owned();
    };
    let tolerance_m = run.case.tolerance_m();
    let wording = match (error > 0.0, error.abs() <= tolerance_m) {
        (false, true) => said.before_within,
        (false, false) => said.before_outside,
        (true, true) => said.past_within,
        (true, false) => said.past_outside,
    };
    let size = off(error.abs());
    let size = size.trim_start_matches('+');
    let tolerance_cm = format!("{:.0}", tolerance_m * 100.0);
    fill(wording, &[("error", &size), ("tolerance", &tolerance_cm)])
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

fn loaded(train: &str, mass_kg: f64, load_kg: f64) -> [Fact; 2] {
    [
        ("Train", format!("{train}, {:.1} t", mass_kg / 1000.0)),
        ("Passengers", format!("{:.1} t", load_kg / 1000.0)),
    ]
}

type Of = fn(&Conditions) -> f64;

/// Train and day of a run. Nominal conditions are left out; train and load are always named.
pub fn conditions(case: &Case) -> Vec<Fact> {
    let plan = &case.plan;
    let nominal = Conditions::default();
    let c = &plan.conditions;
    let mass_kg: f64 = plan.train.cars(plan.load_kg).iter().map(|car| car.1).sum();
    let mut found = Vec::from(loaded(plan.train.name(), mass_kg, plan.load_kg));
    let factors: [(_, Of, _, _); 5] = [
        ("Gradients", |c| c.gradient_offset_permille, " ‰ added", 2),
        ("Adhesion", |c| c.adhesion, "", 3),
        ("Delays", |c| c.delay_factor, " of nominal", 3),
        ("Brakes", |c| c.brake_factor, " of nominal", 3),
        ("Wheel diameter", |c| c.wheel_factor, " of configured", 4),
    ];
    for (name, of, unit, decimals) in factors {
        if of(c) != of(&nominal) {
            found.push((name, format!("{:.decimals$}{unit}", of(c))));
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
