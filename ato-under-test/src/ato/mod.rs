//! ATO: drives the train from station to station while ATP says Automatic Run.
//!
//! One cycle, in order [S0 §3]: whether the inputs are plausible (`monitor`), operating state ([`AtoState`],
//! ART), limits ahead (`track_limit`), speed to run at (`cruise`), where the train will be when the effort acts (`observer`), the
//! speed controller ([`mod@controller`], SPR), what the track costs (`feed_forward`), and the share of
//! available effort for TCMS (`reg`, REG).

mod art;
pub mod controller;
mod cruise;
mod feed_forward;
mod inputs;
mod jog;
mod monitor;
mod observer;
mod profile;
mod reg;
mod track_limit;

use alloc::boxed::Box;

use protocol::Speed;
use protocol::config::{AtoConfig, UnitConfig};
use protocol::message::{AtoFailure, AtoState, Mode};

use controller::{ControllerInput, SpeedController, controller};
use jog::{Jog, JogInputs};
use monitor::{Monitor, MonitorInputs};
use observer::{Observer, SpeedMeasurement};
use reg::{Bounds, GrantedEffort, Regulator};

pub use art::{ArtInputs, Checks};
pub use inputs::{AtoInputs, TrainReport};
pub use jog::JogOutcome;
pub use monitor::Findings;

/// Speed that counts as zero: no pulse for half a second. Standstill as ATP means it is up to 0.3 m/s, at
/// which a train that is stopping still has a second to go.
const STOPPED: Speed = Speed::from_kmh(0.2);
/// Speed below which a train has come to its end, m/s.
const ENDING_MPS: f64 = 0.05;
/// Demand above which a train is to go, m/s².
const STARTING_MPS2: f64 = 0.05;
/// Brake with which a train comes to rest at least, beyond what the track costs, m/s².
const RESTING_MPS2: f64 = 0.1;
/// Effort of the full service brake.
const FULL_BRAKE: i16 = -1024;

/// Commands of ATO.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AtoOutputs {
    /// ATO is out of inspection ([`AtoState::Inspection`]).
    pub ready: bool,
    /// Speed that the speed controller tracks.
    pub target: Speed,
    /// Effort, -1024 full brake .. 1023 full power.
    pub effort: i16,
    /// The holding brake is requested of TCMS.
    pub holding_brake: bool,
    /// Whether the jog that is on goes backward; `None` = no jog.
    pub jogs_backward: Option<bool>,
    /// Result of jogging in this cycle.
    pub jog: JogOutcome,
    /// Distance run in this cycle that sliding wheels did not count, m.
    pub slid_m: f64,
    pub failure: AtoFailure,
    /// Findings of the monitor in this cycle.
    pub findings: Findings,
}

/// Automatic operation of one unit, stepped once a cycle.
#[derive(Clone, Debug)]
pub struct Ato {
    /// Operating state.
    pub state: AtoState,
    failure: AtoFailure,
    monitor: Monitor,
    observer: Observer,
    /// Section and least force on its approach, N/kg.
    approach: Option<(u16, f64)>,
    controller: Box<dyn SpeedController>,
    jog: Jog,
    regulator: Regulator,
    granted: GrantedEffort,
    feed_forward_n: f64,
}

impl Ato {
    /// An ATO at power-up: ready once it has been inspected.
    pub fn new(unit: &UnitConfig) -> Self {
        let config = &unit.ato;
        let measurement = SpeedMeasurement {
            window_s: f64::from(unit.tacho.window_ms) / 1000.0,
            pulse_m: unit.metres_per_pulse(),
        };
        Self {
            state: AtoState::Inspection,
            failure: AtoFailure::None,
            monitor: Monitor::default(),
            observer: Observer::new(&config.observer, measurement),
            approach: None,
            controller: controller(config),
            jog: Jog::default(),
            regulator: Regulator::default(),
            granted: GrantedEffort::default(),
            feed_forward_n: 0.0,
        }
    }

