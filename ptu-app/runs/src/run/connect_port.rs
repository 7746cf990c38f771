//! Reaching a unit on a port: contact, who it is, whether it and the tester go by the same clock, and a known
//! state.

use std::ops::RangeInclusive;

use btu_rig::procedure::plan::Connection;
use btu_rig::procedure::{EventSource, LogState, UnitEvent};
use btu_rig::rig::{Bench, LinkTrouble, TimeOfDay};
use btu_rig::stimulus::Stimulus;
use protocol::event::Event;
use protocol::message::Identity;
use protocol::signal::Sample;
use protocol::{CYCLE, Duration, Instant};

use super::bench_setup::{BenchSetup, Connected};
use super::fault_watch::{self, FaultSeen};
use super::session::Session;
use super::settle::{READY_WITHIN, started};
use super::unit_text;
use crate::clock::{ClockState, now_us};
use crate::failure::{Exit, Failure, NoUnit, RunTrouble};
use crate::link::{Endpoint, WireLink};
use crate::places::Placed;
use crate::stop::Stop;

/// Pace of a unit's clock over the bench's, faulty clocks on a busy computer included: a unit beyond runs at
/// another pace on purpose.
const CLOCKS_AGREE: RangeInclusive<f64> = 0.55..=1.8;

/// Clocks that go together so nearly after [`CLOCK_WATCHED`] are in step; others are watched longer, up to
/// [`CLOCK_DOUBTED`], because either end may have been held up.
const IN_STEP: RangeInclusive<f64> = 0.8..=1.25;
const CLOCK_WATCHED: Duration = Duration::from_ms(1000);
const CLOCK_DOUBTED: Duration = Duration::from_ms(10_000);
/// Time in which the unit's log is answered or given up.
const LOG_WITHIN: Duration = Duration::from_ms(10_000);

impl BenchSetup {
    /// Reaches the unit on its port, identifies it and brings it to a known state. Faults that TCMS finds meanwhile, and
    /// those that the unit finds in its own self-test, are in [`Connected::Port`].
    ///
    /// # Errors
    /// The unit cannot be reached, is another one, or has another configuration.
    pub(super) fn reach(&self, stop: &Stop) -> Result<Connected, Failure> {
        let mut link = WireLink::open(&self.endpoint)?.slower(self.slower);
        if let Some(places) = &self.places {
            link = link.with_instruments(Placed::open(places).map_err(|why| self.bad_bench(why))?);
        }
        let mut rig = self.rig(self.seed, Instant::ZERO);
        rig.set_harness(self.harness);
        let mut bench = Bench::new(rig, link);
        bench.rig.leave_log_before_contact();
        // In lock step the unit's clock stands between scans.
        if !matches!(self.endpoint, Endpoint::LockStep(_)) {
            bench.rig.tell_time(TimeOfDay {
                at: Instant::ZERO,
                utc_us: now_us(),
                uncertainty_ms: ClockState::now().uncertainty_ms(),
            });
        }
        let mut session = self.session(bench, self.endpoint.pace(self.slower), stop, false);
        session.max_lag = Some(self.max_lag(None));
        let mut found = Vec::new();
        let identity = self.bring_up(&mut session, &mut found);
        if session.has_stalled() {
            found.retain(|fault| {
                Event::from_code(fault.code)
                    .is_some_and(|event| event.about_train() || event == Event::SelfTestFailed)
            });
        }
        if stop.presses() > 0 {
            return Err(Failure {
                exit: Exit::Aborted,
                message: RunTrouble::NotReached(self.endpoint.clone()).into(),
            });
        }
        let identity = identity?;
        let connection = session.bench.rig.connection();
        session.max_lag = Some(self.max_lag(connection));
        Ok(Connected::Port(Box::new(session), identity, found))
    }

    /// How far the bench may lag behind the unit. The unit misses its inputs after a silence of `io_timeout_ms`, and
    /// the last frame it received may already be a cycle old. On a train, which gives the inputs itself, the unit ends
    /// the session after `tester_timeout_ms`; a keep-alive may be as old as half of that.
    fn max_lag(&self, connection: Option<Connection>) -> Duration {
        let link = &self.config.content.link;
        if connection == Some(Connection::Ptu) {
            return Duration::from_us(u64::from(link.tester_timeout_ms) * 1000 / 2);
        }
        let silence_us = u64::from(link.io_timeout_ms) * 1000;
        Duration::from_us(silence_us.saturating_sub(CYCLE.as_us()).max(CYCLE.as_us()))
    }

