//! PTU channel: maintenance over the TWC CPU's RS-232 port [S2 §2.2].
//!
//! A session number chosen by the tester ties requests together. Stimuli act through the TEST
//! board only while the unit is armed for that session.

use super::enums::{Answer, ArmRefusal, AtoState, EbCause, FsbCause, Mode, Refusals};
use super::layout::{layout, wire_bits};
use super::self_test::SelfTest;
use super::test_board::TestSignals;

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

layout! {
    /// Asks for the serial number, versions and configuration of the unit, which `Identity` tells.
    Identify, Ptu, 0x01 {}
}
layout! {
    /// First half of the arm exchange.
    ArmRequest, Ptu, 0x02 {
        /// Session number, not 0.
        session: u32,
    }
}
layout! {
    /// Second half: the challenge's answer, within 1 s.
    ArmConfirm, Ptu, 0x03 {
        /// Session number.
        session: u32,
        /// Bitwise complement of the challenge, exclusive-or the session number.
        answer: u32,
    }
}
layout! {
    /// Ends the session: all stimuli off, outputs safe.
    Disarm, Ptu, 0x04 {
        /// Session number.
        session: u32,
    }
}
layout! {
    /// Asks for further `Status` and keeps an armed unit armed; to be sent at least every 500 ms.
    KeepAlive, Ptu, 0x05 {
        /// Session number; 0 = listening only.
        session: u32,
    }
}
layout! {
    /// Identity of the unit.
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
    /// Challenge of the arm exchange.
    ArmChallenge, Ptu, 0x82 {
        /// Session number.
        session: u32,
        /// Number to answer.
        challenge: u32,
    }
}
layout! {
    /// Outcome of arming, and notice when arming lapses.
    ArmState, Ptu, 0x83 {
        /// Session number.
        session: u32,
        /// 1 = armed.
        armed: u8,
        /// Reason for which the unit is not armed.
        refusal: ArmRefusal,
    }
}
layout! {
    /// Answer to a stimulus, release or clear request.
    StimulusAnswer, Ptu, 0x84 {
        /// Sequence number of the request.
        request_seq: u16,
        /// Outcome.
        answer: Answer,
    }
}
layout! {
    /// Another client has the unit: said once to a TCP client that is turned away.
    Taken, Ptu, 0x85 {
        /// IPv6 address of the client that has the unit; an IPv4 address is mapped, `::ffff:192.0.2.1`.
        address: [u8; 16],
        /// Port of the client that has the unit.
        port: u16,
        /// Time since that client came, ms.
        for_ms: u32,
        /// Time since a frame of that client was accepted, ms.
        silent_ms: u32,
    }
}
layout! {
    /// State of the unit, every 50 ms while a tester is heard.
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
        /// Correction of the distance that ATO measures by its wheels, found between markers, 10 ppm.
        wheel_correction_10ppm: i16,
    }
}
