//! What the monitor remembers of the minute: values that were there lately, codes that were there for long enough,
//! runs that the brake line ended, a train that is put away.

use protocol::signal::Signal;
use protocol::{Duration, Instant, SCAN};

use super::monitor::{NO_POWER_N, Observed};

/// Remembers values that were there lately.
#[derive(Default)]
pub(super) struct Lately(Vec<(f64, Instant)>);

impl Lately {
    /// Values of the last `span`, with the present one.
    pub fn note(&mut self, now: Instant, value: f64, span: Duration) -> impl Iterator<Item = f64> {
        self.0
            .retain(|(old, at)| *old != value && now.since(*at) < span);
        self.0.push((value, now));
        self.values()
    }

    /// Values of the last `span`, none of them present.
    pub fn note_none(&mut self, now: Instant, span: Duration) -> impl Iterator<Item = f64> {
        self.0.retain(|(_, at)| now.since(*at) < span);
        self.values()
    }

    fn values(&self) -> impl Iterator<Item = f64> {
        self.0.iter().map(|(value, _)| *value)
    }
}

/// Limits that were there long enough to be detected: for `needs` within `within`, gaps left out.
pub(super) struct Confirmed {
    needs: Duration,
    within: Duration,
    /// Limit, km/h, from when to when.
    spells: Vec<(f64, Instant, Instant)>,
    lately: Lately,
}

impl Confirmed {
    pub fn new(needs: Duration, within: Duration) -> Self {
        Self {
            needs,
            within,
            spells: Vec::new(),
            lately: Lately::default(),
        }
    }

    /// The greatest limit that was confirmed within the last `span`.
    pub fn note(&mut self, now: Instant, limit_kmh: f64, span: Duration) -> f64 {
        match self.spells.last_mut() {
            Some((limit, _, to)) if *limit == limit_kmh => *to = now,
            _ => self.spells.push((limit_kmh, now, now)),
        }
        let within = self.within;
        self.spells.retain(|(.., to)| now.since(*to) < within);
        let heard = self.spells.iter().filter(|(limit, ..)| *limit == limit_kmh);
        // Each scan counts whole.
        let heard_us: u64 = heard
            .map(|(_, from, to)| (to.since(*from) + SCAN).as_us())
            .sum();
        let greatest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        match heard_us >= self.needs.as_us() {
            true => greatest(&mut self.lately.note(now, limit_kmh, span)),
            false => greatest(&mut self.lately.note_none(now, span)),
        }
    }
}

/// Automatic runs that the open brake line ended, or a supply that failed: the train goes on by a person or a new departure alone.
#[derive(Default)]
pub(super) struct Runs {
    under_way: bool,
    ended: bool,
    departure: bool,
    /// When departure was given last while the brake was applied.
    given_braked: Option<Instant>,
}

impl Runs {
    /// Time for which a departure is on its way: given under the brake it may be heard after its release.
    const ON_ITS_WAY: Duration = Duration::from_ms(1_000);

    /// Whether ATO drives on although the line has ended its run.
    pub fn goes_on(&mut self, seen: Observed<'_>, eb: bool) -> bool {
        let driverless = seen.value(Signal::TcmsMode) == 5.0;
        let by_ato = driverless || seen.value(Signal::TcmsMode) == 4.0;
        let departure = seen.on(Signal::Departure);
        let before = std::mem::replace(&mut self.departure, departure);
        // A unit without supply hears no departure.
        let begins = departure && !before && seen.powered;
        // One that is given under the brake is for a train that may not go.
        if begins && eb {
            self.given_braked = Some(seen.now);
        }
        let braked = self.given_braked.take_if(|_| !eb);
        let late = braked.is_some_and(|at| seen.now.since(at) < Self::ON_ITS_WAY);
        let given = begins && !eb || late;
        let switch = matches!(seen.value(Signal::ModeSwitch) as u8, 3 | 4);
        if seen.start || given || !switch || seen.value(Signal::Controller) != 0.0 {
            self.ended = false;
        }
        let powers = by_ato && seen.traction_n > NO_POWER_N;
        self.under_way = by_ato && (self.under_way || powers);
        if eb && self.under_way {
            self.ended = true;
        }
        self.ended && powers && !eb
    }
}

