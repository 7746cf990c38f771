//! The table of stimuli: each row has a stimulus with its values, the way on which it reaches the unit, and its text.
//! Verbs of the script language make stimuli, the rig's `apply` carries them out.

use std::fmt;

use protocol::Speed;
use protocol::message::ModeSwitch;
use serde::{Deserialize, Serialize};

use super::text::{direction, number, on_off, order_text, side, station_text, tacho_text};
use super::{
    CarFailure, CodeSignal, CutOut, DoorLine, DoorState, OrderData, StationData, TachoCondition,
    TcmsCondition, TrainSwitch, WaysideCondition,
};
use crate::lever::Lever;
use crate::stored::{mode_switch, mps};

/// The way on which a stimulus reaches the unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Bench harness, by a generator of the bench.
    Harness,
    /// Bench harness; on a train people do it in the cab.
    Cab,
    /// Maintenance channel.
    Tester,
    /// TEST board, which only an armed unit lets act; asked for on the maintenance channel.
    TestBoard,
}

impl Way {
    /// The tester asks the unit for the stimulus on the maintenance channel; other stimuli go through the harness.
    pub fn by_tester(self) -> bool {
        matches!(self, Self::Tester | Self::TestBoard)
    }
}

macro_rules! stimuli {
    ($(
        $(#[$doc:meta])*
        $name:ident
            $({ $($(#[$field_meta:meta])* $field:ident: $kind:ty,)* })?
            $(($(#[$value_meta:meta])* $value:ident: $value_kind:ty))?
            [$way:ident] => $text:expr;
    )*) => {
        /// One thing done to the unit, through the bench harness or, for `Ptu…`, on the maintenance channel.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Stimulus {
            $(
                $(#[$doc])*
                $name $({ $($(#[$field_meta])* $field: $kind,)* })? $(($(#[$value_meta])* $value_kind))?,
            )*
        }

        impl Stimulus {
            /// The way on which this stimulus reaches the unit.
            pub fn way(&self) -> Way {
                match self {
                    $(Self::$name { .. } => Way::$way,)*
                }
            }
        }

        impl fmt::Display for Stimulus {
            #[allow(unused_variables)]
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let text: String = match *self {
                    $(Self::$name $({ $($field,)* })? $(($value))? => $text.into(),)*
                };
                f.write_str(&text)
            }
        }
    };
}

stimuli! {
    /// Signal in the ATP antenna.
    Code(signal: CodeSignal) [Harness] => format!("antenna signal {signal}");
    /// A second code in the ATP antenna, of a neighbouring track circuit, until the antenna is off; level 0 = none.
    Crosstalk(signal: CodeSignal) [Harness] => match signal.level_mv {
        0.0 => "no code of a neighbouring track".into(),
        level_mv => {
            let CodeSignal { carrier_hz, rate_hz, .. } = signal;
            let level = number(level_mv);
            format!("code of a neighbouring track {carrier_hz} Hz, code rate {rate_hz} Hz, {level} mV")
        }
    };
    /// Lets code rate and level drift from where they are.
    CodeDrift {
        /// Hz per second.
        rate_hz_per_s: f64,
        /// mV per second.
        level_mv_per_s: f64,
    } [Harness] => format!("antenna signal drifts {rate_hz_per_s} Hz/s, {level_mv_per_s} mV/s");
    /// No signal in the antenna.
    CodeOff [Harness] => "antenna signal off";
    /// The antenna signal follows the speed codes of the section that lies along the way, until
    /// another signal is put into the antenna.
    CodesAlong {
        /// On; off keeps the signal that is in the antenna.
        on: bool,
    } [Harness] => format!("speed codes along the way {}", on_off(on));
    /// Tachometer generators go to a speed at this acceleration.
    Speed {
        /// Speed to reach.
        #[serde(rename = "to_mps", with = "mps")]
        to: Speed,
        /// Size of the acceleration, m/s².
        accel_mps2: f64,
    } [Harness] => format!("speed to {to} at {} m/s²", number(accel_mps2));
    /// Tachometer generators run exactly this distance and stand still again.
    Travel {
        /// Distance, m.
        distance_m: f64,
        /// Speed of the travel.
        #[serde(rename = "speed_mps", with = "mps")]
        speed: Speed,
        /// Size of the acceleration, m/s².
        accel_mps2: f64,
    } [Harness] => format!("travel {} m at {speed}", number(distance_m));
    /// Direction in which the wheels turn.
    Direction {
        /// Against the forward direction.
        backward: bool,
    } [Harness] => format!("wheels turn {}", direction(backward));
    /// Condition of one tachometer channel.
    Tacho {
        /// 1 or 2.
        channel: u8,
        condition: TachoCondition,
    } [Harness] => format!("tachometer {channel} {}", tacho_text(condition));
    /// Tachometers and markers follow the train model, which obeys the unit through TCMS.
    TrainDriven {
        /// On; off gives tachometers and markers back to the generators.
        on: bool,
    } [Harness] => format!("train model {}", on_off(on));
    /// Adhesion between the train's wheels and the rail.
    Adhesion {
        /// Coefficient at standstill; `None` = the coefficient of the run's conditions.
        coefficient: Option<f64>,
    } [Harness] => format!("adhesion {}", coefficient.map_or("as always".into(), number));
    /// One pulse of a marker coil.
    Marker {
        /// 1 to 4 = PSM1 to PSM4.
        psm: u8,
    } [Harness] => format!("pulse of marker PSM{psm}");
    /// One of the markers along the way lies elsewhere, or nowhere, until markers are laid again.
    MarkerMoved {
        /// 1 to 4 = PSM1 to PSM4.
        psm: u8,
        /// Distance beyond the marker's place, m; `None` = the marker is missing.
        by_m: Option<f64>,
    } [Harness] => match by_m {
        None => format!("PSM{psm} is missing"),
        Some(by_m) => format!("PSM{psm} lies {} m beyond its place", number(by_m)),
    };
    /// Markers of a section lie along the way from here on and pulse by position.
    MarkersAlong {
        /// Section of the line; `None` = no markers along the way.
        section: Option<u16>,
    } [Harness] => match section {
        None => "no markers along the way".into(),
        Some(section) => format!("markers of section {section} along the way"),
    };
    /// Station data the wayside sends.
    Station(data: StationData) [Harness] => format!("wayside sends {}", station_text(&data));
    /// Orders that the wayside sends beside the station data; `None` = no orders.
    Orders(orders: Option<OrderData>) [Harness] => match orders {
        None => "wayside gives no orders".into(),
        Some(orders) => format!("wayside orders {}", order_text(&orders)),
    };
    /// Condition of the wayside.
    Wayside(condition: WaysideCondition) [Harness] => format!("TWC wayside {condition:?}").to_lowercase();
    /// All doors, of both sides.
    Doors {
        /// Closed and locked, or open.
        closed: bool,
    } [Cab] => format!("doors {}", if closed { "closed" } else { "open" });
    /// Doors of one side.
    SideDoors {
        /// On the left, else on the right.
        left: bool,
        state: DoorState,
    } [Cab] => format!("doors on the {} {}", side(left), state.label());
    /// The doors follow the unit's contacts, until a stimulus moves a door.
    DoorsFollow {
        /// Follow, or stay as they are.
        on: bool,
    } [Harness] => format!("doors follow the unit: {}", on_off(on));
    /// Something stands between the doors of a side, which stop there when they close.
    DoorObstacle {
        /// On the left, else on the right.
        left: bool,
        /// Number of closings that the obstacle stops; 0 = the obstacle is gone.
        times: u8,
    } [Cab] => format!("obstacle in the doors on the {} for {times} closings", side(left));
    /// State that a door train line has at the unit, whatever the doors do.
    DoorLine {
        /// Door line.
        line: DoorLine,
        /// Energised; `None` = as the doors' contacts make it.
        on: Option<bool>,
    } [Harness] => format!("door line {}: {}", line.label(), match on {
        None => "as the doors have it",
        Some(true) => "energised",
        Some(false) => "dead",
    });
    /// Head control relay.
    Hcr {
        /// Energised.
        on: bool,
    } [Cab] => format!("cab active (HCR) {}", on_off(on));
    /// Maintenance key.
    MaintenanceKey {
        /// Position of the key.
        on: bool,
    } [Cab] => format!("maintenance key {}", on_off(on));
    /// Train number keyed in at the cab.
    TrainNumber {
        /// 0 = as the unit is configured.
        number: u16,
    } [Harness] => format!("train number {number} keyed in");
    /// Wheel diameter keyed in at the cab.
    WheelDiameter {
        /// mm; 0 = as the unit is configured.
        diameter_mm: f64,
    } [Harness] => format!("wheel diameter {} mm keyed in", number(diameter_mm));
    /// Mode switch.
    ModeSwitch(#[serde(with = "mode_switch")] mode: ModeSwitch) [Cab] => format!("mode switch to {}", mode.label());
    /// Master controller.
    Controller {
        lever: Lever,
    } [Cab] => format!("master controller to {lever}");
    /// Voltage of the master controller's potentiometer, whatever its position.
    ControllerVolts {
        /// V, 0..=10; `None` = as the position has it.
        volts: Option<f64>,
    } [Harness] => match volts {
        None => "master controller's own voltage".into(),
        Some(volts) => format!("master controller gives {} V", number(volts)),
    };
    /// Contacts of the master controller, whatever its position.
    ControllerContacts {
        /// P and B; `None` = as the position has them.
        contacts: Option<(bool, bool)>,
    } [Harness] => match contacts {
        None => "master controller's own contacts".into(),
        Some((power, brake)) => {
            format!("master controller contacts P {}, B {}", on_off(power), on_off(brake))
        }
    };
    /// Switch of the train.
    Switch {
        /// Switch that is set.
        switch: TrainSwitch,
        /// Position of the switch.
        on: bool,
    } [Cab] => format!("{} {}", switch.label(), on_off(on));
    /// Equipment of a car is cut out or in.
    CutOut {
        /// Equipment that is cut out.
        what: CutOut,
        /// Car, counted from 1 at the head.
        car: u8,
        /// Cut out.
        on: bool,
    } [Cab] => {
        let part = match what {
            CutOut::Brake => "brake",
            CutOut::Inverter => "inverter",
        };
        format!("{part} of car {car} cut {}", if on { "out" } else { "in" })
    };
    /// Equipment of a car fails, or is in order again.
    Failure {
        /// Kind of failure.
        what: CarFailure,
        /// Car, counted from 1 at the head.
        car: u8,
        /// Failed.
        on: bool,
    } [Harness] => format!("{} on car {car}: {}", what.label(), on_off(on));
    /// Gradient added to the gradient of the track.
    Gradient {
        /// ‰, uphill positive; `None` = the gradient of the run's conditions.
        permille: Option<f64>,
    } [Harness] => match permille {
        None => "gradient as always".into(),
        Some(permille) => format!("gradient {} ‰", number(permille)),
    };
    /// Reverser: 1 forward, 0 neutral, -1 backward.
    Reverser {
        /// The position.
        position: i8,
    } [Cab] => format!("reverser to {position}");
    /// Acknowledge button, pressed for 500 ms.
    Acknowledge [Cab] => "press acknowledge";
    /// ATO start button, pressed for 500 ms.
    Start [Cab] => "press ATO start";
    /// Condition of the TCMS link.
    Tcms(condition: TcmsCondition) [Harness] => format!("TCMS link {condition:?}").to_lowercase();
    /// TCMS permits ATO.
    AtoEnable {
        /// Permitted.
        on: bool,
    } [Harness] => format!("TCMS permits ATO: {}", on_off(on));
    /// Passenger load.
    Load {
        /// Mass, kg.
        passengers_kg: f64,
    } [Harness] => format!("load {passengers_kg} kg");
    /// Arm the unit (whole exchange).
    PtuArm [Tester] => "arm the unit";
    /// Ask the unit to arm: a refusal is no error, the signal `arm_refusal` says why.
    PtuAskToArm [Tester] => "ask the unit to arm";
    /// Disarm the unit.
    PtuDisarm [Tester] => "disarm the unit";
    /// The tester falls silent, or speaks again.
    PtuSilent {
        /// Silent.
        on: bool,
    } [Tester] => format!("tester silent: {}", on_off(on));
    /// Test code into the ATP test coil.
    PtuCode(signal: CodeSignal) [TestBoard] => format!("test code {signal}");
    /// Speed signal of the TEST board.
    PtuSpeed {
        /// Bit 0 = input 1, bit 1 = input 2.
        channels: u8,
        /// Turning backward.
        backward: bool,
        /// Test speed to reach.
        #[serde(rename = "to_mps", with = "mps")]
        to: Speed,
        /// Size of the acceleration, m/s²; 0 = at once.
        accel_mps2: f64,
    } [TestBoard] => {
        let inputs = ["none", "1", "2", "1 and 2"][usize::from(channels & 3)];
        format!("test speed {to} {} on input {inputs}", direction(backward))
    };
    /// One pulse of the test marker.
    PtuMarker {
        /// 1 to 4.
        psm: u8,
    } [TestBoard] => format!("pulse of test marker PSM{psm}");
    /// Station data from the TEST modem into the TWC antenna.
    PtuTwc(data: StationData) [TestBoard] => format!("test TWC frame {}", station_text(&data));
    /// Takes all test signals away.
    PtuRelease [TestBoard] => "take test signals away";
    /// Lets the unit test itself.
    PtuSelfTest [TestBoard] => "let the unit test itself";
    /// Clears the unit's event log.
    PtuClearLog [TestBoard] => "clear the event log";
}
