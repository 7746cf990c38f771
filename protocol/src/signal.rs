//! The catalogue of recorded signals: each has one definition of name, unit, kind and range.

use serde::{Deserialize, Serialize};

use crate::message::{
    ArmRefusal, AtoState, DoorSide, EbCause, FsbCause, Mode, ModeSwitch, NumberState, OrderState,
    RunningMode, TrainOrder,
};

/// Meaning of a signal's number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A quantity, exact in steps of `lsb`.
    Number {
        /// Smallest step.
        lsb: f64,
    },
    /// An index into labels.
    Enum(&'static [&'static str]),
    /// 0 or 1.
    Bit,
}

/// Where a signal is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Made by the rig: what the unit is given.
    Rig,
    /// Reported by the unit.
    Unit,
}

/// Definition of one signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Definition {
    /// Name in scripts, databases and reports.
    pub name: &'static str,
    /// Unit of measure; empty for bits, enums and counts.
    pub unit: &'static str,
    /// Kind and resolution.
    pub kind: Kind,
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
    /// Maker of the signal.
    pub origin: Origin,
    /// Meaning of the signal.
    pub doc: &'static str,
}

macro_rules! signals {
    ($( $variant:ident $name:literal $unit:literal $kind:expr, $low:literal ..= $high:literal, $origin:ident, $doc:literal; )*) => {
        /// Every recorded signal.
        #[derive(
            Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
        )]
        #[repr(u8)]
        pub enum Signal { $( #[doc = $doc] #[serde(rename = $name)] $variant ),* }

        impl Signal {
            /// All signals in recording order.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];
            /// Number of signals.
            pub const COUNT: usize = Self::ALL.len();
            /// Behind a reference: a table that is a value is copied to the stack at each use in a test's program.
            const DEFINITIONS: &'static [Definition; Self::COUNT] = &[$( Definition {
                name: $name, unit: $unit, kind: $kind, low: $low as f64, high: $high as f64,
                origin: Origin::$origin, doc: $doc,
            } ),*];

            /// The signal called `name`.
            pub fn from_name(name: &str) -> Option<Self> {
                match name { $( $name => Some(Self::$variant), )* _ => None }
            }
        }
    };
}

/// 0.01 steps.
const CENTI: Kind = Kind::Number { lsb: 0.01 };
/// 0.001 steps.
const MILLI: Kind = Kind::Number { lsb: 0.001 };
const UNITY: Kind = Kind::Number { lsb: 1.0 };
/// Speeds in km/h come from whole cm/s.
const CMS_KMH: Kind = Kind::Number { lsb: 0.036 };
const SWITCHED: Kind = Kind::Enum(&["released", "applied"]);
const MARKERS: Kind = Kind::Enum(&["none", "psm1", "psm2", "psm3", "psm4"]);
const DOORS: Kind = Kind::Enum(&["open", "closed"]);
const SIDE_DOORS: Kind = Kind::Enum(&["open", "closed", "locked"]);
const WAYSIDE: Kind = Kind::Enum(&["silent", "good", "corrupt"]);
const TCMS_MODES: Kind = Kind::Enum(&[
    "none",
    "emergency",
    "yard",
    "manual",
    "automatic",
    "driverless",
]);
const COMPARED: Kind = Kind::Enum(&["differs", "same", "not_stated"]);
const TACHO: Kind = Kind::Enum(&["good", "dead", "noisy", "scaled", "reversed"]);

