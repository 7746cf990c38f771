//! Start-up self-test: each item exercises the part it is named for.

use alloc::vec;

use protocol::config::UnitConfig;
use protocol::line::Line;
use protocol::message::SelfTest;
use protocol::{Duration, Instant};

use crate::timer::OnDelay;

/// Time the brake line has to be dead with the relay.
const RELAY_TIME: Duration = Duration::from_ms(200);

/// What the parts answered during the self-test.
#[derive(Clone, Copy, Debug, Default)]
pub struct SelfTestInputs {
    /// The receiver decoded the test code fed into its coil.
    pub receiver_decoded: bool,
    pub tra_answered: bool,
    /// The TWC modem heard its own test frame.
    pub modem_heard: bool,
    /// The TEST board answers.
    pub test_board_answers: bool,
    /// The brake line is energised although the EB relay is not.
    pub brake_line_energised: bool,
}

/// Runs once after power-up.
#[derive(Debug)]
pub struct SelfTester {
    ends: Instant,
    seen: SelfTestInputs,
    line_energised: OnDelay,
    relay_failed: bool,
    data: SelfTest,
    failed: SelfTest,
    finished: bool,
}

impl SelfTester {
    /// Starts a self-test that takes `span`, with a check of the unit's data.
    pub fn new(now: Instant, span: Duration, config: &UnitConfig, line: &Line) -> Self {
        let mut data = SelfTest::empty();
        data.set(SelfTest::CONFIGURATION, config.check().is_err());
        data.set(SelfTest::TRACK_DATABASE, line.check().is_err());
        Self {
            ends: now + span,
            seen: SelfTestInputs::default(),
            line_energised: OnDelay::default(),
            relay_failed: false,
            data,
            failed: SelfTest::empty(),
            finished: false,
        }
    }

    /// One scan; true in the scan in which the test ends.
    pub fn step(&mut self, now: Instant, inputs: SelfTestInputs) -> bool {
        if self.finished {
            return false;
        }
        self.seen.receiver_decoded |= inputs.receiver_decoded;
        self.seen.tra_answered |= inputs.tra_answered;
        self.seen.modem_heard |= inputs.modem_heard;
        self.seen.test_board_answers |= inputs.test_board_answers;
        self.relay_failed |=
            self.line_energised
                .update(now, inputs.brake_line_energised, RELAY_TIME);
        if now < self.ends {
            return false;
        }
        self.failed = self.data;
        self.failed.set(SelfTest::EB_RELAY, self.relay_failed);
        self.failed.set(SelfTest::MEMORY, !memory_holds_patterns());
        self.failed
            .set(SelfTest::ATP_RECEIVER, !self.seen.receiver_decoded);
        self.failed.set(SelfTest::TRA, !self.seen.tra_answered);
        self.failed.set(SelfTest::TWC_MODEM, !self.seen.modem_heard);
        self.failed
            .set(SelfTest::TEST_BOARD, !self.seen.test_board_answers);
        self.finished = true;
        true
    }

    pub fn finished(&self) -> bool {
        self.finished
    }

    pub fn failed(&self) -> SelfTest {
        self.failed
    }

    /// No item failed without which the train cannot be protected.
    pub fn vital_passed(&self) -> bool {
        let vital = SelfTest::MEMORY
            | SelfTest::CONFIGURATION
            | SelfTest::EB_RELAY
            | SelfTest::ATP_RECEIVER;
        self.finished && !self.failed.intersects(vital)
    }
}

/// March pattern over a block of working memory.
fn memory_holds_patterns() -> bool {
    let mut block = vec![0u8; 1024];
    [0x55u8, 0xAA, 0x00, 0xFF].iter().all(|&pattern| {
        block.fill(pattern);
        core::hint::black_box(&mut block)
            .iter()
            .all(|&cell| cell == pattern)
    })
}
