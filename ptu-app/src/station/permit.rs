//! What may be done to the unit by hand.

use btu_rig::procedure::plan::Connection;
use btu_rig::stimulus::Stimulus;
use protocol::signal::Signal;

use super::{Live, Phase};

/// Why something cannot be done now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    /// No unit is connected.
    NotConnected,
    /// A run has the bench.
    Running,
    /// It goes through the bench harness, which a laptop on the maintenance port has not.
    NeedsBtu,
    /// The unit is not armed.
    NotArmed,
    /// The maintenance key is off.
    KeyOff,
}

/// Whether `stimulus` can be given by hand.
///
/// Stimuli of the TEST board act on an armed unit only; all others go through the bench harness.
///
/// # Errors
/// Why not.
pub fn permit(stimulus: &Stimulus, connection: Connection, live: &Live) -> Result<(), Refused> {
    match live.phase {
        Phase::Idle => {}
        Phase::Running => return Err(Refused::Running),
        Phase::Offline | Phase::Connecting | Phase::MakingSafe => {
            return Err(Refused::NotConnected);
        }
    }
    let on = |signal| live.sample.get(signal) == Some(1.0);
    match stimulus {
        Stimulus::PtuDisarm | Stimulus::PtuSilent { .. } => Ok(()),
        Stimulus::PtuArm if !on(Signal::MaintenanceKey) => Err(Refused::KeyOff),
        // The key of a train is turned by hand.
        Stimulus::PtuArm | Stimulus::MaintenanceKey { .. } => Ok(()),
        _ if stimulus.on_test_board() && !on(Signal::Armed) => Err(Refused::NotArmed),
        _ if stimulus.on_test_board() => Ok(()),
        _ if connection == Connection::Ptu => Err(Refused::NeedsBtu),
        _ => Ok(()),
    }
}
