//! Since when a slow code is there, and whether it still is: its window holds seconds, and the window as a whole does
//! not tell a code that has begun or ended in it.

use core::f32::consts::{PI, TAU};

use super::code::{CodeReceiver, OnCarrier, Tone};

// All of these are [default]s, set by trial with the types of codes that there are.
/// Time about each edge of the keying that is left out, s: the filter needs it to settle.
const EDGE_S: f32 = 0.022;
/// Greatest squared distance of a value from the keying, over the squared amplitude, at which the value still fits the code:
/// more than a weaker second code adds, less than one that counts adds.
const BORNE: f32 = 0.4;
/// Sum of the distances beyond [`BORNE`] at which a code ends.
const ENDS: f32 = 1.0;
/// Share of a period, and time, s, for which two codes may look the same where one becomes the other.
const ALIKE: f32 = 0.5;
const ALIKE_S: f32 = 0.2;
/// Silence before a code: for so long, s, the mean power is below this share of the square of the code's amplitude.
const SILENT: f32 = 0.1;
const SILENT_S: f32 = 0.36;
/// Shortest part of the window that a code must explain to count as there, s.
const LEAST_S: f32 = 0.35;
/// Time without carrier that is still a pause of the keying: share of a period, at most so long, s.
const PAUSE: f32 = 0.4;
const PAUSE_S: f32 = 0.12;
/// Greatest part of a rate's period, in turns, that is left out about an edge.
const MOST_TURNS: f32 = 0.15;

impl CodeReceiver {
    /// Looks back from the newest value as far as this code, at this rate, explains the window: the time from the first
    /// value at which it had its carrier on, s, and the time for which it may be over. `None` if it is over, or
    /// explains too little.
    pub(super) fn spell_s(
        &self,
        on: &OnCarrier,
        (tone, rate_hz): (Tone, f32),
        share_on: f32,
    ) -> Option<[f32; 2]> {
        let value_hz = self.downmix.envelope_hz;
        let turn = rate_hz / value_hz;
        let amplitude = tone.amplitude * PI / 2.0 / libm::sinf(PI * share_on);
        let edge = (EDGE_S * rate_hz).min(MOST_TURNS);
        let (mut beyond, mut begins, mut on_at) = (0.0f32, None, None);
        // The tone's angle is that of its own rate, and is right in the middle of the window.
        let middle = (self.window / 2) as f32;
        let at_middle = tone.angle / TAU + tone.rate_hz / value_hz * middle;
        for place in (0..self.window).rev() {
            // Turns of the rate since the middle of the carrier's time on, and distance from the edge of that time.
            let turns = at_middle + turn * (place as f32 - middle);
            let from_edge = share_on / 2.0 - (turns - libm::roundf(turns)).abs();
            if from_edge.abs() < edge {
                continue;
            }
            let due = if from_edge > 0.0 { amplitude } else { 0.0 };
            // The distance counts across the carrier's phase, too.
            let power = self.line[(self.place + place) % self.window].power();
            let off = (power - 2.0 * due * on.values[place] + due * due) / (amplitude * amplitude);
            beyond = (beyond + off.min(1.0) - BORNE).max(0.0);
            if beyond > ENDS {
                break;
            }
            if beyond == 0.0 && from_edge > 0.0 {
                begins = Some(place as f32 - edge / turn);
                on_at.get_or_insert(place);
            }
        }
        let begins = begins?.max(0.0);
        let before = &on.values[..begins as usize];
        let power = before.iter().map(|value| value * value).sum::<f32>() / begins.max(1.0);
        let is_silent = begins > SILENT_S * value_hz && power < SILENT * amplitude * amplitude;
        let alike_s = match is_silent {
            true => 0.0,
            false => ALIKE_S.min(ALIKE / rate_hz),
        };
        let there_s = (self.window as f32 - begins) / value_hz;
        let since_on = (self.window - on_at?) as f32 / value_hz;
        let over_s = (since_on - PAUSE_S.min(PAUSE / rate_hz)).max(0.0);
        (there_s >= LEAST_S).then_some([(there_s - alike_s).max(0.0), over_s])
    }
}
