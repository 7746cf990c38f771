//! `ptu faults stats`: counts of faults by kind, and how effective repairs were.

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use fault_db::{FaultStat, StatKey, StatQuery, Store};
use serde_json::{Value, json};

use super::filter::FilterArguments;
use crate::cli::output::Output;
use crate::cli::{at_least_one, print_out};
use crate::distances::Distances;
use crate::fault_months::{OnTheWay, by_month, on_the_way};
use crate::sparkline::sparkline;
use ptu_bench::clock::{self, local_minute, rfc3339};
use ptu_bench::failure::{Exit, Failure};
use ptu_bench::table::Table;

/// Keys of a row, in their order.
const KEYS: [&str; 21] = [
    "key",
    "name",
    "faults",
    "not_closed",
    "occurrences",
    "share",
    "units",
    "last_at",
    "mtbf_days",
    "mttr_hours",
    "repairs",
    "repairs_judged",
    "repairs_back",
    "back_rate",
    "closed",
    "no_fault_found",
    "no_fault_found_rate",
    "course",
    "rate_ratio",
    "rate_ratio_low",
    "rate_ratio_high",
];

/// Keys of a month with distances, after the others.
const DISTANCE_KEYS: [&str; 4] = [
    "distance_km",
    "distance_trains",
    "distance_faults",
    "per_10000_km",
];

/// A course over time is shown in so many bars at most: the last ones.
const BARS: usize = 24;

/// Count faults, the most frequent first: which make up most of them, how long units go without one, how
/// long repairs take and whether they hold
///
/// By cause, cases are counted: what one part explains is one, with one repair, and SHARE and CUM are of
/// cases. By anything else, observations are: a part that fails may have several faults.
///
/// SEEN counts occurrences, SHARE and CUM their share and that of all rows so far. FAULTS counts faults
/// first seen in the span, OPEN those that are not closed now. MTBF is calendar days of all units, since
/// the first run of each, by faults. MTTR is from a fault's opening to its repair. BACK are repairs
/// after which the unit had the same fault again in time, of all that are old enough to tell. NFF are
/// faults closed without a repair, of all closed.
///
/// Examples:
///   ptu faults stats --when 2026
///   ptu faults stats --by part --when 2026
///   ptu faults stats --by unit --part eb_relay --back-within 14
///   ptu faults stats --by month --line line8 --csv
///   ptu faults stats --by month --distances odometers.csv
#[derive(Debug, Args)]
#[command(verbatim_doc_comment)]
pub struct StatsArguments {
    /// What to count by
    #[arg(long, value_enum, default_value = "cause")]
    by: GroupBy,
    /// A fault that is seen again within so many days of its repair is back
    #[arg(long, value_name = "DAYS", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=3650))]
    back_within: u32,
    /// At most so many rows in a table; of months the last
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = at_least_one())]
    limit: u32,
    /// Readings of odometers, CSV with the columns train, date and km: with --by month, faults for each 10 000 km
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = ["serial_no", "part_serial_no", "line", "procedure", "run"]
    )]
    distances: Option<PathBuf>,
    #[command(flatten)]
    filter: FilterArguments,
    #[command(flatten)]
    output: Output,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum GroupBy {
    /// By the part that explains them: cases
    Cause,
    /// By fault code
    Code,
    /// By replaceable part
    Part,
    /// By unit
    Unit,
    /// By line
    Line,
    /// By month
    Month,
}

impl StatsArguments {
    pub fn stats(&self, store: &Store) -> Result<Exit, Failure> {
        let by = match self.by {
            GroupBy::Code => StatKey::Code,
            GroupBy::Part => StatKey::Lru,
            GroupBy::Cause => StatKey::Cause,
            GroupBy::Unit => StatKey::Unit,
            GroupBy::Line => StatKey::Line,
            // Of one cause its cases are counted, as without months.
            GroupBy::Month if self.filter.cause.is_some() => StatKey::Cause,
            GroupBy::Month => StatKey::All,
        };
        if self.distances.is_some() && self.by != GroupBy::Month {
            return Err(Failure::usage(
                "distances are told by month: add --by month",
            ));
        }
        let distances = self.distances.as_deref().map(Distances::read).transpose()?;
        let query = StatQuery {
            by,
            filter: self.filter.filter(store)?,
            now_us: clock::now_us(),
            back_within_days: self.back_within,
        };
        let (stats, together) = match (self.by, self.output.is_table()) {
            (GroupBy::Month, _) => {
                let months = by_month(store, &query)?.into_iter();
                (months.map(|month| month.stat).collect(), None)
            }
            (_, false) => (store.stats(&query)?, None),
            (_, true) => {
                let (stats, together) = store.stats_and_total(&query)?;
                (stats, Some(together))
            }
        };
        let distances = distances.map(|known| on_the_way(store, &query, &known));
        let distances = distances.transpose()?;
        self.output.save()?;
        if stats.is_empty() {
            let said = self.filter.nothing(store)?;
            if self.output.is_table() {
                return print_out(&said);
            }
        }
        let all: u64 = stats.iter().map(|stat| self.counted(stat)).sum();
        let row = |stat: &FaultStat| {
            let mut row = entry(stat, (self.counted(stat), all));
            if let Some(distances) = &distances {
                let of_month = distances.get(&stat.key).cloned().unwrap_or_default();
                row["distance_km"] = json!(of_month.km);
                row["distance_trains"] = json!(of_month.trains);
                row["distance_faults"] = json!(of_month.faults);
                row["per_10000_km"] = json!(of_month.per_10000_km());
            }
            row
        };
        let rows: Vec<_> = stats.iter().map(row).collect();
        let more = distances.iter().flat_map(|_| DISTANCE_KEYS);
        let keys: Vec<_> = KEYS.into_iter().chain(more).collect();
        self.output.print(&keys, &rows, || {
            let distances = distances.as_ref();
            self.table(&stats, (together.as_ref(), distances), all)
        })
    }