    /// One 50 ms cycle.
    pub fn step(&mut self, inputs: AtoInputs<'_>, config: &AtoConfig) -> AtoOutputs {
        // While the position is unsure, the shortest distance that can be believed.
        let to_stop_m = inputs
            .section
            .map(|s| s.stop_m - inputs.position_m - inputs.ahead_m);
        let slowing_m = |from_mps, to_mps| self.controller.slowing_m(from_mps, to_mps);
        let cruise = cruise::on_track(&inputs, config, slowing_m);
        let stands = inputs.standstill && inputs.speed <= STOPPED && !self.observer.sliding();
        let may_go = cruise > Speed::ZERO && !inputs.power_cut;
        let drives = art::drives(self.state);
        let jog_inputs = JogInputs {
            drives,
            stands,
            may_go,
            to_stop_m,
            aligned_m: inputs.aligned_m,
            last_marker: inputs.last_marker,
            jogs: inputs.jogs,
        };
        let jog = self.jog.step(&jog_inputs, &config.jog);
        let at_stop = |distance_m: f64| libm::fabs(distance_m) <= inputs.aligned_m;
        let arrived = match drives {
            true => jog.ended,
            false => to_stop_m.is_some_and(at_stop),
        };
        let monitored = MonitorInputs {
            state: self.state,
            may_go: may_go && !inputs.train.overrides,
            asked_mps2: self.net_mps2(&inputs, config),
            stands,
            arrived,
        };
        let findings = self.monitor.step(&inputs, monitored, config);
        self.failure = self.failure_after(&inputs, &findings);
        self.state = art::next(
            self.state,
            ArtInputs {
                fit: inputs.checks != Checks::Running && self.failure == AtoFailure::None,
                run: inputs.mode == Mode::AutomaticRun,
                standstill: stands,
                arrived,
            },
        );
        let outputs = if art::drives(self.state) {
            self.drive(&inputs, cruise, to_stop_m, config)
        } else {
            self.rest(&inputs)
        };
        AtoOutputs {
            ready: self.state != AtoState::Inspection,
            failure: self.failure,
            findings,
            jog,
            ..outputs
        }
    }

    /// Failure of ATO: the first failure of a run is kept until the train stands outside Automatic
    /// Run; then ATO is inspected again.
    fn failure_after(&self, inputs: &AtoInputs<'_>, findings: &Findings) -> AtoFailure {
        let run = inputs.mode == Mode::AutomaticRun;
        let kept = run || !inputs.standstill;
        match (inputs.checks, self.failure) {
            (Checks::Failed(failure), _) => failure,
            (_, failure) if failure != AtoFailure::None && kept => failure,
            _ if run && !findings.absurd.is_empty() => AtoFailure::Inputs,
            _ if findings.not_following_mps.is_some() => AtoFailure::NotFollowing,
            // Power that is withheld makes a late train, brake that is withheld a dangerous one.
            _ if findings.withheld_mps.is_some_and(|more| more > 0.0) => AtoFailure::TrainWithholds,
            _ => AtoFailure::None,
        }
    }

    /// Acceleration the last effort asks for, what the track costs taken off, m/s².
    fn net_mps2(&self, inputs: &AtoInputs<'_>, config: &AtoConfig) -> f64 {
        let mass_kg = config.train.empty_kg + inputs.load_kg + config.train.rotating_kg;
        self.net_n() / mass_kg
    }

    /// Force of the last effort, what the track costs taken off, N.
    fn net_n(&self) -> f64 {
        self.granted.force_n - self.feed_forward_n
    }

