//! PTU channel: the self-test on request.

use super::enums::MeasureUnit;
use super::layout::{layout, wire_bits};

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
        /// TWC CPU did not hand on its test frame.
        TWC_CPU = 8,
        /// RS-485 link to TCMS did not hear its own test frame.
        TCMS_LINK = 9,
    }
}

layout! {
    /// Asks for a self-test: answered, then by one result for each item and the end.
    RunSelfTest, Ptu, 0x15 {
        /// Session number.
        session: u32,
    }
}
layout! {
    /// Result of one item of a self-test that was asked for.
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
        /// Unit of the three numbers.
        unit: MeasureUnit,
    }
}
layout! {
    /// End of a self-test that was asked for.
    SelfTestEnd, Ptu, 0x87 {
        /// Sequence number of the request.
        request_seq: u16,
        /// Items that failed.
        failed: SelfTest,
        /// Time it took, ms.
        took_ms: u16,
    }
}