    /// What shares are of: cases of a cause, else occurrences.
    fn counted(&self, stat: &FaultStat) -> u64 {
        match self.counts_cases() {
            true => u64::from(stat.faults),
            false => stat.occurrences,
        }
    }

    fn counts_cases(&self) -> bool {
        self.by == GroupBy::Cause || self.by == GroupBy::Month && self.filter.cause.is_some()
    }

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

    fn table(
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

fn entry(stat: &FaultStat, (counted, of): (u64, u64)) -> Value {
    let ratio = RateRatio::of(&stat.course);
    let rate = |part: u32, all: u32| (all > 0).then(|| f64::from(part) / f64::from(all));
    json!({
        "key": stat.key, "name": stat.name, "faults": stat.faults,
        "not_closed": stat.not_closed, "occurrences": stat.occurrences,
        "share": (of > 0).then(|| counted as f64 / of as f64),
        "units": stat.units, "last_at": stat.last_at_us.map(rfc3339),
        "mtbf_days": stat.mtbf_days, "mttr_hours": stat.mttr_hours,
        "repairs": stat.repairs, "repairs_judged": stat.repairs_judged,
        "repairs_back": stat.repairs_back, "back_rate": rate(stat.repairs_back, stat.repairs_judged),
        "closed": stat.closed, "no_fault_found": stat.no_fault_found,
        "no_fault_found_rate": rate(stat.no_fault_found, stat.closed),
        "course": stat.course,
        "rate_ratio": ratio.as_ref().map(|ratio| ratio.ratio),
        "rate_ratio_low": ratio.as_ref().map(|ratio| ratio.low),
        "rate_ratio_high": ratio.as_ref().map(|ratio| ratio.high),
    })
}

/// How many times as often something was seen in the later half of a course as in the earlier half.
struct RateRatio {
    ratio: f64,
    /// 95 % interval.
    low: f64,
    high: f64,
}

impl RateRatio {
    /// Of counts by day or month; of an odd number of them the one in the middle counts for neither half. Where
    /// neither half has anything there is no ratio.
    ///
    /// The logarithm of a ratio of two Poisson counts is nearly normal with variance `1/a + 1/b`; half a count is
    /// added to each, so that none divides by zero (Haldane, Anscombe).
    fn of(course: &[u64]) -> Option<Self> {
        let half = course.len() / 2;
        let earlier: u64 = course[..half].iter().sum();
        let later: u64 = course[course.len() - half..].iter().sum();
        if earlier + later == 0 {
            return None;
        }
        let (earlier, later) = (earlier as f64 + 0.5, later as f64 + 0.5);
        let ratio = later / earlier;
        let off = (1.96 * (1.0 / earlier + 1.0 / later).sqrt()).exp();
        Some(Self {
            ratio,
            low: ratio / off,
            high: ratio * off,
        })
    }

    fn text(&self) -> String {
        let said = match (self.low > 1.0, self.high < 1.0) {
            (true, _) => " worse",
            (_, true) => " better",
            _ => "",
        };
        format!("{:.1} ({:.1}–{:.1}){said}", self.ratio, self.low, self.high)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 4.5 to 10.5 is 2.33 times; 1.96 × √(1/4.5 + 1/10.5) is 1.104, and e to that 3.02.
    #[test]
    fn a_rate_ratio_has_the_interval_of_two_counts() {
        let ratio = RateRatio::of(&[1, 3, 50, 4, 6]).expect("something was seen");
        let near = |a: f64, b: f64| (a - b).abs() < 0.01;
        assert!(near(ratio.ratio, 2.33) && near(ratio.low, 0.77) && near(ratio.high, 7.05));
        assert_eq!(ratio.text(), "2.3 (0.8–7.0)");
        let worse = RateRatio::of(&[2, 40]).expect("something was seen");
        assert!(worse.text().ends_with(" worse"), "{}", worse.text());
        let better = RateRatio::of(&[40, 2]).expect("something was seen");
        assert!(better.text().ends_with(" better"), "{}", better.text());
        assert!(RateRatio::of(&[0, 0]).is_none() && RateRatio::of(&[7]).is_none());
    }
}
