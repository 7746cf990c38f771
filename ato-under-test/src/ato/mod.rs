//! ATO: drives the train from station to station while ATP says Automatic Run.
//!
//! Three steps a cycle: operating state (ART), target speed, and the speed controller whose effort
//! REG hands to TCMS [S0 §3]. The controller sits behind [`SpeedController`].

mod art;
mod speed_loop;
mod target;

use protocol::Speed;
use protocol::config::AtoConfig;
use protocol::message::{Mode, RunningMode};

pub use art::{ArtInputs, AtoState};
pub use speed_loop::{Drive, SpeedController, SpeedLoop};
pub use target::{TargetInputs, TargetSpeed};

/// What ATO looks at in one cycle.
#[derive(Clone, Copy, Debug)]
pub struct AtoInputs {
    /// Operating mode set by ATP.
    pub mode: Mode,
    /// Limit from ATP.
    pub limit: Speed,
    /// Fixed speed ordered by the wayside.
    pub fixed_speed: Option<Speed>,
    /// Running mode ordered by the wayside.
    pub running_mode: RunningMode,
    /// Distance to the stop point, m.
    pub to_stop_m: Option<f64>,
    /// Measured speed.
    pub speed: Speed,
    /// Standing still.
    pub standstill: bool,
    /// ATP or TCMS cuts powering.
    pub power_cut: bool,
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
pub struct Ato<C = SpeedLoop> {
    state: AtoState,
    controller: C,
}

impl Ato<SpeedLoop> {
    /// Ready once it has been inspected.
    pub fn new(config: &AtoConfig) -> Self {
        Self {
            state: AtoState::Inspection,
            controller: SpeedLoop::new(config),
        }
    }
}

impl<C: SpeedController> Ato<C> {
    /// One 50 ms cycle.
    pub fn step(&mut self, inputs: AtoInputs, config: &AtoConfig) -> AtoOutputs {
        let ready = inputs.healthy;
        let arrived = inputs.to_stop_m.is_some_and(|d| d < target::ARRIVED_M);
        self.state = self.state.next(ArtInputs {
            healthy: inputs.healthy,
            run: inputs.mode == Mode::AutomaticRun,
            standstill: inputs.standstill,
            arrived,
        });
        let target = target::target(
            TargetInputs {
                limit: inputs.limit,
                fixed_speed: inputs.fixed_speed,
                running_mode: inputs.running_mode,
                to_stop_m: inputs.to_stop_m,
            },
            config,
        );
        match self.state {
            AtoState::Start | AtoState::Run => {
                let effort = self.controller.step(Drive {
                    target,
                    speed: inputs.speed,
                });
                let effort = if inputs.power_cut {
                    effort.min(0.0)
                } else {
                    effort
                };
                AtoOutputs {
                    ready,
                    target: target.speed,
                    effort: regulate(effort),
                    holding_brake: false,
                }
            }
            AtoState::Stop | AtoState::Inspection => {
                self.controller.reset();
                let holding_brake = inputs.mode == Mode::AutomaticRun
                    || inputs.mode == Mode::Automatic && inputs.standstill;
                AtoOutputs {
                    ready,
                    target: Speed::ZERO,
                    effort: 0,
                    holding_brake,
                }
            }
        }
    }

    /// Operating state.
    pub fn state(&self) -> AtoState {
        self.state
    }
}

/// REG: a share of the available effort, -1..=1, in the units TCMS takes (S4).
fn regulate(share: f64) -> i16 {
    let scale = if share < 0.0 { 1024.0 } else { 1023.0 };
    libm::round(share.clamp(-1.0, 1.0) * scale) as i16
}
