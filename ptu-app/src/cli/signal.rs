//! `ptu signal`: waveforms in files and at a sound card: make, read, play and record them.

mod calibrate;
pub mod sound;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

use super::output::print_csv;
use super::{Json, ScriptsOption, made_by, print_out};
use protocol::config::UnitConfig;
use ptu_report::run::html;
use ptu_report::signal::{self as report, Recording};
use ptu_report::words::{Words, fill};
use ptu_runs::failure::{Exit, Failure, SoundTrouble};
use ptu_runs::new_file::kind;
use ptu_runs::signal::{self, FULL_SCALE_MV, Made, Strength, Teeth, Wave};
use ptu_runs::whole_file::{check_writable, write};
use serde_json::Value;

/// Make the waveform of a speed code, of TWC, a marker or a speed sensor, read what is in a recording, play and record
///
/// Examples:
///   ptu signal make code 55 --level 500 --snr 20 code55.wav
///   ptu signal make twc '01 fe 3c' twc.wav
///   ptu signal read recording.wav --json
///   ptu signal read recording.wav --csv --report recording.html
///
/// A recording is read by the receivers of the simulated unit: what they decode is shown. Codes, tones and bit rate are
/// taken from the unit configuration.
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct SignalArguments {
    #[command(subcommand)]
    verb: SignalVerb,
}

#[derive(Debug, Subcommand)]
enum SignalVerb {
    /// Make a waveform
    Make(MakeArguments),
    /// Read a WAV file: which codes and bytes are in it, when, at which level
    Read(ReadArguments),
    Play(sound::PlayArguments),
    Record(sound::RecordArguments),
    Calibrate(calibrate::CalibrateArguments),
    /// List the sound devices, and how each is calibrated
    Devices,
}

#[derive(Debug, Args)]
struct MakeArguments {
    #[command(subcommand)]
    wave: WaveVerb,
}

#[derive(Debug, Subcommand)]
enum WaveVerb {
    /// A speed code
    Code {
        /// Name of the code, see `ptu catalog codes`
        #[arg(value_name = "CODE")]
        name: String,
        /// Length, s
        #[arg(long, value_name = "S", default_value_t = 2.0, value_parser = positive)]
        seconds: f64,
        #[command(flatten)]
        common: CommonOfMake,
    },
    /// Bytes as TWC
    Twc {
        /// The bytes in hex, as '01 fe 3c'
        #[arg(value_name = "HEX", value_parser = hex)]
        bytes: Bytes,
        #[command(flatten)]
        common: CommonOfMake,
    },
    /// The two lines of a speed sensor, one channel each
    Tacho {
        /// Speed, km/h; below 0 backward
        #[arg(long, value_name = "KMH", default_value = "40", allow_negative_numbers = true, value_parser = rolling_kmh)]
        kmh: f64,
        /// Length, s
        #[arg(long, value_name = "S", default_value_t = 2.0, value_parser = positive)]
        seconds: f64,
        /// Phase of line B behind line A, degrees of a period
        #[arg(long, value_name = "DEGREES", default_value_t = 90.0, value_parser = angle)]
        phase: f64,
        /// Share of a period for which a line is high, %
        #[arg(long, value_name = "PERCENT", default_value_t = 50.0, value_parser = percent)]
        duty: f64,
        /// One tooth of the sensor's wheel is missing
        #[arg(long)]
        missing_tooth: bool,
        #[command(flatten)]
        common: CommonOfMake,
    },
    /// A marker as a train passes it
    Marker {
        /// 1 to 4 for PSM1 to PSM4
        #[arg(value_name = "NUMBER", value_parser = clap::value_parser!(u8).range(1..=4))]
        number: u8,
        /// Speed of the train, km/h
        #[arg(long, value_name = "KMH", default_value = "40", value_parser = passing_kmh)]
        kmh: f64,
        #[command(flatten)]
        common: CommonOfMake,
    },
}

fn rolling_kmh(text: &str) -> Result<f64, String> {
    let kmh: Option<f64> = text.parse().ok();
    let kmh = kmh.filter(|kmh| (0.1..=200.0).contains(&kmh.abs()));
    kmh.ok_or_else(|| "a speed is 0.1 to 200 km/h, or as much below 0".to_owned())
}

