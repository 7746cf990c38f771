//! ATO: drives the train from station to station while ATP says Automatic Run.
//!
//! One cycle, in order [S0 §3]: operating state ([`AtoState`], ART), speed to run at (`cruise`), where
//! the train will be when the effort acts (`observer`), the speed controller ([`controller`], SPR),
//! what the track costs (`feed_forward`), and the share of available effort for TCMS (`reg`, REG).

mod art;
pub mod controller;
mod cruise;
mod feed_forward;
mod observer;
mod profile;
mod reg;

use alloc::boxed::Box;

use protocol::Speed;
use protocol::config::AtoConfig;
use protocol::line::Section;
use protocol::message::{AtoState, Mode, RunningMode};

use controller::{Situation, SpeedController, controller};
use cruise::CruiseInputs;
use observer::Observer;
use reg::{Bounds, Granted, Regulator};

pub use art::ArtInputs;

/// What ATO looks at in one cycle.
#[derive(Clone, Copy, Debug)]
pub struct AtoInputs<'a> {
    /// Operating mode set by ATP.
    pub mode: Mode,
    /// Limit from ATP.
    pub limit: Speed,
    /// Fixed speed ordered by the wayside.
    pub fixed_speed: Option<Speed>,
    /// Running mode ordered by the wayside.
    pub running_mode: RunningMode,
    /// Section of the track database the train is in.
    pub section: Option<&'a Section>,
    /// Position in it, m.
    pub position_m: f64,
    /// Measured speed.
    pub speed: Speed,
    /// Standing still.
    pub standstill: bool,
    /// ATP or TCMS cuts powering.
    pub power_cut: bool,
    /// Passenger load TCMS reports, kg.
    pub load_kg: f64,
    /// The processor works.
    pub healthy: bool,
}

/// What ATO commands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AtoOutputs {
    /// Ready to drive.
    pub ready: bool,
    /// Target speed.
    pub target: Speed,
    /// Effort, -1024 full brake .. 1023 full power.
    pub effort: i16,
    /// Holding brake.
    pub holding_brake: bool,
}

/// The automatic operation.
#[derive(Debug)]
pub struct Ato {
    state: AtoState,
    observer: Observer,
    controller: Box<dyn SpeedController>,
    regulator: Regulator,
    granted: Granted,
    feed_forward_n: f64,
}

impl Ato {
    /// Ready once it has been inspected.
    pub fn new(config: &AtoConfig) -> Self {
        Self {
            state: AtoState::Inspection,
            observer: Observer::default(),
            controller: controller(config),
            regulator: Regulator::default(),
            granted: Granted::default(),
            feed_forward_n: 0.0,
        }
    }

    /// One 50 ms cycle.
    pub fn step(&mut self, inputs: AtoInputs<'_>, config: &AtoConfig) -> AtoOutputs {
        let to_stop_m = inputs.section.map(|s| s.stop_m - inputs.position_m);
        self.state = art::next(
            self.state,
            ArtInputs {
                healthy: inputs.healthy,
                run: inputs.mode == Mode::AutomaticRun,
                standstill: inputs.standstill,
                arrived: to_stop_m.is_some_and(|d| d < config.arrived_m),
            },
        );
        match self.state {
            AtoState::Start | AtoState::Run => self.drive(&inputs, to_stop_m, config),
            AtoState::Stop | AtoState::Inspection | AtoState::Unknown(_) => self.rest(&inputs),
        }
    }

    /// Drives for one cycle.
    fn drive(
        &mut self,
        inputs: &AtoInputs<'_>,
        to_stop_m: Option<f64>,
        config: &AtoConfig,
    ) -> AtoOutputs {
        let train = &config.train;
        let weight_kg = train.empty_kg + inputs.load_kg;
        let mass_kg = weight_kg + train.rotating_kg;
        let net_mps2 = (self.granted.force_n - self.feed_forward_n) / mass_kg;
        let ahead = self.observer.step(inputs.speed.mps(), net_mps2, train);
        let cruise = cruise::cruise(
            CruiseInputs {
                limit: inputs.limit,
                fixed_speed: inputs.fixed_speed,
                running_mode: inputs.running_mode,
            },
            config,
        );
        let markers_to_stop_m = inputs
            .section
            .map_or([0.0; 4], |s| s.markers_m.map(|at| s.stop_m - at));
        let demand = self.controller.step(&Situation {
            cruise_mps: cruise.mps(),
            speed_mps: ahead.speed_mps,
            accel_mps2: ahead.accel_mps2,
            to_stop_m: to_stop_m.map(|way| way - ahead.moved_m),
            markers_to_stop_m,
            mass_kg,
            granted_n: self.granted.force_n - self.feed_forward_n,
        });
        self.feed_forward_n =
            feed_forward::holding_force_n(inputs.section, inputs.position_m, weight_kg, train);
        let most = config.accel_kmh_per_s / 3.6 * mass_kg;
        let least = -config.decel_kmh_per_s / 3.6 * mass_kg;
        let bounds = Bounds {
            speed_mps: inputs.speed.mps(),
            mass_kg,
            power_cut: inputs.power_cut,
        };
        // A demand that is no number stays one, so that REG brakes.
        let asked_n = demand.force_n.clamp(least, most) + self.feed_forward_n;
        self.granted = self.regulator.step(asked_n, bounds, config);
        AtoOutputs {
            ready: inputs.healthy,
            target: Speed::from_mps(demand.target_mps),
            effort: self.granted.effort,
            holding_brake: false,
        }
    }

    /// Stands, or is not to drive.
    fn rest(&mut self, inputs: &AtoInputs<'_>) -> AtoOutputs {
        self.controller.reset();
        self.regulator.reset();
        self.observer.reset();
        self.granted = Granted::default();
        self.feed_forward_n = 0.0;
        let holding_brake = inputs.mode == Mode::AutomaticRun
            || inputs.mode == Mode::Automatic && inputs.standstill;
        AtoOutputs {
            ready: inputs.healthy,
            target: Speed::ZERO,
            effort: 0,
            holding_brake,
        }
    }

    /// Operating state.
    pub fn state(&self) -> AtoState {
        self.state
    }
}

#[cfg(test)]
mod tests {
    use protocol::config::{AtoConfig, UnitConfig};

    /// ATO's part of the default configuration.
    pub fn config() -> AtoConfig {
        let text = include_str!("../../../scripts/units/sg100.toml");
        UnitConfig::from_toml(text).unwrap().ato
    }
}
