//! `ptu signal calibrate`: measures the voltage of a sound card's full scale against an instrument.

use clap::Args;
use protocol::config::UnitConfig;
use ptu_report::words::{Words, fill};
use std::fmt::Display;

use super::positive;
use super::sound::{Channel, Device};
use crate::cli::print_out;
use ptu_options::sound_file;
use ptu_runs::clock;
use ptu_runs::failure::{Exit, Failure, SoundTrouble};
use ptu_runs::signal;
use ptu_runs::sound::{
    self, CHANNELS, Calibration, Calibrations, Direction, Lead, SAMPLE_HZ, Side,
};
use ptu_runs::stdio;
use ptu_runs::stop::Stop;
use ptu_runs::typed::{Typed, somebody_is_there};

/// Time for which the reference is played with --measured, s.
const REFERENCE_S: f64 = 5.0;
/// Time for which a level at an input is measured, s.
const MEASURED_S: f64 = 1.0;

/// Calibrate a channel of a sound card against an instrument
///
/// Output: a carrier is played at the level; enter what the instrument at the coil shows. Input: apply a carrier of the
/// level; what the card makes of it is measured. The calibration is stored for this user.
///
/// Examples:
///   ptu signal calibrate --device coil --level 500 --instrument 'Fluke 87 serial 123' --within 2%
///   ptu signal calibrate --device coil.monitor --input --level 500 --instrument 'calibrator 7' --within 1%
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct CalibrateArguments {
    #[command(flatten)]
    device: Device,
    /// Channel
    #[arg(long, value_name = "atp|twc|both", default_value = "atp")]
    channel: Channel,
    /// Calibrate the input, to which a carrier of this level is applied
    #[arg(long, conflicts_with_all = ["measured", "seconds"])]
    input: bool,
    /// Level of the reference carrier, mV rms
    #[arg(long, value_name = "MV", default_value_t = 500.0, value_parser = positive)]
    level: f64,
    /// What the instrument showed, mV rms [default: asked for while the reference is played]
    #[arg(long, value_name = "MV", value_parser = positive)]
    measured: Option<f64>,
    /// With --measured: time for which the reference is played, s [default: 5]
    #[arg(long, value_name = "S", value_parser = positive, requires = "measured")]
    seconds: Option<f64>,
    /// The instrument, with its serial number
    #[arg(long, value_name = "TEXT")]
    instrument: String,
    /// Uncertainty of the instrument, as 2%
    #[arg(long = "within", value_name = "PERCENT", value_parser = percent)]
    uncertainty: f64,
    #[command(flatten)]
    unit: super::UnitChoice,
}

