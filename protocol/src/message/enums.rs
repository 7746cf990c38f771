//! Enumerations and bit sets that several messages share.

use super::layout::{wire_bits, wire_enum};

wire_enum! {
    /// Operating mode of the unit [S2 §3.1, S4].
    Mode {
        /// No cab active or start-up not finished.
        Off = 0 "off",
        /// Yard: a fixed low limit, no speed code needed.
        Yard = 1 "yard",
        /// Manual under cab signal.
        Manual = 2 "manual",
        /// Automatic mode set by ATP, not yet running.
        Automatic = 3 "automatic",
        /// Automatic Run mode: ATO drives.
        AutomaticRun = 4 "automatic_run",
        /// Emergency: cab signal cut out, a fixed low limit.
        Emergency = 5 "emergency",
    }
}

wire_enum! {
    /// Operating state of ATO [S0 §3.3].
    AtoState {
        /// Being checked; cannot drive.
        Inspection = 0 "inspection",
        /// Standing, waiting for Automatic Run.
        Stop = 1 "stop",
        /// Departing.
        Start = 2 "start",
        /// Between stations.
        Run = 3 "run",
    }
}

wire_enum! {
    /// Failure of ATO: the parameter of event `ato_failed`.
    AtoFailure {
        /// ATO has not failed.
        None = 0 "none",
        /// ATO's processor does not work.
        Processor = 1 "processor",
        /// The start-up self-test failed an item that ATO needs.
        SelfTest = 2 "self_test",
        /// ATO's configuration or the track database does not pass its checks.
        StoredData = 3 "stored_data",
        /// TRA failed its test while the train stood; on the way the run is brought to its end.
        Tra = 4 "tra",
        /// The tachometers disagree.
        Tachometers = 5 "tachometers",
        /// Inputs that no train can produce (`AbsurdInputs`).
        Inputs = 6 "inputs",
        /// The train does not do what the effort asks for.
        NotFollowing = 7 "not_following",
        /// The train brakes less than ATO ordered, as TCMS itself reports.
        TrainWithholds = 8 "train_withholds",
    }
}

wire_bits! {
    /// Inputs that ATO cannot believe: the parameter of event `ato_input_absurd`.
    AbsurdInputs {
        /// Speed that is no number, negative or beyond any train's.
        SPEED = 0,
        /// Speed that changed faster than any train's.
        SPEED_JUMP = 1,
        /// Speed that stays exactly the same while effort is asked for.
        FROZEN_SPEED = 2,
        /// Position far outside the section.
        POSITION = 3,
        /// Passenger load that is negative or beyond the train's own mass.
        LOAD = 4,
        /// Speed limit or ordered speed that is no speed.
        LIMIT = 5,
        /// No section of the track database, or one with impossible numbers.
        SECTION = 6,
    }
}

wire_enum! {
    /// A coil or a line of a sensor whose waveform is sent as samples.
    Coil {
        /// ATP antenna.
        AtpAntenna = 0 "atp_antenna",
        /// TWC antenna.
        TwcAntenna = 1 "twc_antenna",
        /// Marker antenna.
        MarkerAntenna = 2 "marker_antenna",
        /// Line A of speed sensor 1.
        Sensor1A = 3 "sensor_1_a",
        /// Line B of speed sensor 1.
        Sensor1B = 4 "sensor_1_b",
        /// Line A of speed sensor 2.
        Sensor2A = 5 "sensor_2_a",
        /// Line B of speed sensor 2.
        Sensor2B = 6 "sensor_2_b",
    }
}

wire_enum! {
    /// Position of the cab's mode switch.
    ModeSwitch {
        /// Off.
        Off = 0 "off",
        /// Yard.
        Yard = 1 "yard",
        /// Manual.
        Manual = 2 "manual",
        /// Automatic.
        Automatic = 3 "automatic",
        /// Driverless.
        Driverless = 4 "driverless",
        /// Emergency (ATC cut out).
        Emergency = 5 "emergency",
    }
}

impl ModeSwitch {
    /// A position at which ATO may drive: automatic or driverless.
    pub const fn is_automatic(self) -> bool {
        matches!(self, Self::Automatic | Self::Driverless)
    }
}

wire_enum! {
    /// Running mode ordered by the wayside [S0 §3.1.1].
    RunningMode {
        /// Normal running.
        Normal = 0 "normal",
        /// Recovery running, making up time.
        Recovery = 1 "recovery",
        /// Slow running.
        Slow = 2 "slow",
    }
}

