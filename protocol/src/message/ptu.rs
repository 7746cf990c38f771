//! PTU channel: maintenance over the TWC CPU's RS-232 port [S2 §2.2].
//!
//! A session number chosen by the tester ties requests together. Stimuli act through the TEST
//! board only while the unit is armed for that session.

use super::enums::{
    Answer, ArmRefusal, AtoState, DoorSide, EbCause, FsbCause, MeasureUnit, Mode, Refusals,
    RunningMode, StoreKind,
};
use super::layout::{layout, wire_bits};

wire_bits! {
    /// States in `Status`.
    StatusBits {
        /// Armed: stimuli are accepted.
        ARMED = 0,
        /// TWC communication is up.
        TWC_OK = 1,
        /// TCMS communication is up.
        TCMS_OK = 2,
        /// TWC station data match the track database.
        STATION_VALID = 3,
        /// Stopped at the stop point.
        ALIGNED = 4,
        /// TRA passed its last test.
        TRA_OK = 5,
        /// ATO ready.
        ATO_READY = 6,
        /// Start-up self-test finished.
        STARTED = 7,
        /// I/O inputs are alive.
        INPUTS_OK = 8,
    }
}

wire_bits! {
    /// Items of the self-test.
    SelfTest {
        /// Memory pattern test.
        MEMORY = 0,
        /// Unit configuration check.
        CONFIGURATION = 1,
        /// Track database check.
        TRACK_DATABASE = 2,
        /// Brake line energised although the EB relay is not.
        EB_RELAY = 3,
        /// ATP receiver did not decode its test code.
        ATP_RECEIVER = 4,
        /// TRA did not answer its test pulse.
        TRA = 5,
        /// TWC modem loop-back.
        TWC_MODEM = 6,
        /// TEST board.
        TEST_BOARD = 7,
    }
}

wire_bits! {
    /// Signals the TEST board makes.
    TestSignals {
        /// Speed code into the ATP test coil.
        CODE = 0,
        /// Speed on tachometer input 1.
        SPEED_1 = 1,
        /// Speed on tachometer input 2.
        SPEED_2 = 2,
        /// Station data from the TEST modem into the TWC antenna.
        TWC = 3,
    }
}

