//! A trend as text: the last values or months, the tests on them, and the units that stand out.

use diagnosis::process::{Process, Sign};
use fault_db::{TrendDay, TrendPoint, TrendStep, TrendUnit};

use crate::sparkline::sparkline_of;
use ptu_report::limits::short;
use ptu_report::trend::{TimeSeries, Trend};
use ptu_report::words::{Words, fill};
use ptu_runs::clock::{local, utc_month};
use ptu_runs::stored::from_stored;
use ptu_runs::table::Table;

/// Days of a month, to show slopes per month.
const MONTH_DAYS: f64 = 30.0;

/// Most bars in which the course of a measurement is shown.
const BARS: usize = 60;

/// Standard deviations from the fleet's median beyond which a unit is shown.
const STANDS_OUT: f64 = 3.0;

pub fn text(trend: &Trend, limit: usize) -> String {
    let counts = &Words::shown().counts;
    let unit = &trend.limits.unit;
    let mut text = match &trend.course {
        TimeSeries::Points(points) => points_table(points, unit, limit),
        TimeSeries::Days(days, _) => months_table(days, limit),
    };
    let Some(process) = &trend.process else {
        return format!("{text}\n{}", counts.nothing_measured);
    };
    text += &format!("\n\n{}", process_text(trend, process));
    if let TimeSeries::Days(_, units) = &trend.course {
        text += &outstanding(units, limit);
    }
    if trend.procedures.len() > 1 && trend.query.procedure.is_none() {
        let names = trend.procedures.join(", ");
        text += &format!("\n{}", fill(counts.by_several, &[("names", &names)]));
    } else if trend.limits_differ() {
        text += &format!("\n{}\n", counts.several_limits);
        text += &steps_table(&trend.steps, &trend.limits.unit);
    }
    text
}

fn steps_table(steps: &[TrendStep], unit: &str) -> String {
    let words = Words::shown();
    let common = &words.common;
    let mut table = Table::headed(&[common.procedure, common.step, common.low, common.high])
        .right([2, 3])
        .limits([2, 3]);
    let limit = |value: Option<f64>| {
        value.map_or_else(|| "-".into(), |value| format!("{} {unit}", short(value)))
    };
    for step in steps {
        table.row([
            step.procedure.clone(),
            words.content(&step.step).into_owned(),
            limit(step.low),
            limit(step.high),
        ]);
    }
    table.render()
}

fn points_table(points: &[TrendPoint], unit: &str, limit: usize) -> String {
    let last = &points[points.len().saturating_sub(limit)..];
    let words = Words::shown();
    let common = &words.common;
    let headings = [
        words.faults.at,
        common.value,
        common.low,
        common.high,
        common.verdict,
        common.run,
    ];
    let mut table = Table::headed(&headings)
        .right([1, 2, 3])
        .limits([2, 3])
        .verdicts(4);
    let number = |value: Option<f64>| value.map_or_else(|| "-".into(), short);
    for point in last {
        table.row([
            local(point.at_us),
            format!("{} {unit}", number(point.value)),
            number(point.low),
            number(point.high),
            words.verdict_name(from_stored(point.verdict)).to_owned(),
            point.run_id.short(),
        ]);
    }
    let values: Vec<_> = points.iter().map(|point| point.value).collect();
    let earlier = points.len() - last.len();
    let more = match earlier {
        0 => String::new(),
        n => fill(words.counts.earlier_values, &[("n", &n)]) + "\n",
    };
    format!("{more}{}\n\n{}", table.render(), bars(&values))
}

