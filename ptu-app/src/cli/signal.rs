//! `ptu signal`: waveforms in files: make one, or read what is in one.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::{Json, ScriptsOption, print_out};
use ptu_bench::failure::{Exit, Failure};
use ptu_bench::signal::{self, FULL_SCALE_MV, Reading, Wave};
use ptu_bench::table::Table;

/// Make the waveform of a speed code or of TWC as a WAV file, or read what is in a recording
///
/// Examples:
///   ptu signal make code 55 --level 500 --snr 20 code55.wav
///   ptu signal make twc '01 fe 3c' twc.wav
///   ptu signal read recording.wav --json
///
/// A recording is read by the receivers of the embedded unit: a code is what they decode. TWC has tones of
/// 9650 Hz less and plus 150 Hz and 300 bit/s; the bit rate of the real equipment is not public.
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
}

#[derive(Clone, Debug)]
struct Bytes(Vec<u8>);

#[derive(Debug, Args)]
struct CommonOfMake {
    /// WAV file to write: one channel of 16 bits, 48 000 samples a second
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Level while the carrier is on, mV rms
    #[arg(long, value_name = "MV", default_value_t = 500.0, value_parser = positive)]
    level: f64,
    /// Noise so many dB below the level, in the receiver's band; without it there is none
    #[arg(long, value_name = "DB", allow_negative_numbers = true)]
    snr: Option<f64>,
    /// Seed of the noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    scale: Scale,
}

#[derive(Debug, Args)]
struct Scale {
    /// What full scale of the file stands for, mV
    #[arg(long, value_name = "MV", default_value_t = FULL_SCALE_MV, value_parser = positive)]
    full_scale: f64,
    /// Unit configuration whose speed codes are meant
    #[arg(long, value_name = "NAME", default_value = "sg100")]
    unit_config: String,
    #[command(flatten)]
    scripts: ScriptsOption,
}

#[derive(Debug, Args)]
struct ReadArguments {
    /// WAV file to read
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    scale: Scale,
}

impl SignalArguments {
    /// Makes or reads.
    pub fn run(self) -> Result<Exit, Failure> {
        match self.verb {
            SignalVerb::Make(arguments) => arguments.run(),
            SignalVerb::Read(arguments) => arguments.run(),
        }
    }
}

impl MakeArguments {
    fn run(self) -> Result<Exit, Failure> {
        let (wave, common) = match self.wave {
            WaveVerb::Code {
                name,
                seconds,
                common,
            } => (Wave::Code { name, seconds }, common),
            WaveVerb::Twc { bytes, common } => (Wave::Twc(bytes.0), common),
        };
        let CommonOfMake {
            file,
            level,
            snr,
            seed,
            scale,
        } = common;
        let unit = scale.scripts.find()?.unit_config(&scale.unit_config)?;
        let to = (file.as_path(), scale.full_scale);
        let made = signal::make(&wave, &unit.content, (level, snr, seed), to)?;
        let clipped = match made.clipped {
            0 => String::new(),
            clipped => format!(
                "; {clipped} samples are beyond {} mV and were cut off there: raise --full-scale or lower --level",
                scale.full_scale
            ),
        };
        print_out(&format!(
            "{}: {:.2} s{clipped}",
            file.display(),
            made.seconds
        ))
    }
}

impl ReadArguments {
    fn run(self) -> Result<Exit, Failure> {
        let unit = (self.scale.scripts.find()?).unit_config(&self.scale.unit_config)?;
        let reading = signal::read(&self.file, &unit.content, self.scale.full_scale)?;
        self.json.answer(|| &reading, || as_text(&reading))
    }
}

fn as_text(reading: &Reading) -> String {
    let number = |value: Option<f64>, digits: usize| {
        value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}"))
    };
    let mut lines = vec![format!("{:.2} s", reading.duration_s)];
    if !reading.sources.is_empty() {
        let heads = [
            "channel",
            "from s",
            "to s",
            "kind",
            "what",
            "carrier Hz",
            "rate Hz",
            "level mV",
            "SNR dB",
        ];
        let mut table = Table::new(&heads);
        for source in &reading.sources {
            let what = match (source.kind, source.what.as_str(), source.rate_hz) {
                ("code", "", rate) if rate < 1.0 => "carrier without a code".to_owned(),
                ("code", "", _) => "no code of this unit configuration".to_owned(),
                (_, what, _) => what.to_owned(),
            };
            let bad = source.bad_bytes.filter(|bad| *bad > 0);
            let bad = bad.map_or_else(String::new, |bad| format!(" ({bad} bytes damaged)"));
            table.row([
                source.channel.to_string(),
                format!("{:.2}", source.from_s),
                format!("{:.2}", source.to_s),
                source.kind.to_owned(),
                what + &bad,
                format!("{:.1}", source.carrier_hz),
                format!("{:.2}", source.rate_hz),
                number(source.level_mv, 0),
                number(source.snr_db, 1),
            ]);
        }
        lines.push(table.render());
    }
    if reading.sources.is_empty() {
        lines.push("no code and no TWC".to_owned());
    }
    for unknown in &reading.not_understood {
        lines.push(format!(
            "{:.2} to {:.2} s: {}",
            unknown.from_s, unknown.to_s, unknown.what
        ));
    }
    lines.join("\n")
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && number < 1e6 => Ok(number),
        _ => Err("a number above 0 and below 1 000 000 is needed".to_owned()),
    }
}

fn hex(text: &str) -> Result<Bytes, String> {
    let digits: Vec<u32> = (text.chars().filter(|letter| !letter.is_whitespace()))
        .map(|letter| letter.to_digit(16))
        .collect::<Option<_>>()
        .ok_or("bytes are pairs of hex digits, as '01 fe 3c'")?;
    if digits.is_empty() || digits.len() % 2 == 1 || digits.len() > 4_096 {
        return Err("1 to 2048 bytes are needed, each of two hex digits".to_owned());
    }
    Ok(Bytes(
        (digits.chunks_exact(2))
            .map(|pair| (pair[0] << 4 | pair[1]) as u8)
            .collect(),
    ))
}
