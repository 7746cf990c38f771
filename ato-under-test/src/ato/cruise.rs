//! Speed to run at: the limit, or a lower one ahead, less a margin that depends on the running mode; no more than the
//! fixed speed, and in slow running no more than `slow_kmh` [S0 §3.1.1, S2 §3.2].

use protocol::Speed;
use protocol::config::AtoConfig;
use protocol::message::RunningMode;

use super::inputs::AtoInputs;
use super::track_limit::{TrainPosition, limit_ahead};

/// The cruising speed where the train is. `slowing_m` gives the distance, m, in which the train slows from one speed to
/// a lower one, both in m/s.
pub fn on_track(
    inputs: &AtoInputs<'_>,
    config: &AtoConfig,
    slowing_m: impl Fn(f64, f64) -> f64,
) -> Speed {
    let under = |limit| cruise(limit, inputs.fixed_speed, inputs.running_mode, config);
    let place = TrainPosition {
        section: inputs.section,
        position_m: inputs.position_m,
        heard_within_m: inputs.speed.mps() * inputs.heard_within_s,
        length_m: config.train.length_m,
        limit: inputs.limit,
    };
    let now_mps = under(inputs.limit).mps();
    let limit = limit_ahead(place, inputs.codes, |lower| {
        slowing_m(now_mps, under(lower).mps())
    });
    under(limit)
}

/// The cruising speed under a limit, with the fixed speed that the wayside has ordered.
pub fn cruise(
    limit: Speed,
    fixed_speed: Option<Speed>,
    running_mode: RunningMode,
    config: &AtoConfig,
) -> Speed {
    let lowering = match running_mode {
        RunningMode::Recovery => 0.0,
        _ => config.normal_lowering_kmh,
    };
    let below = Speed::from_kmh(config.below_limit_kmh + lowering);
    let allowed = (limit - below).max(Speed::ZERO);
    let slow = (running_mode == RunningMode::Slow).then_some(config.slow_kmh);
    [slow.map(Speed::from_kmh), fixed_speed]
        .into_iter()
        .flatten()
        .fold(allowed, Speed::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::sg100;

    /// Limit, order, running mode and the speed to run at, km/h; lowering 5 and 3 km/h, slow at 25.
    #[test]
    fn the_most_restrictive_counts() {
        use RunningMode::{Normal, Recovery, Slow, Unknown};
        let mut config = sg100().ato;
        config.below_limit_kmh = 5.0;
        config.normal_lowering_kmh = 3.0;
        config.slow_kmh = 25.0;
        for (limit, fixed, running_mode, expected) in [
            (65.0, None, Recovery, 60.0),
            (65.0, None, Normal, 57.0),
            (65.0, None, Unknown(3), 57.0),
            (65.0, None, Slow, 25.0),
            (65.0, Some(20.0), Slow, 20.0),
            (25.0, None, Slow, 17.0),
            (65.0, Some(40.0), Recovery, 40.0),
            (45.0, Some(60.0), Recovery, 40.0),
            (0.0, Some(60.0), Recovery, 0.0),
        ] {
            let (most, order) = (Speed::from_kmh(limit), fixed.map(Speed::from_kmh));
            let got = cruise(most, order, running_mode, &config).kmh();
            assert!(
                (got - expected).abs() < 1e-9,
                "{limit}, {fixed:?}, {running_mode:?}: {got}"
            );
        }
    }
}
