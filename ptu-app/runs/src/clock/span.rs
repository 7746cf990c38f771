//! Time spans as users write them: `30d`, `2026-03`, `2026-03..2026-05`, `2026-03-21..`.
//!
//! Dates are those of the local calendar. A year, month or day means all of it, at the end of a span, too.

use std::str::FromStr;

use chrono::{DateTime, Datelike, Days, Local, Months, NaiveDate, NaiveTime, TimeZone};

use super::now_us;

/// Microseconds of an hour.
const HOUR_US: i64 = 3_600_000_000;

/// From and until, microseconds since 1970, without the end itself. None = open.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Span {
    pub since_us: Option<i64>,
    pub until_us: Option<i64>,
}

impl FromStr for Span {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (from, to) = match text.split_once("..") {
            None => return stretch(text),
            Some(("", "")) => {
                return Err("a span has a beginning or an end, such as 2026-03..".into());
            }
            Some(ends) => ends,
        };
        let end = |text: &str| (!text.is_empty()).then(|| stretch(text)).transpose();
        let (from, to) = (end(from)?, end(to)?);
        let span = Self {
            since_us: from.and_then(|from| from.since_us),
            // `..30d` ends thirty days ago.
            until_us: to.and_then(|to| to.until_us.or(to.since_us)),
        };
        match (span.since_us, span.until_us) {
            (Some(since), Some(until)) if since >= until => {
                Err(format!("\"{text}\" ends before it begins"))
            }
            _ => Ok(span),
        }
    }
}

/// The whole local months a span touches, oldest first, each with its name; the first and the last cut
/// to the span. None of a span that ends before it begins.
pub fn months(since_us: i64, until_us: i64) -> Vec<(String, i64, i64)> {
    let local = |at_us: i64| {
        let at = DateTime::from_timestamp_micros(at_us).unwrap_or_default();
        at.with_timezone(&Local).date_naive()
    };
    let mut months = Vec::new();
    if since_us >= until_us {
        return months;
    }
    let mut first = local(since_us).with_day(1).unwrap_or_default();
    while let (Some(begin), Some(next)) =
        (midnight_us(first), first.checked_add_months(Months::new(1)))
    {
        if begin >= until_us {
            break;
        }
        let end = midnight_us(next).unwrap_or(until_us);
        let name = first.format("%Y-%m").to_string();
        months.push((name, begin.max(since_us), end.min(until_us)));
        first = next;
    }
    months
}

/// The stretch of time that a word, a date or a number of days means, with its beginning; without an end it lasts until now.
fn stretch(text: &str) -> Result<Span, String> {
    let ago = [("h", 1), ("d", 24), ("w", 7 * 24)]
        .into_iter()
        .find_map(|(unit, hours)| {
            let number: i64 = text.strip_suffix(unit)?.parse().ok()?;
            (number >= 0).then(|| number.checked_mul(hours * HOUR_US))
        });
    if let Some(ago_us) = ago {
        let since_us = ago_us.and_then(|ago_us| now_us().checked_sub(ago_us));
        let since_us = since_us.ok_or_else(|| format!("\"{text}\" is too long ago"))?;
        return Ok(Span {
            since_us: Some(since_us),
            until_us: None,
        });
    }
    let today = Local::now().date_naive();
    let dates = match text {
        "today" => Some((today, today.checked_add_days(Days::new(1)))),
        "yesterday" => today
            .checked_sub_days(Days::new(1))
            .map(|day| (day, Some(today))),
        _ => calendar(text),
    };
    let bounds = dates.and_then(|(first, next)| Some((midnight_us(first)?, midnight_us(next?)?)));
    let (since_us, until_us) = bounds.ok_or_else(|| {
        format!(
            "\"{text}\" is no time; write 30d, 12h, today, 2026, 2026-03, 2026-03-21, or a span such as 2026-03..2026-05"
        )
    })?;
    Ok(Span {
        since_us: Some(since_us),
        until_us: Some(until_us),
    })
}

