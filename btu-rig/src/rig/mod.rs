//! The bench around the unit under test: what a train, a wayside and a tester give it, and what
//! it answers. It sees the unit only through frames.
//!
//! A scan is [`Rig::step`], the exchange of bytes, [`Rig::receive`]. Read in this order: this
//! file, `apply` (what each stimulus does), `train_side/wheel` and `train_side/tacho` (pulses), `session/tester`.
//! The files of this folder act on the whole rig. Its subfolders do not know the rig, and depend on each other in one
//! direction: `session` uses `link` and `wayside`, `wayside` uses `train_side`.
//!
//! Terms: *distance* is what the wheels have rolled, never falling; *position* is distance run, forward positive;
//! *quiescent* is the state after [`Rig::new`] and after making safe, in which a healthy unit logs
//! no fault.

mod apply;
mod bench;
mod connection;
mod intervention;
mod link;
mod making_safe;
mod receiving;
mod rig_signals;
mod rolling;
mod section_codes;
mod session;
mod tcms;
#[cfg(test)]
mod tests;
mod train_side;
mod trust;
mod wayside;

use protocol::config::{SpeedCode, UnitConfig};
use protocol::injection::FaultMode;
use protocol::line::Line;
use protocol::link::{End, Link};
use protocol::message::{Coil, IoInput};
use protocol::{Duration, Instant, Random};

use crate::conditions::Conditions;
use crate::procedure::UnitEvent;
use crate::stimulus::WaysideCondition;
use crate::tcms::Tcms;
use crate::train::{CarSet, EquipmentFaults, Train, TrainData, TrainInputs, TrainState};
use crate::waveform::ChannelConfig;

pub use crate::procedure::link_trouble::{InstrumentFault, LinkFailure, LinkTrouble, PortFailure};
pub use bench::{Bench, UnitLink};
pub use link::Harness;
pub use session::{ExpectedIdentity, LogSession, StoredData, TimeOfDay, UnitRecord};
pub use tcms::PAIR_DEMANDS;
pub use train_side::{Misplaced, TrueMotion, check_places};

use link::{HarnessWatch, LatestSample, LineWatch, LinkWatch};
use session::{IdentityCheck, Subscription, Tester};
use train_side::{
    CabDesk, Coils, DoorGear, InCoils, Injected, SpeedHistory, Tacho, TcmsPort, TrainFaults,
    TrainSeen, Wheel, Wires,
};
use wayside::{Antenna, Markers, Track, Wayside};

/// Everything around the unit.
#[derive(Debug)]
pub struct Rig {
    line: Line,
    /// The unit's code table and the level its receiver is made for, mV.
    codes: Vec<SpeedCode>,
    level_mv: f64,
    /// Distance the configured wheel rolls for a pulse, m.
    metres_per_pulse: f64,
    pulses_per_turn: u32,
    conditions: Conditions,
    antenna: Antenna,
    /// The antenna signal follows the codes of the section laid along the way.
    codes_along: bool,
    /// Index in the code table of the code that was last put into the antenna from the section.
    code_put_in: Option<usize>,
    wheel: Wheel,
    tachos: [Tacho; 2],
    train: Train,
    train_data: TrainData,
    /// Length of each car from the head, m, and its share of the weight at `cars_load_kg`.
    cars: Vec<(f64, f64)>,
    cars_load_kg: f64,
    train_state: TrainState,
    speeds: SpeedHistory,
    /// The wheels follow the train model instead of their generator.
    train_driven: bool,
    track: Option<Track>,
    markers: Markers,
    /// Codes, TWC, markers and pulses are waveforms instead of numbers.
    coils: Option<Coils>,
    /// Bytes that the wayside sends in a scan, where the loop is a waveform.
    in_loop: Vec<u8>,
    wayside: Wayside,
    train_number: u16,
    tcms: Tcms,
    /// What TCMS last sent to the train.
    train_orders: TrainInputs,
    tcms_port: TcmsPort,
    /// Motor cars and trailers whose demands make up each signal of [`PAIR_DEMANDS`].
    pair_cars: [(CarSet, CarSet); 4],
    /// Events of TCMS that were not taken yet; `tcms_logged` counts all so far.
    tcms_events: Vec<UnitEvent>,
    tcms_logged: u32,
    /// Number of TCMS's events that were not taken in time.
    tcms_dropped: u64,
    injected: Injected,
    faults: TrainFaults,
    /// Faults of the train's equipment that a procedure makes.
    made: EquipmentFaults,
    /// Outputs of the bench on their way to the unit.
    wires: Wires,
    desk: CabDesk,
    door_gear: DoorGear,
    tester: Tester,
    /// The rig slows the wheels down to a standstill, and then makes everything else quiescent.
    making_safe: bool,
    /// The rig was made safe, and nothing was asked of the bench since.
    quiescent: bool,
    /// The stimulus begun last that takes time is a motion.
    awaits_motion: bool,
    braking: bool,
    link: Link,
    watch: LinkWatch,
    line_watch: LineWatch,
    latest: LatestSample,
    harness: HarnessWatch,
    subscription: Subscription,
    identity: IdentityCheck,
    /// Restarts of the unit that were reported as interventions.
    restarts_told: u32,
    now: Instant,
    /// When a frame of the unit came last, and its stamp.
    unit_stamp: Option<(Instant, u32)>,
}

