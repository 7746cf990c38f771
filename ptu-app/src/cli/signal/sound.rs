//! `ptu signal play`, `record`, `calibrate` and `devices`: waveforms to and from a sound card.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use protocol::config::UnitConfig;

use super::{Noisy, Scale, hex, positive};
use crate::cli::print_out;
use crate::sound_file;
use ptu_bench::clock;
use ptu_bench::data::check_writable;
use ptu_bench::failure::{Exit, Failure};
use ptu_bench::signal::{self, End, Samples, Wav, Wave};
use ptu_bench::sound::{
    self, CHANNELS, Calibration, Calibrations, Direction, Lead, SAMPLE_HZ, Side,
};
use ptu_bench::stdio;
use ptu_bench::stop::Stop;
use ptu_bench::table::Table;
use ptu_bench::typed::{Typed, somebody_is_there};

/// How long the reference is heard where nobody is asked, s.
const REFERENCE_S: f64 = 5.0;
/// How long a level at an input is measured, s.
const MEASURED_S: f64 = 1.0;

/// Play a WAV file, a speed code or TWC on a sound card
///
/// The first channel (left) is that of ATP, the second that of TWC. It begins 20 dB below its level and reaches it in
/// half a second. It stops within 100 ms of Ctrl-C, or when this program ends in any way.
///
/// Examples:
///   ptu signal play recording.wav --device coil
///   ptu signal play code 55 --level 300 --device coil      until Ctrl-C
///   ptu signal play twc '01 fe 3c' --device coil
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct PlayArguments {
    /// A WAV file, or `code` or `twc`
    #[arg(value_name = "FILE|code|twc")]
    what: String,
    /// Name of the code, or the bytes in hex
    #[arg(value_name = "CODE|HEX")]
    value: Option<String>,
    #[command(flatten)]
    device: Device,
    /// Channel [default: that of the code or TWC; of a file with one channel both]
    #[arg(long, value_name = "atp|twc|both")]
    channel: Option<Channel>,
    /// Length of a code, s [default: until Ctrl-C]
    #[arg(long, value_name = "S", value_parser = positive)]
    seconds: Option<f64>,
    #[command(flatten)]
    noisy: Noisy,
    #[command(flatten)]
    scale: Scale,
}

/// Record from a sound card to a WAV file of two channels: ATP and TWC
///
/// Full scale of the file is 4000 mV, whatever the card's is: `ptu signal read` shows the levels at the coil.
///
/// Examples:
///   ptu signal record --device coil.monitor --out coil.wav --seconds 10
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct RecordArguments {
    #[command(flatten)]
    device: Device,
    /// WAV file to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// For so long, s [default: until Ctrl-C, at most 3 hours]
    #[arg(long, value_name = "S", value_parser = positive)]
    seconds: Option<f64>,
}

/// Calibrate a channel of a sound card against an instrument
///
/// Output: a carrier is played at the level, and what the instrument at the coil shows is asked for. Input: a carrier
/// of the level is applied, and what the card makes of it is measured. The factor is stored for this user.
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
    /// Calibrate the input: a carrier of this level is applied to it
    #[arg(long, conflicts_with_all = ["measured", "seconds"])]
    input: bool,
    /// Level of the reference, mV rms
    #[arg(long, value_name = "MV", default_value_t = 500.0, value_parser = positive)]
    level: f64,
    /// What the instrument showed, mV rms [default: asked for while the reference is heard]
    #[arg(long, value_name = "MV", value_parser = positive)]
    measured: Option<f64>,
    /// With --measured: how long the reference is heard, s [default: 5]
    #[arg(long, value_name = "S", value_parser = positive, requires = "measured")]
    seconds: Option<f64>,
    /// The instrument, with its serial number
    #[arg(long, value_name = "TEXT")]
    instrument: String,
    /// Its uncertainty, as 2%
    #[arg(long = "within", value_name = "PERCENT", value_parser = percent)]
    uncertainty: f64,
    #[command(flatten)]
    unit: super::UnitChoice,
}

