//! The receiver of markers on a channel, and the markers that were passed.

use ato_under_test::receivers::{MarkerReceiver, Passed};
use protocol::config::UnitConfig;

use super::reading::{Clock, MOST, Source};

/// The receiver of markers.
pub(super) struct Markers {
    receiver: MarkerReceiver,
    tones_hz: [f64; 4],
    pub(super) done: Vec<Source>,
    /// Whether a marker was being passed at each asking of the codes in the last block.
    pub(super) understood: Vec<bool>,
}

impl Markers {
    pub(super) fn new(unit: &UnitConfig, sample_hz: f64) -> Self {
        let tones_hz = unit.marker.tones_hz;
        let level_min = unit.receiver.level_min_mv as f32;
        Self {
            receiver: MarkerReceiver::new(tones_hz, sample_hz as f32, level_min),
            tones_hz,
            done: Vec::new(),
            understood: Vec::new(),
        }
    }

    pub(super) fn take_block(&mut self, samples: &[f32], clock: Clock, channel: usize) {
        self.understood.clear();
        let mut passed_now = false;
        for (place, sample) in samples.iter().enumerate() {
            if let Some(passed) = self.receiver.take(*sample) {
                passed_now = true;
                self.pass(passed, clock.at_s(place), channel);
            }
            if (place + 1) % clock.asked_every == 0 {
                self.understood
                    .push(passed_now || self.receiver.is_passing());
                passed_now = false;
            }
        }
        self.done.truncate(MOST);
    }

    fn pass(&mut self, passed: Passed, at_s: f64, channel: usize) {
        let at_s = at_s - f64::from(passed.ago_s);
        self.done.push(Source {
            kind: "marker",
            channel,
            from_s: at_s,
            to_s: at_s,
            what: format!("PSM{}", passed.marker),
            carrier_hz: self.tones_hz[usize::from(passed.marker) - 1],
            level_mv: Some(f64::from(passed.level_mv)),
            ..Source::default()
        });
    }
}