impl Rig {
    /// A quiescent rig for a type of unit on a line. `line` must have a section, as every
    /// [`Line::from_toml`] has.
    pub fn new(config: &UnitConfig, line: &Line, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let pulse_m = config.metres_per_pulse();
        let tachos = [0, 1].map(|channel| Tacho::new(channel, pulse_m, random.fork()));
        let wayside = Wayside::new(&line.sections[0], random.fork());
        // A session number is never 0.
        let session = random.bits() as u32 | 1;
        let antenna = Antenna::new(random.fork());
        let conditions = Conditions::default();
        let train_data = TrainData::line6();
        let mut rig = Self {
            line: line.clone(),
            codes: config.codes.clone(),
            level_mv: config.receiver.level_nominal_mv,
            metres_per_pulse: pulse_m,
            pulses_per_turn: config.tacho.pulses_per_turn,
            conditions,
            antenna,
            codes_along: false,
            code_put_in: None,
            wheel: Wheel::default(),
            tachos,
            train: Train::new(&train_data, &conditions),
            cars: train_data.weight_shares(0.0),
            cars_load_kg: 0.0,
            tcms: Tcms::new(&train_data),
            train_orders: TrainInputs::default(),
            tcms_port: TcmsPort::default(),
            pair_cars: train_data.first_pairs(),
            tcms_events: Vec::new(),
            tcms_logged: 0,
            tcms_dropped: 0,
            injected: Injected::new(seed),
            faults: TrainFaults::default(),
            made: EquipmentFaults::default(),
            wires: Wires::default(),
            train_data,
            train_state: TrainState::default(),
            speeds: SpeedHistory::default(),
            train_driven: false,
            track: None,
            markers: Markers::default(),
            coils: None,
            in_loop: Vec::new(),
            wayside,
            train_number: config.train.number,
            desk: CabDesk::default(),
            door_gear: DoorGear::default(),
            tester: Tester::new(session),
            making_safe: false,
            quiescent: false,
            awaits_motion: false,
            braking: false,
            link: Link::new(End::Bench),
            watch: LinkWatch::default(),
            line_watch: LineWatch::new(config.link.rejected_per_10s),
            latest: LatestSample::default(),
            harness: HarnessWatch::new(Harness::Bench),
            subscription: Subscription::default(),
            identity: IdentityCheck::default(),
            restarts_told: 0,
            now: Instant::ZERO,
            unit_stamp: None,
        };
        rig.record();
        rig
    }

    /// Says which unit should be there.
    pub fn expect_unit(&mut self, expected: ExpectedIdentity) {
        self.identity = IdentityCheck::new(expected);
    }

    /// Faults of the train, of its wiring and of the bench, each from its time after `power_at`; faults of the unit are
    /// injected in the unit.
    pub fn inject(&mut self, modes: &[FaultMode], power_at: Instant) {
        self.injected.begin(modes, power_at);
    }

    /// Makes the signals in these coils as waveforms from now on, for a unit of this configuration.
    pub fn use_waveforms(
        &mut self,
        config: &UnitConfig,
        channel: &ChannelConfig,
        seed: u64,
        made: &[Coil],
    ) {
        self.coils = Some(Coils::new(config, channel, &mut Random::new(seed), made));
    }

