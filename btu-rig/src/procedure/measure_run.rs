//! One measurement while its step runs: watches each scan and yields the value when the step ends.
//!
//! Without a bench harness a time is measured by the unit's own stamps, as the time between two moments of which each
//! is known within bounds: the value is the middle between the shortest and the longest time that these bounds
//! permit, its uncertainty half of their difference.

use protocol::Instant;
use protocol::message::SelfTestItem;
use protocol::signal::Signal;

use super::UnitTime;
use super::Verdict;
use super::condition::{Answer, Captured, MissingData};
use super::finding::{Finding, LimitMissed, WhyNoValue};
use super::limit::{judge, resolve};
use super::plan::{Condition, Measure, TimeFrom, What};
use super::report::Measurement;
use super::scan::Scan;
use super::unit_clock::Moment;

/// Watches for a condition to *become* true: the condition must have been seen false first. A brake that is
/// applied before its reaction time is measured has no reaction time, and must not get one of 0 ms.
#[derive(Clone, Copy, Debug, Default)]
struct Edge {
    was_false: bool,
}

impl Edge {
    fn look(
        &mut self,
        condition: &Condition,
        scan: Scan<'_>,
        missing_data: &mut Option<MissingData>,
    ) -> bool {
        match condition.truth(scan.sample, scan.captured) {
            Answer::Yes => self.was_false,
            Answer::No => {
                self.was_false = true;
                false
            }
            Answer::NoData(missing) => {
                *missing_data = Some(missing);
                false
            }
        }
    }
}

/// When a measured time began, by the bench's clock and by the unit's.
#[derive(Clone, Copy, Debug)]
struct Start {
    at: Instant,
    by_unit: Option<Moment>,
}

#[derive(Clone, Debug, Default)]
pub(super) struct MeasurementRun {
    from: Edge,
    to: Edge,
    /// When the time measured began.
    start: Option<Start>,
    /// First and latest value of the signal whose change is measured, and what its counter lost by starting again at 0.
    first: Option<f64>,
    latest: Option<f64>,
    wrapped: f64,
    value: Option<f64>,
    uncertainty: Option<f64>,
    item: Option<SelfTestItem>,
    /// The unit does not make this test.
    left_out: bool,
    missing_data: Option<MissingData>,
    done: bool,
    /// The step need not wait for this measurement any longer.
    late: bool,
}

impl MeasurementRun {
    /// Looks at one scan; `actions_end` as in [`super::expectation_run::ExpectationRun::look`], `request_last`: the
    /// last of the actions ended with the unit's answer to a request.
    pub(super) fn look(
        &mut self,
        measure: &Measure,
        scan: Scan<'_>,
        step_start: Instant,
        (actions_end, request_last): (Option<Instant>, bool),
    ) {
        if self.done {
            return;
        }
        match &measure.what {
            What::Time { from, to } => {
                self.time((from, to), scan, step_start, (actions_end, request_last));
            }
            What::At { signal, when } => {
                if self.to.look(when, scan, &mut self.missing_data) {
                    self.done = true;
                    self.missing_data = None;
                    self.value = self.known(*signal, scan);
                }
            }
            What::Maximum(signal) => self.extreme(*signal, scan, f64::max),
            What::Minimum(signal) => self.extreme(*signal, scan, f64::min),
            What::Change(signal) => {
                let value = self.follow(*signal, scan);
                let start = Start {
                    at: step_start,
                    by_unit: None,
                };
                if self.start.replace(start).is_none() {
                    self.first = value;
                }
            }
            What::Value(_) | What::SelfTest { .. } => {}
        }
        self.late = actions_end.is_some_and(|end| scan.now.since(end) >= measure.within);
    }

    /// Whether the step must go on for this measurement.
    pub(super) fn is_open(&self, measure: &Measure) -> bool {
        measure.is_awaited() && !self.done && !self.late
    }

    /// Takes the self-test's result for the item, with the item's limits and their unit.
    pub(super) fn take_item(&mut self, item: Option<SelfTestItem>) {
        self.item = item;
    }

    /// The unit does not make this test: there is nothing to judge.
    pub(super) fn leave_out(&mut self) {
        self.left_out = true;
    }

    /// Ends the measurement with the step's last scan and judges it; a step that was broken off has no value.
    pub(super) fn finish(
        mut self,
        measure: &Measure,
        scan: Scan<'_>,
        broken_off: bool,
    ) -> (Measurement, Option<Finding>) {
        let without_value = || measured(measure, None, None, scan.captured);
        let measurement = if broken_off {
            without_value()
        } else if self.left_out {
            Measurement {
                verdict: Verdict::Skipped,
                ..without_value()
            }
        } else if let Some(item) = self.item {
            of_item(measure, &item)
        } else {
            self.take_last(measure, scan);
            measured(measure, self.value, self.uncertainty, scan.captured)
        };
        let found = self.found(measure, &measurement);
        (measurement, found)
    }

    /// Takes the value of a measurement that ends with the step's last scan.
    fn take_last(&mut self, measure: &Measure, scan: Scan<'_>) {
        match measure.what {
            What::Value(signal) => self.value = self.known(signal, scan),
            What::Change(signal) => {
                let last = self.follow(signal, scan);
                let change = |(first, last)| last - first + self.wrapped;
                self.value = self.first.zip(last).map(change);
            }
            // A gap in the data may have hidden the greatest or least value.
            What::Maximum(_) | What::Minimum(_) if self.missing_data.is_some() => self.value = None,
            _ => {}
        }
    }

