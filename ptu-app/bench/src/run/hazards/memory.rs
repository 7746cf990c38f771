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

/// Automatic runs that the open brake line ended: the train goes on by a person or a new departure alone.
#[derive(Default)]
pub(super) struct Runs {
    under_way: bool,
    ended: bool,
    departure: bool,
}

impl Runs {
    /// Whether ATO drives on although the line has ended its run.
    pub fn goes_on(&mut self, seen: Observed<'_>, eb: bool) -> bool {
        let driverless = seen.value(Signal::TcmsMode) == 5.0;
        let by_ato = driverless || seen.value(Signal::TcmsMode) == 4.0;
        let departure = seen.on(Signal::Departure);
        let given = departure && !std::mem::replace(&mut self.departure, departure);
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