signals! {
    CarrierHz "carrier_hz" "Hz" UNITY, 0 ..= 65535, Rig, "Carrier in the ATP antenna";
    CodeRateHz "code_rate_hz" "Hz" CENTI, 0 ..= 655, Rig, "Code rate in the ATP antenna";
    LevelMv "level_mv" "mV" UNITY, 0 ..= 65535, Rig, "Signal level in the ATP antenna";
    CrosstalkMv "crosstalk_mv" "mV" UNITY, 0 ..= 65535, Rig, "Level of a second code in the ATP antenna, of a neighbouring track";
    TrainSpeed "train_speed" "km/h" CMS_KMH, 0 ..= 200, Rig, "True speed the tachometer generators follow";
    TrainPosition "train_position" "m" CENTI, -100000 ..= 100000, Rig, "True distance run";
    TrainAccel "train_accel" "m/s²" MILLI, -120 ..= 120, Rig, "True acceleration of the train, mean of 50 ms";
    TrainJerk "train_jerk" "m/s³" CENTI, -1200 ..= 1200, Rig, "Change of the true acceleration in 200 ms, by time";
    ToStop "to_stop" "m" MILLI, -100000 ..= 100000, Rig, "True distance to the stop point of the section laid along the way";
    Tacho1 "tacho1" "" TACHO, 0 ..= 4, Rig, "Condition of tachometer channel 1";
    Tacho2 "tacho2" "" TACHO, 0 ..= 4, Rig, "Condition of tachometer channel 2";
    MarkerCoil "marker_coil" "" MARKERS, 0 ..= 4, Rig, "Marker whose coil was entered last";
    Wayside "wayside" "" WAYSIDE, 0 ..= 2, Rig, "Condition of the TWC wayside";
    WaysideStation "wayside_station" "" UNITY, 0 ..= 65535, Rig, "Station number the wayside sends";
    WaysideLoop "wayside_loop" "" UNITY, 0 ..= 65535, Rig, "Loop number the wayside sends";
    WaysideDoorSide "wayside_door_side" "" Kind::Enum(DoorSide::LABELS), 0 ..= 3, Rig, "Door side the wayside sends";
    WaysideMode "wayside_running_mode" "" Kind::Enum(RunningMode::LABELS), 0 ..= 2, Rig, "Running mode the wayside sends";
    Departure "departure" "" Kind::Bit, 0 ..= 1, Rig, "Departure given by the wayside";
    TcmsHears "tcms_hears" "" Kind::Bit, 0 ..= 1, Rig, "TCMS hears the unit on RS-485";
    Doors "doors" "" DOORS, 0 ..= 1, Rig, "Door train line: proved closed or not";
    DoorsLeft "doors_left" "" SIDE_DOORS, 0 ..= 2, Rig, "Train lines of the doors on the left: open, closed, or closed and locked";
    DoorsRight "doors_right" "" SIDE_DOORS, 0 ..= 2, Rig, "Train lines of the doors on the right: open, closed, or closed and locked";
    Hcr "hcr" "" Kind::Bit, 0 ..= 1, Rig, "Head control relay of this cab";
    MaintenanceKey "maintenance_key" "" Kind::Bit, 0 ..= 1, Rig, "Maintenance key";
    ModeSwitch "mode_switch" "" Kind::Enum(ModeSwitch::LABELS), 0 ..= 5, Rig, "Mode switch";
    Controller "controller" "" UNITY, -8 ..= 4, Rig, "Master controller notch";
    EbLoop "eb_loop" "" SWITCHED, 0 ..= 1, Rig, "Emergency brake train line of the train";
    TcmsAlive "tcms_alive" "" Kind::Bit, 0 ..= 1, Rig, "TCMS sends on RS-485 and its alive counter moves";
    ControllerVolts "controller_volts" "V" CENTI, 0 ..= 10, Rig, "Voltage of the master controller's potentiometer";
    TcmsMode "tcms_mode" "" TCMS_MODES, 0 ..= 5, Rig, "Mode TCMS drives in";
    TcmsPower "tcms_power" "" Kind::Bit, 0 ..= 1, Rig, "TCMS orders powering (DRYINP)";
    TcmsBrake "tcms_brake" "" Kind::Bit, 0 ..= 1, Rig, "TCMS orders braking (DRYINB)";
    TcmsCoast "tcms_coast" "" Kind::Bit, 0 ..= 1, Rig, "TCMS orders coasting (DRYINCOA)";
    TcmsValue "tcms_value" "" UNITY, -1024 ..= 1023, Rig, "Powering and braking value TCMS orders (DRYTEBE)";
    TcmsFsb "tcms_fsb" "" SWITCHED, 0 ..= 1, Rig, "Full service brake ordered by TCMS (BCYINFSB)";
    TcmsMsb "tcms_msb" "" SWITCHED, 0 ..= 1, Rig, "Maximum service brake ordered by TCMS (BCYMSB)";
    TcmsHolding "tcms_holding" "" SWITCHED, 0 ..= 1, Rig, "Holding brake ordered by TCMS";
    PowerCutCauses "power_cut_causes" "" UNITY, 0 ..= 65535, Rig, "Why TCMS cuts powering, as bits; 0 = it does not";
    EbSources "eb_sources" "" UNITY, 0 ..= 65535, Rig, "What opens the emergency brake train line, as bits";
    Lamps "lamps" "" UNITY, 0 ..= 65535, Rig, "Lamps in the cabs, as bits";
    NotReleased "not_released" "" UNITY, 0 ..= 65535, Rig, "Cars whose brake is not released, bit 0 = the first";
    MotorDemand "motor_demand" "N" UNITY, -1000000 ..= 1000000, Rig, "Demand of TCMS on all inverters, electric brake negative";
    Motor1 "motor_1" "N" UNITY, -300000 ..= 300000, Rig, "Demand on the inverters of MT pair 1, electric brake negative";
    Motor2 "motor_2" "N" UNITY, -300000 ..= 300000, Rig, "Demand on the inverters of MT pair 2, electric brake negative";
    Motor3 "motor_3" "N" UNITY, -300000 ..= 300000, Rig, "Demand on the inverters of MT pair 3, electric brake negative";
    Motor4 "motor_4" "N" UNITY, -300000 ..= 300000, Rig, "Demand on the inverters of MT pair 4, electric brake negative";
    AirTrailer1 "air_t_1" "N" UNITY, 0 ..= 300000, Rig, "Air demanded of the trailers of MT pair 1";
    AirTrailer2 "air_t_2" "N" UNITY, 0 ..= 300000, Rig, "Air demanded of the trailers of MT pair 2";
    AirTrailer3 "air_t_3" "N" UNITY, 0 ..= 300000, Rig, "Air demanded of the trailers of MT pair 3";
    AirTrailer4 "air_t_4" "N" UNITY, 0 ..= 300000, Rig, "Air demanded of the trailers of MT pair 4";
    AirMotor1 "air_m_1" "N" UNITY, 0 ..= 300000, Rig, "Air demanded of the motor cars of MT pair 1";
    AirMotor2 "air_m_2" "N" UNITY, 0 ..= 300000, Rig, "Air demanded of the motor cars of MT pair 2";
    AirMotor3 "air_m_3" "N" UNITY, 0 ..= 300000, Rig, "Air demanded of the motor cars of MT pair 3";
    AirMotor4 "air_m_4" "N" UNITY, 0 ..= 300000, Rig, "Air demanded of the motor cars of MT pair 4";
    BrakeDemand "brake_demand" "N" UNITY, 0 ..= 1000000, Rig, "Braking effort TCMS wants of the train, electric and air together";
    Traction "traction" "N" UNITY, 0 ..= 1000000, Rig, "Traction the train gives";
    ElectricBrake "electric_brake" "N" UNITY, 0 ..= 1000000, Rig, "Electric brake the train gives";
    AirBrake "air_brake" "N" UNITY, 0 ..= 1000000, Rig, "Air brake the train gives";
    Eb "eb" "" SWITCHED, 0 ..= 1, Unit, "Emergency brake: applied when the EB relay is de-energised";
    Fsb "fsb" "" SWITCHED, 0 ..= 1, Unit, "Full service brake request";
    PowerCut "power_cut" "" Kind::Bit, 0 ..= 1, Unit, "Powering cut";
    Alarm "alarm" "" Kind::Bit, 0 ..= 1, Unit, "Overspeed alarm";
    HoldingBrake "holding_brake" "" SWITCHED, 0 ..= 1, Unit, "Holding brake request";
    DoorEnableLeft "door_enable_left" "" Kind::Bit, 0 ..= 1, Unit, "Doors enabled on the left";
    DoorEnableRight "door_enable_right" "" Kind::Bit, 0 ..= 1, Unit, "Doors enabled on the right";
    DoorOrderLeft "door_order_left" "" Kind::Bit, 0 ..= 1, Unit, "Doors on the left ordered to open";
    DoorOrderRight "door_order_right" "" Kind::Bit, 0 ..= 1, Unit, "Doors on the right ordered to open";
    DoorOrderClose "door_order_close" "" Kind::Bit, 0 ..= 1, Unit, "All doors ordered to close";
    CodeValid "code_valid" "" Kind::Bit, 0 ..= 1, Unit, "A valid speed code is received";
    Standstill "standstill" "" Kind::Bit, 0 ..= 1, Unit, "Standstill detected";
    Healthy "healthy" "" Kind::Bit, 0 ..= 1, Unit, "Unit healthy contact";
    Limit "limit" "km/h" CMS_KMH, 0 ..= 200, Unit, "Speed limit in force";
    Speed "speed" "km/h" CMS_KMH, 0 ..= 200, Unit, "Measured speed";
    Marker "marker" "" MARKERS, 0 ..= 4, Unit, "Last marker the unit detected";
    MarkerCount "marker_count" "" UNITY, 0 ..= 255, Unit, "Markers the unit detected";
    Mode "mode" "" Kind::Enum(Mode::LABELS), 0 ..= 5, Unit, "Operating mode";
    Refusals "refusals" "" UNITY, 0 ..= 65535, Unit, "Preconditions of automatic mode that do not hold, as bits";
    CodeIndex "code_index" "" UNITY, 0 ..= 255, Unit, "Received code's place in the code table; 255 = none";
    EbCause "eb_cause" "" Kind::Enum(EbCause::LABELS), 0 ..= 12, Unit, "Why the emergency brake is applied";
    FsbCause "fsb_cause" "" Kind::Enum(FsbCause::LABELS), 0 ..= 11, Unit, "Why the full service brake is requested";
    Speed1 "speed1" "km/h" CMS_KMH, 0 ..= 200, Unit, "Speed from tachometer 1";
    Speed2 "speed2" "km/h" CMS_KMH, 0 ..= 200, Unit, "Speed from tachometer 2";
    Target "target" "km/h" CMS_KMH, 0 ..= 200, Unit, "ATO target speed";
    Effort "effort" "" UNITY, -1024 ..= 1023, Unit, "Effort sent to TCMS";
    Power "power" "" Kind::Bit, 0 ..= 1, Unit, "Powering command to TCMS";
    Brake "brake" "" Kind::Bit, 0 ..= 1, Unit, "Braking command to TCMS";
    Position "position" "m" CENTI, -100000 ..= 100000, Unit, "Position in the section as the unit sees it";
    AtoState "ato_state" "" Kind::Enum(AtoState::LABELS), 0 ..= 3, Unit, "Operating state of ATO";
    WheelCorrection "wheel_correction" "%" MILLI, -33 ..= 33, Unit, "What ATO adds to the way its wheels tell, found between markers";
    Armed "armed" "" Kind::Bit, 0 ..= 1, Unit, "Armed for stimuli";
    TwcOk "twc_ok" "" Kind::Bit, 0 ..= 1, Unit, "TWC communication up";
    TcmsOk "tcms_ok" "" Kind::Bit, 0 ..= 1, Unit, "TCMS communication up";
    StationValid "station_valid" "" Kind::Bit, 0 ..= 1, Unit, "Station data match the track database";
    Aligned "aligned" "" Kind::Bit, 0 ..= 1, Unit, "Stopped at the stop point";
    TraOk "tra_ok" "" Kind::Bit, 0 ..= 1, Unit, "TRA passed its test";
    AtoReady "ato_ready" "" Kind::Bit, 0 ..= 1, Unit, "ATO ready";
    Started "started" "" Kind::Bit, 0 ..= 1, Unit, "Start-up self-test finished";
    Events "events" "" UNITY, 0 ..= 2147483647, Unit, "Events logged since power-up";
    RejectedFrames "rejected_frames" "" UNITY, 0 ..= 65535, Unit, "Frames the unit rejected";
    TwcReceived "twc_received" "" UNITY, 0 ..= 65535, Unit, "TWC frames the unit accepted";
    TwcAnswerStation "twc_answer_station" "" UNITY, 0 ..= 65535, Unit, "Station number in the train's TWC answer";
    TwcAnswerTrain "twc_answer_train" "" UNITY, 0 ..= 65535, Unit, "Train number in the train's TWC answer";
    TwcAnswers "twc_answers" "" UNITY, 0 ..= 65535, Unit, "TWC answers the wayside received";
    SelfTest "self_test" "" UNITY, 0 ..= 65535, Unit, "Self-test items that failed, as bits";
    TestCarrier "test_carrier" "Hz" UNITY, 0 ..= 65535, Unit, "Carrier measured where it leaves the TEST board";
    TestCodeRate "test_code_rate" "Hz" CENTI, 0 ..= 655, Unit, "Code rate measured where it leaves the TEST board";
    TestLevel "test_level" "mV" UNITY, 0 ..= 65535, Unit, "Code level measured where it leaves the TEST board";
    TestSpeed "test_speed" "km/h" CMS_KMH, 0 ..= 200, Unit, "Speed of the pulses that leave the TEST board";
    IdentitySerial "identity_serial" "" COMPARED, 0 ..= 2, Rig, "The unit's serial number against the one expected";
    IdentitySoftware "identity_software" "" COMPARED, 0 ..= 2, Rig, "The unit's software version against the one expected";
    IdentityConfig "identity_config" "" COMPARED, 0 ..= 2, Rig, "Name and checksum of the unit configuration against those of the tests";
    IdentityLine "identity_line" "" COMPARED, 0 ..= 2, Rig, "Checksum of the track database against that of the tests";
    ArmRefusal "arm_refusal" "" Kind::Enum(ArmRefusal::LABELS), 0 ..= 12, Rig, "Why the unit refused or ended arming, as it said last";
    TestPulses "test_pulses" "" UNITY, 0 ..= 65535, Unit, "Speed pulses that left the TEST board";
    TestMarkers "test_markers" "" UNITY, 0 ..= 255, Unit, "Marker pulses that left the TEST board";
    TestAnswers "test_answers" "" UNITY, 0 ..= 65535, Unit, "TWC answers the TEST modem heard";
    TestAnswerStation "test_answer_station" "" UNITY, 0 ..= 65535, Unit, "Station number in the last TWC answer the TEST modem heard";
    TestAnswerTrain "test_answer_train" "" UNITY, 0 ..= 65535, Unit, "Train number in the last TWC answer the TEST modem heard";
    AskedEb "asked_eb" "" SWITCHED, 0 ..= 1, Unit, "Emergency brake as the functions under test ask for it";
    AskedFsb "asked_fsb" "" SWITCHED, 0 ..= 1, Unit, "Full service brake as the functions under test ask for it";
    AskedPowerCut "asked_power_cut" "" Kind::Bit, 0 ..= 1, Unit, "Powering cut as the functions under test ask for it";
    AskedAlarm "asked_alarm" "" Kind::Bit, 0 ..= 1, Unit, "Overspeed alarm as the functions under test ask for it";
    AskedDoorLeft "asked_door_left" "" Kind::Bit, 0 ..= 1, Unit, "Doors on the left enabled as the functions under test ask for it";
    AskedDoorRight "asked_door_right" "" Kind::Bit, 0 ..= 1, Unit, "Doors on the right enabled as the functions under test ask for it";
    AskedDoorClose "asked_door_close" "" Kind::Bit, 0 ..= 1, Unit, "All doors ordered to close as the functions under test ask for it";
    AskedPower "asked_power" "" Kind::Bit, 0 ..= 1, Unit, "Powering as the functions under test ask for it";
    AskedEffort "asked_effort" "" UNITY, -1024 ..= 1023, Unit, "Effort that the functions under test ask for";
    AskedMode "asked_mode" "" Kind::Enum(Mode::LABELS), 0 ..= 5, Unit, "Operating mode of the functions under test";
    TrainMode "train_mode" "" Kind::Enum(Mode::LABELS), 0 ..= 5, Unit, "Operating mode told to TCMS";
    TrainSpeed1 "train_speed1" "km/h" CMS_KMH, 0 ..= 200, Unit, "Speed by the train's own tachometer 1, whatever test speed there is";
    TrainSpeed2 "train_speed2" "km/h" CMS_KMH, 0 ..= 200, Unit, "Speed by the train's own tachometer 2, whatever test speed there is";
    MarkerAt "marker_at" "s" MILLI, 0 ..= 4294968, Unit, "When the unit detected the last marker, by its own clock";
    TcmsBraking "tcms_braking" "" SWITCHED, 0 ..= 1, Unit, "Service brake of the train as TCMS tells the unit";
    TcmsLineOpen "tcms_eb" "" SWITCHED, 0 ..= 1, Unit, "Emergency brake of the train as TCMS tells the unit";
    TcmsGiven "tcms_given" "" UNITY, -1024 ..= 1023, Unit, "Effort the train gives as TCMS tells the unit";
    TcmsLoad "tcms_load" "t" CENTI, 0 ..= 6554, Unit, "Passenger load as TCMS tells the unit";
    TwcStation "twc_station" "" UNITY, 0 ..= 65535, Unit, "Station number in the station data in force; 0 = none";
    TwcSection "twc_section" "" UNITY, 0 ..= 65535, Unit, "Section number in the station data in force; 0 = none";
    TwcLoop "twc_loop" "" UNITY, 0 ..= 65535, Unit, "Loop number in the station data in force; 0 = none";
    TwcTrain "twc_train" "" UNITY, 0 ..= 65535, Unit, "Train number in the station data in force; 0 = none";
    TcmsTellsLines "tcms_tells_lines" "" Kind::Bit, 0 ..= 1, Unit, "TCMS tells the unit how it reads the train lines";
    TcmsDoors "tcms_doors" "" DOORS, 0 ..= 1, Unit, "Door train line as TCMS tells the unit";
    TcmsHcr "tcms_hcr" "" Kind::Bit, 0 ..= 1, Unit, "Head control relay of the unit's cab as TCMS tells the unit";
    TwcSent "twc_sent" "" UNITY, 0 ..= 65535, Unit, "TWC answers the unit sent into the loop";
    WaysideOrder "wayside_order" "" Kind::Enum(TrainOrder::LABELS), 0 ..= 3, Rig, "Order the wayside gives beside running";
    OrdersAnswered "orders_answered" "" Kind::Bit, 0 ..= 1, Rig, "The unit reports to orders of the wayside; an older one does not know them";
    OwnTrain "own_train" "" UNITY, 0 ..= 65535, Unit, "The unit's own train number as it reports to the wayside's orders";
    NumberState "number_state" "" Kind::Enum(NumberState::LABELS), 0 ..= 2, Unit, "Where that number is from";
    Destination "destination" "" UNITY, 0 ..= 65535, Unit, "Destination in force; 0 = none";
    OrderState "order_state" "" Kind::Enum(OrderState::LABELS), 0 ..= 7, Unit, "How far the last order is carried out";
    TwcHeard "twc_heard" "" UNITY, 0 ..= 65535, Unit, "TWC frames for this train as the unit counts them";
    TwcRefused "twc_refused" "" UNITY, 0 ..= 65535, Unit, "TWC frames the unit refused because they contradict the track database";
    TwcOthers "twc_others" "" UNITY, 0 ..= 65535, Unit, "TWC frames for other trains as the unit counts them";
}