#[derive(Debug, Args)]
struct Device {
    /// The sound device, as `ptu signal devices` names it, or `default`
    #[arg(long, value_name = "NAME")]
    device: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Channel {
    Atp,
    Twc,
    Both,
}

impl Channel {
    fn has(self, side: Side) -> bool {
        match self {
            Self::Both => true,
            Self::Atp => side == Side::Atp,
            Self::Twc => side == Side::Twc,
        }
    }
}

impl PlayArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        let unit = self.scale.unit.find()?;
        let device = self.device.device.as_str();
        let full_scale_mv = full_scale(device, Direction::Output)?;
        let stop = Stop::default();
        stop.listen();
        let on_both = |samples: Samples, channel: Channel| {
            samples.map(move |mv| Side::ALL.map(|side| if channel.has(side) { mv } else { 0.0 }))
        };
        let device = (device, full_scale_mv);
        let played = match (self.what.as_str(), &self.value) {
            ("code" | "twc", None) => {
                return Err(Failure::usage(
                    "name the speed code, or the bytes in hex, as in `ptu signal play code 55`",
                ));
            }
            ("code", Some(name)) => {
                let wave = Wave::Code {
                    name: name.clone(),
                    seconds: self.seconds.unwrap_or(f64::MAX),
                };
                let samples = signal::samples(&wave, &unit, self.noisy.strength())?;
                let channel = self.channel.unwrap_or(Channel::Atp);
                sound::play(on_both(samples, channel), Lead::Within, device, &stop)?
            }
            ("twc", Some(bytes)) => {
                let wave = Wave::Twc(hex(bytes).map_err(Failure::usage)?.0);
                let samples = signal::samples(&wave, &unit, self.noisy.strength())?;
                let channel = self.channel.unwrap_or(Channel::Twc);
                // The receiver hears the first byte at its whole level.
                let rest_hz = signal::rest_hz(&unit) as u32;
                let level = self.noisy.strength().level_mv as u32;
                let lead =
                    Side::ALL.map(|side| (rest_hz, if channel.has(side) { level } else { 0 }));
                sound::play(on_both(samples, channel), Lead::Before(lead), device, &stop)?
            }
            (_, Some(_)) => {
                return Err(Failure::usage(
                    "a code or bytes follow `code` or `twc`, and nothing follows a file",
                ));
            }
            (file, None) => {
                let mut broken = None;
                let channel = self.channel.unwrap_or(Channel::Both);
                let of = Wav::open(Path::new(file))?;
                let samples = of_file(of, channel, self.scale.full_scale, &mut broken)?;
                let played = sound::play(samples, Lead::Within, device, &stop)?;
                if let Some(why) = broken {
                    stdio::note(&format!("the file is cut off or damaged: {why}"));
                }
                played
            }
        };
        let mut said = vec![format!("played {:.2} s", played.seconds)];
        if played.stopped {
            said.push("stopped".to_owned());
        }
        if played.clipped > 0 {
            said.push(format!(
                "{} samples were beyond what the device can make and were cut off: lower --level",
                played.clipped
            ));
        }
        said.extend(gaps("underruns", played.underruns));
        print_out(&said.join("; "))
    }
}

/// The samples of a file, block by block; those of one channel for both.
fn of_file(
    mut wav: Wav,
    channel: Channel,
    full_scale_mv: f64,
    broken: &mut Option<String>,
) -> Result<impl Iterator<Item = [f64; CHANNELS]>, Failure> {
    if wav.sample_hz() != SAMPLE_HZ {
        return Err(Failure::usage(format!(
            "the file has {} samples a second: make it one of {SAMPLE_HZ}, as with `sox IN.wav -r {SAMPLE_HZ} OUT.wav`",
            wav.sample_hz()
        )));
    }
    let mut over = false;
    let blocks = std::iter::from_fn(move || {
        if over {
            return None;
        }
        let (block, end) = wav.block(SAMPLE_HZ as usize / 10, CHANNELS, full_scale_mv);
        over = end.is_some();
        if let Some(End::Broken(why)) = end {
            *broken = Some(why);
        }
        Some(block)
    });
    let frames = blocks.flat_map(move |block| {
        let count = block.first().map_or(0, Vec::len);
        (0..count).map(move |place| {
            let at = |of: usize| {
                block
                    .get(of)
                    .or(block.first())
                    .map_or(0.0, |samples| samples[place])
            };
            let mut together = [f64::from(at(0)), f64::from(at(1))];
            for (mv, side) in together.iter_mut().zip(Side::ALL) {
                *mv = if channel.has(side) { *mv } else { 0.0 };
            }
            together
        })
    });
    Ok(frames)
}

impl RecordArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        let device = self.device.device.as_str();
        check_writable(&self.out)?;
        let full_scale_mv = full_scale(device, Direction::Input)?;
        let stop = Stop::default();
        stop.listen();
        let device = (device, full_scale_mv);
        let recorded = sound::record_to_file(&self.out, device, self.seconds, &stop, &mut |_| {})?;
        let mut said = vec![format!("{}: {:.2} s", self.out.display(), recorded.seconds)];
        for (side, clipped) in Side::ALL.into_iter().zip(recorded.clipped) {
            if clipped > 0 {
                said.push(format!(
                    "{clipped} samples of the channel {} are at the end of the device's range: it was too loud",
                    side.name()
                ));
            }
        }
        said.extend(gaps("overruns", recorded.overruns));
        print_out(&said.join("; "))
    }
}

fn gaps(what: &str, count: u64) -> Option<String> {
    (count > 0).then(|| format!("{what}: {count}; the waveform has gaps there"))
}

