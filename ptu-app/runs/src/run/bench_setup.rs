//! A bench by its content: the data files, faults and settings from which rig and embedded unit are built, and the
//! connection to a unit.

use std::sync::Arc;

use ato_under_test::Setup;
use btu_rig::bench_scatter::{BenchDraw, BenchScatter};
use btu_rig::procedure::plan::Connection;
use btu_rig::rig::{Bench, ExpectedIdentity, Harness, LinkTrouble, Rig, UnitLink};
use btu_rig::train::TrainData;
use btu_rig::waveform::ChannelConfig;
use protocol::config::UnitConfig;
use protocol::injection::FaultMode;
use protocol::line::Line;
use protocol::message::{Coil, Identity};
use protocol::{Duration, Instant};

use super::fault_watch::FaultSeen;
use super::run_control::RunControl;
use super::session::Session;
use super::unit_text;
use crate::aboard::UnitAboard;
use crate::data::DataFile;
use crate::failure::Failure;
use crate::link::{Delayed, Endpoint, Pace, SIM_SERIAL, SimLink, WireLink};
use crate::places::Places;
use crate::stop::Stop;

/// Makes the draw of scans with late frames independent of all other draws by the same seed.
const WIRE_SEQUENCE: u64 = 0x317E_5CA7_7E2D_1A7E;

/// Makes the draws of what disturbs waveforms independent of all other draws by the same seed.
const WAVEFORM_SEQUENCE: u64 = 0xC011_5A3B_1E5D_0A7E;

/// Time an embedded unit is without power before a procedure, so that the signals before show in a trace of its
/// power-up.
pub(crate) const SWITCHED_OFF: Duration = Duration::from_ms(1_000);

/// The content from which benches are built.
#[derive(Clone)]
pub struct BenchSetup {
    /// Where the unit is.
    pub endpoint: Endpoint,
    /// Connection of the bench harness. With `Harness::None` the embedded unit is aboard a train.
    pub harness: Harness,
    pub config: DataFile<UnitConfig>,
    /// Track database.
    pub line: DataFile<Line>,
    /// Train around the unit.
    pub train: TrainData,
    /// Faults injected into the embedded unit, and into the train around any.
    pub faults: Vec<FaultMode>,
    /// Seed of everything random.
    pub seed: u64,
    /// Scatter of good units, trains and benches, drawn by the seed; none = all are nominal.
    pub scatter: Option<Arc<BenchScatter>>,
    /// Codes, TWC, markers and pulses are waveforms, disturbed as this says; `None` = they are numbers.
    pub waveforms: Option<ChannelConfig>,
    pub serial: Option<String>,
    /// Identity that the unit should have.
    pub expected: ExpectedIdentity,
    /// Wall-clock pace also for the embedded unit.
    pub realtime: bool,
    /// Factor by which the bench is slower than the clock, where it goes by the clock.
    pub slower: u32,
    /// Every row is handed on as an event, not only those around faults.
    pub record_whole: bool,
    /// Watches and controls the runs, if set.
    pub run_control: Option<Arc<dyn RunControl>>,
    /// Where stimuli go and readings come from; none = all are in the frames.
    pub places: Option<Arc<Places>>,
}

/// The embedded unit with what is between it and the rig.
pub enum SimUnit {
    /// The unit is on a bench, all of whose channels reach the unit.
    OnBench(Box<SimLink>),
    /// Aboard a train, reached at its maintenance port alone.
    Aboard(Box<UnitAboard>),
}

impl UnitLink for SimUnit {
    fn exchange(
        &mut self,
        now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkTrouble> {
        match self {
            Self::OnBench(unit) => unit.exchange(now, to_unit, from_unit),
            Self::Aboard(train) => train.exchange(now, to_unit, from_unit),
        }
    }
}

/// A unit that has been reached.
pub enum Connected {
    /// The embedded unit, a new one for each procedure.
    Sim(Box<BenchSetup>),
    /// The unit on a port, and the faults that TCMS and the unit's self-test found before the first procedure.
    Port(Box<Session<WireLink>>, Identity, Vec<FaultSeen>),
}

impl BenchSetup {
    /// Serial number before the unit has said its own.
    pub fn expected_serial(&self) -> String {
        match (&self.serial, &self.endpoint) {
            (Some(serial), Endpoint::Sim) => unit_text::of_serial(serial.as_bytes()),
            (Some(serial), _) => serial.clone(),
            (None, Endpoint::Sim) => SIM_SERIAL.into(),
            (None, _) => "unknown".into(),
        }
    }

    /// Whether the run is practice: on a simulated unit, or with injected faults.
    pub fn is_practice(&self) -> bool {
        fault_db::is_practice(&self.endpoint.to_string(), self.injected().as_deref())
    }

    /// Names of the injected faults.
    pub fn injected(&self) -> Option<String> {
        let names: Vec<_> = self.faults.iter().map(|fault| fault.id.as_str()).collect();
        (!names.is_empty()).then(|| names.join(","))
    }

    /// Reaches the unit. A unit on a port is identified and brought to a known state.
    ///
    /// # Errors
    /// The unit cannot be reached, is another one, or has another configuration.
    pub fn connect(&self, stop: &Stop) -> Result<Connected, Failure> {
        if self.endpoint == Endpoint::Sim {
            return Ok(Connected::Sim(Box::new(self.clone())));
        }
        self.reach(stop)
    }

