//! Steps of a manual run with their results in MT pair 1, the pair that S3 plots.

use btu_rig::drive::manual::{Done, Pair, Settled, settled};

use ptu_bench::drive::manual::ManualRun;

/// Time after which the efforts after a step are reported, s: jerk limit and lags are over.
const LATER_S: f64 = 3.0;

/// A step and its result.
pub struct StepResult<'a> {
    /// What was done.
    pub done: &'a Done,
    /// How the brake settled.
    pub settled: Option<Settled>,
    /// MT pair 1 a few seconds later, or just before the next step.
    pub pair: Option<Pair>,
}

/// Results of all steps of a run.
pub fn step_results(run: &ManualRun) -> Vec<StepResult<'_>> {
    let outcome = &run.outcome;
    let ends = outcome.done.iter().skip(1).map(|next| next.t_s);
    let ends = ends.chain([f64::INFINITY]);
    let steps = outcome.done.iter().zip(ends);
    steps
        .map(|(done, until_s)| {
            let at_s = (done.t_s + LATER_S).min(until_s);
            let row = outcome.row_at(at_s).filter(|row| row.t_s > done.t_s);
            StepResult {
                done,
                settled: settled(&outcome.rows, done.t_s, until_s),
                pair: row.map(|row| row.pairs[0]),
            }
        })
        .collect()
}

/// Headings of [`cells`].
pub const HEADINGS: [&str; 9] = [
    "Time s",
    "km/h",
    "Done",
    "Brake within 2 % after s",
    "TE kN",
    "Electric kN",
    "Air T kN",
    "Air M kN",
    "Brake kN",
];

/// A step as cells of a table, the efforts of MT pair 1 afterwards last.
pub fn cells(result: &StepResult<'_>) -> [String; 9] {
    // Adding nothing takes the sign off a nothing.
    let kn = |of: fn(&Pair) -> f64| {
        let pair = result.pair.as_ref();
        pair.map_or("–".into(), |pair| {
            format!("{:.2}", of(pair) / 1000.0 + 0.0)
        })
    };
    [
        format!("{:.2}", result.done.t_s),
        format!("{:.1}", result.done.speed_kmh),
        result.done.what(),
        result
            .settled
            .map_or("–".into(), |settled| format!("{:.2}", settled.after_s)),
        kn(|pair| pair.traction_n),
        kn(|pair| pair.electric_n),
        kn(|pair| pair.air_t_n),
        kn(|pair| pair.air_m_n),
        kn(Pair::brake_n),
    ]
}