fn months_table(days: &[TrendDay], limit: usize) -> String {
    let month = |day: &TrendDay| utc_month(day.day_us);
    let months: Vec<_> = days.chunk_by(|a, b| month(a) == month(b)).collect();
    let last = &months[months.len().saturating_sub(limit)..];
    let words = Words::shown();
    let (terminal, counts) = (&words.terminal, &words.counts);
    let headings = [
        counts.month,
        terminal.values,
        terminal.mean,
        counts.least,
        counts.most,
        counts.not_passed,
    ];
    let mut table = Table::headed(&headings).right(1..6);
    for days in last {
        let n: u32 = days.iter().map(|day| day.n).sum();
        let least = days.iter().map(|day| day.least);
        let most = days.iter().map(|day| day.most);
        let not_passed: u32 = days.iter().map(|day| day.not_passed).sum();
        table.row([
            month(&days[0]),
            n.to_string(),
            short(mean(days)),
            short(least.fold(f64::INFINITY, f64::min)),
            short(most.fold(f64::NEG_INFINITY, f64::max)),
            not_passed.to_string(),
        ]);
    }
    let means: Vec<_> = days.iter().map(|day| Some(day.mean)).collect();
    format!("{}\n\n{}", table.render(), bars(&means))
}

fn mean(days: &[TrendDay]) -> f64 {
    let n: f64 = days.iter().map(|day| f64::from(day.n)).sum();
    let sums = days.iter().map(|day| f64::from(day.n) * day.mean);
    sums.sum::<f64>() / n
}