    /// One scan: generators advance, frames that are due are appended to `out`.
    pub fn step(&mut self, now: Instant, out: &mut Vec<u8>) {
        self.now = now;
        self.watch.step(now);
        if self.wayside.condition == WaysideCondition::Corrupt {
            self.line_watch.note_on_purpose(now);
        }
        self.line_watch.step(now, self.link.counters());
        self.latest.step(now, self.harness.is_there());
        if self.quiescent {
            // The unit may ask for the holding brake a little longer: without this its latch would last into the next
            // procedure.
            self.tcms.unlatch();
        }
        self.door_gear.step(
            self.latest.outputs(),
            self.train_data.doors(),
            &mut self.desk.doors,
        );
        let orders = self.orders_of_tcms();
        self.roll(orders);
        self.follow_codes();
        self.antenna.step();
        for tacho in &mut self.tachos {
            tacho.step(&self.wheel.axle);
        }
        self.markers.step(&self.wheel.motion);
        self.finish_making_safe();

        if self.harness.is_there() {
            self.play_train(now, out);
        }
        self.tester.step(now, &mut self.link, out);
        if self.harness.found.is_some() && self.tester.speaks_since().is_some() {
            let changes = !self.harness.is_there();
            self.subscription.step(now, changes, &mut self.link, out);
        }
        self.record();
    }

    /// Frames of I/O rack, TCMS and wayside that are due.
    fn play_train(&mut self, now: Instant, out: &mut Vec<u8>) {
        for entry in self.desk.entries_due(now).into_iter().flatten() {
            self.link.send(now, &entry, out);
        }
        let mut input = self.io_input(now);
        self.wires.carry(&self.faults.bench, &mut input);
        let makes = |coil| self.coils.as_ref().is_some_and(|coils| coils.makes(coil));
        let by_wave = [Coil::AtpAntenna, Coil::TwcAntenna].map(makes);
        if !by_wave[0]
            && let Some(second) = self.antenna.second_due(now)
        {
            let second = self.faults.bench.second(second);
            self.link.send(now, &second.into(), out);
        }
        if let Some(coils) = &mut self.coils {
            let in_coils = InCoils {
                codes: self.antenna.arriving(),
                twc: &self.in_loop,
                motion: &self.wheel.motion,
                markers: &mut self.markers.along(),
                asked_marker: self.markers.asked,
            };
            coils.send(now, &mut input, in_coils, &mut self.link, out);
            self.in_loop.clear();
        }
        self.link.send(now, &input.into(), out);
        let seen = TrainSeen {
            braking: self.braking,
            doors_closed: self.desk.doors_proved(),
            hcr: self.desk.hcr_energised(),
        };
        if let Some(message) = self.tcms_port.step(now, &self.tcms.view, seen) {
            self.link.send(now, &message.into(), out);
        }
        let in_loop = if by_wave[1] { &mut self.in_loop } else { out };
        let before = in_loop.len();
        self.wayside
            .step(now, self.train_number, &mut self.link, in_loop);
        if self.faults.bench.twc_dead {
            in_loop.truncate(before);
        }
    }

    /// This bench's own computer stalled for longer than the unit tolerates: frames lost meanwhile are not
    /// counted against the line, and are no silence of the unit.
    pub fn note_stalled(&mut self, now: Instant) {
        self.line_watch.note_stalled(now);
        self.watch.note_stalled(now);
    }

    /// Bench and unit both stood still for `pause`: this time counts for neither.
    pub fn note_pause(&mut self, now: Instant, pause: Duration) {
        self.note_stalled(now);
        self.tester.clock.put_off(pause);
    }

    /// What the unit logged before it was first heard is not read.
    pub fn leave_log_before_contact(&mut self) {
        self.tester.leaves_old = true;
    }

    /// Tells the unit the time, now and after each restart.
    pub fn tell_time(&mut self, time: TimeOfDay) {
        self.tester.clock.tell(time);
    }

    /// The wheels do what was last asked of them: speed reached, or distance run.
    pub fn motion_settled(&self) -> bool {
        self.train_driven || self.wheel.settled()
    }

    /// What the unit's inputs see at `now`.
    fn io_input(&self, now: Instant) -> IoInput {
        let [one, two] = &self.tachos;
        let backward = self.wheel.backward;
        IoInput {
            carrier_hz: self.antenna.carrier_hz(),
            code_rate_chz: self.antenna.rate_chz(),
            level_mv: self.antenna.level_mv(),
            tacho1_count: one.count,
            tacho1_edge_us: one.age_us(),
            tacho2_count: two.count,
            tacho2_edge_us: two.age_us(),
            tacho_backward: u8::from(one.tells_backward(backward))
                | u8::from(two.tells_backward(backward)) << 1,
            marker: self.markers.last,
            marker_edges: self.markers.edges,
            marker_edge_us: self.markers.age_us(),
            lines: self.desk.lines(now),
            mode_switch: self.desk.mode_switch,
            controller: self.desk.lever.wire(),
        }
    }
}
