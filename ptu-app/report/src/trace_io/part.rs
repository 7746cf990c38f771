//! The part of a stored trace that is exported: some of its signals, and the rows of a span of time.

use std::ops::Range;
use std::str::FromStr;

use fault_db::{Id, Store, TraceHead};

use super::about::TraceInfo;
use crate::trace_notes::TraceNote;
use crate::words::Language;
use ptu_runs::failure::{Asked, Failure};

/// Rows that are in memory at once, of all signals.
const ROWS_AT_ONCE: usize = 4096;

/// A span of time in seconds from the trigger; an end that is not given is the end of the trace.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seconds {
    from: Option<f64>,
    to: Option<f64>,
}

impl FromStr for Seconds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "\"{text}\" is no span of seconds from the trigger, such as -2..5, ..0 or 1.5.."
            )
        };
        let (from, to) = text.split_once("..").ok_or_else(wrong)?;
        let end = |text: &str| match text.trim() {
            "" => Ok(None),
            text => match text.parse::<f64>() {
                Ok(seconds) if seconds.is_finite() => Ok(Some(seconds)),
                _ => Err(wrong()),
            },
        };
        let (from, to) = (end(from)?, end(to)?);
        if from.zip(to).is_some_and(|(from, to)| from > to) {
            return Err(format!("the span {text} ends before it begins"));
        }
        Ok(Self { from, to })
    }
}

impl Seconds {
    /// The rows at these times, both ends included.
    ///
    /// # Errors
    /// The trace has no row there; the error names the span of the trace.
    pub fn rows(&self, head: &TraceHead) -> Result<Range<usize>, Failure> {
        let trigger = i64::from(head.trigger_row.unwrap_or(0));
        let period_s = head.period_us as f64 / 1e6;
        // A thousandth of a row: a row at an end of the span belongs to the span in spite of rounding.
        let crumb = 1e-3;
        let first = self.from.map_or(0.0, |from| {
            (from / period_s - crumb).ceil() + trigger as f64
        });
        let end = self.to.map_or(head.rows as f64, |to| {
            (to / period_s + crumb).floor() + trigger as f64 + 1.0
        });
        let rows = first.max(0.0) as usize..(end.max(0.0) as usize).min(head.rows);
        let is_all = self.from.is_none() && self.to.is_none();
        if rows.is_empty() && !is_all {
            let at_s = |row: i64| format!("{:.3}", (row - trigger) as f64 * period_s);
            return Err(Failure::usage(Asked::OutsideTrace(
                at_s(0),
                at_s(head.rows as i64 - 1),
            )));
        }
        Ok(rows)
    }
}

/// The part of a stored trace that is asked for.
pub struct TracePart<'s> {
    store: &'s Store,
    id: Id,
    rows: Range<usize>,
    pub about: TraceInfo,
}

impl<'s> TracePart<'s> {
    /// The rows of the span with these signals, or with all signals where none is named.
    ///
    /// # Errors
    /// There is no such signal, or no row.
    pub fn new(
        store: &'s Store,
        id: Id,
        signals: &[String],
        span: Seconds,
    ) -> Result<Self, Failure> {
        let head = store.trace_head(id)?;
        let rows = span.rows(&head)?;
        let names: Vec<_> = signals.iter().map(String::as_str).collect();
        let channels = match &names[..] {
            [] => head.channels.clone(),
            // Without a row: the channels, or an error that names a signal which the trace lacks.
            names => store.trace_window(id, names, 0..0)?.channels,
        };
        let mut about = TraceInfo::part(&head, channels, rows.start, rows.len());
        let times_us = about.time_us(0)..about.time_us(rows.len());
        about.notes = TraceNote::all(store, id, Language::English.words())?;
        about.notes.retain(|note| times_us.contains(&note.time_us));
        Ok(Self {
            store,
            id,
            rows,
            about,
        })
    }

    /// Samples of the signal at this place, in these rows of the part.
    pub(super) fn column(&self, place: usize, rows: Range<usize>) -> Result<Vec<f64>, Failure> {
        let names = [self.about.channels[place].name.as_str()];
        let mut trace = self
            .store
            .trace_window(self.id, &names, self.of_trace(rows))?;
        Ok(trace.columns.pop().unwrap_or_default())
    }

    /// Calls `take` for some rows at a time, in order: with the number of the first of them, and with the columns.
    pub(super) fn each_block(
        &self,
        mut take: impl FnMut(usize, &[Vec<f64>]) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let names: Vec<_> = self
            .about
            .channels
            .iter()
            .map(|c| c.name.as_str())
            .collect();
        for first in (0..self.about.rows).step_by(ROWS_AT_ONCE) {
            let rows = first..self.about.rows.min(first + ROWS_AT_ONCE);
            let trace = self
                .store
                .trace_window(self.id, &names, self.of_trace(rows))?;
            take(first, &trace.columns)?;
        }
        Ok(())
    }

    fn of_trace(&self, rows: Range<usize>) -> Range<usize> {
        self.rows.start + rows.start..self.rows.start + rows.end
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head() -> TraceHead {
        TraceHead {
            id: Id::from_bytes([1; 16]),
            run_id: Id::from_bytes([2; 16]),
            unit_serial: "A".into(),
            t0_bench_us: 0,
            t0_us: 0,
            period_us: 50_000,
            rows: 100,
            trigger_row: Some(40),
            partial: false,
            gaps: false,
            channels: Vec::new(),
        }
    }

    fn rows(span: &str) -> Result<Range<usize>, String> {
        let span: Seconds = span.parse()?;
        span.rows(&head()).map_err(|failure| failure.to_string())
    }

    #[test]
    fn a_span_is_the_rows_at_its_times_both_ends_included() {
        assert_eq!(rows(".."), Ok(0..100));
        assert_eq!(rows("0..0"), Ok(40..41));
        assert_eq!(rows("-0.1..0.15"), Ok(38..44));
        assert_eq!(rows("-0.12..0.17"), Ok(38..44), "between two rows");
        assert_eq!(rows("..-1"), Ok(0..21));
        assert_eq!(rows("2.9.."), Ok(98..100));
        assert_eq!(rows("-99..99"), Ok(0..100));
    }

    #[test]
    fn an_invalid_span_and_a_span_outside_the_trace_give_different_errors() {
        for wrong in ["", "3", "a..b", "1..nan", "1..inf"] {
            let told = rows(wrong).expect_err("no span");
            assert!(told.contains("-2..5"), "{told}");
        }
        assert_eq!(
            rows("2..1"),
            Err("the span 2..1 ends before it begins".into())
        );
        let told = rows("3..9").expect_err("outside");
        assert!(told.contains("-2.000 to 2.950 s"), "{told}");
    }
}