impl Signal {
    /// Definition of the signal.
    pub fn definition(self) -> &'static Definition {
        &Self::DEFINITIONS[self as usize]
    }

    /// Name of the signal.
    pub fn name(self) -> &'static str {
        self.definition().name
    }

    /// Number of values of a counter that wraps to 0; `None` for signals that do not wrap.
    pub const fn wraps_at(self) -> Option<f64> {
        match self {
            Self::MarkerCount | Self::TestMarkers => Some(256.0),
            Self::RejectedFrames
            | Self::TwcReceived
            | Self::TwcAnswers
            | Self::TwcSent
            | Self::TwcHeard
            | Self::TwcRefused
            | Self::TwcOthers
            | Self::TestPulses
            | Self::TestAnswers => Some(65_536.0),
            _ => None,
        }
    }

    /// Place of the signal in a sample row.
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// One value of every signal at one time; `NaN` = not known.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    values: [f64; Signal::COUNT],
}

impl Default for Sample {
    fn default() -> Self {
        Self {
            values: [f64::NAN; Signal::COUNT],
        }
    }
}

impl Sample {
    /// The value of `signal`, if it is known.
    pub fn get(&self, signal: Signal) -> Option<f64> {
        let value = self.values[signal.index()];
        (!value.is_nan()).then_some(value)
    }

