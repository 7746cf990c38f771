use super::line::student;
use super::*;

const DAY: i64 = 86_400_000_000;

fn single(values: &[f64]) -> Vec<Sample> {
    let sample = |(day, value): (usize, &f64)| Sample {
        at_us: day as i64 * DAY,
        value: *value,
        n: 1,
        scatter: 0.0,
    };
    values.iter().enumerate().map(sample).collect()
}

/// Montgomery's paint viscosity batches (Statistical Quality Control, example 6.5): mean 33.52,
/// mean moving range 0.48, limits 32.24 and 34.80.
#[test]
fn control_limits_are_those_of_an_individuals_chart() {
    let values = [
        33.75, 33.05, 34.00, 33.81, 33.46, 34.02, 33.68, 33.27, 33.49, 33.20, 33.62, 33.00, 33.54,
        33.12, 33.84,
    ];
    let process = Process::of(&single(&values)).expect("values");
    let (low, high) = process.control.expect("limits");
    assert!((process.mean - 33.52).abs() < 0.01, "{}", process.mean);
    assert!(
        (low - 32.24).abs() < 0.01 && (high - 34.80).abs() < 0.01,
        "{low} {high}"
    );
    assert!(process.signs.is_empty());
}

/// 0.42 s rising 1 ms a day: 0.58 s after 160 days, whatever the noise.
#[test]
fn a_drifting_value_is_forecast_to_cross_its_limit() {
    let noise = [0.004, -0.003, 0.001, -0.005, 0.003, 0.0, 0.002, -0.002];
    let values: Vec<f64> = (0..60)
        .map(|day| 0.42 + 0.001 * f64::from(day) + noise[day as usize % noise.len()])
        .collect();
    let process = Process::of(&single(&values)).expect("values");
    let forecast = process.forecast(None, Some(0.58)).expect("it will");
    let days = |at_us: i64| at_us as f64 / DAY as f64;
    assert!(
        (days(forecast.at_us) - 160.0).abs() < 4.0,
        "{}",
        days(forecast.at_us)
    );
    assert!(forecast.earliest_us < forecast.at_us);
    assert!(forecast.latest_us.expect("soon") > forecast.at_us);
    assert!(
        process.forecast(Some(0.2), None).is_none(),
        "it moves away from it"
    );
    assert!(
        process
            .signs
            .iter()
            .any(|sign| sign.kind == "nine_on_one_side")
    );
}

#[test]
fn noise_without_drift_gives_no_forecast() {
    let values: Vec<f64> = (0..50)
        .map(|n| 0.42 + 0.01 * f64::from(n * 7 % 11 - 5))
        .collect();
    let process = Process::of(&single(&values)).expect("values");
    assert_eq!(process.forecast(Some(0.0), Some(0.58)), None);
    let fit = process.capability(Some(0.2), Some(0.58)).expect("limits");
    assert!(fit.cp.expect("two limits") > fit.cpk);
    assert!(process.capability(None, None).is_none());
}

#[test]
fn daily_groups_give_the_statistics_of_their_values() {
    let single = Process::of(&single(&[1.0, 3.0, 1.0, 3.0])).expect("values");
    let day = |day: i64| Sample {
        at_us: day * DAY,
        value: 2.0,
        n: 2,
        scatter: 2.0,
    };
    let daily = Process::of(&[day(0), day(1)]).expect("values");
    assert_eq!((single.mean, single.n), (daily.mean, daily.n));
    assert_eq!(single.sigma_overall, daily.sigma_overall);
    assert_eq!(Process::of(&[]), None);
    assert_eq!(Process::of(&[day(0)]).and_then(|one| one.line), None);
}

#[test]
fn equal_values_are_a_process_without_scatter() {
    let process = Process::of(&single(&[2.0; 12])).expect("values");
    assert_eq!(process.capability(Some(1.0), Some(3.0)), None);
    assert_eq!(process.forecast(Some(1.0), Some(3.0)), None);
    assert!(process.signs.is_empty(), "{:?}", process.signs);
}

/// Goal: `student` gives the quantiles in the table of Abramowitz and Stegun, and with very many values the normal one.
#[test]
fn the_fewer_values_the_more_standard_errors_are_likely() {
    for (free, expected) in [
        (1, 12.706),
        (2, 4.303),
        (3, 3.182),
        (4, 2.776),
        (5, 2.571),
        (6, 2.447),
        (10, 2.228),
        (30, 2.042),
        (120, 1.980),
        (100_000_000, 1.960),
    ] {
        let found = student(free);
        assert!((found - expected).abs() <= 0.001, "{free}: {found}");
    }
}

/// Goal: three values that rise about evenly give no forecast: with one degree of freedom their slope is
/// not significant. With as many again it is.
/// Method: a slope of three and a half standard errors, more than 1.96 and less than 12.7.
#[test]
fn three_values_are_too_few_to_be_certain() {
    let three = Process::of(&single(&[1.0, 2.5, 3.0])).expect("values");
    let line = three.line.expect("a line");
    let errors = line.slope_per_day / line.slope_error;
    assert!((3.0..12.0).contains(&errors), "{errors}");
    assert!(!line.is_certain());
    assert!((line.slope_reach() - 12.706 * line.slope_error).abs() < 1e-9);
    assert_eq!(three.forecast(None, Some(5.0)), None);
    let six = Process::of(&single(&[1.0, 2.5, 3.0, 4.0, 5.5, 6.0])).expect("values");
    assert!(six.line.expect("a line").is_certain());
    assert!(six.forecast(None, Some(8.0)).is_some());
}

/// Goal: each mean is judged by the limits for means of as many values.
/// Method: sigma is 1. Among days of many values a single value may lie 2.5 from the mean. Among days of few values a
/// mean of 99 values may not lie 0.4 from the mean of all, which it has moved by 0.1. Limits for the average number of
/// values a day would say the reverse of both.
#[test]
fn each_day_is_judged_by_the_limits_of_as_many_values() {
    let day = |day: i64, n: u32, value: f64| Sample {
        at_us: day * DAY,
        value,
        n,
        scatter: f64::from(n - 1),
    };
    let beyond = |samples: &[Sample]| -> Vec<i64> {
        let signs = Process::of(samples).expect("values").signs;
        let beyond = signs.iter().filter(|sign| sign.kind == "beyond_control");
        beyond.map(|sign| sign.first_at_us / DAY).collect()
    };
    let one_among_many = [day(0, 99, 0.0), day(1, 1, 2.5), day(2, 99, 0.0)];
    assert_eq!(beyond(&one_among_many), [0; 0]);
    let mut many_among_few: Vec<_> = (0..200).map(|n| day(n, 2, 0.0)).collect();
    many_among_few.push(day(200, 99, 0.5));
    assert_eq!(beyond(&many_among_few), [200]);
}
