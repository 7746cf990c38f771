//! Monitoring of ATO's inputs and of ATO itself [S0 §1].
//!
//! * Implausible inputs end the run at once: nothing computed from them can be trusted, so the train brakes. A jump of the
//!   speed has to stay for a cycle, or to come again: beside the first pulses of a train that inches, one spurious
//!   pulse stands out for less than a cycle.
//! * A train that does not follow the effort is not driven any longer. The criterion is not the speed error,
//!   which is great in every departure, but the difference between the speed that the efforts of the last
//!   seconds should have produced and the measured speed.
//! * Effort that the train did not give is not ATO's fault: the effort that TCMS reports is compared with the
//!   effort it was sent. While TCMS brakes by itself or cuts powering nothing is judged. A deviation of which
//!   withheld effort explains at least half is reported as the train's, and ends the run only in braking.
//! * A run that ends away from the stop point is reported; a run that begins past it, to jog back, is no overrun.

use protocol::config::AtoConfig;
use protocol::line::Section;
use protocol::message::{AbsurdInputs, AtoState};
use protocol::{CYCLE, Speed};

use super::art;
use super::inputs::AtoInputs;
use super::reg::power_mps2;

/// Speed beyond any train's of these lines, m/s: 150 km/h [default].
const FASTEST_MPS: f64 = 150.0 / 3.6;
/// Greatest change of speed within a cycle, also of a sliding wheel, m/s [default].
const JUMP_MPS: f64 = 1.0;
/// Time after a jump within which a second one is no lone pulse, s [default]: good tachometers have one in minutes.
const JUMPS_AGAIN_S: f64 = 1.0;
/// Acceleration asked for at which the speed cannot stay the same, m/s² [default]: more than the
/// gradient of 35 ‰ and the resistance that a unit with a wrong track database may not know of.
const ASKED_MPS2: f64 = 0.6;
/// Change of speed in a cycle below which the speed counts as unchanged, m/s: what edge times in whole microseconds can
/// make of one speed.
const SAME_MPS: f64 = 5e-4;
/// Distance outside the section at which a position is absurd, m [default].
const OUTSIDE_M: f64 = 100.0;
/// Longest section, m [default].
const LONGEST_M: f64 = 50e3;
/// Distance past the stop point at which an overrun is reported although the train still moves, m [default].
const FAR_PAST_M: f64 = 10.0;
/// Time standing short of the stop point after which nothing more is expected, s [default].
const STANDS_S: f64 = 5.0;

/// Inputs of the monitor besides ATO's inputs.
#[derive(Clone, Copy, Debug)]
pub struct MonitorInputs {
    /// State until now.
    pub state: AtoState,
    /// Acceleration that the last effort asks for, less what track and resistance cost, m/s².
    pub asked_mps2: f64,
    /// Neither limit nor order nor brake keeps the train standing.
    pub may_go: bool,
    pub stands: bool,
    /// The train is as near to the stop point as ATO could bring it.
    pub arrived: bool,
}

/// Findings of one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Findings {
    /// Inputs no train can make.
    pub absurd: AbsurdInputs,
    /// Measured speed less the speed that the effort should have produced, m/s.
    pub not_following_mps: Option<f64>,
    /// Deviation of a train that, by its TCMS's own report, withholds effort, m/s; reported once until it is over.
    pub withheld_mps: Option<f64>,
    /// Distance past the stop point, m; reported once a run.
    pub overrun_m: Option<f64>,
    /// Distance short of the stop point, m; reported once a run.
    pub short_m: Option<f64>,
}

/// State of the monitoring from cycle to cycle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Monitor {
    before_mps: Option<f64>,
    /// Speed before it jumped in the last cycle, m/s.
    jumped_from_mps: Option<f64>,
    /// Time left in which a next jump counts as following soon, s.
    jumps_again_s: f64,
    expected_mps2: f64,
    deviation_mps: f64,
    /// Acceleration that the sent effort should have by now, m/s².
    sent_mps2: f64,
    /// Speed that the train lacks because it gave less effort than it was sent, m/s.
    withheld_mps: f64,
    withheld_reported: bool,
    frozen_s: f64,
    stands_s: f64,
    /// A stop error of this run is reported, or there was none.
    stop_reported: bool,
    /// The run began past the stop point; `None` = no run.
    begun_past: Option<bool>,
}

