//! The whole unit and its 10 ms scan; [`crate::cycle`] is what it does every fifth one.

use alloc::string::String;
use alloc::vec::Vec;

use protocol::config::UnitConfig;
use protocol::event::Event;
use protocol::injection::{Effect, FaultMode, Place};
use protocol::line::Line;
use protocol::link::{End, Link, Received};
use protocol::message::{
    Channel, IoOutput, Message, Mode, Outputs, TcmsToAtc, TrainLines, TwcWayside,
};
use protocol::{Duration, Instant};

use crate::ato::{Ato, AtoOutputs};
use crate::atp::{Atp, Code, ScanContext};
use crate::com::{ArmConditions, IoImage, Maintenance, RejectWatch, TcmsLink};
use crate::front_end::{
    EffortOutput, Faults, FrontEnd, Late, OutputStage, PowerAndClock, Supply, spoil_stored_data,
};
use crate::kernel::{EventLog, FreezeFrame, RunRecord, SelfTestInputs, SelfTester, Watchdog};
use crate::psm::{Locator, Movement, Tra};
use crate::report;
use crate::signals::{AntennaSignal, Inputs};
use crate::test_board::TestBoard;
use crate::twc::{TrainState, Twc};

/// Scans in a control cycle.
const SCANS_PER_CYCLE: u8 = 5;
/// Bits that a frame with errors has wrong, in one byte.
const DAMAGE: u8 = 0x12;
/// Level of the self-test's code over the least that the receiver must decode [default].
const SELF_TEST_LEVEL: f64 = 1.2;

/// What one unit is made of.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Serial number.
    pub serial: String,
    /// Configuration.
    pub config: UnitConfig,
    /// CRC-32 of the configuration file.
    pub config_crc: u32,
    /// Track database.
    pub line: Line,
    /// CRC-32 of the track database file.
    pub tdb_crc: u32,
    /// Seed of arm challenges and injected noise.
    pub seed: u64,
    /// Faults injected into it.
    pub faults: Vec<FaultMode>,
}

/// An on-board ATC unit.
#[derive(Debug)]
pub struct Unit {
    pub(crate) setup: Setup,
    pub(crate) link: Link,
    pub(crate) log: EventLog,
    pub(crate) maintenance: Maintenance,
    pub(crate) board: TestBoard,
    pub(crate) self_tester: SelfTester,
    pub(crate) atp: Atp,
    pub(crate) twc: Twc,
    pub(crate) locator: Locator,
    pub(crate) tra: Tra,
    pub(crate) tcms: TcmsLink,
    pub(crate) ato_outputs: AtoOutputs,
    pub(crate) effort_output: EffortOutput,
    pub(crate) inputs: Inputs,
    pub(crate) image: IoImage,
    pub(crate) ato: Ato,
    /// Cycles ATO's processor has run, wrapping.
    pub(crate) ato_cycles: u8,
    pub(crate) ato_watchdog: Watchdog,
    pub(crate) run_record: RunRecord,
    pub(crate) faults: Faults,
    power: PowerAndClock,
    /// Station data that a slow TWC CPU has not handed on yet.
    late_stations: Late<(Option<u16>, TwcWayside)>,
    front_end: FrontEnd,
    output_stage: OutputStage,
    contacts: Outputs,
    pub(crate) reject_watch: RejectWatch,
    scan: u8,
    pub(crate) replies: Vec<Message>,
}

impl Unit {
    /// Powers a unit up at [`Instant::ZERO`].
    pub fn new(setup: Setup) -> Self {
        let faults = Faults::new(&setup.faults, setup.seed ^ 0x5EED);
        Self::powered_up(spoil_stored_data(setup), faults)
    }

