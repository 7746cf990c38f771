//! Self-test, at start-up and as often as a tester asks for it: each item exercises the part it is named for and
//! has a value with limits.
//!
//! At start-up a part must answer once: it tells what is dead, and what works at times shall not keep a train
//! from running. On request each test must be answered.

use alloc::{vec, vec::Vec};

use protocol::config::UnitConfig;
use protocol::line::Line;
use protocol::message::{MeasureUnit, Message, SelfTest, SelfTestEnd, SelfTestItem};
use protocol::{Duration, Instant, SCAN};

use crate::timer::{OnDelay, ms};

/// Greatest time for which the brake line may be energised with the relay off, ms.
const LINE_ENERGISED_MS: i32 = 190;
/// Time for which the EB relay is dropped at most on request; its supervision takes 500 ms for a failure.
const RELAY_DROPPED: Duration = Duration::from_ms(450);
/// Tests on request of TRA, modem, TEST board, TWC CPU and RS-485 link, one in a scan.
const TESTS: u16 = 10;
/// Time beyond that of detecting a code that the receiver may take on request, ms, and how long it is waited for.
const DECODE_BEYOND_MS: u32 = 100;
const DECODE_WAIT_MS: u32 = 200;
/// Memory that is tested, bytes.
const BLOCK: usize = 1024;
/// Results sent in a cycle, so that its byte budget holds.
const RESULTS_PER_CYCLE: usize = 2;

/// Answers of the parts in a scan of the self-test.
#[derive(Clone, Copy, Debug, Default)]
pub struct SelfTestInputs {
    /// The receiver hands on the test code that is fed in behind its antenna.
    pub code_heard: bool,
    pub tra_answers: bool,
    /// The TWC modem heard its own test frame.
    pub modem_hears: bool,
    /// The TWC CPU handed on the test frame that was put in behind the modem, unchanged and in time.
    pub twc_cpu_hands_on: bool,
    /// The RS-485 link to TCMS heard its own test frame.
    pub tcms_link_hears: bool,
    pub board_answers: bool,
    pub line_energised: bool,
    /// The brake line should be energised: the relay has been energised for long enough, and the
    /// line is fed.
    pub line_due: bool,
    /// Cells of the tested memory that do not keep what is written.
    pub bad_cells: usize,
}

/// A self-test under way.
#[derive(Debug, Default)]
struct Run {
    /// Sequence number of the request; `None` at start-up.
    request: Option<u16>,
    begun: Instant,
    ends: Instant,
    decoding: OnDelay,
    decoded_after: Option<Duration>,
    tests: u16,
    tra_answers: u16,
    modem_frames: u16,
    board_answers: u16,
    twc_cpu_frames: u16,
    tcms_link_frames: u16,
    energised_since: Option<Instant>,
    energised: Duration,
    /// The line had to be energised when the test began: the relay was, and nothing else opened the line.
    line_due: bool,
    relay_off: bool,
}

/// Start-up's result, and the results of the last request until they are sent.
#[derive(Debug)]
pub struct SelfTester {
    run: Option<Run>,
    start_up_failed: SelfTest,
    started: bool,
    results: Vec<Message>,
}

impl SelfTester {
    /// Begins the start-up self-test, which takes `span`.
    pub fn new(now: Instant, span: Duration) -> Self {
        Self {
            run: Some(Run::new(now, None, now + span)),
            start_up_failed: SelfTest::empty(),
            started: false,
            results: Vec::new(),
        }
    }

    /// Begins a self-test for a request; one that is under way goes on for it.
    pub fn begin(&mut self, now: Instant, request: u16, config: &UnitConfig) {
        match &mut self.run {
            Some(run) => run.request = Some(request),
            None => {
                let span = u64::from(config.receiver.detect_ms + DECODE_WAIT_MS);
                let ends = now + Duration::from_ms(span).max(RELAY_DROPPED);
                self.run = Some(Run::new(now, Some(request), ends));
            }
        }
    }

