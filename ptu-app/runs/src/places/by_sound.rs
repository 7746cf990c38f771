//! Waveforms that a sound card carries in place of frames.

use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use btu_rig::rig::{InstrumentFault, LinkTrouble};
use protocol::message::{COIL_PART, COIL_SAMPLES, COIL_STEP_MV, Coil, CoilSamples};

use super::file::Places;
use super::worker::trouble;
use crate::signal::FULL_SCALE_MV;
use crate::sound::{Stream, record};
use crate::stop::Stop;

const SCAN: Duration = Duration::from_millis(10);
/// Scans of a beep, and of the silence before and after, in which the beep before has faded.
const BEEP: u32 = 5;
const QUIET: u32 = 40;
/// Level of a beep, mV, and the least ratio of a beep to the silence before the beep.
const BEEP_MV: f32 = 500.0;
const LOUDER: f32 = 4.0;

/// The sound card at work.
pub(super) struct BySound {
    pub name: String,
    pub stream: Stream,
    coils: Vec<Coil>,
    /// How late the sound may be heard, as the bench file states.
    uncertainty: Duration,
    pub late: Duration,
    /// Samples of this scan, two channels: codes, and TWC with markers.
    samples: [[f32; 2]; COIL_SAMPLES],
    /// Frames that were played and not sent: the numbers of later frames are lower by so many.
    pub left_out: u16,
}

impl BySound {
    pub fn open(places: &Places) -> Result<Option<Self>, LinkTrouble> {
        let Some((name, device)) = places.sound_card() else {
            return Ok(None);
        };
        let stream = Stream::start(&device, places.full_scale_mv);
        let stream = stream.map_err(|fault| trouble(name, fault))?;
        Ok(Some(Self {
            name: name.clone(),
            stream,
            coils: places.coils_by_sound(),
            uncertainty: Duration::from_millis(places.instruments[name].uncertainty_ms),
            late: Duration::ZERO,
            samples: [[0.0; 2]; COIL_SAMPLES],
            left_out: 0,
        }))
    }

    pub fn carries(&self, coil: Coil) -> bool {
        self.coils.contains(&coil)
    }

    pub fn take(&mut self, part: &CoilSamples) {
        let channel = usize::from(part.coil != Coil::AtpAntenna);
        let from = usize::from(part.part) * COIL_PART;
        let slots = self.samples.iter_mut().skip(from);
        for (slot, sample) in slots.zip(part.samples.0) {
            slot[channel] += f32::from(sample) * COIL_STEP_MV;
        }
        self.left_out = self.left_out.wrapping_add(1);
    }

    /// Ends a scan: hands its samples to the card.
    pub fn play(&mut self) {
        self.stream.feed(&self.samples);
        self.samples.fill([0.0; 2]);
        let takes = Duration::from_millis(self.stream.takes_ms());
        self.late = self.late.max(takes.saturating_sub(self.uncertainty));
    }

    pub fn fault(&self) -> Option<InstrumentFault> {
        match self.stream.clipped() {
            Ok(0) => None,
            Ok(_) => Some(InstrumentFault::TooLoud),
            Err(fault) => Some(fault),
        }
    }
}

/// Time that sound takes, ms: from playing beeps to hearing them where the bench file has `heard_at`; otherwise the longest
/// time that half a second of silence waits in the sound server.
pub(super) fn try_sound(places: &Places, name: &str, rounds: u32) -> Result<f64, InstrumentFault> {
    let entry = &places.instruments[name];
    let stream = Stream::start(&entry.reach().to_string(), places.full_scale_mv)?;
    if let Some(at) = &entry.heard_at {
        return hear_beeps(&stream, at, rounds);
    }
    let mut takes_ms = 0;
    for _ in 0..50 {
        stream.feed(&[[0.0; 2]; COIL_SAMPLES]);
        std::thread::sleep(SCAN);
        takes_ms = takes_ms.max(stream.takes_ms());
    }
    stream.clipped().map(|_| takes_ms as f64)
}

/// Longest time from playing to hearing of so many beeps, with the time in which the input hands samples on.
fn hear_beeps(stream: &Stream, at: &str, rounds: u32) -> Result<f64, InstrumentFault> {
    let stop = Stop::default();
    let (told, heard) = channel();
    std::thread::scope(|scope| {
        let recorder = scope.spawn(|| {
            let loudest = |most: f32, mv: &f32| most.max(mv.abs());
            record((at, [FULL_SCALE_MV; 2]), None, &stop, &mut |block| {
                let _ = told.send((Instant::now(), block[0].iter().fold(0.0, loudest)));
                Ok(())
            })
        });
        let rounds = (0..rounds).try_fold(0.0f64, |longest, _| {
            Some(longest.max(beep(stream, &heard)?.as_secs_f64() * 1000.0))
        });
        stop.press_once();
        let recorded = recorder.join();
        stream.clipped()?;
        match (rounds, recorded) {
            (Some(longest_ms), Ok(Ok(_))) => Ok(longest_ms),
            _ => Err(InstrumentFault::NotHeard(at.to_owned())),
        }
    })
}

/// Time from playing a beep until it is heard; `None` if it is not heard.
fn beep(stream: &Stream, heard: &Receiver<(Instant, f32)>) -> Option<Duration> {
    let mut silence = 1.0f32;
    let play = |scans: u32, mv: f32| {
        for _ in 0..scans {
            // 3 kHz.
            let sample = |place: usize| if place % 16 < 8 { mv } else { -mv };
            stream.feed(&std::array::from_fn::<_, COIL_SAMPLES, _>(|place| {
                [sample(place); 2]
            }));
            std::thread::sleep(SCAN);
        }
    };
    play(QUIET, 0.0);
    heard
        .try_iter()
        .for_each(|(_, mv)| silence = silence.max(mv));
    let began = Instant::now();
    play(BEEP, BEEP_MV);
    play(QUIET, 0.0);
    let loud = heard.try_iter().filter(|(_, mv)| *mv > LOUDER * silence);
    // All samples are taken, so that this beep does not count as the silence before the next.
    let first = loud.map(|(at, _)| at).min();
    first.map(|at| at.saturating_duration_since(began))
}