    /// Drives for one cycle.
    fn drive(
        &mut self,
        inputs: &AtoInputs<'_>,
        cruise: Speed,
        to_stop_m: Option<f64>,
        config: &AtoConfig,
    ) -> AtoOutputs {
        let train = &config.train;
        let weight_kg = train.empty_kg + inputs.load_kg;
        let mass_kg = weight_kg + train.rotating_kg;
        if self.jog.begins() {
            // What was asked for until now was for the other direction, or to hold the train.
            self.observer.reset();
        }
        let granted_n = self.net_n();
        let ahead = self
            .observer
            .step(inputs.speed.mps(), granted_n / mass_kg, train);
        let markers_to_stop_m = inputs
            .section
            .map_or([0.0; 4], |s| s.markers_m.map(|at| s.stop_m - at));
        let brake_mps2 = self.brake_mps2(inputs, weight_kg / mass_kg, config);
        let jogs = self.jog.acts();
        let backward = self.jog.backward();
        let demand = if jogs {
            self.controller.reset();
            let to_stop_m = to_stop_m.unwrap_or_default();
            let left_m = if backward { -to_stop_m } else { to_stop_m };
            self.jog.demand(
                left_m - ahead.moved_m,
                ahead.speed_mps,
                mass_kg,
                train.jerk_mps3,
                &config.jog,
            )
        } else {
            self.controller.step(&ControllerInput {
                cruise_mps: cruise.mps(),
                speed_mps: ahead.speed_mps,
                accel_mps2: ahead.accel_mps2,
                to_stop_m: to_stop_m.map(|distance| distance - ahead.moved_m),
                markers_to_stop_m,
                mass_kg,
                brake_mps2,
                granted_n,
            })
        };
        self.feed_forward_n = feed_forward::holding_force_n(
            inputs.section,
            inputs.position_m,
            backward,
            weight_kg,
            train,
        );
        let most = match to_stop_m {
            Some(distance) if distance < markers_to_stop_m[1] => config.gently_mps2,
            _ => config.accel_kmh_per_s / 3.6,
        } * mass_kg;
        let least = -config.decel_kmh_per_s / 3.6 * mass_kg;
        let bounds = Bounds {
            speed_mps: inputs.speed.mps(),
            mass_kg,
            power_cut: inputs.power_cut,
        };
        let speed_ends = ahead.speed_mps <= ENDING_MPS;
        let starts_mps2 = self.jog.least_mps2();
        let goes = demand.force_n > STARTING_MPS2 * mass_kg || starts_mps2.is_some();
        // A departure under a target speed of 0 holds the train until there is a speed to run at.
        let rests = !goes && (self.state == AtoState::Run || jogs || cruise == Speed::ZERO);
        // A demand that is not a number (NaN) stays NaN, so that REG brakes.
        let past_it = !jogs && to_stop_m.is_some_and(|distance| distance < -config.watch.overrun_m);
        let force_n = if past_it { least } else { demand.force_n };
        let asked_n = force_n.clamp(least, most) + self.feed_forward_n;
        // When this effort acts the train will stand: what held it on a climb until then must be a brake.
        let standing_n = -(libm::fabs(self.feed_forward_n) + RESTING_MPS2 * mass_kg);
        let asked_n = match starts_mps2 {
            Some(least_mps2) => asked_n.max(least_mps2 * mass_kg),
            None if rests && speed_ends => asked_n.min(standing_n),
            None => asked_n,
        };
        self.granted = self.regulator.step(asked_n, bounds, config);
        AtoOutputs {
            holding_brake: rests && inputs.standstill && inputs.speed <= STOPPED,
            jogs_backward: self.jog.direction(),
            target: Speed::from_mps(demand.target_mps),
            slid_m: ahead.slid_m,
            effort: self.granted.effort,
            ..AtoOutputs::default()
        }
    }

    /// Deceleration the full brake has on the steepest descent of the approach, m/s².
    fn brake_mps2(&mut self, inputs: &AtoInputs<'_>, weighs: f64, config: &AtoConfig) -> f64 {
        let Some(section) = inputs.section else {
            return 0.0;
        };
        let known = self
            .approach
            .filter(|(number, _)| *number == section.section);
        let (_, least) = *self.approach.insert(known.unwrap_or_else(|| {
            let least = feed_forward::approach_n_per_kg(section, &config.train);
            (section.section, least)
        }));
        config.decel_kmh_per_s / 3.6 + least * weighs
    }

    /// Outputs while the train stands, or while ATO is not to drive.
    fn rest(&mut self, inputs: &AtoInputs<'_>) -> AtoOutputs {
        self.controller.reset();
        self.regulator.reset();
        self.observer.reset();
        self.granted = GrantedEffort::default();
        self.feed_forward_n = 0.0;
        let holding_brake = inputs.mode == Mode::AutomaticRun
            || inputs.mode == Mode::Automatic && inputs.standstill;
        // A train that ATO has to drive and cannot is braked until it stands.
        let brakes = inputs.mode == Mode::AutomaticRun && !inputs.standstill;
        AtoOutputs {
            effort: if brakes { FULL_BRAKE } else { 0 },
            holding_brake,
            ..AtoOutputs::default()
        }
    }

    /// The train stands after a run, at the stop point or as near to it as it came.
    pub fn arrived(&self) -> bool {
        self.state == AtoState::Stop
    }

    /// The train stands after a run away from the stop point, and jogging has given up.
    pub fn gave_up(&self) -> bool {
        self.jog.gave_up
    }
}
