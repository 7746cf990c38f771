//! The places in the signal path where faults act.

use serde::{Deserialize, Serialize};

/// A place in the signal path.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// Level from the ATP antenna, before the receiver.
    AtpAntenna,
    /// Code rate as the receiver hears it.
    AtpReceiver,
    /// Pulses of speed sensor 1.
    SpeedSensor1,
    /// Pulses of speed sensor 2.
    SpeedSensor2,
    /// Contact of the EB relay.
    EbRelay,
    /// Full service brake output.
    FsbOutput,
    /// Inputs of all door lines.
    DoorInput,
    /// Inputs of the lines of the doors on the left.
    DoorInputLeft,
    /// Inputs of the lines of the doors on the right.
    DoorInputRight,
    /// Door enable outputs.
    DoorOutput,
    /// Contacts that order doors to open.
    DoorOpenOutput,
    /// Contact that orders doors to close.
    DoorCloseOutput,
    /// Input of the head control relay.
    CabInput,
    /// Input of the mode switch.
    ModeInput,
    /// Input of the master controller's position.
    ControllerInput,
    /// Marker antenna.
    MarkerAntenna,
    /// Trigger receiver assembly.
    Tra,
    /// TWC antenna, both ways.
    TwcAntenna,
    /// TWC modem, receiving side.
    FskReceiver,
    /// TWC modem, sending side.
    FskTransmitter,
    /// TWC CPU: what it hands on, and when.
    TwcCpu,
    /// Door side as the TWC CPU hands it on.
    TwcDoorSide,
    /// Train number in the TWC CPU's answer.
    TwcAnswer,
    /// Supervision of doors that open without being enabled.
    DoorGuard,
    /// Side of ATO's order to open doors.
    DoorOrder,
    /// ATO's order to close doors.
    DoorClosing,
    /// Opening again of doors that do not close.
    DoorReopening,
    /// Doors proved closed as a condition of departure.
    DepartureGuard,
    /// Slow running that the wayside orders.
    SlowRunning,
    /// Comparison of the train number in station data with the unit's own.
    TrainGuard,
    /// Comparison of orders' destination and section length with the track database.
    OrderGuard,
    /// Train number keyed in at the cab, as the TWC CPU takes it.
    CabEntries,
    /// Range of a wheel diameter keyed in at the cab.
    WheelGuard,
    /// Emergency brake of a cab that is given up at a turn-back.
    HandOverBrake,
    /// Emergency brake of a train that is put away.
    PutAwayBrake,
    /// Self-test of a train that wakes up.
    WakeUpTest,
    /// Comparison of station data with the track database, door side left out.
    StationGuard,
    /// Comparison of the door side in station data with the track database.
    SideGuard,
    /// RS-485 link to TCMS, receiving side.
    TcmsReceiver,
    /// RS-485 link to TCMS, sending side.
    TcmsTransmitter,
    /// TEST board.
    TestBoard,
    /// Level of the TEST board's code generator.
    TestCode,
    /// Carrier of the TEST board's code generator.
    TestCarrier,
    /// Code rate of the TEST board's code generator.
    TestRate,
    /// Pulses of the TEST board's speed generator.
    TestSpeed,
    /// Pulses of the TEST board's marker generator.
    TestMarker,
    /// Supervision of motion under a stop.
    StopGuard,
    /// Comparison of an acknowledgement with the emergency brake's cause.
    ReleaseGuard,
    /// Confirmation of the speed code in force.
    CodeConfirmation,
    /// The receiver's choice of the stronger of two codes.
    CodeSeparation,
    /// Supervision of a brake line that others open.
    LineGuard,
    /// Supervision of motion with the reverser in neutral.
    NeutralGuard,
    /// Comparison of a falling speed with the greatest deceleration of a train, and with the speed that TCMS reports.
    SpeedGuard,
    /// Standstill (no pulse) as a condition of release of the emergency brake.
    ReleaseStandstill,
    /// Comparison of a marker with the distance run since the marker before.
    MarkerGuard,
    /// Door enables that last until the doors are proved closed.
    EnableLatch,
    /// The track database's places of the loops.
    LoopPlaces,
    /// Supply of both speed sensors.
    SpeedSensors,
    /// Debouncing of marker pulses.
    MarkerDebounce,
    /// Supervision of ATO's jogging: speed, way and direction.
    JogGuard,
    /// ATO's jogging to a stop point that was missed, and the direction it orders.
    Jog,
    /// Standstill as a condition of arming.
    ArmStandstill,
    /// Applied brakes as a condition of arming, and of staying armed.
    ArmBrakes,
    /// Supervision of the train's own motion while armed.
    MotionGuard,
    /// Supervision of the code in the rail while armed.
    CodeGuard,
    /// Supervision of the mode switch while armed.
    ModeGuard,
    /// Supervision of the maintenance key while armed.
    KeyGuard,
    /// Full service brake that is held while armed.
    BrakeHold,
    /// Bar on powering while armed.
    TractionBar,
    /// Bar on Automatic Run while armed.
    StartBar,
    /// Bar on door enables while armed.
    DoorBar,
    /// The unit's power supply.
    PowerSupply,
    /// The unit's clock, which also times its pulse inputs.
    Clock,
    /// Effort that the ATO processor orders.
    AtoCpu,
    /// Working memory of the ATP CPU.
    Memory,
    /// Stored track database: stop points moved, or nothing there.
    TrackDatabase,
    /// Wheel diameter the unit is set to.
    WheelParameter,
    /// A car's inverter.
    Inverter,
    /// Electric brake of a car's inverter.
    Regeneration,
    /// A car's brake control unit.
    BrakeUnit,
    /// A car's brake cylinders.
    BrakeCylinder,
    /// Potentiometer of the master controller.
    ControllerPot,
    /// Contacts that prove the doors closed and locked, of both sides.
    DoorContact,
    /// Contact that proves the doors on the left closed.
    DoorContactLeft,
    /// Contact that proves the doors on the right closed.
    DoorContactRight,
    /// Head control relay of the cab.
    HeadControlRelay,
    /// Frames of TCMS on RS-485.
    Tcms,
    /// Change of cabs by TCMS.
    TcmsCabs,
    /// Pressure switch of the main reservoir.
    MainReservoir,
    /// Level of the bench's code generator.
    BenchLevel,
    /// Carrier of the bench's code generator.
    BenchCarrier,
    /// Code rate of the bench's code generator.
    BenchRate,
    /// Pulses of the bench's speed generator, for both speed sensors.
    BenchSpeed,
    /// Wire from the bench's speed generator to the input of speed sensor 1.
    WireSpeed1,
    /// Pulses of the bench's marker generator.
    BenchMarker,
    /// The bench's TWC loop, sending side.
    BenchTwc,
    /// Wires from the bench to the unit's door inputs.
    WireDoors,
    /// Wire from the bench to the unit's input of the head control relay.
    WireHcr,
    /// The bench's input that reads the EB relay's contact.
    BenchEb,
    /// The bench's input that reads the full service brake output.
    BenchFsb,
    /// The bench's inputs that read the door enables.
    BenchDoors,
}

