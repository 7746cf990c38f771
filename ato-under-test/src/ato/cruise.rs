//! Speed to run at: the most restrictive of limit and fixed speed, lowered by running mode
//! [S0 §3.1.1, S2 §3.2], and of lower limits ahead.

use protocol::Speed;
use protocol::config::AtoConfig;
use protocol::message::RunningMode;

use super::AtoInputs;
use super::track_limit::{TrainPosition, limit_ahead};

/// Inputs of the cruising speed.
#[derive(Clone, Copy, Debug)]
pub struct CruiseInputs {
    /// Limit from ATP.
    pub limit: Speed,
    /// Fixed speed ordered by the wayside.
    pub fixed_speed: Option<Speed>,
    pub running_mode: RunningMode,
}

/// The cruising speed where the train is. `slowing_m` tells in which way it slows from one speed to a lower one, m/s.
pub fn on_track(
    inputs: &AtoInputs<'_>,
    config: &AtoConfig,
    slowing_m: impl Fn(f64, f64) -> f64,
) -> Speed {
    let under = |limit: Speed| {
        let inputs = CruiseInputs {
            limit,
            fixed_speed: inputs.fixed_speed,
            running_mode: inputs.running_mode,
        };
        cruise(inputs, config)
    };
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

/// The cruising speed in force.
pub fn cruise(inputs: CruiseInputs, config: &AtoConfig) -> Speed {
    let lowering = match inputs.running_mode {
        RunningMode::Recovery => 0.0,
        _ => config.normal_lowering_kmh,
    };
    let below = Speed::from_kmh(config.below_limit_kmh + lowering);
    let allowed = (inputs.limit - below).max(Speed::ZERO);
    let slow = (inputs.running_mode == RunningMode::Slow).then_some(config.slow_kmh);
    [slow.map(Speed::from_kmh), inputs.fixed_speed]
        .into_iter()
        .flatten()
        .fold(allowed, Speed::min)
}

#[cfg(test)]
mod tests {
    use super::super::tests::config;
    use super::*;

    /// Limit, order, running mode and the speed to run at, km/h; lowering 5 and 3 km/h, slow at 25.
    #[test]
    fn the_most_restrictive_counts() {
        use RunningMode::{Normal, Recovery, Slow, Unknown};
        let mut config = config();
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
            let inputs = CruiseInputs {
                limit: Speed::from_kmh(limit),
                fixed_speed: fixed.map(Speed::from_kmh),
                running_mode,
            };
            let got = cruise(inputs, &config).kmh();
            assert!((got - expected).abs() < 1e-9, "{inputs:?}: {got}");
        }
    }
}
