//! Memory of the monitor: recent values, codes that were there for long enough, a train that is put away,
//! tachometers that are dead.

use protocol::signal::Signal;
use protocol::{Duration, Instant, SCAN};

use super::observed::Observed;

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

/// Break of a code that no receiver notices: a scan or two.
const BLINK: Duration = Duration::from_ms(30);

/// Limits that were there long enough to be detected: each for `needs` without a break, and from then on for as long as
/// it is heard so long in sum `within` a span.
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
        // Each scan counts whole.
        let long = |from: &Instant, to: &Instant| to.since(*from) + SCAN;
        let heard = self.spells.iter().filter(|(limit, ..)| *limit == limit_kmh);
        let heard_us: u64 = heard.map(|(_, from, to)| long(from, to).as_us()).sum();
        let steady = self
            .spells
            .last()
            .map(|(_, _, to)| long(&self.began(limit_kmh), to));
        let takes_over = steady.is_some_and(|long| long >= self.needs);
        let known = self.lately.values().any(|known| known >= limit_kmh);
        let greatest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        match takes_over || known && heard_us >= self.needs.as_us() {
            true => greatest(&mut self.lately.note(now, limit_kmh, span)),
            false => greatest(&mut self.lately.note_none(now, span)),
        }
    }

    /// When the present limit began: another one for a moment is no break.
    fn began(&self, limit_kmh: f64) -> Instant {
        let mut began = Instant::ZERO;
        let mut follows: Option<Instant> = None;
        for (limit, from, to) in self.spells.iter().rev() {
            if follows.is_some_and(|next| next.since(*to) > BLINK) {
                break;
            }
            if *limit == limit_kmh {
                (began, follows) = (*from, Some(*from));
            }
        }
        began
    }
}

/// A train that is put away, and not woken with a self-test that was passed.
#[derive(Default)]
pub(super) struct Asleep(bool);

impl Asleep {
    /// Notes what the train reports to the wayside; a person who turns the mode switch away from driverless
    /// has taken the train.
    pub fn note(&mut self, seen: Observed<'_>) -> bool {
        let state = seen.value(Signal::OrderState) as u8;
        let (put_away, waking, failed) = (state == 4, state == 5, state == 7);
        self.0 = put_away || self.0 && (waking || failed);
        self.0 &= seen.value(Signal::ModeSwitch) as u8 == 4;
        self.0
    }
}

/// Time since which both tachometers are dead: other signs of motion come later.
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