    fn powered_up(setup: Setup, faults: Faults) -> Self {
        let config = &setup.config;
        let link = &config.link;
        let ms = |ms: u32| Duration::from_ms(u64::from(ms));
        let mut log = EventLog::default();
        log.push(Instant::ZERO, Event::PowerUp, 0);
        Self {
            link: Link::new(End::Unit),
            log,
            maintenance: Maintenance::new(ms(link.tester_timeout_ms), setup.seed),
            board: TestBoard::new(config.metres_per_pulse()),
            self_tester: SelfTester::new(
                Instant::ZERO,
                ms(config.start.self_test_ms),
                config,
                &setup.line,
            ),
            atp: Atp::new(config),
            twc: Twc::new(ms(link.twc_timeout_ms)),
            locator: Locator::new(config),
            tra: Tra::new(ms(config.marker.tra_test_ms)),
            tcms: TcmsLink::new(ms(link.tcms_timeout_ms), config.ato.train.empty_kg),
            ato: Ato::new(config),
            ato_cycles: 0,
            ato_watchdog: Watchdog::default(),
            run_record: RunRecord::default(),
            ato_outputs: AtoOutputs::default(),
            effort_output: EffortOutput::default(),
            inputs: Inputs::default(),
            image: IoImage::new(ms(link.io_timeout_ms)),
            faults,
            power: PowerAndClock::default(),
            late_stations: Late::default(),
            front_end: FrontEnd::new(config.metres_per_pulse()),
            output_stage: OutputStage::default(),
            contacts: Outputs::empty(),
            reject_watch: RejectWatch::new(link.rejected_per_10s),
            scan: 0,
            replies: Vec::new(),
            setup,
        }
    }

    /// Takes bytes from the wire; they are acted on in the next scan.
    pub fn receive(&mut self, bytes: &[u8]) {
        if !self.power.down() {
            self.link.push(bytes);
        }
    }

    /// The wire ends at another tester from now on: nothing of the last one's goes on.
    pub fn begin_anew(&mut self) {
        self.link.begin_anew();
    }

    /// Frames accepted since power-up, on all channels.
    pub fn frames_accepted(&self) -> u64 {
        self.link.counters().accepted_total()
    }

    /// One scan, every 10 ms; frames to send are appended to `out`.
    pub fn step(&mut self, now: Instant, out: &mut Vec<u8>) {
        self.faults.step(now);
        match self.power.supply(now, &mut self.faults) {
            Supply::Down => return,
            Supply::Back => self.restart(now),
            Supply::Up => {}
        }
        let clock_rate = self.faults.gain(Place::Clock);
        let now = self.power.own(now, clock_rate);
        self.image.set_clock_rate(clock_rate);
        self.receive_frames(now, out);
        self.read_inputs(now);
        self.test_self(now);
        self.protect(now);
        self.locate(now);
        if self.scan == 0 {
            self.cycle(now, out);
        }
        self.scan = (self.scan + 1) % SCANS_PER_CYCLE;
        self.drive_outputs(now, out);
    }

    /// Begins anew after a dip of the supply; the hardware, and what is wrong with it, stays the same.
    fn restart(&mut self, now: Instant) {
        let faults = core::mem::replace(&mut self.faults, Faults::new(&[], 0));
        *self = Self::powered_up(self.setup.clone(), faults);
        self.power = PowerAndClock::restarted(now);
        self.log.push(Instant::ZERO, Event::SupplyDip, 0);
    }

    /// Latches what came; answers requests of the tester.
    fn receive_frames(&mut self, now: Instant, out: &mut Vec<u8>) {
        while let Some(Received { header, message }) = self.link.poll(now) {
            match message {
                Message::IoInput(input) => self.image.latch(now, header.stamp_ms, input),
                Message::TcmsToAtc(frame) => self.hear_tcms(now, frame),
                Message::TwcWayside(data) => self.take_station(now, Some(header.seq), data, out),
                Message::Identify(_) => {
                    let identity = report::identity(self, now);
                    self.link.send(now, &identity, out);
                }
                other if header.channel == Channel::Ptu => {
                    let conditions = self.arm_conditions();
                    let parts = (&mut self.board, &mut self.log);
                    let request = (header.seq, other);
                    self.maintenance
                        .handle(now, request, conditions, parts, &mut self.replies);
                }
                _ => {}
            }
        }
        while let Some((seq, data)) = self.late_stations.pop(now) {
            self.handle_station(now, seq, data, out);
        }
        let conditions = self.arm_conditions();
        let notice = self
            .maintenance
            .step(now, conditions, &mut self.board, &mut self.log);
        self.replies.extend(notice);
        for reply in self.replies.drain(..) {
            self.link.send(now, &reply, out);
        }
    }

