//! The RS-485 link to TCMS: alive while frames come that make sense and their alive counter moves.

use protocol::message::{TcmsToAtc, TcmsToAtcBits};
use protocol::{Duration, Instant, Speed};

use super::pace::Pace;

/// Effort as TCMS may say it: 10 bits and sign (S4).
const EFFORT: core::ops::RangeInclusive<i16> = -1024..=1023;
/// TCMS brakes by itself, or gives no power whatever it is asked for.
const HINDERS: TcmsToAtcBits = TcmsToAtcBits::POWERING_CUT
    .union(TcmsToAtcBits::FULL_SERVICE_BRAKE)
    .union(TcmsToAtcBits::EMERGENCY_BRAKE_APPLIED)
    .union(TcmsToAtcBits::HOLDING_BRAKE_APPLIED);

/// Latest report of TCMS.
#[derive(Debug, Default)]
pub struct TcmsLink {
    /// The last frame that made sense.
    pub last: TcmsToAtc,
    heard: Option<Instant>,
    counter_moved: Option<Instant>,
    pub pace: Pace,
    pub alive: bool,
    reported: Option<bool>,
    timeout: Duration,
    most_load_kg: f64,
}

impl TcmsLink {
    /// A link that is lost after `timeout` without a moving alive counter, to a train that cannot carry
    /// more than `most_load_kg`.
    pub fn new(timeout: Duration, most_load_kg: f64) -> Self {
        Self {
            timeout,
            most_load_kg,
            ..Self::default()
        }
    }

    /// Takes a frame; returns whether it makes sense. A frame that says what no train can do counts as lost: the frame
    /// before stands, until the link is given up.
    pub fn take(&mut self, now: Instant, frame: TcmsToAtc) -> bool {
        if !EFFORT.contains(&frame.effort) || load_kg(&frame) > self.most_load_kg {
            return false;
        }
        self.heard = Some(now);
        if self.counter_moved.is_none() || frame.alive != self.last.alive {
            self.counter_moved = Some(now);
            let counts = frame.alive.wrapping_sub(self.last.alive);
            self.pace.count(now, counts);
        }
        self.last = frame;
        true
    }

    pub fn step(&mut self, now: Instant) {
        self.alive = self.fresh(self.counter_moved, now);
    }

    fn fresh(&self, at: Option<Instant>, now: Instant) -> bool {
        at.is_some_and(|at| now.since(at) < self.timeout)
    }

    /// Frames come, and it is only their alive counter that stands.
    pub fn stands(&self, now: Instant) -> bool {
        !self.alive && self.fresh(self.heard, now)
    }

    /// `Some(alive)` once after each change, the first coming up left out.
    pub fn takes_change(&mut self) -> Option<bool> {
        let before = self.reported;
        if before == Some(self.alive) || (before.is_none() && !self.alive) {
            return None;
        }
        self.reported = Some(self.alive);
        before.map(|_| self.alive)
    }

    /// Passenger load last reported, kg.
    pub fn load_kg(&self) -> f64 {
        load_kg(&self.last)
    }

    /// TCMS permits automatic operation, and the train can run.
    pub fn ready(&self) -> bool {
        self.says(TcmsToAtcBits::ATO_ENABLE) && !self.says(TcmsToAtcBits::BRAKE_NOT_RELEASED)
    }

    /// TCMS orders the full service brake on the train, and the service brake is applied.
    pub fn full_service_brake_applied(&self) -> bool {
        self.alive
            && self.last.bits.contains(
                TcmsToAtcBits::FULL_SERVICE_BRAKE.union(TcmsToAtcBits::SERVICE_BRAKE_APPLIED),
            )
    }

    /// Whether the emergency brake is applied, while TCMS says it. An open line does not apply a brake that is cut out.
    pub fn emergency_brake_applied(&self) -> Option<bool> {
        self.alive.then_some(
            self.last
                .bits
                .contains(TcmsToAtcBits::EMERGENCY_BRAKE_APPLIED),
        )
    }

    /// Speed of the axles that TCMS measures; `None` = it does not tell.
    pub fn speed(&self) -> Option<Speed> {
        let tells = self.says(TcmsToAtcBits::TELLS_SPEED);
        tells.then(|| Speed::from_cms(self.last.speed_cms))
    }

    /// TCMS reads the head control relay of the unit's cab as dropped.
    pub fn reads_cab_unmanned(&self) -> bool {
        self.says(TcmsToAtcBits::TELLS_LINES) && !self.says(TcmsToAtcBits::CAB_MANNED)
    }

