//! Waveforms that a sound card carries in place of frames.

use std::time::Duration;

use btu_rig::rig::{InstrumentFault, LinkTrouble};
use protocol::message::{COIL_PART, COIL_SAMPLES, COIL_STEP_MV, Coil, CoilSamples};

use super::file::Places;
use super::placed::trouble;
use crate::sound::Stream;

/// The sound card at work.
pub(super) struct BySound {
    pub name: String,
    pub stream: Stream,
    coils: Vec<Coil>,
    /// How late it may be heard.
    uncertainty: Duration,
    pub late: Duration,
    /// This scan's samples: codes; TWC and markers.
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

    /// The end of a scan.
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

/// How long sound is on its way, ms: half a second of silence is played, as fast as it comes.
pub(super) fn try_sound(stream: &Stream) -> Result<f64, InstrumentFault> {
    let mut takes_ms = 0;
    for _ in 0..50 {
        stream.feed(&[[0.0; 2]; COIL_SAMPLES]);
        std::thread::sleep(Duration::from_millis(10));
        takes_ms = takes_ms.max(stream.takes_ms());
    }
    stream.clipped().map(|_| takes_ms as f64)
}