impl Monitor {
    pub fn step(
        &mut self,
        inputs: &AtoInputs<'_>,
        on: MonitorInputs,
        config: &AtoConfig,
    ) -> Findings {
        let mut absurd = absurd(inputs, config);
        let speed_mps = inputs.speed.mps();
        let before_mps = self.before_mps.replace(speed_mps);
        let (overrun_m, short_m) = self.stop_error(inputs, on, config);
        if !art::drives(on.state) {
            self.expected_mps2 = 0.0;
            self.deviation_mps = 0.0;
            self.sent_mps2 = 0.0;
            self.withheld_mps = 0.0;
            self.withheld_reported = false;
            self.frozen_s = 0.0;
            (self.jumped_from_mps, self.jumps_again_s) = (None, 0.0);
            return Findings {
                absurd,
                overrun_m,
                short_m,
                ..Findings::default()
            };
        }
        let before_mps = before_mps.unwrap_or(speed_mps);
        let change_mps = speed_mps - before_mps;
        let (doubted, jumped) = self.jumps(speed_mps, before_mps);
        absurd.set(AbsurdInputs::SPEED_JUMP, jumped);
        let frozen = self.frozen(change_mps, inputs, on.asked_mps2, config);
        absurd.set(AbsurdInputs::FROZEN_SPEED, frozen);
        let deviation_mps = (absurd.is_empty() && !doubted)
            .then(|| self.follow(change_mps, inputs, on.asked_mps2, config))
            .flatten();
        let (not_following_mps, withheld_mps) = self.whose(deviation_mps);
        Findings {
            absurd,
            not_following_mps,
            withheld_mps,
            overrun_m,
            short_m,
        }
    }

    /// Whether the speed has jumped in this cycle or the last, and whether no lone pulse explains it: the jump stays, or
    /// another follows soon.
    fn jumps(&mut self, speed_mps: f64, before_mps: f64) -> (bool, bool) {
        let far = |from_mps: f64| libm::fabs(speed_mps - from_mps) > JUMP_MPS;
        let soon = self.jumps_again_s > 0.0;
        self.jumps_again_s -= CYCLE.as_secs();
        if let Some(from_mps) = self.jumped_from_mps.take() {
            return (true, far(from_mps));
        }
        let jumps = far(before_mps);
        if jumps {
            self.jumped_from_mps = Some(before_mps);
            self.jumps_again_s = JUMPS_AGAIN_S;
        }
        (jumps, jumps && soon)
    }

    /// The measured speed stays exactly the same although effort is asked for.
    fn frozen(
        &mut self,
        change_mps: f64,
        inputs: &AtoInputs<'_>,
        asked_mps2: f64,
        config: &AtoConfig,
    ) -> bool {
        let stands_braked = inputs.standstill && asked_mps2 < 0.0;
        let asked = libm::fabs(asked_mps2) > ASKED_MPS2 && !cut(inputs) && !stands_braked;
        if !asked || libm::fabs(change_mps) > SAME_MPS {
            self.frozen_s = 0.0;
            return false;
        }
        self.frozen_s += CYCLE.as_secs();
        self.frozen_s >= f64::from(config.watch.following_ms) / 1000.0
    }

    /// Compares the change of speed with what the efforts should have made, both fading with the
    /// watch's time. While ATP or TCMS brakes ATO's efforts do not count.
    fn follow(
        &mut self,
        change_mps: f64,
        inputs: &AtoInputs<'_>,
        asked_mps2: f64,
        config: &AtoConfig,
    ) -> Option<f64> {
        let dt = CYCLE.as_secs();
        let lag_s = (config.train.dead_time_ms + config.train.lag_ms) / 1000.0;
        let share = (dt / lag_s.max(dt)).min(1.0);
        self.expected_mps2 += (asked_mps2 - self.expected_mps2) * share;
        let memory_s = f64::from(config.watch.following_ms.max(1)) / 1000.0;
        let fades = (dt / memory_s).min(1.0);
        self.deviation_mps -= self.deviation_mps * fades;
        self.withheld_mps -= self.withheld_mps * fades;
        let effort_mps2 = |effort: i16| mps2_from_effort(effort, inputs.speed, config);
        let train = inputs.train;
        self.sent_mps2 += (effort_mps2(train.sent) - self.sent_mps2) * share;
        let stands_braked = inputs.standstill && self.expected_mps2 < 0.0;
        if !cut(inputs) && !stands_braked {
            self.deviation_mps += change_mps - self.expected_mps2 * dt;
            let given_mps2 = train.given.map_or(self.sent_mps2, effort_mps2);
            self.withheld_mps += (self.sent_mps2 - given_mps2) * dt;
        }
        let most_mps = config.watch.following_kmh / 3.6;
        (libm::fabs(self.deviation_mps) > most_mps).then_some(self.deviation_mps)
    }