layout! {
    /// Asks who the unit is. Tester → unit.
    Identify, Ptu, 0x01 {}
}
layout! {
    /// First half of the arm exchange. Tester → unit.
    ArmRequest, Ptu, 0x02 {
        /// Session number, not 0.
        session: u32,
    }
}
layout! {
    /// Second half: the challenge's answer, within 1 s. Tester → unit.
    ArmConfirm, Ptu, 0x03 {
        /// Session number.
        session: u32,
        /// Bitwise complement of the challenge, exclusive-or the session number.
        answer: u32,
    }
}
layout! {
    /// Ends the session: all stimuli off, outputs safe. Tester → unit.
    Disarm, Ptu, 0x04 {
        /// Session number.
        session: u32,
    }
}
layout! {
    /// Keeps the status flowing, and an armed unit armed. Tester → unit, at least every 500 ms.
    KeepAlive, Ptu, 0x05 {
        /// Session number; 0 = listening only.
        session: u32,
    }
}
layout! {
    /// Speed code into the ATP test coil. Tester → unit, answered.
    TestCode, Ptu, 0x10 {
        /// Session number.
        session: u32,
        /// Carrier, Hz.
        carrier_hz: u16,
        /// Code rate, 0.01 Hz; 0 = unmodulated.
        code_rate_chz: u16,
        /// Level, mV, at most 3000.
        level_mv: u16,
    }
}
layout! {
    /// Speed signal in place of the tachometers. Tester → unit, answered.
    TestSpeed, Ptu, 0x11 {
        /// Session number.
        session: u32,
        /// Inputs driven: bit 0 = tachometer 1, bit 1 = tachometer 2; not 0.
        channels: u8,
        /// 1 = backward, 0 = forward.
        backward: u8,
        /// Speed to reach, cm/s, at most 3000.
        speed_cms: u16,
        /// How fast to get there, mm/s²; 0 = the board's own 3000.
        accel_mms2: u16,
    }
}
layout! {
    /// One pulse of the test marker. Tester → unit, answered.
    TestMarker, Ptu, 0x12 {
        /// Session number.
        session: u32,
        /// Marker 1 to 4.
        marker: u8,
    }
}
layout! {
    /// Station data from the TEST modem into the TWC antenna, every 250 ms. Tester → unit, answered.
    TestTwc, Ptu, 0x13 {
        /// Session number.
        session: u32,
        /// Route number.
        route: u16,
        /// Section number.
        section: u16,
        /// This station's number.
        station: u16,
        /// The next station's number.
        next_station: u16,
        /// Loop number.
        loop_id: u16,
        /// Fixed speed, km/h; 255 = none.
        fixed_speed_kmh: u8,
        /// Running mode.
        running_mode: RunningMode,
        /// Door side.
        door_side: DoorSide,
        /// Departure: 1 = given, 0 = held.
        departure: u8,
        /// Train number.
        train_number: u16,
    }
}
layout! {
    /// Takes test signals away. Tester → unit, answered.
    TestRelease, Ptu, 0x14 {
        /// Session number.
        session: u32,
        /// Signals to take away; either speed bit takes away both.
        signals: TestSignals,
    }
}
layout! {
    /// Asks for a self-test: answered, then by one result for each item and the end. Tester → unit.
    RunSelfTest, Ptu, 0x15 {
        /// Session number.
        session: u32,
    }
}
layout! {
    /// Asks for the event log from an index on; answered by entries, then `LogEnd`. Tester → unit.
    ReadLog, Ptu, 0x20 {
        /// First entry wanted.
        from_index: u32,
    }
}
layout! {
    /// Asks for the record of automatic runs from an index on; answered by rows, then `RunEnd`. Tester → unit.
    ReadRun, Ptu, 0x22 {
        /// First row wanted.
        from_index: u32,
    }
}
layout! {
    /// Clears the event log. Tester → unit, answered.
    ClearLog, Ptu, 0x21 {
        /// Session number.
        session: u32,
    }
}
layout! {
    /// Asks for what the unit has stored over power-ups, from a sequence number on; answered by `StoredEntry` and
    /// `StoredClock`, or by `StoredRow`, then `StoredEnd`. Tester → unit.
    ReadStored, Ptu, 0x23 {
        /// Which of the two stores.
        store: StoreKind,
        /// First entry wanted; 4294967295 asks for the end alone.
        from_sequence: u32,
        /// Entries wanted in each 50 ms, 1 to 4.
        per_cycle: u8,
    }
}
layout! {
    /// Tells the unit the time, which it stores with its own. Tester → unit, answered.
    SetClock, Ptu, 0x24 {
        /// Time since 1970 without leap seconds, UTC, ms; from the year 2000 to the year 2100.
        utc_ms: u64,
        /// It may be wrong by so much, ms.
        uncertainty_ms: u16,
    }
}
layout! {
    /// Who the unit is. Unit → tester.
    Identity, Ptu, 0x81 {
        /// Serial number, ASCII, filled up with 0.
        serial: [u8; 16],
        /// Unit configuration's name, ASCII, filled up with 0.
        config: [u8; 16],
        /// CRC-32 of the unit configuration.
        config_crc: u32,
        /// CRC-32 of the track database.
        tdb_crc: u32,
        /// Software version: major, minor, patch.
        software: [u8; 3],
        /// Time since power-up, ms.
        uptime_ms: u32,
        /// Items of the start-up self-test that failed.
        self_test: SelfTest,
    }
}
layout! {
    /// Challenge of the arm exchange. Unit → tester.
    ArmChallenge, Ptu, 0x82 {
        /// Session number.
        session: u32,
        /// Number to answer.
        challenge: u32,
    }
}
layout! {
    /// Outcome of arming, and notice when arming lapses. Unit → tester.
    ArmState, Ptu, 0x83 {
        /// Session number.
        session: u32,
        /// 1 = armed.
        armed: u8,
        /// Why not.
        refusal: ArmRefusal,
    }
}
layout! {
    /// Answer to a stimulus, release or clear request. Unit → tester.
    StimulusAnswer, Ptu, 0x84 {
        /// Sequence number of the request.
        request_seq: u16,
        /// Outcome.
        answer: Answer,
    }
}
layout! {
    /// Another client has the unit: said once to a TCP client that is turned away. Unit → tester.
    Taken, Ptu, 0x85 {
        /// IPv6 address of the client that has it; one of IPv4 is mapped, `::ffff:192.0.2.1`.
        address: [u8; 16],
        /// Its port.
        port: u16,
        /// Time since that client came, ms.
        for_ms: u32,
        /// Time since a frame of that client was accepted, ms.
        silent_ms: u32,
    }
}
layout! {
    /// Result of one item of a self-test that was asked for. Unit → tester.
    SelfTestItem, Ptu, 0x86 {
        /// Sequence number of the request.
        request_seq: u16,
        /// The item, one bit.
        item: SelfTest,
        /// 1 = passed.
        passed: u8,
        /// Measured value.
        value: i32,
        /// Least value allowed.
        low: i32,
        /// Greatest value allowed.
        high: i32,
        /// What the three are measured in.
        unit: MeasureUnit,
    }
}
layout! {
    /// End of a self-test that was asked for. Unit → tester.
    SelfTestEnd, Ptu, 0x87 {
        /// Sequence number of the request.
        request_seq: u16,
        /// Items that failed.
        failed: SelfTest,
        /// Time it took, ms.
        took_ms: u16,
    }
}
layout! {
    /// State of the unit, every 50 ms while a tester is heard. Unit → tester.
    Status, Ptu, 0x90 {
        /// States.
        bits: StatusBits,
        /// Operating mode.
        mode: Mode,
        /// Preconditions of automatic mode that do not hold.
        refusals: Refusals,
        /// Index of the received code in the unit's code table; 255 = none.
        code_index: u8,
        /// Emergency brake's cause.
        eb_cause: EbCause,
        /// Full service brake's cause.
        fsb_cause: FsbCause,
        /// Speed from tachometer 1, cm/s.
        speed1_cms: u16,
        /// Speed from tachometer 2, cm/s.
        speed2_cms: u16,
        /// ATO target speed, cm/s.
        target_cms: u16,
        /// Effort, -1024..1023.
        effort: i16,
        /// Position from the section's start, cm.
        position_cm: i32,
        /// Events logged since power-up.
        events: u32,
        /// Frames rejected since power-up, all reasons, wrapping.
        rejected_frames: u16,
        /// TWC frames accepted since power-up, wrapping.
        twc_received: u16,
        /// Items of the start-up self-test that failed.
        self_test: SelfTest,
        /// Signals the TEST board was asked for and has not been told to take away.
        test_signals: TestSignals,
        /// Carrier measured where it leaves the TEST board, Hz.
        test_carrier_hz: u16,
        /// Code rate measured where it leaves the TEST board, 0.01 Hz.
        test_code_rate_chz: u16,
        /// Level measured where it leaves the TEST board, mV.
        test_level_mv: u16,
        /// Speed of the pulses that leave the TEST board, cm/s.
        test_speed_cms: u16,
        /// Operating state of ATO.
        ato_state: AtoState,
        /// What ATO adds to the way its wheels tell, found between markers, 10 ppm.
        wheel_correction_10ppm: i16,
    }
}
layout! {
    /// One entry of the event log. Unit → tester.
    LogEntry, Ptu, 0xA0 {
        /// Index since power-up, from 0; never reused.
        index: u32,
        /// Event code of the event dictionary.
        code: u16,
        /// Time since power-up, ms.
        at_ms: u32,
        /// Event's parameter, its meaning given by the dictionary.
        parameter: i32,
        /// Freeze frame: measured speed, cm/s.
        speed_cms: u16,
        /// Freeze frame: speed limit, cm/s.
        limit_cms: u16,
        /// Freeze frame: position, cm.
        position_cm: i32,
        /// Freeze frame: operating mode.
        mode: Mode,
        /// Freeze frame: emergency brake's cause.
        eb_cause: EbCause,
    }
}
layout! {
    /// End of the log as it stands. Unit → tester.
    LogEnd, Ptu, 0xA1 {
        /// Index the next event will get.
        next_index: u32,
        /// Oldest index still kept.
        oldest_index: u32,
    }
}
layout! {
    /// One cycle of an automatic run as ATO recorded it [S0 §2, §3.1]. Unit → tester.
    RunRow, Ptu, 0xA2 {
        /// Index since power-up, from 0; never reused.
        index: u32,
        /// Run since power-up, from 1, wrapping.
        run: u16,
        /// Time since power-up, ms.
        at_ms: u32,
        /// Position from the section's start, cm.
        position_cm: i32,
        /// Speed ATO goes by, wheel correction applied, cm/s.
        speed_cms: u16,
        /// Target speed, cm/s.
        target_cms: u16,
        /// Effort, -1024..1023.
        effort: i16,
        /// Marker detected since the last row, 1 to 4 = PSM1 to PSM4; 0 = none.
        marker: u8,
        /// Operating state of ATO.
        ato_state: AtoState,
    }
}
layout! {
    /// End of the run record as it stands. Unit → tester.
    RunEnd, Ptu, 0xA3 {
        /// Index the next row will get.
        next_index: u32,
        /// Oldest index still kept.
        oldest_index: u32,
    }
}
layout! {
    /// One stored entry of the event log. Unit → tester.
    StoredEntry, Ptu, 0xA4 {
        /// Sequence number in the store, over all power-ups; never reused.
        sequence: u32,
        /// Power-up that it was made in, from 1.
        power_up: u32,
        /// Index since that power-up, from 0.
        index: u32,
        /// Event code of the event dictionary.
        code: u16,
        /// Time since that power-up, ms.
        at_ms: u32,
        /// Event's parameter, its meaning given by the dictionary.
        parameter: i32,
        /// Freeze frame: measured speed, cm/s.
        speed_cms: u16,
        /// Freeze frame: speed limit, cm/s.
        limit_cms: u16,
        /// Freeze frame: position, cm.
        position_cm: i32,
        /// Freeze frame: operating mode.
        mode: Mode,
        /// Freeze frame: emergency brake's cause.
        eb_cause: EbCause,
    }
}
layout! {
    /// The time as a tester told it, among the stored entries of the event log. Unit → tester.
    StoredClock, Ptu, 0xA5 {
        /// Sequence number in the store of events.
        sequence: u32,
        /// Power-up that it was told in, from 1.
        power_up: u32,
        /// Time since that power-up, ms.
        at_ms: u32,
        /// Time since 1970, UTC, ms.
        utc_ms: u64,
        /// It may be wrong by so much, ms.
        uncertainty_ms: u16,
    }
}
layout! {
    /// One stored row of the run record. Unit → tester.
    StoredRow, Ptu, 0xA6 {
        /// Sequence number in the store, over all power-ups; never reused.
        sequence: u32,
        /// Power-up that it was made in, from 1.
        power_up: u32,
        /// Index since that power-up, from 0.
        index: u32,
        /// Run since that power-up, from 1, wrapping.
        run: u16,
        /// Time since that power-up, ms.
        at_ms: u32,
        /// Position from the section's start, cm.
        position_cm: i32,
        /// Speed ATO goes by, wheel correction applied, cm/s.
        speed_cms: u16,
        /// Target speed, cm/s.
        target_cms: u16,
        /// Effort, -1024..1023.
        effort: i16,
        /// Marker detected since the last row, 1 to 4 = PSM1 to PSM4; 0 = none.
        marker: u8,
        /// Operating state of ATO.
        ato_state: AtoState,
    }
}
layout! {
    /// End of a store as it stands. Unit → tester.
    StoredEnd, Ptu, 0xA7 {
        /// Which of the two stores.
        store: StoreKind,
        /// Sequence number that the next entry will get.
        next_sequence: u32,
        /// Oldest one still kept.
        oldest_sequence: u32,
        /// Present power-up, from 1.
        power_up: u32,
        /// 1 = entries are stored; 0 = the memory failed, and nothing is.
        works: u8,
    }
}
