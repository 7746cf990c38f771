//! The wayside of a ride from platform to platform, and the driver who presses the start button.

use btu_rig::stimulus::{StationData, Stimulus};
use protocol::message::ModeSwitch;
use protocol::{Duration, Instant};

use super::play::Player;

/// Longest time at a platform, and time from new station data to departure and to the start button.
const DWELL: Duration = Duration::from_ms(14_000);
const DEPARTS: Duration = Duration::from_ms(3_000);
const STARTS: Duration = Duration::from_ms(4_500);

/// Next act of the wayside in a ride.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Ride {
    At(Instant),
    Given(Instant),
    Pressed,
    UnderWay,
    Arrived(Instant),
    Over,
}

impl Player<'_> {
    /// The wayside of a ride, and a driver who presses the start button.
    pub(super) fn go_on(&mut self, now: Instant) {
        let truth = self.bench.rig.truth();
        let stands = truth.speed_mps.abs() < 0.05;
        let line = &self.setup.line.content;
        self.ride = match self.ride {
            Ride::At(at) if now.since(at) > DEPARTS => {
                let departure = StationData {
                    departure: true,
                    ..self.told
                };
                self.apply(Stimulus::Station(departure));
                Ride::Given(at)
            }
            Ride::Given(at) if now.since(at) > STARTS => {
                if self.plan.scene.switch() == ModeSwitch::Automatic {
                    self.apply(Stimulus::Start);
                }
                Ride::Pressed
            }
            Ride::Given(_) | Ride::Pressed if truth.speed_mps > 1.4 => {
                let next = line.station_after(self.section);
                self.apply(Stimulus::Station(StationData::at_arrival(
                    self.section,
                    next,
                )));
                Ride::UnderWay
            }
            Ride::UnderWay if stands && truth.to_stop_m.is_some_and(|m| m.abs() < 25.0) => {
                Ride::Arrived(now)
            }
            Ride::Arrived(at) if now.since(at) > DWELL => match line.after(self.section) {
                None => Ride::Over,
                Some(next) => {
                    self.section = next;
                    self.lay();
                    let data_of = self.plan.data_of.and_then(|at| line.sections.get(at));
                    let data = StationData::at_departure(data_of.unwrap_or(next));
                    self.apply(Stimulus::Station(data));
                    Ride::At(now)
                }
            },
            ride => ride,
        };
    }
}