    /// Sets a value.
    pub fn set(&mut self, signal: Signal, value: f64) {
        self.values[signal.index()] = value;
    }

    /// Sets a bit.
    pub fn set_bit(&mut self, signal: Signal, on: bool) {
        self.set(signal, f64::from(on));
    }

    /// Makes a signal unknown.
    pub fn forget(&mut self, signal: Signal) {
        self.set(signal, f64::NAN);
    }

    /// All values in recording order.
    pub fn values(&self) -> &[f64; Signal::COUNT] {
        &self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_lead_back() {
        for &signal in Signal::ALL {
            assert_eq!(Signal::from_name(signal.name()), Some(signal));
        }
    }

    #[test]
    fn a_counter_wraps_after_its_greatest_value() {
        for &signal in Signal::ALL {
            let definition = signal.definition();
            let expected = signal.wraps_at().map(|values| (0.0, values - 1.0));
            let range = expected.map(|_| (definition.low, definition.high));
            assert_eq!(range, expected, "{}", definition.name);
        }
    }

    #[test]
    fn ranges_fit_kinds() {
        for definition in Signal::ALL.iter().map(|s| s.definition()) {
            assert!(definition.low <= definition.high, "{}", definition.name);
            if let Kind::Enum(labels) = definition.kind {
                assert_eq!(
                    definition.high as usize + 1,
                    labels.len(),
                    "{}",
                    definition.name
                );
            }
        }
    }
}
