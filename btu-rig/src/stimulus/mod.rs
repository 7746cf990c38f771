//! Stimuli: everything that can be done to a unit, as typed values that scripts build and the rig carries
//! out.

mod conditions;
mod orders;
pub(crate) mod ranges;
mod station;

use protocol::Speed;
use protocol::message::ModeSwitch;
use serde::{Deserialize, Serialize};

use crate::lever::Lever;
use crate::stored::{mode_switch, mps};

pub use conditions::{
    CarFailure, CutOut, DoorLine, DoorState, TachoCondition, TcmsCondition, TrainSwitch,
    WaysideCondition,
};
pub use orders::OrderData;
pub use station::StationData;

/// Steepest gradient that can be added to the track's, ‰.
pub const MAX_GRADIENT_PERMILLE: f64 = 100.0;

/// One thing done to the unit, through the bench harness or, for `Ptu…`, through the TEST board.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stimulus {
    /// Signal in the ATP antenna; rate 0 = unmodulated.
    Code {
        /// Carrier, Hz.
        carrier_hz: f64,
        /// Code rate, Hz.
        rate_hz: f64,
        /// Level, mV.
        level_mv: f64,
    },
    /// A second code in the ATP antenna, of a neighbouring track circuit, until the antenna is off; level 0 = none.
    Crosstalk {
        /// Carrier, Hz.
        carrier_hz: f64,
        /// Code rate, Hz.
        rate_hz: f64,
        /// Level, mV.
        level_mv: f64,
    },
    /// Lets code rate and level drift from where they are.
    CodeDrift {
        /// Hz per second.
        rate_hz_per_s: f64,
        /// mV per second.
        level_mv_per_s: f64,
    },
    /// No signal in the antenna.
    CodeOff,
    /// The antenna signal follows the speed codes of the section that lies along the way, until
    /// another signal is put into the antenna.
    CodesAlong {
        /// On, or keeping what is there.
        on: bool,
    },
    /// Tachometer generators go to a speed at this acceleration.
    Speed {
        /// Speed to reach.
        #[serde(rename = "to_mps", with = "mps")]
        to: Speed,
        /// Size of the acceleration, m/s².
        accel_mps2: f64,
    },
    /// Tachometer generators run exactly this distance and stand still again.
    Travel {
        /// Distance, m.
        distance_m: f64,
        /// Speed of the travel.
        #[serde(rename = "speed_mps", with = "mps")]
        speed: Speed,
        /// Size of the acceleration, m/s².
        accel_mps2: f64,
    },
    /// Direction in which the wheels turn.
    Direction {
        /// Against the forward direction.
        backward: bool,
    },
    /// Condition of one tachometer channel.
    Tacho {
        /// 1 or 2.
        channel: u8,
        /// Its condition.
        condition: TachoCondition,
    },
    /// Tachometers and markers follow the train model, which obeys the unit through TCMS.
    TrainDriven {
        /// On or back to the generators.
        on: bool,
    },
    /// Adhesion between the train's wheels and the rail.
    Adhesion {
        /// Coefficient at standstill; `None` = that of the run's conditions.
        coefficient: Option<f64>,
    },
    /// One pulse of a marker coil.
    Marker {
        /// 1 to 4 = PSM1 to PSM4.
        psm: u8,
    },
    /// One of the markers along the way lies elsewhere, or nowhere, until markers are laid anew.
    MarkerMoved {
        /// 1 to 4 = PSM1 to PSM4.
        psm: u8,
        /// How far beyond its place, m; `None` = it is missing.
        by_m: Option<f64>,
    },
    /// Markers of a section lie along the way from here on and pulse by position.
    MarkersAlong {
        /// Section of the line; `None` = no markers along the way.
        section: Option<u16>,
    },
    /// Station data the wayside sends.
    Station(StationData),
    /// Orders that the wayside sends beside them; `None` = none.
    Orders(Option<OrderData>),
    /// Condition of the wayside.
    Wayside(WaysideCondition),
    /// All doors, of both sides.
    Doors {
        /// Closed and locked, or open.
        closed: bool,
    },
    /// Doors of one side.
    SideDoors {
        /// On the left, else on the right.
        left: bool,
        /// What they are.
        state: DoorState,
    },
    /// The doors follow the unit's contacts, until a hand moves one.
    DoorsFollow {
        /// Follow, or stay as they are.
        on: bool,
    },
    /// Something stands between the doors of a side, which stop there when they close.
    DoorObstacle {
        /// On the left, else on the right.
        left: bool,
        /// Closings that it stops; 0 = it is gone.
        times: u8,
    },
    /// A door train line says this to the unit, whatever the doors are.
    DoorLine {
        /// Which.
        line: DoorLine,
        /// Energised; `None` = as the doors have it.
        on: Option<bool>,
    },
    /// Head control relay.
    Hcr {
        /// Energised.
        on: bool,
    },
    /// Maintenance key.
    MaintenanceKey {
        /// On.
        on: bool,
    },
    /// Train number keyed in at the cab.
    TrainNumber {
        /// 0 = as the unit is configured.
        number: u16,
    },
    /// Wheel diameter keyed in at the cab.
    WheelDiameter {
        /// mm; 0 = as the unit is configured.
        diameter_mm: f64,
    },
    /// Mode switch.
    ModeSwitch(#[serde(with = "mode_switch")] ModeSwitch),
    /// Master controller.
    Controller {
        /// Its position.
        lever: Lever,
    },
    /// Voltage of the master controller's potentiometer, whatever its position.
    ControllerVolts {
        /// V, 0..=10; `None` = as the position has it.
        volts: Option<f64>,
    },
    /// Contacts of the master controller, whatever its position.
    ControllerContacts {
        /// P and B; `None` = as the position has them.
        contacts: Option<(bool, bool)>,
    },
    /// Switch of the train.
    Switch {
        /// Which.
        switch: TrainSwitch,
        /// On.
        on: bool,
    },
    /// Equipment of a car is cut out or in.
    CutOut {
        /// What.
        what: CutOut,
        /// Car, counted from 1 at the head.
        car: u8,
        /// Cut out.
        on: bool,
    },
    /// Equipment of a car fails, or is in order again.
    Failure {
        /// What.
        what: CarFailure,
        /// Car, counted from 1 at the head.
        car: u8,
        /// Failed.
        on: bool,
    },
    /// Gradient added to the track's.
    Gradient {
        /// ‰, uphill positive; `None` = that of the run's conditions.
        permille: Option<f64>,
    },
    /// Reverser: 1 forward, 0 neutral, -1 backward.
    Reverser {
        /// The position.
        position: i8,
    },
    /// Acknowledge button, pressed for 500 ms.
    Acknowledge,
    /// ATO start button, pressed for 500 ms.
    Start,
    /// Condition of the TCMS link.
    Tcms(TcmsCondition),
    /// TCMS permits ATO.
    AtoEnable {
        /// Permitted.
        on: bool,
    },
    /// Passenger load.
    Load {
        /// Mass, kg.
        passengers_kg: f64,
    },
    /// Arm the unit (whole exchange).
    PtuArm,
    /// Ask the unit to arm: a refusal is no error, the signal `arm_refusal` says why.
    PtuAskToArm,
    /// Disarm it.
    PtuDisarm,
    /// The tester falls silent, or speaks again.
    PtuSilent {
        /// Silent.
        on: bool,
    },
    /// Test code into the ATP test coil.
    PtuCode {
        /// Carrier, Hz.
        carrier_hz: f64,
        /// Code rate, Hz.
        rate_hz: f64,
        /// Level, mV.
        level_mv: f64,
    },
    /// Speed signal of the TEST board.
    PtuSpeed {
        /// Bit 0 = input 1, bit 1 = input 2.
        channels: u8,
        /// Turning backward.
        backward: bool,
        /// Speed.
        #[serde(rename = "to_mps", with = "mps")]
        to: Speed,
        /// Size of the acceleration, m/s²; 0 = at once.
        accel_mps2: f64,
    },
    /// One pulse of the test marker.
    PtuMarker {
        /// 1 to 4.
        psm: u8,
    },
    /// Station data from the TEST modem into the TWC antenna.
    PtuTwc(StationData),
    /// Takes all test signals away.
    PtuRelease,
    /// Lets the unit test itself.
    PtuSelfTest,
    /// Clears the unit's event log.
    PtuClearLog,
}

impl Stimulus {
    /// Something the tester asks of the unit on the maintenance channel; all else goes through the harness.
    pub fn by_tester(&self) -> bool {
        matches!(
            self,
            Self::PtuArm | Self::PtuAskToArm | Self::PtuDisarm | Self::PtuSilent { .. }
        ) || self.on_test_board()
    }

    /// A test signal or request of the TEST board, which an armed unit only takes.
    pub fn on_test_board(&self) -> bool {
        matches!(
            self,
            Self::PtuCode { .. }
                | Self::PtuSpeed { .. }
                | Self::PtuMarker { .. }
                | Self::PtuTwc(_)
                | Self::PtuRelease
                | Self::PtuSelfTest
                | Self::PtuClearLog
        )
    }
}
