//! The whole unit and its 10 ms scan, [`Unit::step`]: frames in, inputs, self-test, ATP, position, every
//! fifth scan the 50 ms cycle (`cycle`), outputs. `frames` handles the links, `orders` what the wayside orders beside
//! running, `report` builds what the unit says of itself.

mod cycle;
mod frames;
mod functions;
mod orders;
mod outputs;
mod report;
mod self_test;
mod test_mode;
mod train_state;

use alloc::boxed::Box;
use alloc::vec::Vec;

use protocol::Instant;
use protocol::event::Event;
use protocol::injection::Place;
use protocol::message::{IoOutput, Message, Outputs};

use crate::com::{IoImage, Maintenance, Port, Ports, RejectWatch, TcmsLink};
use crate::driverless::Stabling;
use crate::faults::Faults;
use crate::flash::{BlockDevice, Memory, RamFlash};
use crate::front_end::{
    DelayQueue, FrontEnd, OutputStage, PowerAndClock, RelayWatch, ScannedInputs, Supply,
    apply_stored_data_faults, atp_gain,
};
use crate::guards::Guards;
use crate::kernel::{EventLog, RunRecord, SelfTester};
use crate::keyed::Keyed;
use crate::psm::Tra;
use crate::receivers::Coils;
use crate::setup::Setup;
use crate::test_board::TestBoard;
use crate::timer::ms;
use crate::twc::{FromWayside, OwnNumber};
use functions::{Functions, Surroundings};
use test_mode::TestMode;
use train_state::StateReport;

/// Scans in a control cycle.
const SCANS_PER_CYCLE: u8 = 5;

/// An on-board ATC unit.
#[derive(Debug)]
pub struct Unit {
    setup: Setup,
    ports: Ports,
    log: EventLog,
    maintenance: Maintenance,
    board: TestBoard,
    self_tester: SelfTester,
    /// Functions that see the train; nothing of test signals gets into them.
    functions: Functions,
    test_mode: Option<TestMode>,
    scanned: ScannedInputs,
    tra: Tra,
    tcms: TcmsLink,
    image: IoImage,
    /// Receivers of waveforms, from the first samples on.
    coils: Option<Box<Coils>>,
    run_record: RunRecord,
    /// Log and record over power-ups.
    memory: Memory,
    faults: Faults,
    guards: Guards,
    power: PowerAndClock,
    /// Data that a slow TWC CPU has not handed on yet.
    late: DelayQueue<FromWayside>,
    /// Number of the unit's own train.
    number: OwnNumber,
    wheel_entry: Keyed,
    /// Wheel diameter of the configuration, mm, to which each power-up goes back.
    configured_wheel_mm: f64,
    front_end: FrontEnd,
    output_stage: OutputStage,
    relay_watch: RelayWatch,
    /// States asked of the contacts in this scan, and then their actual states.
    commanded: Outputs,
    contacts: Outputs,
    /// Count of markers, and when it last changed, ms since power-up.
    marker_at: (u8, u32),
    state_report: StateReport,
    reject_watch: RejectWatch,
    scan: u8,
    replies: Vec<Message>,
}

impl Unit {
    /// Powers a unit up at [`Instant::ZERO`], with a flash of its own that is erased.
    pub fn new(setup: Setup) -> Self {
        Self::with_flash(setup, Box::new(RamFlash::default()))
    }

    /// Powers a unit up at [`Instant::ZERO`] with the flash that it had before.
    pub fn with_flash(setup: Setup, flash: Box<dyn BlockDevice>) -> Self {
        let faults = Faults::new(&setup.faults, setup.seed ^ 0x5EED);
        Self::powered_up(apply_stored_data_faults(setup), faults, flash)
    }

    /// Powers the unit off; its flash is for the next power-up.
    pub fn power_off(mut self) -> Box<dyn BlockDevice> {
        self.memory.take_device()
    }