    /// TCMS reads the doors as not closed.
    pub fn reads_doors_open(&self) -> bool {
        self.says(TcmsToAtcBits::TELLS_LINES) && !self.says(TcmsToAtcBits::DOORS_CLOSED)
    }

    /// TCMS cuts powering. What it cuts while its holding brake is on is left out: ATO asks for that
    /// brake itself, and the train leaves it by motor current.
    pub fn cuts_power(&self) -> bool {
        self.says(TcmsToAtcBits::POWERING_CUT) && !self.says(TcmsToAtcBits::HOLDING_BRAKE_APPLIED)
    }

    /// TCMS brakes by itself, or gives no power: what the train does is not what ATO asks.
    pub fn overrides(&self) -> bool {
        self.alive && self.last.bits.intersects(HINDERS)
    }

    /// Effort the train gives, −1024..1023, while TCMS says it.
    pub fn given(&self) -> Option<i16> {
        self.alive.then_some(self.last.effort)
    }

    fn says(&self, bit: TcmsToAtcBits) -> bool {
        self.alive && self.last.bits.contains(bit)
    }
}

fn load_kg(frame: &TcmsToAtc) -> f64 {
    f64::from(frame.load_100kg) * 100.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::for_tests::with;

    const FRAME: TcmsToAtc = TcmsToAtc {
        bits: TcmsToAtcBits::ATO_ENABLE,
        load_100kg: 1600,
        alive: 1,
        effort: 1023,
        speed_cms: 0,
    };

    fn link() -> TcmsLink {
        TcmsLink::new(Duration::from_ms(500), 268_807.0)
    }

    /// Frames that no train can mean are passed over, and give the link up when no others come.
    #[test]
    fn frames_with_implausible_content_are_refused() {
        let mut link = link();
        assert!(link.take(Instant::ZERO, FRAME));
        let nonsense = [
            with(FRAME, |it| it.effort = 1024),
            with(FRAME, |it| it.effort = -1025),
            with(FRAME, |it| it.effort = i16::MIN),
            with(FRAME, |it| it.load_100kg = 2689),
            with(FRAME, |it| it.load_100kg = u16::MAX),
        ];
        for ms in 1..=100 {
            let bad = nonsense[ms as usize % nonsense.len()];
            let frame = with(bad, |it| it.alive = ms as u8);
            assert!(!link.take(Instant::from_ms(10 * ms), frame));
            link.step(Instant::from_ms(10 * ms));
            assert_eq!(link.alive, ms < 50);
        }
        assert_eq!((link.load_kg(), link.given()), (160e3, None));
        assert!(!link.ready() && !link.stands(Instant::from_ms(1000)));
        let borders = with(FRAME, |it| (it.effort, it.load_100kg) = (-1024, 2688));
        assert!(link.take(Instant::from_ms(1000), borders));
    }

    #[test]
    fn a_standing_counter_is_no_silence() {
        let mut link = link();
        for ms in (0..1000).step_by(50) {
            link.take(Instant::from_ms(ms), FRAME);
            link.step(Instant::from_ms(ms));
        }
        assert!(!link.alive && link.stands(Instant::from_ms(1000)));
        assert!(!link.stands(Instant::from_ms(1500)));
    }

    #[test]
    fn tcms_overrides_effort_only_while_its_frames_arrive() {
        let mut link = link();
        for (bits, cuts, overrides) in [
            (TcmsToAtcBits::empty(), false, false),
            (TcmsToAtcBits::SERVICE_BRAKE_APPLIED, false, false),
            (TcmsToAtcBits::POWERING_CUT, true, true),
            (TcmsToAtcBits::FULL_SERVICE_BRAKE, false, true),
            (TcmsToAtcBits::EMERGENCY_BRAKE_APPLIED, false, true),
            (TcmsToAtcBits::HOLDING_BRAKE_APPLIED, false, true),
            (
                TcmsToAtcBits::HOLDING_BRAKE_APPLIED.union(TcmsToAtcBits::POWERING_CUT),
                false,
                true,
            ),
        ] {
            link.take(Instant::ZERO, TcmsToAtc { bits, ..FRAME });
            link.step(Instant::ZERO);
            assert_eq!(
                (link.cuts_power(), link.overrides()),
                (cuts, overrides),
                "{bits:?}"
            );
        }
        link.step(Instant::from_ms(500));
        assert!(!link.overrides() && !link.cuts_power());
    }
}