    /// Attributes a deviation to ATO, or to the train when withheld effort explains at least half of it.
    fn whose(&mut self, deviation_mps: Option<f64>) -> (Option<f64>, Option<f64>) {
        let Some(deviation_mps) = deviation_mps else {
            self.withheld_reported = false;
            return (None, None);
        };
        let left_mps = deviation_mps + self.withheld_mps;
        if libm::fabs(left_mps) > 0.5 * libm::fabs(deviation_mps) {
            return (Some(deviation_mps), None);
        }
        let first = !self.withheld_reported;
        self.withheld_reported = true;
        (None, first.then_some(deviation_mps))
    }

    /// Overrun and stop short, once a run.
    fn stop_error(
        &mut self,
        inputs: &AtoInputs<'_>,
        on: MonitorInputs,
        config: &AtoConfig,
    ) -> (Option<f64>, Option<f64>) {
        let running = inputs.section.filter(|_| on.state == AtoState::Run);
        let Some(section) = running else {
            (self.stands_s, self.stop_reported, self.begun_past) = (0.0, false, None);
            return (None, None);
        };
        self.stands_s = if on.stands && on.may_go {
            self.stands_s + CYCLE.as_secs()
        } else {
            0.0
        };
        let to_stop_m = section.stop_m - inputs.position_m;
        let past_m = -to_stop_m;
        let ended = on.stands && on.arrived || self.stands_s > STANDS_S;
        let past = past_m > config.watch.overrun_m;
        let begun_past = *self.begun_past.get_or_insert(past);
        let overrun = past && !begun_past && (on.stands || past_m > FAR_PAST_M);
        let short = to_stop_m > inputs.aligned_m && ended;
        let first = !self.stop_reported;
        self.stop_reported |= ended || overrun;
        (
            (first && overrun).then_some(past_m),
            (first && short).then_some(to_stop_m),
        )
    }
}

/// Whether the train does something else than ATO asks: powering is cut, or TCMS brakes by itself.
fn cut(inputs: &AtoInputs<'_>) -> bool {
    inputs.power_cut || inputs.train.overrides
}

/// Acceleration an effort stands for at a speed, m/s².
fn mps2_from_effort(effort: i16, speed: Speed, config: &AtoConfig) -> f64 {
    let effort = f64::from(effort);
    if effort < 0.0 {
        effort / 1024.0 * config.train.brake_kmh_per_s / 3.6
    } else {
        effort / 1023.0 * power_mps2(&config.train, speed.mps())
    }
}

/// Inputs that are impossible, each judged by itself.
fn absurd(inputs: &AtoInputs<'_>, config: &AtoConfig) -> AbsurdInputs {
    let speed = |mps: f64| (0.0..=FASTEST_MPS).contains(&mps);
    let order = |order: Speed| order.mps().is_finite() && order >= Speed::ZERO;
    let limits = speed(inputs.limit.mps()) && inputs.fixed_speed.is_none_or(order);
    let load = (0.0..=config.train.empty_kg).contains(&inputs.load_kg);
    let section = inputs.section.is_some_and(sound);
    let position = inputs.section.is_none_or(|s| {
        let place = s.start_m - OUTSIDE_M..=s.stop_m + OUTSIDE_M;
        place.contains(&inputs.position_m) && (0.0..=s.length_m).contains(&inputs.ahead_m)
    });
    let mut absurd = AbsurdInputs::empty();
    absurd.set(AbsurdInputs::SPEED, !speed(inputs.speed.mps()));
    absurd.set(AbsurdInputs::LIMIT, !limits);
    absurd.set(AbsurdInputs::LOAD, !load);
    absurd.set(AbsurdInputs::SECTION, !section);
    absurd.set(AbsurdInputs::POSITION, !position);
    absurd
}

/// A section whose numbers can be those of a track.
fn sound(section: &Section) -> bool {
    let places = [section.start_m, section.stop_m, section.length_m];
    let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
    let gradients = &section.gradients;
    let curves = &section.curves;
    finite(&places)
        && finite(&section.markers_m)
        && section.start_m < section.stop_m
        && section.length_m <= LONGEST_M
        && section.stop_m - section.start_m <= section.length_m + OUTSIDE_M
        && gradients
            .iter()
            .all(|g| finite(&[g.at_m]) && libm::fabs(g.permille) <= 100.0)
        && curves
            .iter()
            .all(|c| finite(&[c.at_m]) && (0.0..=1e6).contains(&c.radius_m))
}

#[cfg(test)]
mod tests;
