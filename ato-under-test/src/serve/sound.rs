//! Sound of a sound card as samples in the unit's coils; and the system's programs that carry it: of PulseAudio,
//! which PipeWire has, too, or of ALSA.

extern crate std;

use std::format;
use std::io::{self, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::string::ToString;
use std::sync::{Arc, Mutex, PoisonError};

use protocol::message::{COIL_SAMPLE_HZ, COIL_SAMPLES, COIL_STEP_MV};

use super::ServeError;
use super::steady::{Pair, Steady};

/// The device that the system has chosen.
pub const DEFAULT: &str = "default";
/// Channels: the first is the ATP antenna's, the second that of TWC and markers.
const CHANNELS: usize = 2;
/// Time for which samples wait in the sound server on their way here, ms.
const LATENCY_MS: u32 = 20;
/// Samples that are to wait here, 40 ms: more than a block of the sound server and a scan together.
const WAITING: usize = 4 * COIL_SAMPLES;

/// The program that plays on a device, or records from it: two channels of 16 bits through its standard streams. The
/// sound server holds samples for `latency_ms`. If there is no such program, the error names those that would do.
pub fn carrier(
    plays: bool,
    device: &str,
    latency_ms: u32,
) -> Result<Command, (&'static str, &'static str)> {
    let (of_server, of_alsa) = match plays {
        true => ("pacat", "aplay"),
        false => ("parec", "arecord"),
    };
    let mut command;
    if is_there(of_server) {
        command = Command::new(of_server);
        command.args([
            if plays { "--playback" } else { "--record" },
            "--raw",
            "--format=s16le",
            "--no-remix",
            "--volume=65536",
            "--client-name=ptu",
            "--verbose",
        ]);
        command.arg(format!("--rate={COIL_SAMPLE_HZ}"));
        command.arg(format!("--channels={CHANNELS}"));
        command.arg(format!("--latency-msec={latency_ms}"));
        if device != DEFAULT {
            command.arg(format!("--device={device}"));
        }
    } else if is_there(of_alsa) {
        command = Command::new(of_alsa);
        command.args(["-t", "raw", "-f", "S16_LE", "-D", device]);
        command.args([
            "-r",
            &COIL_SAMPLE_HZ.to_string(),
            "-c",
            &CHANNELS.to_string(),
        ]);
        command.arg(format!("--buffer-time={}", latency_ms * 1_000));
    } else {
        return Err((of_server, of_alsa));
    }
    command.env("LC_ALL", "C");
    Ok(command)
}

/// Whether a folder of `PATH` has this program.
pub fn is_there(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path)
        .any(|folder: std::path::PathBuf| Path::is_file(&folder.join(program)))
}

/// Listens at a sound card.
pub struct Listener {
    child: Child,
    /// Samples that were heard, mV; `None` = the program that carries the sound has ended.
    heard: Arc<Mutex<Option<Steady>>>,
}

impl Listener {
    /// Listens at a device whose full-scale sample stands for this number of mV.
    ///
    /// # Errors
    /// Nothing here carries sound.
    pub fn start(device: &str, full_scale_mv: f32) -> Result<Self, ServeError> {
        let failed = ServeError::new(format!("listening at {device}"));
        let started = carrier(false, device, LATENCY_MS)
            .map_err(|(one, other)| {
                io::Error::other(format!("neither {one} nor {other} is installed"))
            })
            .and_then(|mut command| {
                let quiet = command.stdin(Stdio::null()).stderr(Stdio::null());
                quiet.stdout(Stdio::piped()).spawn()
            });
        let mut child = started.map_err(failed)?;
        let heard = Arc::new(Mutex::new(Some(Steady::new(WAITING))));
        if let Some(mut samples) = child.stdout.take() {
            let heard = heard.clone();
            std::thread::spawn(move || {
                let mut bytes = [0; 2 * CHANNELS * COIL_SAMPLES / 4];
                let in_mv = |low, high| {
                    f32::from(i16::from_le_bytes([low, high])) / 32_768.0 * full_scale_mv
                };
                while samples.read_exact(&mut bytes).is_ok() {
                    let pairs = bytes.as_chunks::<{ 2 * CHANNELS }>().0.iter();
                    let pairs = pairs.map(|[a, b, c, d]| [in_mv(*a, *b), in_mv(*c, *d)]);
                    if let Some(steady) = &mut *lock(&heard) {
                        steady.push(pairs);
                    }
                }
                *lock(&heard) = None;
            });
        }
        Ok(Self { child, heard })
    }

    /// Samples of a scan, as steps of each channel.
    ///
    /// # Errors
    /// The device is gone.
    pub fn scan(&mut self) -> Result<[[i16; COIL_SAMPLES]; CHANNELS], ServeError> {
        let mut pairs = [Pair::default(); COIL_SAMPLES];
        let gone = || io::Error::other("the device is gone");
        match &mut *lock(&self.heard) {
            Some(steady) => steady.take(&mut pairs),
            None => return Err(ServeError::new("listening")(gone())),
        }
        Ok([0, 1].map(|side| pairs.map(|pair| libm::roundf(pair[side] / COIL_STEP_MV) as i16)))
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        // The process may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn lock(heard: &Mutex<Option<Steady>>) -> std::sync::MutexGuard<'_, Option<Steady>> {
    heard.lock().unwrap_or_else(PoisonError::into_inner)
}