    /// Makes contact, identifies the unit, acknowledges a brake left from before, compares the clocks, and waits for
    /// log and self-test. Entries that the unit's log had before are not read; the train is this bench's, and what TCMS
    /// finds goes to `found`.
    fn bring_up(
        &self,
        session: &mut Session<WireLink>,
        found: &mut Vec<FaultSeen>,
    ) -> Result<Identity, Failure> {
        let mut seen = |entry: &UnitEvent, at, sample: &Sample| {
            if entry.source == EventSource::Tcms && fault_watch::is_fault(entry) {
                found.push(fault_watch::of_event(entry, at, sample));
            }
        };
        let wrong = |identity: &Identity| self.check_identity(identity).is_err();
        let mut first = None;
        let ready = session.idle(READY_WITHIN, &mut seen, |bench| {
            // The unit's clock goes while it starts up.
            first = first.or(bench.rig.unit_stamp_ms());
            let identity = bench.rig.identity();
            identity.is_some_and(|identity| wrong(identity) || started(bench))
        });
        let at = || self.endpoint.clone();
        if let Some(why) = session.bench.rig.turned_away() {
            return Err(NoUnit::Taken(at(), why).into());
        }
        if let Some(why) = session.link_failure().filter(|why| !why.is_of_the_bench()) {
            return Err(NoUnit::PortFailed(why.clone()).into());
        }
        self.link_holds(session)?;
        let Some(identity) = session.bench.rig.identity().copied().filter(|_| ready) else {
            return Err(NoUnit::NotReady(at(), READY_WITHIN).into());
        };
        self.check_identity(&identity)?;
        let now = session.now();
        if session.bench.rig.connection() == Some(Connection::Btu) {
            // A brake latched since the last tester left needs its acknowledgement.
            let _ = session.bench.rig.apply(now, &Stimulus::Acknowledge);
        }
        self.check_clock(session, first, &mut seen)?;
        session.idle(LOG_WITHIN, &mut seen, |bench| {
            let rig = &bench.rig;
            rig.evidence().log == LogState::Read || rig.link_error().is_some()
        });
        self.link_holds(session)?;
        let failed = session.bench.rig.evidence().self_test;
        if !failed.is_empty() {
            let sample = session.bench.rig.sample().clone();
            found.push(fault_watch::of_self_test(failed, session.now(), &sample));
        }
        Ok(identity)
    }

    fn bad_bench(&self, why: LinkTrouble) -> NoUnit {
        let bench = self.places.as_ref().map(|places| places.name.clone());
        NoUnit::BadBench(bench.unwrap_or_default(), why)
    }

    fn link_holds(&self, session: &Session<WireLink>) -> Result<(), NoUnit> {
        match session.link_error() {
            None => Ok(()),
            Some(why) if why.is_of_the_bench() => Err(self.bad_bench(why)),
            Some(why) => Err(NoUnit::BadLink(self.endpoint.clone(), why)),
        }
    }

    /// Holds the unit's clock against the bench's, as long as there is doubt, from the `first` time it reported
    /// on.
    fn check_clock(
        &self,
        session: &mut Session<WireLink>,
        mut first: Option<(Instant, u32)>,
        seen: &mut impl FnMut(&UnitEvent, Instant, &Sample),
    ) -> Result<(), Failure> {
        let mut times_faster = 1.0;
        session.idle(CLOCK_DOUBTED, seen, |bench| {
            let Some((at, stamp_ms)) = bench.rig.unit_stamp_ms() else {
                return false;
            };
            let (first_at, first_ms) = *first.get_or_insert((at, stamp_ms));
            let passed_ms = stamp_ms.wrapping_sub(first_ms) as i32;
            if passed_ms < 0 {
                // A unit that started again meanwhile is for the procedures to find.
                first = None;
                return false;
            }
            let watched = at.since(first_at);
            if watched < CLOCK_WATCHED {
                return false;
            }
            times_faster = f64::from(passed_ms) / 1000.0 / watched.as_secs();
            IN_STEP.contains(&times_faster)
        });
        if CLOCKS_AGREE.contains(&times_faster) {
            return Ok(());
        }
        Err(NoUnit::OtherPace(self.endpoint.clone(), format!("{times_faster:.1}")).into())
    }

    fn check_identity(&self, identity: &Identity) -> Result<(), Failure> {
        let serial = unit_text::serial(identity);
        unit_text::check_expected(&self.endpoint, identity, self.serial.as_deref())?;
        let sum = |crc: u32| format!("{crc:08x}");
        let (unit, ours) = (identity.config_crc, self.config.crc);
        if unit != ours {
            return Err(NoUnit::OtherConfiguration(serial, sum(unit), sum(ours)).into());
        }
        let (unit, ours) = (identity.tdb_crc, self.line.crc);
        if unit != ours {
            return Err(NoUnit::OtherTrack(serial, sum(unit), sum(ours)).into());
        }
        Ok(())
    }
}
