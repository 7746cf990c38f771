//! Test mode: what the unit does while a tester is armed.
//!
//! While armed, the functions have a second instance, a copy made at arming, which has the test signals as its inputs
//! and is what the tester sees. The first instance goes on with the inputs of train and track alone. It knows nothing
//! of test signals, so that nothing of them is left when the copy is thrown away. At the outputs the more restrictive
//! of both counts, and the full service brake is held (`outputs`).
//!
//! Test mode is for a train that stands. It ends, and the emergency brake is applied, when the train moves, when the
//! speed code in the rail or the mode switch changes, when the maintenance key is taken, and when the train no longer
//! proves that it is braked.

use protocol::config::UnitConfig;
use protocol::message::{ArmRefusal, ModeSwitch, TrainLines};
use protocol::{Duration, Instant, Speed};

use super::functions::Functions;
use crate::atp::{Code, lookup};
use crate::front_end::ScannedInputs;
use crate::guards::Guards;
use crate::signals::Pulses;
use crate::timer::OnDelay;

/// Way that a standing train may be moved, m: couplers and suspension give, a wheel that turns gives more.
const MOST_MOVED_M: f64 = 0.3;
/// Speed above which a train moves.
const MOVES: Speed = Speed::from_kmh(0.5);
/// Time for which another code must be in the rail: a scan in which the signal is disturbed is no change.
const CODE_STEADY: Duration = Duration::from_ms(50);
/// Longest time without a proof of applied brakes [default]: one brake takes over from another, as TCMS tells, in less.
const UNPROVED: Duration = Duration::from_ms(1000);

#[derive(Debug)]
pub struct TestMode {
    /// The functions under test, fed with the test signals.
    pub functions: Functions,
    /// Way since arming by each tachometer, m, backward negative.
    moved_m: [f64; 2],
    mode_switch: ModeSwitch,
    code: Code,
    /// Time until which the receiver may still hear a code that was over at arming.
    heard_until: Option<Instant>,
    other_code: OnDelay,
    unbraked: OnDelay,
}

impl TestMode {
    /// Begins with what the unit knows, and with the inputs as they are.
    pub fn begin(functions: &Functions, inputs: &ScannedInputs, config: &UnitConfig) -> Self {
        Self {
            functions: functions.clone(),
            moved_m: [0.0; 2],
            mode_switch: inputs.train.mode_switch,
            code: lookup(inputs.track, config),
            heard_until: None,
            other_code: OnDelay::default(),
            unbraked: OnDelay::default(),
        }
    }

    /// One scan: why test mode must end, if it must. `train` is the instance that sees the train alone; `braked`: the
    /// train proves that its brakes are applied.
    pub fn ends(
        &mut self,
        now: Instant,
        inputs: &ScannedInputs,
        (train, braked): (&Functions, bool),
        config: &UnitConfig,
        guards: Guards,
    ) -> Option<ArmRefusal> {
        let code = lookup(inputs.track, config);
        let until = now + inputs.track.heard_for;
        let may_end = now < *self.heard_until.get_or_insert(until);
        if may_end && code == Code::None {
            self.code = code;
        }
        let other_code = self.other_code.update(now, code != self.code, CODE_STEADY);
        let unbraked = self.unbraked.update(now, !braked, UNPROVED);
        let causes = [
            (
                guards.key,
                !inputs.train.lines.contains(TrainLines::MAINTENANCE_KEY),
                ArmRefusal::KeyOff,
            ),
            (
                guards.motion,
                self.moves(&inputs.train.pulses, train, config),
                ArmRefusal::TrainMoved,
            ),
            (
                guards.mode_switch,
                inputs.train.mode_switch != self.mode_switch,
                ArmRefusal::ModeChanged,
            ),
            (guards.rail_code, other_code, ArmRefusal::CodeChanged),
            (guards.arm_brakes, unbraked, ArmRefusal::BrakesReleased),
        ];
        let broken = causes.iter().find(|(guard, holds, _)| *holds && *guard);
        broken.map(|(_, _, refusal)| *refusal)
    }

    fn moves(&mut self, pulses: &[Pulses; 2], train: &Functions, config: &UnitConfig) -> bool {
        for (moved_m, pulses) in self.moved_m.iter_mut().zip(pulses) {
            *moved_m += pulses.way_m(config.metres_per_pulse());
        }
        let far = self
            .moved_m
            .iter()
            .any(|way_m| libm::fabs(*way_m) > MOST_MOVED_M);
        far || train.atp.tachometers().speed() > MOVES
    }
}
