//! Delays the bytes between rig and embedded unit as a cable does.

use std::collections::VecDeque;

use btu_rig::bench_scatter::Timing;
use btu_rig::rig::{LinkTrouble, UnitLink};
use protocol::{Duration, Instant, Random, SCAN};

/// A unit at the other end of a wire that delays bytes.
#[derive(Debug)]
pub struct Delayed<L> {
    link: L,
    to_unit: Direction,
    from_unit: Direction,
    /// Bytes that arrive at the unit in this scan, and those it sends.
    arriving: Vec<u8>,
    sent: Vec<u8>,
}

impl<L> Delayed<L> {
    /// A wire to `link`; `seed` picks the scans whose bytes are late.
    pub fn new(link: L, timing: &Timing, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut way = |takes| Direction::new(takes, timing.late_share, random.fork());
        Self {
            link,
            to_unit: way(timing.to_unit),
            from_unit: way(timing.from_unit),
            arriving: Vec::new(),
            sent: Vec::new(),
        }
    }
}

impl<L: UnitLink> UnitLink for Delayed<L> {
    fn exchange(
        &mut self,
        now: Instant,
        to_unit: &[u8],
        from_unit: &mut Vec<u8>,
    ) -> Result<(), LinkTrouble> {
        self.arriving.clear();
        self.to_unit.carry(now, to_unit, &mut self.arriving);
        self.sent.clear();
        self.link.exchange(now, &self.arriving, &mut self.sent)?;
        self.from_unit.carry(now, &self.sent, from_unit);
        Ok(())
    }
}

/// One direction. Bytes stay in order.
#[derive(Debug)]
struct Direction {
    takes: Duration,
    late_share: f64,
    random: Random,
    /// Bytes on their way with their times of arrival; never longer than the scans the way takes.
    under_way: VecDeque<(Instant, Vec<u8>)>,
}

impl Direction {
    fn new(takes: Duration, late_share: f64, random: Random) -> Self {
        Self {
            takes,
            late_share,
            random,
            under_way: VecDeque::new(),
        }
    }

    /// Puts `bytes` on their way and takes off what has arrived.
    fn carry(&mut self, now: Instant, bytes: &[u8], arrived: &mut Vec<u8>) {
        let mut at = now + self.takes;
        if self.late_share > 0.0 && self.random.unit() < self.late_share {
            at += SCAN;
        }
        if let Some((before, _)) = self.under_way.back() {
            at = at.max(*before);
        }
        self.under_way.push_back((at, bytes.to_vec()));
        while let Some((_, bytes)) = self.under_way.front().filter(|(at, _)| *at <= now) {
            arrived.extend_from_slice(bytes);
            self.under_way.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sends back what it gets.
    struct Echo;

    impl UnitLink for Echo {
        fn exchange(
            &mut self,
            _now: Instant,
            to_unit: &[u8],
            from_unit: &mut Vec<u8>,
        ) -> Result<(), LinkTrouble> {
            from_unit.extend_from_slice(to_unit);
            Ok(())
        }
    }

    fn echoed(timing: &Timing, seed: u64) -> Vec<Vec<u8>> {
        let mut wire = Delayed::new(Echo, timing, seed);
        let scan = |scan: u8| {
            let mut back = Vec::new();
            let now = Instant::from_ms(u64::from(scan) * 10);
            wire.exchange(now, &[scan], &mut back).unwrap();
            back
        };
        (0..200).map(scan).collect()
    }

    #[test]
    fn without_delay_bytes_come_in_the_same_scan() {
        let expected: Vec<_> = (0..200).map(|scan| vec![scan]).collect();
        assert_eq!(echoed(&Timing::default(), 1), expected);
    }

    /// 12 ms there are two scans, 3 ms back one.
    #[test]
    fn bytes_are_on_their_way_for_whole_scans() {
        let timing = Timing {
            to_unit: Duration::from_ms(12),
            from_unit: Duration::from_ms(3),
            ..Timing::default()
        };
        let back = echoed(&timing, 1);
        assert!(back[..3].iter().all(Vec::is_empty));
        assert!(
            back[3..]
                .iter()
                .zip(0..)
                .all(|(bytes, sent)| *bytes == [sent])
        );
    }

    #[test]
    fn late_bytes_are_neither_lost_nor_out_of_order_and_repeat_with_the_seed() {
        let timing = Timing {
            late_share: 0.3,
            ..Timing::default()
        };
        let back = echoed(&timing, 5);
        let most = back.iter().map(Vec::len).max();
        assert!(most > Some(1), "{most:?}");
        let in_order: Vec<u8> = (0..).take(back.concat().len()).collect();
        assert_eq!(back.concat(), in_order);
        assert!(in_order.len() >= 198);
        assert_eq!(back, echoed(&timing, 5));
        assert_ne!(back, echoed(&timing, 6));
    }
}