    /// A frame is lost at `place`; one that arrives damaged is counted like any rejected frame.
    pub(crate) fn loses(&mut self, place: Place) -> bool {
        let lost = self.faults.loses(place);
        let damaged = lost && matches!(self.faults.at(place), Some(Effect::BitErrors { .. }));
        match place {
            Place::TcmsReceiver if damaged => self.reject_watch.count_lost(Channel::Tcms),
            Place::FskReceiver | Place::TwcAntenna if damaged => {
                self.reject_watch.count_lost(Channel::Twc);
            }
            _ => {}
        }
        lost
    }

    fn hear_tcms(&mut self, now: Instant, frame: TcmsToAtc) {
        if !self.loses(Place::TcmsReceiver) && !self.tcms.take(now, frame) {
            self.reject_watch.count_lost(Channel::Tcms);
        }
    }

    /// Station data from the loop (`seq` given, answered) or from the TWC TEST module.
    pub(crate) fn take_station(
        &mut self,
        now: Instant,
        seq: Option<u16>,
        mut data: TwcWayside,
        out: &mut Vec<u8>,
    ) {
        // The TEST module is wired to the modem: only what comes from the loop passes the antenna.
        if seq.is_some() && self.loses(Place::TwcAntenna) {
            return;
        }
        if self.loses(Place::FskReceiver) {
            return;
        }
        // While the TEST module talks to the modem the loop is not heard.
        if seq.is_some() && self.board.makes_twc() {
            return;
        }
        match self.faults.at(Place::TwcCpu) {
            Some(Effect::Dead) => return,
            Some(Effect::Delay { ms }) => {
                let due = now + Duration::from_ms(u64::from(ms));
                return self.late_stations.push(due, (seq, data));
            }
            Some(Effect::Offset { by }) => {
                data.station = data.station.wrapping_add_signed(by as i16);
            }
            _ => {}
        }
        self.handle_station(now, seq, data, out);
    }

    /// Takes station data and answers those from the loop.
    fn handle_station(
        &mut self,
        now: Instant,
        seq: Option<u16>,
        data: TwcWayside,
        out: &mut Vec<u8>,
    ) {
        self.twc.take(now, data, &self.setup.line, &mut self.log);
        let Some(seq) = seq else { return };
        let answer = self.twc.answer(seq, &data, self.train_state());
        if !self.loses(Place::TwcAntenna) {
            self.send_through(Place::FskTransmitter, now, &answer.into(), out);
        }
    }

    /// Sends by a modem or line driver that may lose or damage the frame.
    pub(crate) fn send_through(
        &mut self,
        place: Place,
        now: Instant,
        message: &Message,
        out: &mut Vec<u8>,
    ) {
        if matches!(self.faults.at(place), Some(Effect::Dead)) {
            return;
        }
        let begin = out.len();
        self.link.send(now, message, out);
        if self.faults.loses(place) {
            let middle = (begin + out.len()) / 2;
            if let Some(byte) = out.get_mut(middle) {
                *byte ^= DAMAGE;
            }
        }
    }

    fn train_state(&self) -> TrainState {
        TrainState {
            mode: self.atp.sequence().mode(),
            doors_closed: self.inputs.lines.contains(TrainLines::DOORS_CLOSED),
            aligned: self.aligned(),
            standstill: self.atp.tachometers().standstill(),
            speed: self.atp.tachometers().speed(),
        }
    }

    fn arm_conditions(&self) -> ArmConditions {
        ArmConditions {
            started: self.self_tester.finished(),
            key_on: self.inputs.lines.contains(TrainLines::MAINTENANCE_KEY),
            standing: self.atp.tachometers().train_stands(),
        }
    }

    /// Reads all inputs through antennas, sensors and TEST board.
    fn read_inputs(&mut self, now: Instant) {
        self.image.step(now);
        self.tcms.step(now);
        self.board.set_dead(matches!(
            self.faults.at(Place::TestBoard),
            Some(Effect::Dead)
        ));
        let built_in = (!self.self_tester.finished())
            .then(|| self.self_test_code())
            .flatten();
        let (image, board) = (&self.image, &mut self.board);
        self.inputs = self
            .front_end
            .scan(now, image, board, built_in, &mut self.faults);
    }

    /// The code that start-up feeds into the receiver: the first of the table, little above the least
    /// level it must decode.
    fn self_test_code(&self) -> Option<AntennaSignal> {
        let config = &self.setup.config;
        config.codes.first().map(|code| AntennaSignal {
            carrier_hz: code.carrier_hz,
            rate_hz: code.rate_hz,
            level_mv: config.receiver.level_min_mv * SELF_TEST_LEVEL,
        })
    }