/// Bars for the values, at most `BARS`; a bar is the mean of its share of the values.
fn bars(values: &[Option<f64>]) -> String {
    let share = values.len().div_ceil(BARS).max(1);
    let mean = |values: &[Option<f64>]| {
        let known: Vec<f64> = values.iter().flatten().copied().collect();
        (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
    };
    sparkline_of(&values.chunks(share).map(mean).collect::<Vec<_>>())
}

fn process_text(trend: &Trend, process: &Process) -> String {
    let (limits, unit) = (&trend.limits, &trend.limits.unit);
    let day_name = trend.course.day_name();
    let value = |value: f64| format!("{} {unit}", short(value));
    let counts = &Words::shown().counts;
    let range = |wording, low: f64, high: f64| {
        fill(wording, &[("low", &short(low)), ("high", &value(high))])
    };
    let of = [("n", &process.n as _), ("mean", &value(process.mean) as _)];
    let sigma = process.sigma.map_or_else(String::new, |sigma| {
        fill(counts.sigma, &[("sigma", &value(sigma))])
    });
    let mut lines = vec![fill(counts.n_values, &of) + &sigma];
    if let Some((low, high)) = process.control {
        lines.push(range(counts.control, low, high));
    }
    let allowed = match (limits.low, limits.high) {
        (Some(low), Some(high)) => range(counts.allowed, low, high),
        (Some(low), None) => fill(counts.allowed_from, &[("low", &value(low))]),
        (None, Some(high)) => fill(counts.allowed_to, &[("high", &value(high))]),
        (None, None) if trend.limits_differ() => counts.limits_differ.to_owned(),
        (None, None) => counts.no_limits.to_owned(),
    };
    let fit = process.capability(limits.low, limits.high).map(|fit| {
        let cp = fit
            .cp
            .map_or_else(String::new, |cp| format!("  Cp {cp:.2}"));
        format!("{cp}  Cpk {:.2}", fit.cpk)
    });
    lines.push(allowed + &fit.unwrap_or_default());
    if let Some(line) = &process.line {
        let certain = match line.is_certain() {
            true => "",
            false => counts.no_drift,
        };
        lines.push(fill(
            counts.slope,
            &[
                ("slope", &signed(line.slope_per_day * MONTH_DAYS)),
                ("reach", &two_digits(line.slope_reach() * MONTH_DAYS)),
                ("unit", unit),
                ("certain", &certain),
            ],
        ));
    }
    if let Some(forecast) = process.forecast(limits.low, limits.high) {
        let latest = forecast
            .latest_us
            .map_or_else(|| counts.never.to_owned(), day_name);
        lines.push(fill(
            counts.reaches,
            &[
                ("limit", &value(forecast.limit)),
                ("day", &day_name(forecast.at_us)),
                ("from", &day_name(forecast.earliest_us)),
                ("until", &latest),
            ],
        ));
    }
    lines.extend(process.signs.iter().map(|found| sign(found, day_name)));
    lines.join("\n")
}

fn sign(sign: &Sign, day_name: fn(i64) -> String) -> String {
    let counts = &Words::shown().counts;
    let first = day_name(sign.first_at_us);
    let times = match sign.times {
        1 => counts.once.to_owned(),
        n => fill(counts.several, &[("n", &n), ("day", &first)]),
    };
    fill(
        counts.more_than_chance,
        &[
            ("what", &counts.sign(sign.kind)),
            ("times", &times),
            ("day", &day_name(sign.last_at_us)),
        ],
    )
}

/// Units that lie, or drift, otherwise than the fleet, the farthest first.
fn outstanding(units: &[TrendUnit], limit: usize) -> String {
    let words = Words::shown();
    let counts = &words.counts;
    let means = units.iter().map(|unit| unit.mean).collect();
    let Some(mean) = Spread::of(means) else {
        return String::new();
    };
    let slope = Spread::of(units.iter().filter_map(|unit| unit.slope_per_day).collect());
    let drift = |unit: &TrendUnit| match (&slope, unit.slope_per_day) {
        (Some(slope), Some(drift)) => slope.off(drift),
        _ => 0.0,
    };
    let off = |unit: &TrendUnit| mean.off(unit.mean).abs().max(drift(unit).abs());
    let mut far: Vec<_> = units
        .iter()
        .filter(|unit| off(unit) >= STANDS_OUT)
        .collect();
    far.sort_by(|a, b| off(b).total_cmp(&off(a)));
    if far.is_empty() {
        let said = fill(counts.none_stands_out, &[("n", &units.len())]);
        return format!("\n{said}");
    }
    let (unit, terminal) = (words.common.unit, &words.terminal);
    let headings = [
        unit,
        terminal.values,
        terminal.mean,
        counts.off,
        counts.in_30_days,
        counts.off,
    ];
    let mut table = Table::headed(&headings).right(1..6);
    for unit in far.iter().take(limit) {
        let slope = unit.slope_per_day.map(|slope| signed(slope * MONTH_DAYS));
        table.row([
            unit.unit_serial.clone(),
            unit.n.to_string(),
            short(unit.mean),
            format!("{:+.1}", mean.off(unit.mean)),
            slope.unwrap_or_else(|| "-".to_owned()),
            format!("{:+.1}", drift(unit)),
        ]);
    }
    let of = [("n", &far.len() as _), ("of", &units.len() as _)];
    let said = fill(counts.stand_out, &of);
    format!("\n\n{said}\n{}", table.render())
}

/// Median and scatter of units. The scatter is taken from the middle half, so that a few bad units do not widen it.
struct Spread {
    middle: f64,
    sigma: f64,
}

impl Spread {
    fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let quarter = values.len() / 4;
        let upper = values.get(values.len().checked_sub(1 + quarter)?)?;
        let width = upper - values.get(quarter)?;
        // The middle half of a normal distribution is 1.349 standard deviations wide.
        (values.len() >= 4 && width > 0.0).then(|| Self {
            middle: values[values.len() / 2],
            sigma: width / 1.349,
        })
    }

    /// Distance of a value from the median, in standard deviations.
    fn off(&self, value: f64) -> f64 {
        (value - self.middle) / self.sigma
    }
}

/// A number with two significant digits, however small; 12 decimals at most.
fn two_digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return short(value);
    }
    let decimals = (1 - value.abs().log10().floor() as i32).clamp(0, 12) as usize;
    format!("{value:.decimals$}")
}

fn signed(value: f64) -> String {
    match value {
        rise if rise > 0.0 => format!("+{}", two_digits(rise)),
        value => two_digits(value),
    }
}