fn passing_kmh(text: &str) -> Result<f64, String> {
    let kmh = text.parse().ok().filter(|kmh| (1.0..=200.0).contains(kmh));
    kmh.ok_or_else(|| "a speed is 1 to 200 km/h".to_owned())
}

#[derive(Clone, Debug)]
struct Bytes(Vec<u8>);

#[derive(Debug, Args)]
struct CommonOfMake {
    /// WAV file to write: 16 bits, 48 000 samples a second, one channel, for a speed sensor two
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    noisy: Noisy,
    #[command(flatten)]
    scale: Scale,
}

#[derive(Debug, Args)]
struct Noisy {
    /// Level while the carrier is on, mV rms
    #[arg(long, value_name = "MV", default_value_t = 500.0, value_parser = positive)]
    level: f64,
    /// Noise this many dB below the level, in the receiver's band [default: no noise]
    #[arg(long, value_name = "DB", allow_negative_numbers = true, value_parser = decibels)]
    snr: Option<f64>,
    /// Seed of the noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Noisy {
    fn strength(&self) -> Strength {
        Strength {
            level_mv: self.level,
            snr_db: self.snr,
            seed: self.seed,
        }
    }
}

#[derive(Debug, Args)]
struct Scale {
    /// Voltage that full scale of the file stands for, mV
    #[arg(long, value_name = "MV", default_value_t = FULL_SCALE_MV, value_parser = positive)]
    full_scale: f64,
    #[command(flatten)]
    unit: UnitChoice,
}

#[derive(Debug, Args)]
struct UnitChoice {
    /// Unit configuration whose codes, tones and bit rate count
    #[arg(long, value_name = "NAME", default_value = "sg100")]
    unit_config: String,
    #[command(flatten)]
    scripts: ScriptsOption,
}

impl UnitChoice {
    fn find(&self) -> Result<UnitConfig, Failure> {
        let file = self.scripts.find()?.unit_config(&self.unit_config)?;
        Ok(file.content)
    }
}

#[derive(Debug, Args)]
struct ReadArguments {
    /// WAV file to read
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    json: Json,
    /// Print CSV, a line of headings first, a line for each code and message that was heard
    #[arg(long, conflicts_with = "json")]
    csv: bool,
    /// Write a page with spectrum, envelope and eye beside what was heard, .html; repeatable
    #[arg(long, value_name = "FILE", value_parser = page)]
    report: Vec<PathBuf>,
    /// Read each two channels as the lines A and B of a speed sensor
    #[arg(long, conflicts_with = "report")]
    tacho: bool,
    #[command(flatten)]
    scale: Scale,
}

impl SignalArguments {
    pub fn run(self) -> Result<Exit, Failure> {
        match self.verb {
            SignalVerb::Make(arguments) => arguments.run(),
            SignalVerb::Read(arguments) => arguments.run(),
            SignalVerb::Play(arguments) => arguments.run(),
            SignalVerb::Record(arguments) => arguments.run(),
            SignalVerb::Calibrate(arguments) => arguments.run(),
            SignalVerb::Devices => sound::list_devices(),
        }
    }
}

impl MakeArguments {
    fn run(self) -> Result<Exit, Failure> {
        let (wave, common) = match self.wave {
            WaveVerb::Tacho {
                kmh,
                seconds,
                phase,
                duty,
                missing_tooth,
                common,
            } => {
                let CommonOfMake { file, noisy, scale } = common;
                let unit = scale.unit.find()?;
                let teeth = Teeth {
                    per_turn: unit.tacho.pulses_per_turn,
                    lacks_one: missing_tooth,
                    phase: phase / 360.0 * kmh.signum(),
                    duty: duty / 100.0,
                };
                let to = (file.as_path(), scale.full_scale);
                let run = (kmh.abs(), seconds);
                let made = signal::make_tacho(teeth, run, &unit, noisy.strength(), to)?;
                return told(&file, made);
            }
            WaveVerb::Code {
                name,
                seconds,
                common,
            } => (Wave::Code { name, seconds }, common),
            WaveVerb::Twc { bytes, common } => (Wave::Twc(bytes.0), common),
            WaveVerb::Marker {
                number,
                kmh,
                common,
            } => (Wave::Marker { number, kmh }, common),
        };
        let CommonOfMake { file, noisy, scale } = common;
        let unit = scale.unit.find()?;
        let to = (file.as_path(), scale.full_scale);
        let made = signal::make(&wave, &unit, noisy.strength(), to)?;
        told(&file, made)
    }
}

