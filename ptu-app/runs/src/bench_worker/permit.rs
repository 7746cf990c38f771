//! Which manual stimuli are permitted in the present state of the unit.

use btu_rig::procedure::plan::Connection;
use btu_rig::stimulus::{Stimulus, Way};
use protocol::signal::Signal;

use super::{LiveData, Phase};

/// Why a stimulus is not permitted now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    /// No unit is connected.
    NotConnected,
    /// A run has the bench.
    Running,
    /// The act needs the bench harness; only the maintenance port is connected.
    NeedsHarness,
    /// A person in the cab does it: only the maintenance port is connected.
    InCab,
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
/// The reason why it cannot.
pub fn permit(stimulus: &Stimulus, live: &LiveData) -> Result<(), Refused> {
    match live.phase {
        Phase::Idle => {}
        Phase::Running => return Err(Refused::Running),
        Phase::Offline | Phase::Connecting | Phase::MakingSafe => {
            return Err(Refused::NotConnected);
        }
    }
    let on = |signal| live.sample.get(signal) == Some(1.0);
    let alone = live.connection == Some(Connection::Ptu);
    match stimulus.way() {
        Way::Tester if *stimulus == Stimulus::PtuArm && !on(Signal::MaintenanceKey) => {
            Err(Refused::KeyOff)
        }
        Way::TestBoard if !on(Signal::Armed) => Err(Refused::NotArmed),
        Way::Cab if alone => Err(Refused::InCab),
        Way::Harness if alone => Err(Refused::NeedsHarness),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Way of a stimulus, and with that its needs.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    enum Needs {
        Harness,
        Cab,
        Armed,
        Key,
        Unit,
    }

    /// One that needs each of these; the table of stimuli says which way each takes.
    const ONE_OF_EACH: [(Stimulus, Needs); 5] = [
        (Stimulus::CodeOff, Needs::Harness),
        (Stimulus::Start, Needs::Cab),
        (Stimulus::PtuRelease, Needs::Armed),
        (Stimulus::PtuArm, Needs::Key),
        (Stimulus::PtuDisarm, Needs::Unit),
    ];

    fn expected(
        needs: Needs,
        connection: Connection,
        phase: Phase,
        armed: bool,
        key: bool,
    ) -> Result<(), Refused> {
        match (phase, needs) {
            (Phase::Running, _) => Err(Refused::Running),
            (Phase::Offline | Phase::Connecting | Phase::MakingSafe, _) => {
                Err(Refused::NotConnected)
            }
            (Phase::Idle, Needs::Harness) if connection == Connection::Ptu => {
                Err(Refused::NeedsHarness)
            }
            (Phase::Idle, Needs::Cab) if connection == Connection::Ptu => Err(Refused::InCab),
            (Phase::Idle, Needs::Armed) if !armed => Err(Refused::NotArmed),
            (Phase::Idle, Needs::Key) if !key => Err(Refused::KeyOff),
            (Phase::Idle, _) => Ok(()),
        }
    }

    /// Method: what each stimulus needs × connection × phase × armed × key.
    #[test]
    fn a_stimulus_is_permitted_when_its_requirements_are_met() {
        let phases = [
            Phase::Offline,
            Phase::Connecting,
            Phase::Idle,
            Phase::Running,
            Phase::MakingSafe,
        ];
        let bools = [false, true];
        for (stimulus, needs) in &ONE_OF_EACH {
            for connection in [Connection::Btu, Connection::Ptu] {
                for phase in phases {
                    for (armed, key) in bools.iter().flat_map(|a| bools.map(|k| (*a, k))) {
                        let mut live = LiveData {
                            phase,
                            connection: Some(connection),
                            ..LiveData::default()
                        };
                        live.sample.set_bit(Signal::Armed, armed);
                        live.sample.set_bit(Signal::MaintenanceKey, key);
                        assert_eq!(
                            permit(stimulus, &live),
                            expected(*needs, connection, phase, armed, key),
                            "{stimulus:?}, {connection:?}, {phase:?}, armed {armed}, key {key}"
                        );
                    }
                }
            }
        }
    }

    /// A unit that says nothing is not armed.
    #[test]
    fn an_unknown_signal_counts_as_off() {
        let live = LiveData {
            phase: Phase::Idle,
            ..LiveData::default()
        };
        let refused = |stimulus| permit(&stimulus, &live);
        assert_eq!(refused(Stimulus::PtuRelease), Err(Refused::NotArmed));
        assert_eq!(refused(Stimulus::PtuArm), Err(Refused::KeyOff));
    }
}