/// A train that is put away, and not woken with a self-test that was passed.
#[derive(Default)]
pub(super) struct Asleep(bool);

impl Asleep {
    /// By what the train reports to the wayside; who turns the mode switch away from driverless has taken it.
    pub fn note(&mut self, seen: Observed<'_>) -> bool {
        let state = seen.value(Signal::OrderState) as u8;
        let (put_away, waking, failed) = (state == 4, state == 5, state == 7);
        self.0 = put_away || self.0 && (waking || failed);
        self.0 &= seen.value(Signal::ModeSwitch) as u8 == 4;
        self.0
    }
}

/// Both tachometers are dead: what no wheel tells is noticed later.
#[derive(Default)]
pub(super) struct Blind {
    since: Option<Instant>,
}

impl Blind {
    /// Speed at which TCMS tells that the train moves, km/h, with what it may be off.
    const TOLD_KMH: f64 = 6.0;
    /// Time until the unit acts on it.
    const TOLD: Duration = Duration::from_ms(2_500);

    /// The unit cannot know yet that the train moves.
    pub fn note(&mut self, seen: Observed<'_>) -> bool {
        let blind = seen.blind;
        if !blind || seen.kmh() < Self::TOLD_KMH {
            self.since = None;
            return blind;
        }
        let since = *self.since.get_or_insert(seen.now);
        seen.now.since(since) < Self::TOLD
    }
}

#[cfg(test)]
mod tests {
    use protocol::signal::Sample;

    use super::*;

    /// A scan of a driverless train that powers.
    fn goes_on(runs: &mut Runs, departure: bool, powered: bool, eb: bool) -> bool {
        goes_on_at(runs, 0, departure, powered, eb)
    }

    fn goes_on_at(runs: &mut Runs, ms: u64, departure: bool, powered: bool, eb: bool) -> bool {
        let mut sample = Sample::default();
        sample.set(Signal::TcmsMode, 5.0);
        sample.set(Signal::ModeSwitch, 4.0);
        sample.set_bit(Signal::Departure, departure);
        let seen = Observed {
            speed_mps: 1.0,
            traction_n: 2.0 * NO_POWER_N,
            powered,
            ..Observed::at_rest(Instant::from_us(ms * 1_000), &sample)
        };
        runs.goes_on(seen, eb)
    }

    /// Goal: each new departure begins a run, not only the minute's first; none is heard without supply.
    #[test]
    fn a_run_that_was_ended_goes_on_by_a_new_departure() {
        let mut runs = Runs::default();
        assert!(!goes_on(&mut runs, true, true, false), "under way");
        for _ in 0..2 {
            assert!(!goes_on(&mut runs, true, true, true), "braked");
            assert!(goes_on(&mut runs, true, true, false), "still given");
            assert!(goes_on(&mut runs, false, true, false), "withheld");
            assert!(!goes_on(&mut runs, true, true, false), "given again");
        }
        assert!(!goes_on(&mut runs, false, false, true), "no supply");
        assert!(!goes_on(&mut runs, true, false, true), "given unheard");
        assert!(goes_on(&mut runs, true, true, false));
    }

    /// Goal: a departure that is given under the brake does not begin a run, but for one that is heard after its release.
    #[test]
    fn a_departure_under_the_brake_begins_no_run() {
        for (released_ms, goes) in [(3_000, true), (1_500, false)] {
            let mut runs = Runs::default();
            assert!(!goes_on_at(&mut runs, 0, true, true, false), "under way");
            assert!(!goes_on_at(&mut runs, 500, false, true, true), "braked");
            assert!(!goes_on_at(&mut runs, 1_000, true, true, true), "given");
            let released = goes_on_at(&mut runs, released_ms, true, true, false);
            assert_eq!(released, goes, "released at {released_ms} ms");
        }
    }
}