    fn powered_up(setup: Setup, faults: Faults, flash: Box<dyn BlockDevice>) -> Self {
        let config = &setup.config;
        let link = &config.link;
        let mut log = EventLog::default();
        log.push(Instant::ZERO, Event::PowerUp, 0);
        let memory = Memory::power_up(flash);
        let mut functions = Functions::new(config);
        let last = memory.last_of(&[Event::PutAway, Event::WokenUp]);
        functions.stabling = Stabling::at_power_up(last == Some(Event::PutAway));
        Self {
            ports: Ports::new(),
            log,
            maintenance: Maintenance::new(ms(link.tester_timeout_ms), setup.seed),
            board: TestBoard::new(config.metres_per_pulse()),
            self_tester: SelfTester::new(Instant::ZERO, ms(config.start.self_test_ms)),
            functions,
            test_mode: None,
            scanned: ScannedInputs::default(),
            tra: Tra::new(ms(config.marker.tra_test_ms)),
            tcms: TcmsLink::new(ms(link.tcms_timeout_ms), config.ato.train.empty_kg),
            run_record: RunRecord::default(),
            memory,
            image: IoImage::new(ms(link.io_timeout_ms)),
            coils: None,
            faults,
            guards: Guards::ALL,
            power: PowerAndClock::default(),
            late: DelayQueue::default(),
            number: OwnNumber::new(config.train.number),
            wheel_entry: Keyed::default(),
            configured_wheel_mm: config.tacho.wheel_diameter_mm,
            front_end: FrontEnd::new(config.metres_per_pulse(), config.receiver.apart_db),
            output_stage: OutputStage::default(),
            relay_watch: RelayWatch::new(ms(config.overspeed.eb_feedback_ms)),
            commanded: Outputs::empty(),
            contacts: Outputs::empty(),
            marker_at: (0, 0),
            state_report: StateReport::default(),
            reject_watch: RejectWatch::new(link.rejected_per_10s),
            scan: 0,
            replies: Vec::new(),
            setup,
        }
    }