    pub(super) fn rig(&self, seed: u64, power_at: Instant) -> Rig {
        let mut rig = Rig::new(&self.config.content, &self.line.content, seed);
        rig.set_train(self.train.clone());
        rig.expect_unit(self.expected.clone());
        if let Some(drawn) = self.drawn() {
            rig.set_conditions(drawn.conditions);
            rig.set_sensors(&drawn.sensors);
            rig.set_usual_load(drawn.load_kg);
        }
        let by_sound = (self.places.as_ref()).map_or(Vec::new(), |places| places.coils_by_sound());
        let coils = if by_sound.is_empty() {
            Coil::ALL
        } else {
            &by_sound
        };
        let nothing = (!by_sound.is_empty()).then(ChannelConfig::default);
        if let Some(channel) = self.waveforms.as_ref().or(nothing.as_ref()) {
            let seed = seed ^ WAVEFORM_SEQUENCE;
            rig.use_waveforms(&self.config.content, channel, seed, coils);
        }
        rig.inject(&self.faults, power_at);
        rig
    }

    /// The embedded unit, powered up at `power_at`.
    fn unit(&self, seed: u64, power_at: Instant) -> SimLink {
        let setup = Setup {
            serial: self.serial.clone().unwrap_or(SIM_SERIAL.into()),
            config: self.config.content.clone(),
            config_crc: self.config.crc,
            line: self.line.content.clone(),
            tdb_crc: self.line.crc,
            seed,
            faults: of_unit(&self.faults),
        };
        SimLink::new(setup, power_at)
    }

    /// The embedded unit aboard the train, which stands in a depot, without a bench: powered up at `power_at`, with
    /// the faults of both.
    pub fn aboard(&self, seed: u64, power_at: Instant) -> UnitAboard {
        UnitAboard::in_depot(self.rig(seed, power_at), self.unit(seed, power_at))
    }

    /// The embedded unit on a bench, without a procedure.
    pub fn on_bench(&self, seed: u64, power_at: Instant) -> Bench<SimLink> {
        Bench::new(self.rig(seed, power_at), self.unit(seed, power_at))
    }

    /// Conditions drawn for this run; none without scatter.
    fn drawn(&self) -> Option<BenchDraw> {
        let scatter = self.scatter.as_ref()?;
        Some(scatter.draw(self.seed, self.train.full_load_kg()))
    }

    /// A bench with a fresh embedded unit, powered up after [`SWITCHED_OFF`].
    pub(crate) fn sim_session(&self, procedure: &str, stop: &Stop) -> Session<Delayed<SimUnit>> {
        self.sim_session_by(procedure, stop, |link| link)
    }

    /// As [`Self::sim_session`]; `wired` wraps the link to the unit.
    pub(super) fn sim_session_by<L: UnitLink>(
        &self,
        procedure: &str,
        stop: &Stop,
        wired: impl FnOnce(Delayed<SimUnit>) -> L,
    ) -> Session<L> {
        let seed = seed_for(self.seed, procedure);
        let timing = self.drawn().map(|drawn| drawn.timing).unwrap_or_default();
        let power_at = Instant::ZERO + SWITCHED_OFF + timing.power_up;
        let alone = self.harness == Harness::None;
        let unit = match alone {
            false => SimUnit::OnBench(Box::new(self.unit(seed, power_at))),
            true => SimUnit::Aboard(Box::new(self.aboard(seed, power_at))),
        };
        let link = Delayed::new(unit, &timing, seed ^ WIRE_SEQUENCE);
        let mut rig = self.rig(seed, power_at);
        if alone {
            rig.set_harness(Harness::None);
        }
        let pace = if self.realtime {
            Pace::slower(self.slower)
        } else {
            Pace::Virtual
        };
        self.session(Bench::new(rig, wired(link)), pace, stop, true)
    }

    /// As [`Session::new`], watched, controlled and recorded as this setup says.
    pub(super) fn session<L: UnitLink>(
        &self,
        bench: Bench<L>,
        pace: Pace,
        stop: &Stop,
        fresh_unit: bool,
    ) -> Session<L> {
        let mut session = Session::new(bench, pace, stop.clone(), fresh_unit);
        session.run_control.clone_from(&self.run_control);
        session.rows = self.record_whole.then(Vec::new);
        session
    }
}

/// Faults of the unit; the unit does not know those of the train.
fn of_unit(faults: &[FaultMode]) -> Vec<FaultMode> {
    let own = faults.iter().filter(|fault| fault.place.in_unit());
    own.cloned().collect()
}

impl Connected {
    /// Serial number of the unit.
    pub fn serial(&self) -> String {
        match self {
            Self::Sim(setup) => setup.expected_serial(),
            Self::Port(_, identity, _) => unit_text::serial(identity),
        }
    }

    /// Connection by which the unit was reached.
    pub fn connection(&mut self) -> Connection {
        let found = match self {
            Self::Sim(setup) if setup.harness == Harness::None => Some(Connection::Ptu),
            Self::Sim(_) => Some(Connection::Btu),
            Self::Port(session, ..) => session.bench.rig.connection(),
        };
        found.unwrap_or(Connection::Btu)
    }

    /// Replaces the stop that ends runs on this unit.
    pub fn set_stop(&mut self, stop: &Stop) {
        if let Self::Port(session, ..) = self {
            session.set_stop(stop);
        }
    }
}

/// A seed for one procedure of a run: the same whatever else is run (FNV-1a over its name).
fn seed_for(seed: u64, procedure: &str) -> u64 {
    procedure
        .bytes()
        .fold(seed ^ 0xCBF2_9CE4_8422_2325, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3)
        })
}
