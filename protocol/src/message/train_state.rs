//! State of the train for a tester without a harness: [`TrainState`], sent beside `Status` to a tester that
//! asked for it by [`Subscribe`].
//!
//! A harness shows the unit's contacts and its frames to TCMS and wayside; on a train only the unit itself
//! can tell of them.

use super::enums::{EbCause, FsbCause, Mode, ModeSwitch};
use super::io::{Outputs, TrainLines};
use super::layout::layout;
use super::tcms::TcmsToAtcBits;

layout! {
    /// Asks for `TrainState` beside each `Status` for the next 1 s; to be sent at least every 500 ms.
    Subscribe, Ptu, 0x06 {
        /// 1 = also at once in the scan of a change, 0 = with each `Status` only.
        changes: u8,
    }
}

layout! {
    /// Outputs of the unit to the train, and inputs from the train, in the scan of the frame's stamp.
    TrainState, Ptu, 0x91 {
        /// Scans of 10 ms since a change that was not sent at once, at most 255; 0 = all that is new here
        /// changed in this scan.
        held: u8,
        /// Output contacts.
        outputs: Outputs,
        /// Contacts that the functions under test ask for; `outputs` is what relays and test mode make of them.
        asked: Outputs,
        /// Operating mode told to TCMS.
        mode: Mode,
        /// Operating mode of the functions under test, as in `Status`.
        asked_mode: Mode,
        /// Effort sent to TCMS, -1024..1023.
        effort: i16,
        /// Effort that the functions under test ask for, -1024..1023.
        asked_effort: i16,
        /// Index of the received code in the unit's code table, as in `Status`; 255 = none.
        code_index: u8,
        /// Emergency brake's cause, as in `Status`.
        eb_cause: EbCause,
        /// Full service brake's cause, as in `Status`.
        fsb_cause: FsbCause,
        /// Speed limit on the cab display, cm/s.
        limit_cms: u16,
        /// Measured speed on the cab display, cm/s.
        speed_cms: u16,
        /// Speed by the train's own tachometer 1, whatever test speed there is, cm/s.
        train_speed1_cms: u16,
        /// Speed by the train's own tachometer 2, whatever test speed there is, cm/s.
        train_speed2_cms: u16,
        /// Train lines as the unit reads them.
        lines: TrainLines,
        /// Mode switch as the unit reads it.
        mode_switch: ModeSwitch,
        /// Master controller as the unit reads it: -8 emergency, -7 to -1 brake notches, 0 neutral, 1 to 4 power.
        controller: i8,
        /// Last marker the unit detected, 1 to 4; 0 = none.
        marker: u8,
        /// Markers the unit detected so far, wrapping.
        marker_count: u8,
        /// Time since power-up at which the last marker was detected, ms; 0 = none.
        marker_at_ms: u32,
        /// States that TCMS said last.
        tcms_bits: TcmsToAtcBits,
        /// Effort the train gives as TCMS said last, -1024..1023.
        tcms_effort: i16,
        /// Passenger load as TCMS said last, units of 100 kg.
        load_100kg: u16,
        /// Station number in the station data in force; 0 = none.
        twc_station: u16,
        /// Section number in the station data in force; 0 = none.
        twc_section: u16,
        /// Loop number in the station data in force; 0 = none.
        twc_loop: u16,
        /// Train number in the station data in force; 0 = none.
        twc_train_number: u16,
        /// TWC answers sent into the loop since power-up, wrapping.
        twc_answers: u16,
        /// TWC answers that the TEST modem heard since power-up, wrapping.
        test_answers: u16,
        /// Station number in the last answer that the TEST modem heard.
        test_answer_station: u16,
        /// Train number in the last answer that the TEST modem heard.
        test_answer_train: u16,
        /// Speed pulses that left the TEST board since power-up, wrapping.
        test_pulses: u16,
        /// Marker pulses that left the TEST board since power-up, wrapping.
        test_markers: u8,
    }
}