    fn test_self(&mut self, now: Instant) {
        if self.self_tester.finished() {
            return;
        }
        let seen = SelfTestInputs {
            receiver_decoded: matches!(self.atp.decoder().candidate(), Code::Known(_)),
            tra_answered: self.inputs.tra_answers,
            modem_heard: self.loop_back(),
            test_board_answers: self.board.answers(),
            brake_line_energised: self.inputs.lines.contains(TrainLines::EB_LOOP),
        };
        if self.self_tester.step(now, seen) {
            self.atp.forget_test_code();
            let failed = self.self_tester.failed();
            if !failed.is_empty() {
                self.log
                    .push(now, Event::SelfTestFailed, i32::from(failed.bits()));
            }
        }
    }

    /// The modem's test frame, through its transmitter back into its receiver. One that arrives
    /// damaged is no bad frame of the link.
    fn loop_back(&mut self) -> bool {
        let sent = !self.faults.loses(Place::FskTransmitter);
        sent && !self.faults.loses(Place::FskReceiver)
    }

    /// One scan of ATP.
    fn protect(&mut self, now: Instant) {
        let context = ScanContext {
            vital_passed: self.self_tester.vital_passed(),
            started: self.self_tester.finished(),
            ever_alive: self.image.ever_heard(),
            aligned: self.aligned(),
            at_platform: self.at_platform(),
            door_side: self
                .twc
                .data()
                .map(|data| data.door_side)
                .unwrap_or_default(),
            twc_up: self.twc.up(),
            tcms_up: self.tcms.alive(),
            ato_ready: self.ato_outputs.ready,
        };
        self.log.freeze(FreezeFrame {
            speed: self.atp.tachometers().speed(),
            limit: self.atp.limit(),
            position_m: self.locator.position_m(),
            mode: self.atp.sequence().mode(),
            eb_cause: self.atp.brake().cause(),
        });
        self.atp.scan(
            now,
            &self.inputs,
            context,
            &self.setup.config,
            &mut self.log,
        );
    }

    fn locate(&mut self, now: Instant) {
        let tachometers = self.atp.tachometers();
        let channel = tachometers.way_channel();
        let pulses = &self.inputs.pulses[channel];
        let movement = Movement {
            moved_m: tachometers.moved_m(),
            edge_age_s: pulses.sampled_at.since(pulses.edge_at).as_secs(),
            speed_mps: tachometers.channel(channel).mps(),
            standstill: tachometers.standstill(),
            driven: self.atp.sequence().mode() == Mode::AutomaticRun,
        };
        self.locator
            .step(now, movement, self.inputs.marker, &mut self.log);
    }

    pub(crate) fn aligned(&self) -> bool {
        self.atp.tachometers().standstill()
            && self.locator.aligned(self.setup.config.doors.aligned_m)
    }

    /// On the arrival station's loop, with valid station data.
    fn at_platform(&self) -> bool {
        let on_loop = self.twc.data().zip(self.locator.section());
        self.twc.valid() && on_loop.is_some_and(|(data, section)| data.loop_id == section.to_loop)
    }

    /// ATO holds the train; so it stays when ATO has failed, until the driver takes it.
    fn holds(&self) -> bool {
        let left_alone = self.atp.sequence().failed()
            && self.atp.tachometers().standstill()
            && self.inputs.controller == 0;
        self.ato_outputs.holding_brake || left_alone
    }

    /// Drives the contacts and tells the bench what they do.
    fn drive_outputs(&mut self, now: Instant, out: &mut Vec<u8>) {
        let healthy = self.self_tester.vital_passed() && self.inputs.alive;
        let mut wanted = self.atp.outputs(healthy);
        wanted.set(Outputs::HOLDING_BRAKE, self.holds());
        self.contacts = self.output_stage.drive(now, wanted, &self.faults);
        let output = IoOutput {
            outputs: self.contacts,
            limit_cms: self.atp.limit().to_cms(),
            speed_cms: self.atp.tachometers().speed().to_cms(),
            marker: self.locator.last_marker(),
            marker_count: self.locator.count(),
        };
        self.link.send(now, &output.into(), out);
    }
}