/// The first day of a year, month or day, and the first after it.
fn calendar(text: &str) -> Option<(NaiveDate, Option<NaiveDate>)> {
    let numbers: Vec<u32> = text
        .split('-')
        .map(|part| part.parse().ok())
        .collect::<Option<_>>()?;
    let digits: Vec<usize> = text.split('-').map(str::len).collect();
    if !matches!(digits[..], [4] | [4, 2] | [4, 2, 2]) {
        return None;
    }
    let date = |month, day| NaiveDate::from_ymd_opt(numbers[0] as i32, month, day);
    Some(match numbers[1..] {
        [month, day] => (
            date(month, day)?,
            date(month, day)?.checked_add_days(Days::new(1)),
        ),
        [month] => (
            date(month, 1)?,
            date(month, 1)?.checked_add_months(Months::new(1)),
        ),
        _ => (date(1, 1)?, date(1, 1)?.checked_add_months(Months::new(12))),
    })
}

/// When a local day begins; where clocks are put forward at midnight, an hour later.
fn midnight_us(date: NaiveDate) -> Option<i64> {
    let midnight = date.and_time(NaiveTime::MIN);
    let begin = (0..3).find_map(|hours| {
        let later = midnight + chrono::TimeDelta::hours(hours);
        Local.from_local_datetime(&later).earliest()
    });
    begin.map(|begin| begin.timestamp_micros())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(text: &str) -> Span {
        text.parse().expect(text)
    }

    fn day_us(year: i32, month: u32, day: u32) -> Option<i64> {
        midnight_us(NaiveDate::from_ymd_opt(year, month, day).expect("a day"))
    }

    #[test]
    fn a_month_at_the_end_of_a_span_counts_whole() {
        let spring = span("2026-03..2026-05");
        assert_eq!(
            (spring.since_us, spring.until_us),
            (day_us(2026, 3, 1), day_us(2026, 6, 1))
        );
        let year = span("2024");
        assert_eq!(
            (year.since_us, year.until_us),
            (day_us(2024, 1, 1), day_us(2025, 1, 1))
        );
        let day = span("2024-02-29");
        assert_eq!(
            (day.since_us, day.until_us),
            (day_us(2024, 2, 29), day_us(2024, 3, 1))
        );
        assert_eq!(span("..2024").since_us, None);
        assert_eq!(span("2024-02-29..").until_us, None);
    }

    #[test]
    fn a_time_ago_lasts_until_now() {
        let month = span("30d");
        let ago = now_us() - month.since_us.expect("a beginning");
        assert!((ago - 30 * 24 * HOUR_US).abs() < HOUR_US, "{ago}");
        assert_eq!(month.until_us, None);
        assert!(span("60d..30d").until_us.expect("an end") < now_us());
        // The day may change between the two.
        let is_day_before = || span("yesterday").until_us == span("today").since_us;
        assert!(is_day_before() || is_day_before());
    }

    #[test]
    fn text_that_is_no_span_is_quoted_in_the_error() {
        for (text, why) in [
            ("2026-13", "is no time"),
            ("2026-3", "is no time"),
            ("last week", "is no time"),
            ("", "is no time"),
            ("-3d", "is no time"),
            ("..", "a beginning or an end"),
            ("2026-05..2026-03", "ends before it begins"),
            ("99999999999999d", "too long ago"),
            ("2026-03...2026-05", "is no time"),
        ] {
            let error = text.parse::<Span>().expect_err(text);
            assert!(error.contains(why), "{text}: {error}");
        }
    }

    #[test]
    fn months_cover_a_span_without_a_gap() {
        let (since, until) = (
            day_us(2025, 11, 15).expect("a day"),
            day_us(2026, 2, 2).expect("a day"),
        );
        let months = months(since, until);
        let names: Vec<_> = months.iter().map(|month| month.0.as_str()).collect();
        assert_eq!(names, ["2025-11", "2025-12", "2026-01", "2026-02"]);
        assert_eq!((months[0].1, months[3].2), (since, until));
        assert!(months.windows(2).all(|two| two[0].2 == two[1].1));
        assert!(super::months(since, since).is_empty());
        assert!(super::months(until, since).is_empty());
    }
}