    /// Ends a self-test on request and forgets its results: they are not waited for.
    pub fn cancel(&mut self) {
        self.results.clear();
        if self.started {
            self.run = None;
        }
    }

    pub fn runs(&self) -> bool {
        self.run.is_some()
    }

    /// The test code is fed into the receiver in the antenna's place.
    pub fn feeds_receiver(&self) -> bool {
        let run = self.run.as_ref();
        run.is_some_and(|run| run.request.is_none() || run.decoded_after.is_none())
    }

    /// Tests of TRA, modem, TEST board, TWC CPU and RS-485 link go on.
    pub fn tests(&self) -> bool {
        let run = self.run.as_ref();
        run.is_some_and(|run| run.request.is_none() || run.tests < TESTS)
    }

    /// The EB relay is to be off for the test.
    pub fn drops_relay(&self) -> bool {
        let run = self.run.as_ref();
        run.is_some_and(|run| run.request.is_some() && run.relay_off)
    }

    /// One scan; the failed items in the scan in which a self-test ends.
    pub fn step(
        &mut self,
        now: Instant,
        inputs: SelfTestInputs,
        config: &UnitConfig,
        line: &Line,
    ) -> Option<SelfTest> {
        let tests = self.tests();
        let run = self.run.as_mut()?;
        let detect = ms(config.receiver.detect_ms);
        if run.decoding.update(now, inputs.code_heard, detect) && run.decoded_after.is_none() {
            run.decoded_after = Some(now.since(run.begun));
        }
        if tests {
            run.tests += 1;
            run.tra_answers += u16::from(inputs.tra_answers);
            run.modem_frames += u16::from(inputs.modem_hears);
            run.board_answers += u16::from(inputs.board_answers);
            run.twc_cpu_frames += u16::from(inputs.twc_cpu_hands_on);
            run.tcms_link_frames += u16::from(inputs.tcms_link_hears);
        }
        run.line_due |= now == run.begun && inputs.line_due;
        run.watch_line(now, inputs.line_energised);
        if now < run.ends {
            return None;
        }
        let run = self.run.take()?;
        let items = run.items(now, inputs.bad_cells, config, line);
        let failed = items.iter().filter(|item| item.passed == 0);
        let failed = failed.fold(SelfTest::empty(), |all, item| all | item.item);
        match run.request {
            None => {
                self.started = true;
                self.start_up_failed = failed;
            }
            Some(request_seq) => {
                self.results = items.map(Message::from).into();
                let took_ms = now.since(run.begun).as_ms() as u16;
                let end = SelfTestEnd {
                    request_seq,
                    failed,
                    took_ms,
                };
                self.results.push(end.into());
            }
        }
        Some(failed)
    }

    /// Results to send in this cycle.
    pub fn take_results(&mut self, replies: &mut Vec<Message>) {
        let count = self.results.len().min(RESULTS_PER_CYCLE);
        replies.extend(self.results.drain(..count));
    }

    /// Start-up is over.
    pub fn finished(&self) -> bool {
        self.started
    }

    /// Items that failed at start-up, by which the unit goes.
    pub fn failed(&self) -> SelfTest {
        self.start_up_failed
    }

    /// Failed items without which no run begins: the TEST board takes no part in running.
    pub fn failed_for_running(&self) -> SelfTest {
        self.start_up_failed.difference(SelfTest::TEST_BOARD)
    }

    /// No item failed at start-up without which the train cannot be protected.
    pub fn vital_passed(&self) -> bool {
        let vital = SelfTest::MEMORY
            | SelfTest::CONFIGURATION
            | SelfTest::EB_RELAY
            | SelfTest::ATP_RECEIVER;
        self.started && !self.start_up_failed.intersects(vital)
    }
}

