//! SQL functions that the schema's triggers and queries call and SQLite does not have.

use chrono::{DateTime, Datelike as _, NaiveDate, NaiveTime};
use rusqlite::Connection;
use rusqlite::functions::{Context, FunctionFlags};
use rusqlite::types::FromSqlError;

use crate::schema::derived_columns::{self, part_of, said};
use crate::schema::full_text::{Search, words};
use crate::schema::packed::PackRows;
use crate::schema::statistics;

/// Microseconds of a day.
pub(crate) const DAY_US: i64 = 86_400_000_000;

/// Registers the functions on a connection.
pub(crate) fn register(conn: &Connection) -> rusqlite::Result<()> {
    let flags = FunctionFlags::SQLITE_UTF8
        | FunctionFlags::SQLITE_DETERMINISTIC
        | FunctionFlags::SQLITE_INNOCUOUS;
    conn.create_scalar_function("utc_day", 1, flags, |context| at(context, utc_day))?;
    conn.create_scalar_function("utc_month", 1, flags, |context| at(context, utc_month))?;
    statistics::register(conn, flags)?;
    conn.create_aggregate_function("packed_rows", -1, flags, PackRows)?;
    conn.create_scalar_function("part_of", 1, flags, |context| {
        Ok(part_of(context.get_raw(0).as_str()?))
    })?;
    conn.create_scalar_function("search_words", 1, flags, |context| {
        Ok(words(&said(context.get_raw(0).as_str()?)).join(" "))
    })?;
    conn.create_scalar_function("server_part", 2, flags, |context| {
        let (kind, body) = (context.get_raw(0), context.get_raw(1));
        Ok(derived_columns::part(kind.as_str()?, body.as_str()?))
    })?;
    conn.create_scalar_function("server_event_words", 2, flags, |context| {
        let (kind, body) = (context.get_raw(0), context.get_raw(1));
        Ok(derived_columns::event_words(kind.as_str()?, body.as_str()?))
    })?;
    conn.create_scalar_function("server_note_words", 1, flags, |context| {
        Ok(derived_columns::note_words(context.get_raw(0).as_str()?))
    })?;
    conn.create_scalar_function("says", 2, flags, |context| {
        let asked = context.get_or_create_aux(1, |asked| {
            Ok::<_, FromSqlError>(Search::new(asked.as_str()?))
        })?;
        let text = context.get_raw(0).as_str()?;
        Ok(asked
            .as_ref()
            .as_ref()
            .is_some_and(|asked| asked.is_in(&said(text))))
    })
}

/// Applies `number` to the argument; NULL gives NULL.
fn at(context: &Context<'_>, number: fn(i64) -> i64) -> rusqlite::Result<Option<i64>> {
    Ok(context.get::<Option<i64>>(0)?.map(number))
}

/// Number of the UTC day of a time, counted from 1970.
pub(crate) fn utc_day(at_us: i64) -> i64 {
    at_us.div_euclid(DAY_US)
}

/// The number of the month of a time since January 1970, UTC.
pub(crate) fn utc_month(at_us: i64) -> i64 {
    let at = DateTime::from_timestamp_micros(at_us).unwrap_or_default();
    (i64::from(at.year()) - 1970) * 12 + i64::from(at.month0())
}

/// Beginning of a month, which is numbered from January 1970; µs since 1970.
pub(crate) fn month_start_us(month: i64) -> i64 {
    let year = i32::try_from(1970 + month.div_euclid(12)).unwrap_or(i32::MAX);
    let first = NaiveDate::from_ymd_opt(year, month.rem_euclid(12) as u32 + 1, 1);
    let midnight = first.unwrap_or_default().and_time(NaiveTime::MIN);
    midnight.and_utc().timestamp_micros()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2024-02-29 is day 19 782, 2024-03-01 the next; 2023-12-31 is day 19 722.
    #[test]
    fn months_are_those_of_the_calendar() {
        let month = |day: i64| utc_month(day * DAY_US + 5);
        assert_eq!(month(0), 0);
        assert_eq!(month(-1), -1);
        assert_eq!(month(19_782), 54 * 12 + 1);
        assert_eq!(month(19_783), 54 * 12 + 2);
        assert_eq!(month(19_722), 53 * 12 + 11);
        for number in -500..3000 {
            let start = month_start_us(number);
            assert_eq!(
                (utc_month(start), utc_month(start - 1)),
                (number, number - 1)
            );
        }
    }
}
