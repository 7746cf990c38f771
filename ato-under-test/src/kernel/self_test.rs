//! Start-up self-test: each item exercises the part it is named for.

use alloc::vec;

use protocol::message::SelfTest;
use protocol::{Duration, Instant};

/// What the parts answered during the self-test.
#[derive(Clone, Copy, Debug, Default)]
pub struct SelfTestInputs {
    /// The receiver decoded the test code fed into its coil.
    pub receiver_decoded: bool,
    /// TRA answered its test pulse.
    pub tra_answered: bool,
    /// The TWC modem heard its own test frame.
    pub modem_heard: bool,
    /// The TEST board answers.
    pub test_board_answers: bool,
}

/// Runs once after power-up.
#[derive(Debug)]
pub struct SelfTester {
    ends: Instant,
    seen: SelfTestInputs,
    failed: SelfTest,
    finished: bool,
}

impl SelfTester {
    /// Starts a self-test that takes `span`.
    pub fn new(now: Instant, span: Duration) -> Self {
        Self {
            ends: now + span,
            seen: SelfTestInputs::default(),
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
        if now < self.ends {
            return false;
        }
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

    /// The test has ended.
    pub fn finished(&self) -> bool {
        self.finished
    }

    /// Items that failed.
    pub fn failed(&self) -> SelfTest {
        self.failed
    }

    /// No item failed without which the train cannot be protected.
    pub fn vital_passed(&self) -> bool {
        let vital = SelfTest::MEMORY | SelfTest::CONFIGURATION | SelfTest::ATP_RECEIVER;
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