impl Run {
    fn new(now: Instant, request: Option<u16>, ends: Instant) -> Self {
        Self {
            request,
            begun: now,
            ends,
            relay_off: true,
            ..Self::default()
        }
    }

    /// Takes the longest time for which the line is energised with the relay off. At start-up the relay is off
    /// all the time, on request until the line has followed it.
    fn watch_line(&mut self, now: Instant, energised: bool) {
        if !self.relay_off {
            return;
        }
        if energised {
            let since = *self.energised_since.get_or_insert(now);
            // A scan counts whole: a line that follows at once was energised for one.
            self.energised = self.energised.max(now.since(since) + SCAN);
        } else {
            self.energised_since = None;
        }
        if self.request.is_some() {
            self.relay_off = energised && now.since(self.begun) < RELAY_DROPPED;
        }
    }

    fn items(
        &self,
        now: Instant,
        bad_cells: usize,
        config: &UnitConfig,
        line: &Line,
    ) -> [SelfTestItem; 10] {
        use MeasureUnit::{Answers, Bytes, Errors, Frames, Milliseconds};
        let whole = |span: Duration| i32::try_from(span.as_ms()).unwrap_or(i32::MAX);
        let run_ms = whole(self.ends.since(self.begun));
        let (least, decode_ms) = match self.request {
            None => (1, run_ms),
            Some(_) => {
                let most = config.receiver.detect_ms + DECODE_BEYOND_MS;
                (i32::from(self.tests), most as i32)
            }
        };
        let all = i32::from(self.tests);
        let counted = |answers: u16| (i32::from(answers), least, all);
        let decoded = self
            .decoded_after
            .unwrap_or(now.since(self.begun) + Duration::from_ms(1));
        let wrong = |is_wrong: bool| (i32::from(is_wrong), 0, 0);
        let items = [
            (SelfTest::MEMORY, (wrong_bytes(bad_cells), 0, 0), Bytes),
            (
                SelfTest::CONFIGURATION,
                wrong(config.check().is_err()),
                Errors,
            ),
            (
                SelfTest::TRACK_DATABASE,
                wrong(line.check().is_err()),
                Errors,
            ),
            (
                SelfTest::EB_RELAY,
                (
                    whole(self.energised),
                    // A relay that was never energised has dropped nothing.
                    i32::from(self.line_due && self.request.is_some()),
                    LINE_ENERGISED_MS,
                ),
                Milliseconds,
            ),
            (
                SelfTest::ATP_RECEIVER,
                (whole(decoded), 0, decode_ms),
                Milliseconds,
            ),
            (SelfTest::TRA, counted(self.tra_answers), Answers),
            (SelfTest::TWC_MODEM, counted(self.modem_frames), Frames),
            (SelfTest::TEST_BOARD, counted(self.board_answers), Answers),
            (SelfTest::TWC_CPU, counted(self.twc_cpu_frames), Frames),
            (SelfTest::TCMS_LINK, counted(self.tcms_link_frames), Frames),
        ];
        items.map(|(item, (value, low, high), unit)| SelfTestItem {
            request_seq: self.request.unwrap_or_default(),
            item,
            passed: u8::from((low..=high).contains(&value)),
            value,
            low,
            high,
            unit,
        })
    }
}

/// Bytes of a block of working memory that do not hold one of the patterns; the first `bad_cells` keep nothing.
fn wrong_bytes(bad_cells: usize) -> i32 {
    let mut block = vec![0u8; BLOCK];
    let mut wrong = vec![false; BLOCK];
    for pattern in [0x55u8, 0xAA, 0x00, 0xFF] {
        block.fill(pattern);
        let (stuck, _) = block.split_at_mut(bad_cells.min(BLOCK));
        stuck.fill(0xFF);
        let read = core::hint::black_box(&mut block);
        for (cell, wrong) in read.iter().zip(&mut wrong) {
            *wrong |= *cell != pattern;
        }
    }
    wrong.iter().filter(|wrong| **wrong).count() as i32
}
