//! Moments by the unit's own clock, each known within bounds.
//!
//! A change that a state frame is the first to show happened after the frame before, and by the frame's stamp; a change
//! that the unit tells in the scan of the change happened within that scan. Bounds are in ms and wrap as stamps do.

use protocol::SCAN;
use protocol::signal::Signal;

use super::UnitTime;
use super::plan::Condition;

/// A moment later than `after_ms` and, if `by_ms` is known, not later than `by_ms`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Moment {
    after_ms: u32,
    by_ms: Option<u32>,
}

/// How a signal's change is dated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Dating {
    /// The unit tells the change in the scan of the change.
    Scan,
    /// The unit tells the change in its next state frame.
    Frame,
    /// The unit tells the change in its next `Status`.
    Cycle,
}

impl Moment {
    /// When a condition became true that the sample of this scan is the first to show as true.
    pub fn of_edge(time: &UnitTime, condition: &Condition) -> Self {
        let mut dating = Dating::Scan;
        condition.for_each_signal(&mut |signal| dating = dating.max(Dating::of(signal)));
        Self {
            after_ms: match dating {
                Dating::Scan => time.after.scan_ms,
                Dating::Frame => time.after.frame_ms,
                Dating::Cycle => time.after.cycle_ms,
            },
            by_ms: Some(time.stamp_ms),
        }
    }

    /// When the unit carried out the request that it answered last.
    pub fn of_answer(time: &UnitTime) -> Self {
        match time.answered_ms {
            Some(stamp_ms) => Self {
                after_ms: stamp_ms.wrapping_sub(SCAN.as_ms() as u32),
                by_ms: Some(stamp_ms),
            },
            None => Self::before_the_next(time),
        }
    }

    /// A moment at the tester: after the latest state frame was sent and before the next one is sent.
    pub fn before_the_next(time: &UnitTime) -> Self {
        Self {
            after_ms: time.stamp_ms,
            by_ms: None,
        }
    }

    /// Ends a moment that has no end yet at the stamp of the latest state frame, if that frame is a later one.
    pub fn ended_by(self, time: &UnitTime) -> Self {
        let next = (time.stamp_ms != self.after_ms).then_some(time.stamp_ms);
        Self {
            by_ms: self.by_ms.or(next),
            ..self
        }
    }

    /// Time from `start` to this moment, and its uncertainty, ms; `None` if the clock went back meanwhile.
    pub fn since(self, start: Self) -> Option<(f64, f64)> {
        let by_ms = self.by_ms.unwrap_or(self.after_ms);
        // A start without a known end is bounded by the end of the measured time.
        let start_by_ms = start.by_ms.unwrap_or(by_ms);
        let span = |from: u32, to: u32| f64::from(to.wrapping_sub(from) as i32);
        let least = span(start_by_ms, self.after_ms).max(0.0);
        let most = span(start.after_ms, by_ms);
        (most >= least).then(|| ((least + most) / 2.0, (most - least) / 2.0))
    }
}

impl Dating {
    fn of(signal: Signal) -> Self {
        match signal {
            Signal::Eb
            | Signal::Fsb
            | Signal::PowerCut
            | Signal::Alarm
            | Signal::HoldingBrake
            | Signal::DoorEnableLeft
            | Signal::DoorEnableRight
            | Signal::DoorOrderLeft
            | Signal::DoorOrderRight
            | Signal::DoorOrderClose
            | Signal::CodeValid
            | Signal::Standstill
            | Signal::Healthy
            | Signal::Limit
            | Signal::Marker
            | Signal::MarkerCount
            | Signal::Mode
            | Signal::TrainMode
            | Signal::CodeIndex
            | Signal::EbCause
            | Signal::FsbCause
            | Signal::AskedEb
            | Signal::AskedFsb
            | Signal::AskedPowerCut
            | Signal::AskedAlarm
            | Signal::AskedDoorLeft
            | Signal::AskedDoorRight
            | Signal::AskedDoorClose
            | Signal::AskedMode
            | Signal::Doors
            | Signal::DoorsLeft
            | Signal::DoorsRight
            | Signal::Hcr
            | Signal::MaintenanceKey
            | Signal::EbLoop
            | Signal::TwcSent
            | Signal::TestAnswers => Self::Scan,
            Signal::Speed
            | Signal::TrainSpeed1
            | Signal::TrainSpeed2
            | Signal::AskedPower
            | Signal::AskedEffort
            | Signal::Effort
            | Signal::Power
            | Signal::Brake
            | Signal::ModeSwitch
            | Signal::Controller
            | Signal::MarkerAt
            | Signal::TcmsBraking
            | Signal::TcmsLineOpen
            | Signal::TcmsGiven
            | Signal::TcmsLoad
            | Signal::TcmsTellsLines
            | Signal::TcmsDoors
            | Signal::TcmsHcr
            | Signal::TwcStation
            | Signal::TwcSection
            | Signal::TwcLoop
            | Signal::TwcTrain
            | Signal::TestAnswerStation
            | Signal::TestAnswerTrain
            | Signal::TestPulses
            | Signal::TestMarkers => Self::Frame,
            _ => Self::Cycle,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::UnitTimeBounds;
    use super::*;

    fn at(stamp_ms: u32, before_ms: u32) -> UnitTime {
        UnitTime {
            stamp_ms,
            after: UnitTimeBounds {
                scan_ms: stamp_ms.wrapping_sub(10),
                frame_ms: before_ms,
                cycle_ms: before_ms.wrapping_sub(50),
            },
            answered_ms: Some(1000),
        }
    }

    fn is_(signal: Signal) -> Condition {
        use super::super::plan::{Comparison, Operand};
        Condition::Compare {
            signal,
            comparison: Comparison::Equal,
            operand: Operand::Literal(1.0),
        }
    }

    #[test]
    fn what_is_told_in_its_scan_is_known_to_a_scan() {
        let start = Moment::of_answer(&at(1030, 1000));
        let end = Moment::of_edge(&at(1210, 1200), &is_(Signal::Eb));
        assert_eq!(end.since(start), Some((210.0, 10.0)));
    }

    #[test]
    fn what_is_told_later_is_known_to_the_frames_around_it() {
        let start = Moment::of_edge(&at(1000, 950), &is_(Signal::TestSpeed));
        let end = Moment::of_edge(&at(1210, 1200), &is_(Signal::Speed));
        // 900 to 1000, 1200 to 1210.
        assert_eq!(end.since(start), Some((255.0, 55.0)));
    }

    #[test]
    fn a_moment_of_the_testers_lies_between_two_frames() {
        let start = Moment::before_the_next(&at(1000, 950));
        let start = start.ended_by(&at(1000, 950)).ended_by(&at(1050, 1000));
        let start = start.ended_by(&at(1100, 1050));
        let end = Moment::of_edge(&at(1210, 1200), &is_(Signal::Eb));
        assert_eq!(end.since(start), Some((180.0, 30.0)));
    }

    #[test]
    fn a_clock_that_wraps_is_followed_and_one_that_goes_back_is_not() {
        let start = Moment::of_edge(&at(u32::MAX - 39, u32::MAX - 89), &is_(Signal::Eb));
        let end = Moment::of_edge(&at(60, 10), &is_(Signal::Eb));
        assert_eq!(end.since(start), Some((100.0, 10.0)));
        assert_eq!(start.since(end), None);
    }
}
