//! When the window is woken: soon after something it shows has changed, and seldom while nothing has, because each
//! time it is painted whole.

use std::sync::Arc;
use std::time::Duration;

use protocol::signal::{Sample, Signal};

/// Told when there is something new to look at; must not block.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// The window is woken at most this often: at every second cycle of 50 ms, so that a change is seen within 100 ms. It
/// is less than two cycles, because a cycle may end a little early …
const OFTEN: Duration = Duration::from_millis(75);
/// … or this often, where only curves over half a minute and more are seen …
const FOR_CURVES: Duration = Duration::from_millis(125);
/// … and at least this often while nothing changes but the time and counts.
const SELDOM: Duration = Duration::from_secs(1);
/// … or this often, when only the connection bar shows the unit.
const RARELY: Duration = Duration::from_secs(5);
/// Counts that run on while a unit does nothing: not worth waking anybody.
const COUNTS: [Signal; 5] = [
    Signal::TwcReceived,
    Signal::TwcAnswers,
    Signal::TwcSent,
    Signal::TwcHeard,
    Signal::TwcOthers,
];
/// What the connection bar shows, whatever page is in front.
const ALWAYS_SHOWN: [Signal; 2] = [Signal::Armed, Signal::MaintenanceKey];

/// Signals that the window shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Watched {
    /// Signals of the connection bar.
    Bar,
    Curves,
    /// All signals, as the cab shows them.
    #[default]
    All,
}

impl Watched {
    pub(super) const ALL: [Self; 3] = [Self::Bar, Self::Curves, Self::All];

    /// Shortest and longest time between two wakings.
    fn often(self) -> (Duration, Duration) {
        match self {
            Self::Bar => (OFTEN, RARELY),
            Self::Curves => (FOR_CURVES, SELDOM),
            Self::All => (OFTEN, SELDOM),
        }
    }

    /// Whether the window shows a difference between these values.
    fn differs(self, before: &Values, now: &Values) -> bool {
        let differs = |signal: &Signal| before[signal.index()] != now[signal.index()];
        if self == Self::Bar {
            ALWAYS_SHOWN.iter().any(differs)
        } else {
            let mut signals = Signal::ALL.iter();
            signals.any(|signal| differs(signal) && !COUNTS.contains(signal))
        }
    }
}

/// The bits of each signal's value, which are equal also where it is unknown.
type Values = [u64; Signal::COUNT];

/// When the window was woken last, and what there was to see then.
pub(super) struct Waking {
    at: Duration,
    shown: Values,
}

impl Default for Waking {
    fn default() -> Self {
        Self {
            at: Duration::ZERO,
            shown: [0; Signal::COUNT],
        }
    }
}

impl Waking {
    /// Whether the window is to be woken after the cycle that ended `at`; if so, it is taken for woken.
    pub fn is_due(&mut self, at: Duration, watched: Watched, sample: &Sample) -> bool {
        let since = at.saturating_sub(self.at);
        let (at_most, at_least) = watched.often();
        let now = sample.values().map(f64::to_bits);
        let due = since >= at_least || (since >= at_most && watched.differs(&self.shown, &now));
        if due {
            (self.at, self.shown) = (at, now);
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use btu_rig::procedure::Runner;
    use btu_rig::rig::Rig;
    use btu_rig::stimulus::Stimulus;
    use protocol::{Instant, Speed};

    use super::*;
    use crate::link::Pace;
    use crate::run::{READY_WITHIN, RunControl, settled};
    use crate::stop::Stop;
    use crate::test_support;

    /// Counts by bench time, which is virtual, when a window would be woken, and how late it shows a change of speed.
    #[derive(Default)]
    struct Looks {
        waking: Waking,
        count: usize,
        shown_speed: Option<f64>,
        /// Since when another speed is true than the one shown.
        stale_since: Option<Instant>,
        latest: protocol::Duration,
    }

    #[derive(Default)]
    struct Window(Mutex<Looks>);

    impl Window {
        /// Frames since the last call, and the longest time a speed that was no longer true was shown.
        fn looks(&self) -> (usize, protocol::Duration) {
            let mut looks = self.0.lock().expect("no thread panicked");
            let latest = std::mem::take(&mut looks.latest);
            (std::mem::take(&mut looks.count), latest)
        }
    }

    impl RunControl for Window {
        fn after_cycle(&self, now: Instant, rig: &Rig) {
            let mut looks = self.0.lock().expect("no thread panicked");
            let speed = rig.sample().get(Signal::TrainSpeed);
            if speed != looks.shown_speed {
                looks.stale_since.get_or_insert(now);
            }
            let at = Duration::from_micros(now.as_us());
            if looks.waking.is_due(at, Watched::All, rig.sample()) {
                looks.count += 1;
                looks.shown_speed = speed;
                if let Some(since) = looks.stale_since.take() {
                    looks.latest = looks.latest.max(now.since(since));
                }
            }
        }

        fn before_scan(&self, _: &mut Runner) {}
    }

    /// Goal: the live page is painted once in a second at rest, ten times while the train moves, and shows each change
    /// within 100 ms. Method: the embedded unit in virtual time, 20 s at standstill and 10 s under way.
    #[test]
    fn a_window_is_woken_once_a_second_at_rest_and_ten_times_while_the_train_moves() {
        let window = Arc::<Window>::default();
        let mut setup = test_support::setup(&[]);
        setup.run_control = Some(window.clone());
        let stop = Stop::default();
        let mut session = setup.sim_session("live", &stop);
        session.set_pace(Pace::Virtual);
        session.idle(READY_WITHIN + READY_WITHIN, |_, _, _| {}, settled());
        let idle_s = |session: &mut crate::run::Session<_>, s: u64| {
            session.idle(
                protocol::Duration::from_ms(1000 * s),
                |_, _, _| {},
                |_| false,
            );
            window.looks()
        };
        // Time for what the unit does after power-up.
        idle_s(&mut session, 5);
        let (at_rest, _) = idle_s(&mut session, 20);
        assert!((19..=22).contains(&at_rest), "{at_rest} times in 20 s");

        let now = session.now();
        let go = Stimulus::Speed {
            to: Speed::from_kmh(60.0),
            accel_mps2: 1.0,
        };
        session.bench.rig.apply(now, &go).expect("it goes");
        let (moving, latest) = idle_s(&mut session, 10);
        assert!((90..=101).contains(&moving), "{moving} times in 10 s");
        assert!(latest <= protocol::Duration::from_ms(100), "{latest:?}");
    }
}
