//! What the ATP antenna hears in a minute: codes that stay, codes that flicker, and those of a neighbouring track.

use btu_rig::stimulus::Stimulus;
use protocol::{Duration, Instant};

use super::Minute;

impl Minute<'_> {
    pub(super) fn change_code(&mut self) {
        self.flicker = None;
        if self.chance(0.4) {
            return self.apply(Stimulus::CodesAlong { on: true });
        }
        let code = self.any_code();
        self.apply(code);
    }

    /// Two codes by turns, or one and none, that stay from 10 ms to a second.
    pub(super) fn let_code_flicker(&mut self) {
        let mut one = || {
            let ms = self.one_of(&[10, 20, 50, 100, 200, 380, 450, 900]);
            (self.any_code(), Duration::from_ms(ms))
        };
        let turns = [one(), one()];
        let [(first, _), (second, _)] = turns;
        let now = self.bench.now();
        self.acts.push((
            now,
            format!(
                "{first} and {second} by turns, {:?} and {:?}",
                turns[0].1, turns[1].1
            ),
        ));
        self.flicker = Some(turns);
        self.flicker_due = now;
    }

    pub(super) fn turn_code(&mut self, now: Instant) {
        let Some(turns) = self.flicker.as_mut().filter(|_| now >= self.flicker_due) else {
            return;
        };
        turns.reverse();
        let (code, stays) = turns[0];
        self.flicker_due = now + stays;
        let refused = self.bench.rig_mut().apply(now, &code);
        refused.expect("any code can be put in");
    }

    /// A code of a neighbouring track beside what is there, from 12 dB weaker to 6 dB stronger than a nominal one; or none any more.
    pub(super) fn let_neighbour_speak(&mut self) {
        let config = &self.setup.config.content;
        let code = config.codes[self.random.below(config.codes.len())].clone();
        let times = self.one_of(&[0.0, 0.25, 0.5, 0.5, 0.56, 0.7, 1.0, 1.4, 2.0]);
        self.apply(Stimulus::Crosstalk {
            carrier_hz: code.carrier_hz,
            rate_hz: code.rate_hz,
            level_mv: times * config.receiver.level_nominal_mv,
        });
    }

    fn any_code(&mut self) -> Stimulus {
        let config = &self.setup.config.content;
        let code = config.codes[self.random.below(config.codes.len())].clone();
        let level_mv = config.receiver.level_nominal_mv;
        let signal = |rate_hz| Stimulus::Code {
            carrier_hz: code.carrier_hz,
            rate_hz,
            level_mv,
        };
        match self.random.below(8) {
            0 => Stimulus::CodeOff,
            1 => signal(0.0),
            _ => signal(code.rate_hz),
        }
    }
}