fn told(file: &Path, made: Made) -> Result<Exit, Failure> {
    let words = &Words::shown().signals;
    let clipped = match made.clipped {
        0 => String::new(),
        clipped => format!("; {}", fill(words.cut_off, &[("n", &clipped)])),
    };
    print_out(&format!(
        "{}: {:.2} s{clipped}",
        file.display(),
        made.seconds
    ))
}

impl ReadArguments {
    fn run(self) -> Result<Exit, Failure> {
        let unit = self.scale.unit.find()?;
        self.report
            .iter()
            .try_for_each(|file| check_writable(file, kind::HTML))?;
        let full_scale_mv = self.scale.full_scale;
        let reading = match self.report.is_empty() {
            _ if self.tacho => signal::read_tacho(&self.file, &unit, full_scale_mv)?,
            true => signal::read(&self.file, &unit, full_scale_mv)?,
            false => {
                let (reading, pictures) =
                    signal::read_and_picture(&self.file, &unit, full_scale_mv)?;
                let recording = Recording {
                    file: self.file.display().to_string(),
                    unit_config: unit.name.clone(),
                    full_scale_mv,
                    reading,
                    pictures,
                    made: made_by(),
                };
                let page = html(&recording, Words::shown());
                for file in &self.report {
                    write(file, kind::HTML, &page)?;
                }
                recording.reading
            }
        };
        if self.csv {
            let rows = reading.sources.iter().map(|source| {
                let row = serde_json::to_value(source).unwrap_or_default();
                let of = |column: &str| match &row["tacho"][column] {
                    Value::Null => row[column].clone(),
                    of_tacho => of_tacho.clone(),
                };
                SOURCE_COLUMNS.map(|column| (column.to_owned(), of(column)))
            });
            let rows: Vec<Value> = rows.map(|row| row.into_iter().collect()).collect();
            return print_csv(&SOURCE_COLUMNS, &rows);
        }
        let text = || report::text(&reading, Words::shown());
        self.json.answer(|| &reading, text)
    }
}

/// Columns of the CSV: one row for each code, message, marker or speed sensor that was heard.
const SOURCE_COLUMNS: [&str; 15] = [
    "channel",
    "from_s",
    "to_s",
    "kind",
    "what",
    "carrier_hz",
    "rate_hz",
    "level_mv",
    "snr_db",
    "bad_bytes",
    "forward",
    "backward",
    "mean_kmh",
    "phase_deg",
    "missing_teeth",
];

fn page(file: &str) -> Result<PathBuf, String> {
    match file.ends_with(".html") {
        true => Ok(file.into()),
        false => Err("a page of a recording ends in .html".into()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && number < 1e6 => Ok(number),
        _ => Err("a number above 0 and below 1 000 000 is needed".to_owned()),
    }
}

fn decibels(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if (-60.0..=120.0).contains(&number) => Ok(number),
        _ => Err("a ratio from -60 to 120 is needed".to_owned()),
    }
}

/// Parses an angle within a period, 0 to below 360 degrees.
fn angle(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if (0.0..360.0).contains(&number) => Ok(number),
        _ => Err("an angle from 0 to below 360 is needed".to_owned()),
    }
}

/// Parses a share of 1 to 99 %.
fn percent(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if (1.0..=99.0).contains(&number) => Ok(number),
        _ => Err("a share from 1 to 99 is needed".to_owned()),
    }
}

fn hex(text: &str) -> Result<Bytes, SoundTrouble> {
    signal::bytes_of(text).map(Bytes)
}
