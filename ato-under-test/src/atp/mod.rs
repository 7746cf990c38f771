//! ATP: automatic train protection. [`Atp::scan`] runs every 10 ms, in order: speed code, speed, limit,
//! overspeed, doors, direction of travel, brakes. The mode sequence runs with the 50 ms cycle.

mod brake_proof;
mod causes;
mod code;
mod contacts;
mod credible_speed;
mod direction;
mod door_lines;
mod door_order;
mod doors;
mod emergency;
mod heard;
mod interlock;
mod jog_guard;
mod mode;
mod outputs;
mod overspeed;
mod sides;
mod stop_and_proceed;
mod tachometers;
mod yard;

use protocol::config::{OverspeedConfig, UnitConfig};
use protocol::event::Event;
use protocol::message::{DoorSide, EbCause, FsbCause, Mode, ModeSwitch, TrainLines};
use protocol::{Instant, Speed};

use crate::guards::Guards;
use crate::kernel::EventLog;
use crate::signals::Inputs;
use crate::timer::Edge;
use contacts::Contacts;
use direction::{Rollback, Towards};
use door_order::DoorOrders;
use interlock::{BrakePath, Interlock};
use jog_guard::{JogGuard, JogInputs};
use stop_and_proceed::{ProceedInputs, StopAndProceed};
use yard::Yard;

pub use brake_proof::{BrakeProof, BrakeState, Demand};
pub use causes::shown_cause;
pub use code::{CodeDecoder, lookup};
pub use credible_speed::SpeedEvidence;
pub use door_lines::DoorLines;
pub use doors::{DoorInputs, Doors};
pub use emergency::{BrakeInputs, EmergencyBrake};
pub use heard::Code;
pub use mode::{ModeInputs, ModeSequence};
pub use overspeed::{Overspeed, OverspeedSupervision, SupervisedMotion};
pub use tachometers::Tachometers;

/// Data of the other functions for a scan of ATP.
#[derive(Clone, Copy, Debug)]
pub struct ScanContext {
    /// Start-up has finished, and no vital item has failed.
    pub vital_passed: bool,
    pub started: bool,
    /// The harness has been alive at least once.
    pub ever_alive: bool,
    pub aligned: bool,
    /// The train is on the arrival station's loop, with valid station data.
    pub at_platform: bool,
    pub door_side: DoorSide,
    /// Sides on which ATO orders doors to open.
    pub door_order: DoorSide,
    pub twc_up: bool,
    pub tcms_up: bool,
    pub ato_ready: bool,
    /// Direction in which ATO jogs: backward or not; `None` = no jog.
    pub jogs_backward: Option<bool>,
    /// Distance past the stop point, m, where the section's last marker proves it.
    pub overrun_m: Option<f64>,
    /// Share by which markers prove that the wheels run farther than is measured.
    pub runs_farther: f64,
    /// Speed of the axles that TCMS measures; `None` = it does not tell.
    pub tcms_speed: Option<Speed>,
    /// Share by which the unit's clock is faster than TCMS's; 0 if it is not.
    pub clock_ahead: f64,
    /// Something else than the unit has opened the brake line, by read-back or as TCMS tells.
    pub line_open: bool,
    /// Something else has opened the line after it had followed the relay.
    pub line_fell: bool,
    /// The brake line is energised although the unit's relay should have opened it.
    pub line_stays: bool,
    /// Emergency brake of the train as TCMS tells it.
    pub tcms_eb: Option<bool>,
    /// TCMS holds the train, or cuts its power.
    pub tcms_holds: bool,
    /// ATO asks for power.
    pub ato_powers: bool,
    pub guards: Guards,
}

/// Causes for the emergency brake that functions of ATP found in a scan.
#[derive(Clone, Copy, Debug)]
struct Found {
    /// The train ran against the reverser.
    rollback: bool,
    /// The train ran forward although ATO jogs it backward.
    wrong_way: bool,
    door_open: bool,
    /// Faster than the limit for too long.
    beyond: bool,
    /// The service brake that is asked for slows the train too little.
    ineffective: bool,
    /// Others opened the brake line of a train that moves: it stays braked until it stands.
    line_opened: bool,
}

/// State of the protection functions from scan to scan.
#[derive(Clone, Debug)]
pub struct Atp {
    decoder: CodeDecoder,
    tachometers: Tachometers,
    yard: Yard,
    proceeds: StopAndProceed,
    supervision: OverspeedSupervision,
    proof: BrakeProof,
    doors: Doors,
    door_orders: DoorOrders,
    switch: Contacts<ModeSwitch>,
    reverser: Contacts<TrainLines>,
    rollback: Rollback,
    jog: JogGuard,
    brake: EmergencyBrake,
    path: BrakePath,
    interlock: Interlock,
    sequence: ModeSequence,
    limit: Speed,
    overspeed: Overspeed,
    fsb_cause: FsbCause,
    inputs_lost: Edge,
    broken: Edge,
    doors_closed: bool,
    /// The train has told of doors by side since power-up.
    doors_by_side: bool,
    doors_open: DoorSide,
}

