//! `ptu signal play`, `record` and `devices`: waveforms to and from a sound card.

use ptu_report::words::{Words, fill};
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{Noisy, Scale, hex, positive};
use crate::cli::print_out;
use ptu_options::sound_file;
use ptu_runs::clock;
use ptu_runs::failure::{Exit, Failure, SoundTrouble};
use ptu_runs::new_file::kind;
use ptu_runs::signal::{self, End, Samples, Wav, Wave};
use ptu_runs::sound::{
    self, CHANNELS, Calibration, Calibrations, Direction, Lead, SAMPLE_HZ, Side,
};
use ptu_runs::stdio;
use ptu_runs::stop::Stop;
use ptu_runs::table::Table;
use ptu_runs::whole_file::check_writable;

/// Play a WAV file, a speed code or TWC on a sound card
///
/// The first channel (left) carries ATP, the second channel TWC. The sound begins 20 dB below its level and reaches the
/// level in half a second. The sound stops within 100 ms of Ctrl-C, or when this program ends in any way.
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
    /// Channel [default: atp for a code, twc for TWC; a file with one channel plays on both]
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
/// Full scale of the file is 4000 mV, whatever the card's full scale: `ptu signal read` shows the levels at the coil.
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
    /// Length, s [default: until Ctrl-C, at most 3 hours]
    #[arg(long, value_name = "S", value_parser = positive)]
    seconds: Option<f64>,
}

#[derive(Debug, Args)]
pub(super) struct Device {
    /// The sound device, as `ptu signal devices` names it, or `default`
    #[arg(long, value_name = "NAME")]
    pub(super) device: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Channel {
    Atp,
    Twc,
    Both,
}

impl Channel {
    pub(super) fn has(self, side: Side) -> bool {
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
        let words = &Words::shown().signals;
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
                return Err(Failure::usage(SoundTrouble::NoCode));
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
                // Before the first byte a tone rises, so that the receiver hears this byte at its full level.
                let rest_hz = signal::rest_hz(&unit) as u32;
                let level = self.noisy.strength().level_mv as u32;
                let lead =
                    Side::ALL.map(|side| (rest_hz, if channel.has(side) { level } else { 0 }));
                sound::play(on_both(samples, channel), Lead::Before(lead), device, &stop)?
            }
            (_, Some(_)) => {
                return Err(Failure::usage(SoundTrouble::OneValue));
            }
            (file, None) => {
                let mut broken = None;
                let channel = self.channel.unwrap_or(Channel::Both);
                let of = Wav::open(Path::new(file))?;
                let samples = of_file(of, channel, self.scale.full_scale, &mut broken)?;
                let played = sound::play(samples, Lead::Within, device, &stop)?;
                if let Some(why) = broken {
                    stdio::note(&fill(words.broken, &[("why", &why)]));
                }
                played
            }
        };
        let time = format!("{:.2}", played.seconds);
        let mut said = vec![fill(words.played, &[("time", &time)])];
        if played.stopped {
            said.push(words.stopped.to_owned());
        }
        if played.clipped > 0 {
            said.push(fill(words.cut_off, &[("n", &played.clipped)]));
        }
        said.extend(gaps(played.underruns));
        print_out(&said.join("; "))
    }
}

/// The samples of a file, mV, block by block; a file with one channel goes to both channels.
fn of_file(
    mut wav: Wav,
    channel: Channel,
    full_scale_mv: f64,
    broken: &mut Option<String>,
) -> Result<impl Iterator<Item = [f64; CHANNELS]>, Failure> {
    if wav.sample_hz() != SAMPLE_HZ {
        return Err(Failure::usage(SoundTrouble::Rate(
            wav.sample_hz(),
            SAMPLE_HZ,
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
        check_writable(&self.out, kind::WAV)?;
        let full_scale_mv = full_scale(device, Direction::Input)?;
        let stop = Stop::default();
        stop.listen();
        let device = (device, full_scale_mv);
        let recorded = sound::record_to_file(&self.out, device, self.seconds, &stop, &mut |_| {})?;
        let words = &Words::shown().signals;
        let mut said = vec![format!("{}: {:.2} s", self.out.display(), recorded.seconds)];
        for (side, clipped) in Side::ALL.into_iter().zip(recorded.clipped) {
            if clipped > 0 {
                let of = [("n", &clipped as _), ("channel", &side.name() as _)];
                said.push(fill(words.too_loud, &of));
            }
        }
        said.extend(gaps(recorded.overruns));
        print_out(&said.join("; "))
    }
}

fn gaps(count: u64) -> Option<String> {
    (count > 0).then(|| fill(Words::shown().signals.gaps, &[("n", &count)]))
}

/// Prints the devices there are, and how each is calibrated.
pub fn list_devices() -> Result<Exit, Failure> {
    let known = Calibrations::load(&sound_file()?)?;
    let devices = sound::devices()?;
    let words = &Words::shown().signals;
    if devices.is_empty() {
        return print_out(words.no_device);
    }
    let mut table = Table::headed(&[words.device, words.direction, words.calibrated]);
    for device in devices {
        let calibrated = Side::ALL.into_iter().filter_map(|side| {
            let of = known.of(&device.name, device.direction, side)?;
            Some(format!("{} {}", side.name(), said(of)))
        });
        table.row([
            device.name.clone(),
            match device.direction {
                Direction::Output => words.output.to_owned(),
                Direction::Input => words.input.to_owned(),
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

/// Voltage that full scale of each channel stands for, mV; a note names the channels that nobody has calibrated.
pub fn full_scale(device: &str, direction: Direction) -> Result<[f64; CHANNELS], Failure> {
    let known = Calibrations::load(&sound_file()?)?;
    let without = Side::ALL
        .into_iter()
        .filter(|side| known.of(device, direction, *side).is_none());
    let without: Vec<_> = without.map(Side::name).collect();
    if !without.is_empty() {
        let channels = without.join(", ");
        let of = [("device", &device as _), ("channels", &channels as _)];
        stdio::note(&fill(Words::shown().signals.uncalibrated, &of));
    }
    Ok(known.full_scale_mv(device, direction))
}
