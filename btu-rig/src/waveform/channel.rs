//! Disturbances of the signals on their way into a coil: gain, noise, hum of the supply, a line of an inverter that
//! sweeps in frequency, dropouts and clipping.

use protocol::Random;
use protocol::config::{ConfigError, within};
use serde::{Deserialize, Serialize};

use super::{Phase, cosine};

/// Disturbances of all coils; a disturbance that is left out does not act.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ChannelConfig {
    /// Ratio of the level behind the channel to the level before it.
    pub gain: f64,
    /// White noise, mV rms over all frequencies up to half of the sample rate.
    pub noise_mv: f64,
    /// Hum of the supply: level of its first line, mV rms; line n has 1/n of this level.
    pub hum_mv: f64,
    /// Frequency of the supply, Hz.
    pub hum_hz: f64,
    pub hum_lines: u32,
    /// Level of the traction inverter's line, mV rms.
    pub inverter_mv: f64,
    /// Least and greatest frequency of the inverter's line, Hz, which sweeps up and down between them.
    pub inverter_hz: [f64; 2],
    /// Time of one sweep of the inverter's line, up and down, s.
    pub inverter_sweep_s: f64,
    /// Mean number of dropouts, 1/s.
    pub dropouts_per_s: f64,
    /// Duration of a drop-out, s.
    pub dropout_s: f64,
    /// Greatest amplitude that passes, mV.
    pub clip_mv: f64,
}

impl Default for ChannelConfig {
    fn default() -> Self {
        Self {
            gain: 1.0,
            noise_mv: 0.0,
            hum_mv: 0.0,
            hum_hz: 60.0,
            hum_lines: 9,
            inverter_mv: 0.0,
            inverter_hz: [400.0, 4_000.0],
            inverter_sweep_s: 20.0,
            dropouts_per_s: 0.0,
            dropout_s: 0.02,
            clip_mv: 3_000.0,
        }
    }
}

impl ChannelConfig {
    /// Reads a channel.
    ///
    /// # Errors
    /// The text does not parse, or a value is out of its range; the error names the key.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        let channel: Self =
            toml::from_str(text).map_err(|error| ConfigError::Syntax(error.to_string()))?;
        protocol::check_ranges! { channel, "";
            gain: 0.0, 1e6;
            noise_mv: 0.0, 1e6;
            hum_mv: 0.0, 1e6;
            hum_hz: 0.0, 1e6;
            hum_lines: 0.0, 200.0;
            inverter_mv: 0.0, 1e6;
            inverter_sweep_s: 0.0, 1e6;
            dropouts_per_s: 0.0, 1e6;
            dropout_s: 0.0, 1e6;
            clip_mv: 0.0, 1e6;
        }
        for hz in channel.inverter_hz {
            within("inverter_hz", hz, 0.0, 1e6)?;
        }
        Ok(channel)
    }
}

/// The channel of one coil.
#[derive(Clone, Debug)]
pub struct Channel {
    config: ChannelConfig,
    sample_hz: f64,
    random: Random,
    hum: Phase,
    inverter: Phase,
    sweep: Phase,
    /// Samples left of a dropout.
    dropout: f64,
    nothing: bool,
}

impl Channel {
    /// A channel whose disturbances are drawn from `random`.
    pub fn new(config: &ChannelConfig, sample_hz: f64, random: Random) -> Self {
        let nothing = ChannelConfig {
            clip_mv: config.clip_mv,
            ..ChannelConfig::default()
        };
        Self {
            nothing: *config == nothing,
            config: config.clone(),
            sample_hz,
            random,
            hum: Phase::default(),
            inverter: Phase::default(),
            sweep: Phase::default(),
            dropout: 0.0,
        }
    }

    /// Disturbs these samples, mV.
    pub fn disturb(&mut self, samples: &mut [f64]) {
        let clip = self.config.clip_mv;
        for sample in samples {
            if !self.nothing {
                *sample = self.disturbed(*sample);
            }
            *sample = sample.clamp(-clip, clip);
        }
    }

    fn disturbed(&mut self, sample: f64) -> f64 {
        let config = &self.config;
        let mut sum = config.gain * sample;
        if config.dropouts_per_s > 0.0 {
            if self.dropout <= 0.0 && self.random.chance(config.dropouts_per_s / self.sample_hz) {
                self.dropout = config.dropout_s * self.sample_hz;
            }
            self.dropout -= 1.0;
            if self.dropout > 0.0 {
                sum = 0.0;
            }
        }
        let peak = std::f64::consts::SQRT_2;
        if config.hum_mv > 0.0 {
            let cycles = self.hum.step(config.hum_hz / self.sample_hz);
            for line in 1..=config.hum_lines {
                let line = f64::from(line);
                sum += peak * config.hum_mv / line * cosine(cycles * line);
            }
        }
        if config.inverter_mv > 0.0 {
            let way = self
                .sweep
                .step(1.0 / (config.inverter_sweep_s * self.sample_hz).max(1.0));
            let [low, high] = config.inverter_hz;
            let now_hz = low + (high - low) * (1.0 - (2.0 * way - 1.0).abs());
            sum += peak * config.inverter_mv * cosine(self.inverter.step(now_hz / self.sample_hz));
        }
        if config.noise_mv > 0.0 {
            sum += config.noise_mv * nearly_normal(self.random.bits());
        }
        sum
    }
}

/// A number of standard deviation 1 whose distribution is nearly normal: the sum of four uniform numbers.
fn nearly_normal(bits: u64) -> f64 {
    let parts = [0, 16, 32, 48].map(|shift| f64::from((bits >> shift) as u16));
    (parts.iter().sum::<f64>() / 65_536.0 - 2.0) * 3f64.sqrt()
}