    fn time(
        &mut self,
        (from, to): (&TimeFrom, &Condition),
        scan: Scan<'_>,
        step_start: Instant,
        (actions_end, request_last): (Option<Instant>, bool),
    ) {
        if self.start.is_none() {
            let by_unit = |moment: fn(&UnitTime) -> Moment| scan.unit_time.as_ref().map(moment);
            let start = |at| Start {
                at,
                by_unit: by_unit(Moment::before_the_next),
            };
            self.start = match from {
                TimeFrom::StepStart => Some(start(step_start)),
                TimeFrom::ActionsEnd if request_last => actions_end.map(|at| Start {
                    at,
                    by_unit: by_unit(Moment::of_answer),
                }),
                TimeFrom::ActionsEnd => actions_end.map(start),
                TimeFrom::Condition(condition) => {
                    let begins = self.from.look(condition, scan, &mut self.missing_data);
                    begins.then(|| Start {
                        at: scan.now,
                        by_unit: scan.unit_time.map(|time| Moment::of_edge(&time, condition)),
                    })
                }
            };
        } else if let (Some(start), Some(time)) = (&mut self.start, &scan.unit_time) {
            start.by_unit = start.by_unit.map(|moment| moment.ended_by(time));
        }
        let reached = self.to.look(to, scan, &mut self.missing_data);
        // An end before the beginning is passed over; the next one counts.
        match self.start {
            Some(start) if reached => {
                self.done = true;
                self.take_time(start, to, scan);
            }
            None if reached => self.to = Edge::default(),
            _ => {}
        }
    }

    fn take_time(&mut self, start: Start, to: &Condition, scan: Scan<'_>) {
        match (start.by_unit, scan.unit_time) {
            (Some(start), Some(time)) => {
                let between = Moment::of_edge(&time, to).since(start);
                self.value = between.map(|(value_ms, _)| value_ms);
                self.uncertainty = between.map(|(_, uncertainty_ms)| uncertainty_ms);
            }
            // Without a state frame at the beginning nothing dates the beginning by the unit's clock.
            (None, Some(_)) => {}
            (_, None) => self.value = Some(scan.now.since(start.at).as_us() as f64 / 1000.0),
        }
    }

    fn extreme(&mut self, signal: Signal, scan: Scan<'_>, choose: fn(f64, f64) -> f64) {
        if let Some(value) = self.known(signal, scan) {
            self.value = Some(self.value.map_or(value, |best| choose(best, value)));
        }
    }

    /// The value of a signal whose change is taken: a counter is followed from scan to scan, as the counter may wrap
    /// to 0 more than once.
    fn follow(&mut self, signal: Signal, scan: Scan<'_>) -> Option<f64> {
        let value = self.known(signal, scan)?;
        let before = self.latest.replace(value);
        if before.is_some_and(|before| value < before) {
            self.wrapped += signal.wraps_at().unwrap_or(0.0);
        }
        Some(value)
    }

    fn known(&mut self, signal: Signal, scan: Scan<'_>) -> Option<f64> {
        let value = scan.sample.get(signal).filter(|v| v.is_finite());
        if value.is_none() {
            self.missing_data = Some(MissingData::Signal(signal));
        }
        value
    }

    /// Reason for which the measurement did not pass; none if it did.
    fn found(&self, measure: &Measure, measured: &Measurement) -> Option<Finding> {
        let measurement = measure.name.clone();
        Some(match (measured.verdict, measured.value) {
            (Verdict::Passed | Verdict::Skipped, _) => return None,
            (Verdict::Failed, Some(value)) => Finding::LimitMissed(LimitMissed {
                measurement,
                value,
                uncertainty: measured.uncertainty,
                low: measured.low,
                high: measured.high,
                unit: measured.unit.to_owned(),
            }),
            (_, Some(_)) => Finding::LimitUnknown { measurement },
            (_, None) => Finding::NoValue {
                measurement,
                others: 0,
                why: match (self.missing_data, &measure.what) {
                    (Some(missing), _) => WhyNoValue::Missing(missing),
                    (None, What::Time { to: end, .. } | What::At { when: end, .. }) => {
                        WhyNoValue::NeverEnded(end.clone())
                    }
                    (None, _) => WhyNoValue::NotMeasured,
                },
            },
        })
    }
}

/// An item of the self-test, judged by the unit and by its limits.
fn of_item(measure: &Measure, item: &SelfTestItem) -> Measurement {
    let [value, low, high] = [item.value, item.low, item.high].map(f64::from);
    let verdict = match judge(Some(value), None, Ok(Some(low)), Ok(Some(high))) {
        Verdict::Passed if item.passed != 1 => Verdict::Failed,
        verdict => verdict,
    };
    Measurement {
        name: measure.name.clone(),
        value: Some(value),
        unit: item.unit.label(),
        low: Some(low),
        high: Some(high),
        uncertainty: None,
        limit_source: measure.origin.text(),
        verdict,
    }
}

/// A measurement with its limits as they stand now.
fn measured(
    measure: &Measure,
    value: Option<f64>,
    uncertainty: Option<f64>,
    captured: &Captured,
) -> Measurement {
    let low = resolve(measure.low.as_ref(), captured);
    let high = resolve(measure.high.as_ref(), captured);
    Measurement {
        name: measure.name.clone(),
        value,
        unit: measure.unit(),
        low: low.ok().flatten(),
        high: high.ok().flatten(),
        uncertainty: uncertainty.filter(|_| value.is_some()),
        limit_source: measure.origin.text(),
        verdict: judge(value, uncertainty, low, high),
    }
}
