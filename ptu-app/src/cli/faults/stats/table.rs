//! Counts of faults as a table for people, with a caption that says what is counted.

use std::collections::BTreeMap;

use fault_db::{FaultStat, FaultState};

use super::rate_ratio::RateRatio;
use super::{GroupBy, StatsArguments};
use crate::sparkline::sparkline;
use ptu_report::fault_months::OnTheWay;
use ptu_report::words::{Words, fill};
use ptu_runs::clock::local_minute;
use ptu_runs::table::Table;

/// Most bars in which a course over time is shown, the latest.
const BARS: usize = 24;

impl StatsArguments {
    fn headings(&self) -> Vec<&'static str> {
        let words = Words::shown();
        let (common, terminal, counts) = (&words.common, &words.terminal, &words.counts);
        let heading = match self.by {
            GroupBy::Code => common.code,
            GroupBy::Part => common.part,
            GroupBy::Cause => words.faults.cause,
            GroupBy::Unit => common.unit,
            GroupBy::Line => common.line,
            GroupBy::Month => counts.month,
        };
        let (counted, other) = match self.counts_cases() {
            true => (counts.cases, words.faults.seen),
            false => (words.faults.seen, terminal.faults),
        };
        let mut headings = vec![heading, counted];
        if self.by != GroupBy::Month {
            headings.extend([terminal.share, terminal.cumulated]);
        }
        headings.extend([
            other,
            words.fault_state(FaultState::Open),
            counts.units,
            counts.mtbf,
            counts.mttr,
            terminal.back,
            counts.not_found,
            words.faults.last_seen,
        ]);
        if self.by != GroupBy::Month {
            headings.extend([terminal.course, terminal.later_earlier]);
        }
        if self.distances.is_some() {
            let [km, rate] = [counts.kilometres, counts.per_10000_km];
            headings.extend([km, counts.trains, counts.their_faults, rate]);
        }
        headings
    }

    pub(super) fn table(
        &self,
        stats: &[FaultStat],
        (together, distances): (Option<&FaultStat>, Option<&BTreeMap<String, OnTheWay>>),
        all: u64,
    ) -> String {
        let counts = &Words::shown().counts;
        let is_course = self.by != GroupBy::Month;
        let headings = self.headings();
        let words_last = match distances {
            Some(_) => 0,
            None => 1 + 2 * usize::from(is_course),
        };
        let numbers = 1..headings.len() - words_last;
        let mut table = Table::headed(&headings).right(numbers);
        let mut so_far = 0;
        let more = stats.len().saturating_sub(self.limit as usize);
        let shown = match self.by {
            GroupBy::Month => &stats[more..],
            _ => &stats[..stats.len() - more],
        };
        let shown = shown.iter().map(|stat| (stat, true));
        for (stat, is_row) in shown.chain(together.map(|all| (all, false))) {
            so_far += if is_row { self.counted(stat) } else { 0 };
            let name = match is_row {
                true => format!("{} {}", stat.key, stat.name),
                false => counts.all.to_owned(),
            };
            let mut row = vec![name.trim_end().to_owned(), self.counted(stat).to_string()];
            if is_course {
                row.push(share(self.counted(stat), all));
                row.push(match is_row {
                    true => share(so_far, all),
                    false => String::new(),
                });
            }
            let other = match self.counts_cases() {
                true => stat.occurrences,
                false => u64::from(stat.faults),
            };
            row.extend([
                other.to_string(),
                stat.not_closed.to_string(),
                stat.units.to_string(),
                stat.mtbf_days.map_or_else(dash, days),
                stat.mttr_hours
                    .map_or_else(dash, |hours| days(hours / 24.0)),
                of(stat.repairs_back, stat.repairs_judged),
                of(stat.no_fault_found, stat.closed),
                stat.last_at_us.map_or_else(dash, local_minute),
            ]);
            if is_course {
                let first = stat.course.len().saturating_sub(BARS);
                row.push(sparkline(&stat.course[first..]));
                row.push(RateRatio::of(&stat.course).map_or_else(dash, |ratio| ratio.text()));
            }
            if let Some(distances) = distances {
                let of_month = distances.get(&stat.key).cloned().unwrap_or_default();
                let rate = of_month.per_10000_km();
                row.push(rate.map_or_else(dash, |_| format!("{:.0}", of_month.km)));
                row.push(rate.map_or_else(dash, |_| of_month.trains.to_string()));
                row.push(rate.map_or_else(dash, |_| of_month.faults.to_string()));
                row.push(rate.map_or_else(dash, |rate| format!("{rate:.2}")));
            }
            table.row(row);
        }
        let (earlier, more) = match (more, self.by) {
            (0, _) => Default::default(),
            (n, GroupBy::Month) => (
                fill(counts.earlier_months, &[("n", &n)]) + "\n",
                String::new(),
            ),
            (n, _) => {
                let more = fill(counts.n_more, &[("n", &n)]);
                (String::new(), format!("\n{more}"))
            }
        };
        format!(
            "{earlier}{}{more}\n\n{}",
            table.render(),
            self.caption(stats)
        )
    }

    /// Caption that says what the numbers count.
    fn caption(&self, stats: &[FaultStat]) -> String {
        let words = Words::shown();
        let counts = &words.counts;
        let span = words.span(self.filter.span());
        let by_day = stats
            .iter()
            .map(|stat| stat.course.len())
            .max()
            .unwrap_or(0);
        let course = match (self.by, by_day) {
            (GroupBy::Month, _) => "",
            (_, 0..=1) => "",
            _ => counts.course_is,
        };
        let distances = match self.distances {
            Some(_) => counts.rate_is,
            None => "",
        };
        let back = fill(counts.back_is, &[("n", &self.back_within)]);
        format!("{span}{back}{course}{distances}")
    }
}

fn dash() -> String {
    "-".to_owned()
}

fn share(part: u64, all: u64) -> String {
    format!("{:.1} %", 100.0 * part as f64 / all.max(1) as f64)
}

fn of(part: u32, all: u32) -> String {
    match all {
        0 => dash(),
        _ => format!("{:.0} % of {all}", 100.0 * f64::from(part) / f64::from(all)),
    }
}

/// A time of `days` as text, in hours below 2 days.
fn days(days: f64) -> String {
    match days {
        hours if hours < 2.0 => format!("{:.1} h", 24.0 * days),
        days if days < 100.0 => format!("{days:.1} d"),
        days => format!("{days:.0} d"),
    }
}