wire_enum! {
    /// Orders of the wayside to a train, other than to run [S0, S4].
    TrainOrder {
        /// No order.
        None = 0 "none",
        /// Turn back: hand the train over to the other cab.
        TurnBack = 1 "turn_back",
        /// Be put away.
        PutAway = 2 "put_away",
        /// Wake up.
        WakeUp = 3 "wake_up",
    }
}

wire_enum! {
    /// State of a train's last order.
    OrderState {
        /// No order is under way.
        Idle = 0 "idle",
        /// TCMS is asked for the change of cabs, the train is held.
        TurningBack = 1 "turning_back",
        /// The other cab has the train.
        HandedOver = 2 "handed_over",
        /// This cab has the train from the other one, and waits for station data.
        TakingOver = 3 "taking_over",
        /// Put away: the emergency brake is applied, and only waking up is waited for.
        PutAway = 4 "put_away",
        /// Waking up: the unit tests itself.
        Waking = 5 "waking",
        /// Ready for a departure.
        Ready = 6 "ready",
        /// The order was not carried out; the train stays held.
        Failed = 7 "failed",
    }
}

wire_enum! {
    /// Where the unit's train number is from.
    NumberState {
        /// From the unit configuration.
        Configured = 0 "configured",
        /// Keyed in at the cab; the wayside has not used it yet.
        Keyed = 1 "keyed",
        /// Keyed in at the cab, and the wayside has sent data for it.
        Confirmed = 2 "confirmed",
    }
}

wire_bits! {
    /// Reasons for which an order is not carried out: the parameter of event `order_refused`.
    OrderLacks {
        /// The train moves.
        STANDSTILL = 0,
        /// Doors are not proved closed and locked.
        DOORS_CLOSED = 1,
        /// The train is not aligned at its destination, or has no station data of its destination.
        AT_DESTINATION = 2,
        /// The mode switch is not at driverless.
        DRIVERLESS = 3,
        /// An automatic run is under way.
        RUN_ENDED = 4,
        /// A tester is armed.
        DISARMED = 5,
        /// Another order is being carried out.
        FREE = 6,
        /// The train is not put away.
        PUT_AWAY = 7,
        /// The head control relay of this cab is not energised.
        CAB_ACTIVE = 8,
    }
}

wire_enum! {
    /// Side of the platform.
    DoorSide {
        /// No doors may open.
        None = 0 "none",
        /// Left.
        Left = 1 "left",
        /// Right.
        Right = 2 "right",
        /// Both sides.
        Both = 3 "both",
    }
}

wire_enum! {
    /// Cause for which the unit holds the emergency brake.
    EbCause {
        /// The unit does not hold the emergency brake.
        None = 0 "none",
        /// Start-up or no cab active: the brake has not been released yet.
        NotReleased = 1 "not_released",
        /// Overspeed beyond the emergency margin.
        Overspeed = 2 "overspeed",
        /// The full service brake did not slow the train.
        ServiceBrakeIneffective = 3 "service_brake_ineffective",
        /// The two tachometers disagree.
        Tachometer = 4 "tachometer",
        /// Moving against the reverser.
        Rollback = 5 "rollback",
        /// A door opened while moving.
        DoorOpen = 6 "door_open",
        /// The bench or I/O rack fell silent.
        InputsLost = 7 "inputs_lost",
        /// A self-test failed.
        SelfTest = 8 "self_test",
        /// A broken invariant on board.
        Internal = 9 "internal",
        /// While armed for maintenance: real motion, a changed input, or no proof that the train brakes.
        TestMode = 10 "test_mode",
        /// Moving forward while ATO jogs backward.
        Jog = 11 "jog",
        /// The EB train line of a moving train was opened by something other than the unit.
        LineOpened = 12 "line_opened",
    }
}