impl Place {
    /// Whether the place is on the train around the unit.
    pub const fn on_train(self) -> bool {
        matches!(
            self,
            Self::Inverter
                | Self::Regeneration
                | Self::BrakeUnit
                | Self::BrakeCylinder
                | Self::ControllerPot
                | Self::DoorContact
                | Self::DoorContactLeft
                | Self::DoorContactRight
                | Self::HeadControlRelay
                | Self::Tcms
                | Self::TcmsCabs
                | Self::MainReservoir
        )
    }

    /// Whether the place is in the bench or its wires to the unit: the unit is not at fault.
    pub const fn on_bench(self) -> bool {
        matches!(
            self,
            Self::BenchLevel
                | Self::BenchCarrier
                | Self::BenchRate
                | Self::BenchSpeed
                | Self::WireSpeed1
                | Self::BenchMarker
                | Self::BenchTwc
                | Self::WireDoors
                | Self::WireHcr
                | Self::BenchEb
                | Self::BenchFsb
                | Self::BenchDoors
        )
    }

    /// Whether the place is in the unit, which applies the fault mode itself; the bench applies all
    /// others.
    pub const fn in_unit(self) -> bool {
        !self.on_train() && !self.on_bench()
    }

    /// Whether the place is data stored in the unit: wrong from power-up on, or not at all.
    pub const fn is_stored(self) -> bool {
        matches!(self, Self::TrackDatabase | Self::WheelParameter)
    }

    /// Whether the place is on one of the train's cars, which the mode must name.
    pub const fn on_car(self) -> bool {
        matches!(
            self,
            Self::Inverter | Self::Regeneration | Self::BrakeUnit | Self::BrakeCylinder
        )
    }
}
