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
    /// It needs the bench harness, and only the maintenance port is connected.
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
/// Why not.
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
    use btu_rig::lever::Lever;
    use btu_rig::stimulus::{
        CarFailure, CutOut, DoorLine, StationData, TachoCondition, TcmsCondition, TrainSwitch,
        WaysideCondition,
    };
    use protocol::Speed;
    use protocol::message::{DoorSide, ModeSwitch, RunningMode};

    use super::*;

    /// Which way a stimulus takes, and with that what it needs.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    enum Needs {
        Harness,
        Cab,
        Armed,
        Key,
        Unit,
    }

    /// One of every kind. A kind that is added does not compile in `needs` until it has its row there;
    /// the count below asks for it here, too.
    fn one_of_every_kind() -> Vec<Stimulus> {
        let station = StationData {
            route: 8,
            section: 61,
            station: 823,
            next_station: 824,
            loop_id: 8231,
            fixed_speed_kmh: None,
            running_mode: RunningMode::Normal,
            door_side: DoorSide::None,
            departure: false,
            train_number: 8001,
        };
        let (carrier_hz, rate_hz, level_mv) = (3_000.0, 15.0, 500.0);
        let (to, accel_mps2) = (Speed::from_kmh(40.0), 0.8);
        vec![
            Stimulus::Code {
                carrier_hz,
                rate_hz,
                level_mv,
            },
            Stimulus::CodeDrift {
                rate_hz_per_s: 0.1,
                level_mv_per_s: 0.0,
            },
            Stimulus::CodeOff,
            Stimulus::CodesAlong { on: true },
            Stimulus::Speed { to, accel_mps2 },
            Stimulus::Travel {
                distance_m: 10.0,
                speed: to,
                accel_mps2,
            },
            Stimulus::Direction { backward: true },
            Stimulus::Tacho {
                channel: 1,
                condition: TachoCondition::Dead,
            },
            Stimulus::TrainDriven { on: true },
            Stimulus::Adhesion { coefficient: None },
            Stimulus::Marker { psm: 1 },
            Stimulus::MarkerMoved { psm: 1, by_m: None },
            Stimulus::MarkersAlong { section: None },
            Stimulus::Station(station),
            Stimulus::Orders(None),
            Stimulus::TrainNumber { number: 0 },
            Stimulus::Wayside(WaysideCondition::Silent),
            Stimulus::Doors { closed: false },
            Stimulus::DoorLine {
                line: DoorLine::All,
                on: None,
            },
            Stimulus::Hcr { on: false },
            Stimulus::MaintenanceKey { on: true },
            Stimulus::ModeSwitch(ModeSwitch::Yard),
            Stimulus::Controller {
                lever: Lever::Neutral,
            },
            Stimulus::ControllerVolts { volts: None },
            Stimulus::ControllerContacts { contacts: None },
            Stimulus::Switch {
                switch: TrainSwitch::DeadMan,
                on: true,
            },
            Stimulus::CutOut {
                what: CutOut::Brake,
                car: 1,
                on: true,
            },
            Stimulus::Failure {
                what: CarFailure::BrakeStuck,
                car: 1,
                on: true,
            },
            Stimulus::Gradient { permille: None },
            Stimulus::Reverser { position: 0 },
            Stimulus::Acknowledge,
            Stimulus::Start,
            Stimulus::Tcms(TcmsCondition::Silent),
            Stimulus::AtoEnable { on: false },
            Stimulus::Load { passengers_kg: 0.0 },
            Stimulus::PtuArm,
            Stimulus::PtuAskToArm,
            Stimulus::PtuDisarm,
            Stimulus::PtuSilent { on: true },
            Stimulus::PtuCode {
                carrier_hz,
                rate_hz,
                level_mv,
            },
            Stimulus::PtuSpeed {
                channels: 3,
                backward: false,
                to,
                accel_mps2,
            },
            Stimulus::PtuMarker { psm: 1 },
            Stimulus::PtuTwc(station),
            Stimulus::PtuRelease,
            Stimulus::PtuSelfTest,
            Stimulus::PtuClearLog,
        ]
    }

    fn needs(stimulus: &Stimulus) -> Needs {
        match stimulus {
            Stimulus::Code { .. }
            | Stimulus::Crosstalk { .. }
            | Stimulus::CodeDrift { .. }
            | Stimulus::CodeOff
            | Stimulus::CodesAlong { .. }
            | Stimulus::Speed { .. }
            | Stimulus::Travel { .. }
            | Stimulus::Direction { .. }
            | Stimulus::Tacho { .. }
            | Stimulus::TrainDriven { .. }
            | Stimulus::Adhesion { .. }
            | Stimulus::Marker { .. }
            | Stimulus::MarkerMoved { .. }
            | Stimulus::MarkersAlong { .. }
            | Stimulus::Station(_)
            | Stimulus::Orders(_)
            | Stimulus::TrainNumber { .. }
            | Stimulus::WheelDiameter { .. }
            | Stimulus::Wayside(_)
            | Stimulus::ControllerVolts { .. }
            | Stimulus::ControllerContacts { .. }
            | Stimulus::Failure { .. }
            | Stimulus::Gradient { .. }
            | Stimulus::DoorsFollow { .. }
            | Stimulus::DoorLine { .. }
            | Stimulus::Tcms(_)
            | Stimulus::AtoEnable { .. }
            | Stimulus::Load { .. } => Needs::Harness,
            Stimulus::Doors { .. }
            | Stimulus::SideDoors { .. }
            | Stimulus::DoorObstacle { .. }
            | Stimulus::Hcr { .. }
            | Stimulus::MaintenanceKey { .. }
            | Stimulus::ModeSwitch(_)
            | Stimulus::Controller { .. }
            | Stimulus::Switch { .. }
            | Stimulus::CutOut { .. }
            | Stimulus::Reverser { .. }
            | Stimulus::Acknowledge
            | Stimulus::Start => Needs::Cab,
            Stimulus::PtuCode { .. }
            | Stimulus::PtuSpeed { .. }
            | Stimulus::PtuMarker { .. }
            | Stimulus::PtuTwc(_)
            | Stimulus::PtuRelease
            | Stimulus::PtuSelfTest
            | Stimulus::PtuClearLog => Needs::Armed,
            Stimulus::PtuArm => Needs::Key,
            Stimulus::PtuAskToArm | Stimulus::PtuDisarm | Stimulus::PtuSilent { .. } => Needs::Unit,
        }
    }

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

    /// Method: every kind of stimulus × connection × phase × armed × key, against what each kind needs.
    #[test]
    fn a_stimulus_is_permitted_when_its_requirements_are_met() {
        let all = one_of_every_kind();
        let kinds: std::collections::HashSet<_> = all.iter().map(std::mem::discriminant).collect();
        assert_eq!(kinds.len(), 46);
        let phases = [
            Phase::Offline,
            Phase::Connecting,
            Phase::Idle,
            Phase::Running,
            Phase::MakingSafe,
        ];
        let bools = [false, true];
        for stimulus in &all {
            let needs = needs(stimulus);
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
                            expected(needs, connection, phase, armed, key),
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