impl Atp {
    /// ATP at power-up, with the emergency brake applied.
    pub fn new(config: &UnitConfig) -> Self {
        Self {
            decoder: CodeDecoder::default(),
            tachometers: Tachometers::new(config),
            yard: Yard::new(config),
            proceeds: StopAndProceed::default(),
            supervision: OverspeedSupervision::default(),
            proof: BrakeProof::default(),
            doors: Doors::default(),
            door_orders: DoorOrders::default(),
            switch: Contacts::default(),
            reverser: Contacts::default(),
            rollback: Rollback::default(),
            jog: JogGuard::default(),
            brake: EmergencyBrake::new(),
            path: BrakePath::default(),
            interlock: Interlock::default(),
            sequence: ModeSequence::new(),
            limit: Speed::ZERO,
            overspeed: Overspeed::default(),
            fsb_cause: FsbCause::None,
            inputs_lost: Edge::default(),
            broken: Edge::default(),
            doors_closed: false,
            doors_by_side: false,
            doors_open: DoorSide::None,
        }
    }

    pub fn scan(
        &mut self,
        now: Instant,
        inputs: &Inputs,
        context: ScanContext,
        config: &UnitConfig,
        log: &mut EventLog,
    ) {
        let guards = context.guards;
        let confirmed = guards.code_confirmation;
        self.decoder
            .step(now, inputs.signal, confirmed, config, log);
        let moves = !self.tachometers.standstill();
        let switch = (inputs.mode_switch, moves);
        (self.switch).step(now, switch, Event::ModeSwitchChatters, log);
        let reverser = (inputs.lines).intersection(TrainLines::FORWARD | TrainLines::BACKWARD);
        (self.reverser).step(now, (reverser, moves), Event::ReverserChatters, log);
        self.tachometers.correct(context.runs_farther);
        let evidence = self.evidence(inputs, context);
        self.tachometers.step(now, inputs, evidence, config, log);
        let (speed, standstill) = (self.tachometers.speed(), self.tachometers.standstill());
        let still = self.tachometers.still();
        let mode = self.sequence.mode();
        let known = self.decoder.known(&config.codes);
        let meaning = known.map(|code| code.meaning);
        let stops = self.decoder.stops(&config.codes);
        self.yard.step(now, mode, meaning, stops, log);
        let proceed_inputs = ProceedInputs {
            without_code: self.by_code() && self.decoder.code == Code::None,
            by_driver: matches!(inputs.mode_switch, ModeSwitch::Manual | ModeSwitch::Yard),
            standstill,
            brakes: inputs.controller < 0,
        };
        self.proceeds
            .step(now, proceed_inputs, config.stop_and_proceed.as_ref(), log);
        self.limit = match self.protected(inputs.lines) {
            true => self.limit_in_force(config),
            false => Speed::ZERO,
        };
        let motion = SupervisedMotion {
            speed,
            limit: self.limit,
            stop: self.must_stand() && guards.stop,
            standstill,
            moves: self.tachometers.moves(config),
        };
        self.overspeed = self.supervision.step(now, motion, config, log);
        self.fsb_cause = self.service_cause(context, motion.stop);
        let margins = &config.overspeed;
        let proof = self
            .proof
            .step(now, speed, self.demand(motion, margins), margins);
        let beyond = self.supervision.emergency(now, motion, proof, margins);
        self.doors_by_side |= inputs.lines.contains(TrainLines::DOORS_BY_SIDE);
        let door_lines = DoorLines::new(inputs.lines, self.doors_by_side);
        self.doors_closed = door_lines.closed();
        self.doors_open = door_lines.open();
        let door_inputs = DoorInputs {
            lines: inputs.alive.then_some(door_lines),
            supervised: guards.doors && self.sequence.mode() != Mode::Off,
            latched: guards.enable_latch,
            standstill,
            aligned: context.aligned,
            at_platform: context.at_platform,
            side: context.door_side,
            speed,
            // A lone pulse of wheels that stand is spurious.
            way_m: if still {
                0.0
            } else {
                self.tachometers.farthest_m()
            },
        };
        let door_open = self.doors.step(now, door_inputs, &config.doors, log);
        self.door_orders
            .step(now, context.door_order, self.doors.enable(), log);
        let moved_m = self.tachometers.ways_m;
        let jog_inputs = JogInputs {
            backward: context.jogs_backward,
            permitted: self.may_jog_backward(inputs.lines),
            overrun_m: context.overrun_m,
            moved_m,
            speed,
            standstill,
            still,
            guarded: guards.jog,
        };
        let wrong_way = self.jog.step(now, jog_inputs, config, log);
        let allowed_m = config.tacho.rollback_m + self.jog.back_m();
        // Rollback is summed up anew when a jog's permission ends, when the train stands with its brake applied or
        // after a jog, and when an automatic run begins.
        let stopped = still && (self.brake.applied() || self.jog.back_m() > 0.0);
        let from_zero = self.jog.ended || stopped || self.sequence.begins();
        let chatters = self.reverser.chatters();
        let towards = Towards::of(inputs.lines, chatters, inputs.test_speed, guards.neutral);
        let rollback =
            self.rollback
                .step(now, (moved_m, still), towards, from_zero, allowed_m, log);
        let found = Found {
            rollback,
            wrong_way,
            door_open,
            beyond,
            ineffective: proof.ineffective,
            line_opened: context.line_fell && !standstill,
        };
        let cause = self.emergency_cause(now, inputs, context, found, log);
        let brake_inputs = BrakeInputs {
            cause,
            excess_cms: self.overspeed.excess_cms,
            proof,
            standstill,
            still: standstill && (still || !guards.release_standstill),
            doors_closed: self.doors_closed,
            acknowledge: inputs.lines.contains(TrainLines::ACKNOWLEDGE),
            compares_cause: guards.release,
        };
        self.brake.step(now, brake_inputs, log);
        // The brake of a power-up is not judged at standstill: TCMS may not have told of the line yet.
        let asked =
            self.brake.applied() && (self.brake.cause() != EbCause::NotReleased || !standstill);
        let unslowed = !standstill && !proof.proved;
        let stays = context.line_stays;
        self.path
            .step(now, asked, stays, context.tcms_eb, unslowed, log);
        let held = self.brake.applied()
            || context.line_fell
            || !self.doors_closed
            || self.sequence.unmanned();
        self.interlock
            .step(now, held, context.line_open, inputs.controller);
    }