impl CalibrateArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        let unit = self.unit.find()?;
        let file = sound_file::usual()?;
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
            stdio::note("stopped: nothing was stored");
            return Ok(Exit::Aborted);
        }
        let mut lines = Vec::new();
        for (side, (now, measured)) in Side::ALL.into_iter().zip(now.into_iter().zip(measured)) {
            if !self.channel.has(side) {
                continue;
            }
            // Output: a whole sample made more than was thought. Input: it was made by less.
            let full_scale_mv = match self.input {
                true => now * self.level / measured,
                false => now * measured / self.level,
            };
            if !(1e-3..1e9).contains(&full_scale_mv) {
                return Err(Failure::usage(format!(
                    "channel {}: {measured:.3} mV where {} mV were expected cannot be right",
                    side.name(),
                    self.level
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
            lines.push(format!(
                "{device}, channel {}: full scale is {full_scale_mv:.1} mV ± {} %, by {}",
                side.name(),
                self.uncertainty,
                self.instrument
            ));
        }
        print_out(&lines.join("\n"))
    }

    /// What the instrument shows while the reference is played.
    fn heard(
        &self,
        device: (&str, [f64; CHANNELS]),
        unit: &UnitConfig,
        stop: &Stop,
    ) -> Result<[f64; CHANNELS], Failure> {
        if self.measured.is_none() && !somebody_is_there() {
            return Err(Failure::usage(
                "nobody can be asked here: give what the instrument showed with --measured",
            ));
        }
        let seconds = match self.measured {
            Some(_) => self.seconds.unwrap_or(REFERENCE_S),
            None => f64::MAX,
        };
        let typed = self.measured.is_none().then(Typed::listen);
        if typed.is_some() {
            stdio::note(&format!(
                "a carrier of {} mV rms is played: type what the instrument at the coil shows, mV rms, and Enter",
                self.level
            ));
        }
        let mut answer = self.measured;
        let tones = signal::reference_hz(unit);
        let rate = f64::from(SAMPLE_HZ);
        let mut at = 0u64;
        let samples = std::iter::from_fn(|| {
            if at as f64 >= seconds * rate {
                return None;
            }
            // Asked for each 10 ms.
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
            return Err(Failure::usage(format!(
                "the device cannot make {} mV: choose a lower --level",
                self.level
            )));
        }
        Ok([answer.unwrap_or(0.0); CHANNELS])
    }

    /// What the device shows of the level that is applied: all within 20 Hz of the reference.
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
        // The first second is the card's own beginning.
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
        // Half of the amplitude times the mean of the window, which is a half.
        Ok(sums.map(|[re, im]| re.hypot(im) * 4.0 / half as f64 / std::f64::consts::SQRT_2))
    }
}

/// Prints the devices there are, and how each is calibrated.
pub fn list_devices() -> Result<Exit, Failure> {
    let known = Calibrations::load(&sound_file::usual()?)?;
    let devices = sound::devices()?;
    if devices.is_empty() {
        return print_out("no device for sound");
    }
    let mut table = Table::new(&["DEVICE", "DIRECTION", "CALIBRATED"]);
    for device in devices {
        let calibrated = Side::ALL.into_iter().filter_map(|side| {
            let of = known.of(&device.name, device.direction, side)?;
            Some(format!("{} {}", side.name(), said(of)))
        });
        table.row([
            device.name.clone(),
            match device.direction {
                Direction::Output => "output".to_owned(),
                Direction::Input => "input".to_owned(),
            },
            calibrated.collect::<Vec<_>>().join("; "),
        ]);
    }
    print_out(&table.render())
}

fn said(of: &Calibration) -> String {
    format!(
        "{:.1} mV ± {} %, {}, {}",
        of.full_scale_mv,
        of.uncertainty_percent,
        clock::local_minute(of.at_us),
        of.instrument
    )
}

/// What a whole sample of each channel stands for; says which channel nobody has calibrated.
fn full_scale(device: &str, direction: Direction) -> Result<[f64; CHANNELS], Failure> {
    let known = Calibrations::load(&sound_file::usual()?)?;
    let without = Side::ALL
        .into_iter()
        .filter(|side| known.of(device, direction, *side).is_none());
    let without: Vec<_> = without.map(Side::name).collect();
    if !without.is_empty() {
        stdio::note(&format!(
            "{device}: no calibration of the channel {}: levels are nominal, see `ptu signal calibrate`",
            without.join(" and ")
        ));
    }
    Ok(known.full_scale_mv(device, direction))
}

fn percent(text: &str) -> Result<f64, String> {
    let number = text.trim_end_matches('%').trim().parse();
    match number {
        Ok(number) if (0.0..=100.0).contains(&number) => Ok(number),
        _ => Err("an uncertainty is 0 to 100 %, as 2%".to_owned()),
    }
}
