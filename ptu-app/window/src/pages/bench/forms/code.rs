//! Form for the ATP signal in the track.

use btu_rig::stimulus::{CodeSignal, Stimulus};
use protocol::config::{SpeedCode, UnitConfig};

use super::StimulusPath;

#[derive(Clone, Debug)]
pub struct CodeForm {
    /// Carrier, Hz.
    pub carrier_hz: f64,
    /// Code rate, Hz; 0 = unmodulated.
    pub rate_hz: f64,
    /// Level, mV; also used for the codes of the table.
    pub level_mv: f64,
    /// Drift of the code rate, Hz/s.
    pub rate_drift_hz_per_s: f64,
    /// Drift of the level, mV/s.
    pub level_drift_mv_per_s: f64,
}

impl CodeForm {
    /// The last code of the table at its nominal level, drifting slowly.
    pub fn new(config: &UnitConfig) -> Self {
        let (carrier_hz, rate_hz) = config
            .codes
            .last()
            .map_or((0.0, 0.0), |code| (code.carrier_hz, code.rate_hz));
        Self {
            carrier_hz,
            rate_hz,
            level_mv: config.receiver.level_nominal_mv,
            rate_drift_hz_per_s: 0.1,
            level_drift_mv_per_s: -20.0,
        }
    }

    /// A signal of the entered carrier, code rate and level.
    pub fn free(&self, way: StimulusPath) -> Stimulus {
        self.signal(self.carrier_hz, self.rate_hz, way)
    }

    /// A code of the table at the entered level.
    pub fn of_table(&self, code: &SpeedCode, way: StimulusPath) -> Stimulus {
        self.signal(code.carrier_hz, code.rate_hz, way)
    }

    /// Lets the present signal drift.
    pub fn drift(&self) -> Stimulus {
        Stimulus::CodeDrift {
            rate_hz_per_s: self.rate_drift_hz_per_s,
            level_mv_per_s: self.level_drift_mv_per_s,
        }
    }

    fn signal(&self, carrier_hz: f64, rate_hz: f64, way: StimulusPath) -> Stimulus {
        let signal = CodeSignal::new(carrier_hz, rate_hz, self.level_mv);
        match way {
            StimulusPath::Harness => Stimulus::Code(signal),
            StimulusPath::TestBoard => Stimulus::PtuCode(signal),
        }
    }
}

/// Ends the drift; the signal stays as it is.
pub const NO_DRIFT: Stimulus = Stimulus::CodeDrift {
    rate_hz_per_s: 0.0,
    level_mv_per_s: 0.0,
};

#[cfg(test)]
mod tests {
    use super::*;

    const SG100: &str = include_str!("../../../../../../scripts/units/sg100.toml");

    #[test]
    fn a_code_of_the_table_has_its_carrier_and_rate_at_the_level_filled_in() {
        let config = UnitConfig::from_toml(SG100).expect("configuration");
        let mut form = CodeForm::new(&config);
        assert_eq!(form.level_mv, config.receiver.level_nominal_mv);
        form.level_mv = 80.0;
        let code = &config.codes[4];
        let signal = CodeSignal::new(code.carrier_hz, code.rate_hz, 80.0);
        assert_eq!(
            form.of_table(code, StimulusPath::Harness),
            Stimulus::Code(signal)
        );
        assert_eq!(
            form.of_table(code, StimulusPath::TestBoard),
            Stimulus::PtuCode(signal)
        );
    }

    #[test]
    fn free_values_and_drifts_go_as_they_are_filled_in() {
        let config = UnitConfig::from_toml(SG100).expect("configuration");
        let form = CodeForm {
            carrier_hz: 3_040.0,
            rate_hz: 0.0,
            rate_drift_hz_per_s: -0.5,
            ..CodeForm::new(&config)
        };
        assert_eq!(
            form.free(StimulusPath::Harness),
            Stimulus::Code(CodeSignal::new(3_040.0, 0.0, 500.0))
        );
        assert_eq!(
            form.drift(),
            Stimulus::CodeDrift {
                rate_hz_per_s: -0.5,
                level_mv_per_s: -20.0
            }
        );
    }
}