    /// Takes bytes that came at the harness; they are acted on in the next scan.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.receive_at(Port::Harness, bytes);
    }

    /// Takes bytes that came at a port; they are acted on in the next scan.
    pub fn receive_at(&mut self, port: Port, bytes: &[u8]) {
        if !self.power.down {
            self.ports.link_mut(port).push(bytes);
        }
    }

    /// Appends what the last scan sent on the maintenance port; nothing unless a tester was heard there last.
    pub fn take_maintenance(&mut self, out: &mut Vec<u8>) {
        self.ports.take_maintenance(out);
    }

    /// Draws arm challenges from another seed, which nobody outside knows.
    pub fn draw_challenges(&mut self, seed: u64) {
        self.maintenance.draw_challenges(seed);
    }

    /// Another tester is connected to a port from now on: nothing the last one sent there is continued.
    pub fn reset_connection(&mut self, port: Port) {
        self.ports.link_mut(port).reset_connection();
    }

    /// Frames accepted at a port since power-up, on all its channels.
    pub fn frames_accepted(&self, port: Port) -> u64 {
        self.ports.link(port).counters().accepted_total()
    }

    /// One scan, every 10 ms; frames for the harness are appended to `out`, those for the maintenance port wait
    /// for [`Self::take_maintenance`] until the next scan.
    pub fn step(&mut self, now: Instant, out: &mut Vec<u8>) {
        self.ports.begin_scan();
        self.faults.step(now);
        match self.power.supply(now, &mut self.faults) {
            Supply::Down => return,
            Supply::Back => self.restart(now),
            Supply::Up => {}
        }
        self.guards = Guards::of(&self.faults);
        let clock_rate = self.faults.gain(Place::Clock);
        let now = self.power.own(now, clock_rate);
        self.image.clock_rate = clock_rate;
        if let Some(coils) = &mut self.coils {
            let unselective = self.faults.dead(Place::CodeSeparation);
            coils.suffer(atp_gain(&self.faults), unselective);
        }
        self.receive_frames(now, out);
        self.read_inputs(now);
        self.test_self(now);
        self.protect(now, out);
        let cycle = self.scan == 0;
        if cycle {
            self.cycle(now, out);
        }
        self.scan = (self.scan + 1) % SCANS_PER_CYCLE;
        self.drive_outputs(now, out);
        self.tell_train_state(now, cycle, out);
        self.store(now);
    }

    /// Stores what is new in log and record, a few entries a scan.
    fn store(&mut self, now: Instant) {
        if self.memory.step(&self.log, &self.run_record) {
            self.log.push(now, Event::MemoryFailed, 0);
        }
    }

    /// Restarts after a dip of the supply; the hardware and its injected faults stay.
    fn restart(&mut self, now: Instant) {
        let faults = core::mem::replace(&mut self.faults, Faults::new(&[], 0));
        let flash = self.memory.take_device();
        let mut setup = self.setup.clone();
        setup.config.tacho.wheel_diameter_mm = self.configured_wheel_mm;
        *self = Self::powered_up(setup, faults, flash);
        self.power = PowerAndClock::restarted(now);
        self.log.push(Instant::ZERO, Event::SupplyDip, 0);
    }

    /// Reads all inputs through antennas, sensors and TEST board.
    fn read_inputs(&mut self, now: Instant) {
        self.image.step(now);
        self.tcms.step(now);
        let built_in = self.self_test_code();
        let (image, board) = (&self.image, &mut self.board);
        self.scanned = self
            .front_end
            .scan(now, image, board, built_in, &mut self.faults);
        let Some(mode) = &mut self.test_mode else {
            // Outside test mode only start-up feeds a code into the receiver.
            self.functions.inputs = self.scanned.tested;
            return;
        };
        mode.functions.inputs = self.scanned.tested;
        self.functions.inputs = self.scanned.train;
        if self.scanned.receiver_taken {
            self.functions.atp.forget_code();
        }
        if self.board.modem.sends() {
            self.functions.twc.forget();
        }
    }

    fn protect(&mut self, now: Instant, out: &mut Vec<u8>) {
        self.with_functions(|functions, around, log| functions.scan(now, around, log));
        self.supervise_test_mode(now, out);
        self.commanded = self.wanted(now);
        let energised = self.commanded.contains(Outputs::EB_RELAY);
        let inputs = &self.functions.inputs;
        let lines = inputs.alive.then_some(inputs.lines);
        self.relay_watch.step(now, energised, lines, &mut self.log);
    }

    /// Ends test mode where it must end, with the emergency brake.
    fn supervise_test_mode(&mut self, now: Instant, out: &mut Vec<u8>) {
        let braked = self.brakes_proved();
        let Some(mode) = &mut self.test_mode else {
            return;
        };
        let config = &self.setup.config;
        let around = (&self.functions, braked);
        let Some(refusal) = mode.ends(now, &self.scanned, around, config, self.guards) else {
            return;
        };
        let parameter = i32::from(refusal.code());
        self.log.push(now, Event::TestModeBroken, parameter);
        let notice = self
            .maintenance
            .end(now, refusal, &mut self.board, &mut self.log);
        self.replies.extend(notice);
        self.send_replies(now, out);
        self.functions.atp.brake_for_test_mode();
        self.leave_test_mode();
    }

    /// Enters test mode when a tester is armed, leaves it when none is any more.
    fn follow_arming(&mut self) {
        match (self.maintenance.armed(), &self.test_mode) {
            (true, None) => {
                let config = &self.setup.config;
                self.test_mode = Some(TestMode::begin(&self.functions, &self.scanned, config));
            }
            (false, Some(_)) => self.leave_test_mode(),
            _ => {}
        }
    }

    /// Leaves test mode. The count of markers goes on: a tester takes a lower count for a wrapped one.
    fn leave_test_mode(&mut self) {
        if let Some(mode) = self.test_mode.take() {
            self.functions
                .locator
                .count_on_from(&mode.functions.locator);
        }
    }

    /// Lets every instance of the functions do a part of its work.
    fn with_functions(&mut self, work: impl Fn(&mut Functions, &Surroundings<'_>, &mut EventLog)) {
        let mut around = Surroundings {
            setup: &self.setup,
            self_tester: &self.self_tester,
            tcms: &self.tcms,
            tra: &self.tra,
            faults: &self.faults,
            guards: self.guards,
            line_fell: self.relay_watch.line_fell,
            ever_heard: self.image.ever_heard(),
            barred: false,
        };
        let before = self.log.next_index();
        if let Some(mode) = &mut self.test_mode {
            work(&mut mode.functions, &around, &mut self.log);
            around.barred = true;
            self.log.leave_out_repeats(Some(before));
        }
        work(&mut self.functions, &around, &mut self.log);
        self.log.leave_out_repeats(None);
    }

    /// Drives the contacts and reports to the bench what they do.
    fn drive_outputs(&mut self, now: Instant, out: &mut Vec<u8>) {
        self.commanded = self.wanted(now);
        let mut wanted = self.commanded;
        if self.self_tester.drops_relay() {
            wanted.remove(Outputs::EB_RELAY);
        }
        self.contacts = self.output_stage.drive(now, wanted, &self.faults);
        let tested = self.tested();
        let output = IoOutput {
            outputs: self.contacts,
            limit_cms: tested.atp.limit().to_cms(),
            speed_cms: tested.atp.tachometers().speed().to_cms(),
            marker: tested.locator.last_marker,
            marker_count: tested.locator.count,
        };
        self.ports.send(now, &output.into(), out);
    }
}
