//! What was done in a run, and what came of it in MT pair 1, which S3 plots.

use btu_rig::drive::manual::{Done, Pair, Settled, settled};

use crate::drive::manual::ManualRun;

/// Time after which the efforts a deed came to are told, s: jerk limit and lags are over.
const LATER_S: f64 = 3.0;

/// A deed and what came of it.
pub struct Deed<'a> {
    /// What was done.
    pub done: &'a Done,
    /// How the brake settled.
    pub settled: Option<Settled>,
    /// MT pair 1 a few seconds later, or just before the next deed.
    pub pair: Option<Pair>,
}

/// All deeds of a run.
pub fn deeds(run: &ManualRun) -> Vec<Deed<'_>> {
    let outcome = &run.outcome;
    let ends = outcome.done.iter().skip(1).map(|next| next.t_s);
    let ends = ends.chain([f64::INFINITY]);
    let deeds = outcome.done.iter().zip(ends);
    deeds
        .map(|(done, until_s)| {
            let at_s = (done.t_s + LATER_S).min(until_s);
            let row = outcome.row_at(at_s).filter(|row| row.t_s > done.t_s);
            Deed {
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

/// A deed as cells of a table, the efforts of MT pair 1 afterwards last.
pub fn cells(deed: &Deed<'_>) -> [String; 9] {
    // Adding nothing takes the sign off a nothing.
    let kn = |of: fn(&Pair) -> f64| {
        let pair = deed.pair.as_ref();
        pair.map_or("–".into(), |pair| {
            format!("{:.2}", of(pair) / 1000.0 + 0.0)
        })
    };
    [
        format!("{:.2}", deed.done.t_s),
        format!("{:.1}", deed.done.speed_kmh),
        deed.done.what(),
        deed.settled
            .map_or("–".into(), |settled| format!("{:.2}", settled.after_s)),
        kn(|pair| pair.traction_n),
        kn(|pair| pair.electric_n),
        kn(|pair| pair.air_t_n),
        kn(|pair| pair.air_m_n),
        kn(Pair::brake_n),
    ]
}