impl CalibrateArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        let unit = self.unit.find()?;
        let file = sound_file()?;
        let mut known = Calibrations::load(&file)?;
        let device = self.device.device.as_str();
        let stop = Stop::default();
        stop.listen();
        let direction = if self.input {
            Direction::Input
        } else {
            Direction::Output
        };
        let now = known.full_scale_mv(device, direction);
        let measured = match self.input {
            true => self.applied((device, now), &unit, &stop)?,
            false => self.heard((device, now), &unit, &stop)?,
        };
        if stop.presses() > 0 {
            stdio::note(Words::shown().signals.not_stored);
            return Ok(Exit::Aborted);
        }
        let mut lines = Vec::new();
        for (side, (now, measured)) in Side::ALL.into_iter().zip(now.into_iter().zip(measured)) {
            if !self.channel.has(side) {
                continue;
            }
            // Factor on the assumed full scale: measured / level for an output, level / measured for an input.
            let full_scale_mv = match self.input {
                true => now * self.level / measured,
                false => now * measured / self.level,
            };
            if !(1e-3..1e9).contains(&full_scale_mv) {
                return Err(Failure::usage(SoundTrouble::Implausible(
                    side.name(),
                    format!("{measured:.3}"),
                    self.level,
                )));
            }
            known.keep(
                Calibration {
                    device: device.to_owned(),
                    direction,
                    channel: side,
                    full_scale_mv,
                    at_us: clock::now_us(),
                    instrument: self.instrument.clone(),
                    uncertainty_percent: self.uncertainty,
                },
                &file,
            )?;
            let of: [(_, &dyn Display); 5] = [
                ("device", &device),
                ("channel", &side.name()),
                ("mv", &format!("{full_scale_mv:.1}")),
                ("percent", &self.uncertainty),
                ("by", &self.instrument),
            ];
            lines.push(fill(Words::shown().signals.scale_of, &of));
        }
        print_out(&lines.join("\n"))
    }

    /// Level that the instrument shows while the reference is played, mV rms: `--measured`, or typed by a person.
    fn heard(
        &self,
        device: (&str, [f64; CHANNELS]),
        unit: &UnitConfig,
        stop: &Stop,
    ) -> Result<[f64; CHANNELS], Failure> {
        if self.measured.is_none() && !somebody_is_there() {
            return Err(Failure::usage(SoundTrouble::NobodyAsked));
        }
        let seconds = match self.measured {
            Some(_) => self.seconds.unwrap_or(REFERENCE_S),
            None => f64::MAX,
        };
        let typed = self.measured.is_none().then(Typed::listen);
        if typed.is_some() {
            let said = Words::shown().signals.play_reference;
            stdio::note(&fill(said, &[("mv", &self.level)]));
        }
        let mut answer = self.measured;
        let tones = signal::reference_hz(unit);
        let rate = f64::from(SAMPLE_HZ);
        let mut at = 0u64;
        let samples = std::iter::from_fn(|| {
            if at as f64 >= seconds * rate {
                return None;
            }
            // Looks for a typed line every 10 ms (480 samples).
            if at.is_multiple_of(480)
                && let Some(typed) = &typed
            {
                for line in typed.lines() {
                    match positive(line.trim_end_matches("mV").trim()) {
                        Ok(number) => answer = Some(number),
                        Err(why) => stdio::note(&why),
                    }
                }
                if answer.is_some() {
                    return None;
                }
            }
            let mut together = [0.0; CHANNELS];
            for (place, side) in Side::ALL.into_iter().enumerate() {
                if self.channel.has(side) {
                    let turns = (at as f64 * tones[place] / rate).fract();
                    let amplitude = self.level * std::f64::consts::SQRT_2;
                    together[place] = amplitude * (std::f64::consts::TAU * turns).cos();
                }
            }
            at += 1;
            Some(together)
        });
        let played = sound::play(samples, Lead::Within, device, stop)?;
        if played.clipped > 0 {
            return Err(Failure::usage(SoundTrouble::TooLoud(self.level)));
        }
        Ok([answer.unwrap_or(0.0); CHANNELS])
    }

    /// Level of the applied carrier as the device records it, mV rms: what lies within 2 Hz of the reference.
    fn applied(
        &self,
        device: (&str, [f64; CHANNELS]),
        unit: &UnitConfig,
        stop: &Stop,
    ) -> Result<[f64; CHANNELS], Failure> {
        let tones = signal::reference_hz(unit);
        let rate = f64::from(SAMPLE_HZ);
        let mut sums = [[0.0; 2]; CHANNELS];
        let mut count = 0usize;
        let half = (MEASURED_S * rate) as usize;
        // The first second is left out: the card has just started.
        sound::record(device, Some(2.0 * MEASURED_S), stop, &mut |block| {
            for place in 0..block[0].len() {
                if count >= half {
                    let hann = 0.5
                        - 0.5 * (std::f64::consts::TAU * (count - half) as f64 / half as f64).cos();
                    for ((sum, samples), hz) in sums.iter_mut().zip(block).zip(tones) {
                        let angle = std::f64::consts::TAU * (count as f64 * hz / rate).fract();
                        let value = hann * f64::from(samples[place]);
                        sum[0] += value * angle.cos();
                        sum[1] += value * angle.sin();
                    }
                }
                count += 1;
            }
            Ok(())
        })?;
        // A sum is half the amplitude, times the mean of the Hann window (1/2), times the number of samples.
        Ok(sums.map(|[re, im]| re.hypot(im) * 4.0 / half as f64 / std::f64::consts::SQRT_2))
    }
}

fn percent(text: &str) -> Result<f64, String> {
    let number = text.trim_end_matches('%').trim().parse();
    match number {
        Ok(number) if (0.0..=100.0).contains(&number) => Ok(number),
        _ => Err("an uncertainty is 0 to 100 %, as 2%".to_owned()),
    }
}