wire_enum! {
    /// Cause for which the unit asks for the full service brake.
    FsbCause {
        /// The unit does not ask for the full service brake.
        None = 0 "none",
        /// Speed above the limit by more than the margin.
        Overspeed = 1 "overspeed",
        /// No valid speed code where one is needed.
        NoCode = 2 "no_code",
        /// TWC lost in automatic run.
        TwcLost = 3 "twc_lost",
        /// TCMS lost.
        TcmsLost = 4 "tcms_lost",
        /// ATO failed in automatic run.
        AtoFailed = 5 "ato_failed",
        /// TCMS took its permission back in automatic run, or said that the train cannot run.
        NotPermitted = 6 "not_permitted",
        /// Armed for maintenance.
        TestMode = 7 "test_mode",
        /// Absolute stop, moving under a code that says stop, or backward under any code.
        StopCode = 8 "stop_code",
        /// A door is open on a side that is not enabled.
        DoorOpen = 9 "door_open",
        /// Jogging faster than permitted.
        Jog = 10 "jog",
        /// The emergency brake is asked for and does not act.
        EbFailed = 11 "eb_failed",
    }
}

wire_enum! {
    /// Outcome of a maintenance request.
    Answer {
        /// Done.
        Accepted = 0 "accepted",
        /// The unit is not armed for this session.
        NotArmed = 1 "not_armed",
        /// A value is outside what the TEST board can make.
        OutOfRange = 2 "out_of_range",
        /// The TEST board did not take the request.
        BoardFailed = 3 "board_failed",
    }
}

wire_enum! {
    /// Stores of the unit that outlast a power-up.
    StoreKind {
        /// The event log.
        Events = 0 "events",
        /// The record of automatic runs.
        Runs = 1 "runs",
    }
}

wire_enum! {
    /// Reason for which arming was refused or lapsed.
    ArmRefusal {
        /// The request is not refused.
        None = 0 "none",
        /// The maintenance key is off.
        KeyOff = 1 "key_off",
        /// The train is moving.
        Moving = 2 "moving",
        /// The answer to the challenge was wrong or late.
        BadAnswer = 3 "bad_answer",
        /// Another session holds the unit.
        Busy = 4 "busy",
        /// The tester fell silent.
        TesterSilent = 5 "tester_silent",
        /// The tester disarmed the unit.
        Disarmed = 6 "disarmed",
        /// Start-up self-test is still running.
        StartingUp = 7 "starting_up",
        /// The train does not prove that its brakes are applied.
        BrakesReleased = 8 "brakes_released",
        /// The train moved while armed.
        TrainMoved = 9 "train_moved",
        /// The speed code in the rail changed while armed.
        CodeChanged = 10 "code_changed",
        /// The mode switch was turned while armed.
        ModeChanged = 11 "mode_changed",
        /// A door is not proved closed.
        DoorsOpen = 12 "doors_open",
    }
}

wire_enum! {
    /// Unit of a value of the self-test.
    MeasureUnit {
        /// Milliseconds.
        Milliseconds = 0 "ms",
        /// Bytes.
        Bytes = 1 "bytes",
        /// Errors found.
        Errors = 2 "errors",
        /// Answers to tests.
        Answers = 3 "answers",
        /// Frames heard.
        Frames = 4 "frames",
    }
}

wire_bits! {
    /// Preconditions of automatic mode and run that do not hold [S2 §3.1].
    Refusals {
        /// The train is not at standstill.
        NOT_STANDSTILL = 0,
        /// Doors are not proved closed, or TCMS reads them open.
        DOORS_OPEN = 1,
        /// No TWC communication.
        NO_TWC = 2,
        /// TWC station data do not match the track database.
        STATION_INVALID = 3,
        /// No valid speed code.
        NO_CODE = 4,
        /// The cab is not active (no HCR, or TCMS reads none), or its reverser is not forward.
        CAB_INACTIVE = 5,
        /// The mode switch is not at automatic or driverless.
        MODE_SWITCH = 6,
        /// The master controller is not at neutral.
        CONTROLLER_NOT_NEUTRAL = 7,
        /// The emergency brake is applied.
        EB_APPLIED = 8,
        /// TCMS is silent or does not enable ATO.
        TCMS_NOT_READY = 9,
        /// ATO is not ready.
        ATO_NOT_READY = 10,
        /// TRA failed its test.
        TRA_FAILED = 11,
        /// Self-test failed or still running.
        SELF_TEST = 12,
        /// The wayside has not given departure, or the start button was not pressed.
        NO_DEPARTURE = 13,
        /// In driverless operation the doors at this station have still to open, stand open or do not close.
        DOOR_SEQUENCE = 14,
        /// An order of the wayside holds the train: turn-back, put-away or wake-up.
        ORDERED = 15,
    }
}
