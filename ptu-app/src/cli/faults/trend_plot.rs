//! A measurement over time, drawn on a page: values, limits, control limits, and the line of drift.

use crate::cli::made_by;
use ptu_report::plot::{Plot, Series, Style};
use ptu_report::plot_page::PlotPage;
use ptu_report::run::html;
use ptu_report::trend::{TimeSeries, Trend};
use ptu_report::words::Language;

/// Microseconds of a day.
const DAY_US: f64 = 86.4e9;

pub fn page(trend: &Trend) -> String {
    let page = PlotPage {
        plot: plot(trend),
        made: made_by(),
    };
    html(&page, Language::English.words())
}

fn title(trend: &Trend) -> String {
    let of = match &trend.query.unit {
        Some(unit) => format!("of unit {unit}"),
        None => "of all units, by day".to_owned(),
    };
    format!("{} {of}", trend.query.measurement)
}

/// Plot of the values over days until the last value.
fn plot(trend: &Trend) -> Plot {
    let samples = trend.course.samples();
    let last_us = samples.last().map_or(0, |sample| sample.at_us);
    let day = |at_us: i64| (at_us - last_us) as f64 / DAY_US;
    let (from, to) = (samples.first().map_or(0.0, |sample| day(sample.at_us)), 0.0);
    let level = |name: &str, colour, value: f64| Series {
        name: name.to_owned(),
        colour,
        style: Style::Dashed,
        points: vec![(from, value), (to, value)],
    };
    let mut series = vec![Series {
        name: match trend.course {
            TimeSeries::Points(_) => "value".to_owned(),
            TimeSeries::Days(..) => "mean of the day".to_owned(),
        },
        colour: 0,
        style: Style::Dots,
        points: samples
            .iter()
            .map(|sample| (day(sample.at_us), sample.value))
            .collect(),
    }];
    series.extend(trend.limits.low.map(|low| level("low", 3, low)));
    series.extend(trend.limits.high.map(|high| level("high", 3, high)));
    if let Some(process) = &trend.process {
        if let Some((low, high)) = process.control {
            series.push(level("control limit", 1, low));
            series.push(level("", 1, high));
        }
        if let Some(line) = &process.line {
            series.push(Series {
                name: "drift".to_owned(),
                colour: 2,
                style: Style::Line,
                points: vec![(from, line.now + from * line.slope_per_day), (to, line.now)],
            });
        }
    }
    Plot {
        title: title(trend),
        x_label: format!("days until {}", trend.course.day_name()(last_us)),
        y_label: format!("{} ({})", trend.query.measurement, trend.limits.unit),
        series,
        ..Plot::default()
    }
}