    /// A code protects the track ahead alone: backward it permits nothing.
    fn protected(&self, lines: TrainLines) -> bool {
        !lines.contains(TrainLines::BACKWARD) || !self.by_code()
    }

    /// A train that has run past its stop point may be jogged back.
    fn may_jog_backward(&self, lines: TrainLines) -> bool {
        let ahead = lines.contains(TrainLines::FORWARD) && !lines.contains(TrainLines::BACKWARD);
        let run = self.sequence.mode() == Mode::AutomaticRun;
        run && ahead && self.doors_closed && self.limit > Speed::ZERO
    }

    /// Demand on the service brake, if it is asked for and has a train to slow.
    fn demand(&self, motion: SupervisedMotion, margins: &OverspeedConfig) -> Demand {
        let alarm_kmh = motion.limit.kmh() + margins.alarm_margin_kmh;
        match self.fsb_cause {
            FsbCause::None => Demand::default(),
            // Close to the limit a deceleration can no longer be measured.
            FsbCause::Overspeed => Demand {
                holds: true,
                measurable: motion.speed.kmh() > alarm_kmh,
            },
            _ => Demand {
                holds: motion.moves,
                measurable: motion.moves,
            },
        }
    }

    /// Forgets the decoded code, after the receiver was used for a test.
    pub fn forget_code(&mut self) {
        self.decoder = CodeDecoder::default();
    }

    /// One cycle of the mode sequence.
    pub fn cycle(&mut self, now: Instant, inputs: ModeInputs, log: &mut EventLog) {
        self.sequence.step(now, inputs, log);
    }

    /// No powering while braking, with doors open, against a stop or for a jog that is not permitted.
    pub fn power_cut(&self) -> bool {
        self.brake.applied()
            || self.fsb_cause != FsbCause::None
            || !self.doors_closed
            || self.limit == Speed::ZERO
            || self.interlock.cuts()
            || self.jog.refuses()
            || self.tachometers.credible.cuts_power()
    }

    /// Evidence against which the speed is held.
    fn evidence(&self, inputs: &Inputs, context: ScanContext) -> SpeedEvidence {
        let notch = match self.sequence.mode() {
            Mode::AutomaticRun => context.ato_powers,
            Mode::Off => false,
            _ => inputs.controller > 0,
        };
        let held = self.power_cut() || context.tcms_holds;
        SpeedEvidence {
            tcms_speed: context.tcms_speed,
            clock_ahead: context.clock_ahead,
            powers: notch && !held,
            acknowledge: inputs.lines.contains(TrainLines::ACKNOWLEDGE),
            tested: inputs.test_speed.contains(&true),
            unguarded: !context.guards.speed,
        }
    }
}
