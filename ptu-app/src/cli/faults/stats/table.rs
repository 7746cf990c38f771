//! Counts of faults as a table for people, with what its numbers are of.

use std::collections::BTreeMap;

use fault_db::FaultStat;

use super::rate_ratio::RateRatio;
use super::{GroupBy, StatsArguments};
use crate::sparkline::sparkline;
use ptu_report::fault_months::OnTheWay;
use ptu_runs::clock::local_minute;
use ptu_runs::table::Table;

/// A course over time is shown in this many bars at most: the last ones.
const BARS: usize = 24;

impl StatsArguments {
    fn headings(&self) -> Vec<&'static str> {
        let heading = match self.by {
            GroupBy::Code => "CODE",
            GroupBy::Part => "PART",
            GroupBy::Cause => "CAUSE",
            GroupBy::Unit => "UNIT",
            GroupBy::Line => "LINE",
            GroupBy::Month => "MONTH",
        };
        let (counted, other) = match self.counts_cases() {
            true => ("CASES", "SEEN"),
            false => ("SEEN", "FAULTS"),
        };
        let mut headings = vec![heading, counted];
        if self.by != GroupBy::Month {
            headings.extend(["SHARE", "CUM"]);
        }
        headings.extend([
            other,
            "OPEN",
            "UNITS",
            "MTBF",
            "MTTR",
            "BACK",
            "NFF",
            "LAST SEEN",
        ]);
        if self.by != GroupBy::Month {
            headings.extend(["COURSE", "LATER/EARLIER"]);
        }
        if self.distances.is_some() {
            headings.extend(["KM", "TRAINS", "THEIR FAULTS", "PER 10000 KM"]);
        }
        headings
    }

    pub(super) fn table(
        &self,
        stats: &[FaultStat],
        (together, distances): (Option<&FaultStat>, Option<&BTreeMap<String, OnTheWay>>),
        all: u64,
    ) -> String {
        let is_course = self.by != GroupBy::Month;
        let headings = self.headings();
        let words_last = match distances {
            Some(_) => 0,
            None => 1 + 2 * usize::from(is_course),
        };
        let numbers = 1..headings.len() - words_last;
        let mut table = Table::new(&headings).right(numbers);
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
                false => "all".to_owned(),
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
            (_, GroupBy::Month) => (
                format!("… {more} earlier months; see --limit\n"),
                String::new(),
            ),
            _ => (String::new(), format!("\n… and {more} more; see --limit")),
        };
        format!(
            "{earlier}{}{more}\n\n{}",
            table.render(),
            self.caption(stats)
        )
    }

    /// What the numbers are of.
    fn caption(&self, stats: &[FaultStat]) -> String {
        let span = self.filter.span();
        let by_day = stats
            .iter()
            .map(|stat| stat.course.len())
            .max()
            .unwrap_or(0);
        let course = match (self.by, by_day) {
            (GroupBy::Month, _) => "",
            (_, 0..=1) => "",
            _ => {
                "; course by day or month, the last 24; LATER/EARLIER: occurrences of the later half of the course \
                 over the earlier half, with what it is in 95 of 100 cases; \"worse\" or \"better\" where that is \
                 above or below 1"
            }
        };
        let distances = match self.distances {
            Some(_) => {
                "; PER 10000 KM: faults first seen in runs in trains whose odometer readings cover the time, over what \
                 these trains ran; between two readings a train runs evenly"
            }
            None => "",
        };
        format!(
            "{span}; BACK: within {} days of the repair{course}{distances}",
            self.back_within
        )
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

/// A length of time in the unit that fits.
fn days(days: f64) -> String {
    match days {
        hours if hours < 2.0 => format!("{:.1} h", 24.0 * days),
        days if days < 100.0 => format!("{days:.1} d"),
        days => format!("{days:.0} d"),
    }
}
