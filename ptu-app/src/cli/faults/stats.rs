//! `ptu faults stats`: counts of faults by kind, and how effective repairs were.

mod rate_ratio;
mod table;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use fault_db::{FaultStat, StatKey, StatQuery, Store};
use serde_json::{Value, json};

use super::filter::FilterArguments;
use crate::cli::output::{Output, keys};
use crate::cli::{at_least_one, print_out};
use ptu_report::distances::Distances;
use ptu_report::fault_months::{by_month, on_the_way};
use ptu_runs::clock::{self, rfc3339};
use ptu_runs::failure::{Asked, Exit, Failure};
use rate_ratio::RateRatio;

/// Count faults, the most frequent first: which make up most of them, how long units go without one, how
/// long repairs take and whether they hold
///
/// With --by cause, cases are counted: all faults that one part explains are one case, with one repair; SHARE and CUM
/// are shares of the cases. With any other --by, occurrences are counted: a part that fails may have several faults.
///
/// SEEN counts occurrences, SHARE and CUM are the share of a row and of all rows down to it. FAULTS counts faults
/// first seen in the span, OPEN faults that are not closed now. MTBF is calendar days of all units, since the first
/// run of each, divided by faults. MTTR is from a fault's opening to its repair. BACK is the share of repairs after
/// which the unit had the fault again within --back-within, of all repairs that are old enough to judge. NFF is the
/// share of closed faults that were closed without a repair.
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
    /// A fault that is seen again within N days of its repair counts as back
    #[arg(long, value_name = "DAYS", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=3650))]
    back_within: u32,
    /// At most N rows in a table; of months the latest
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
    /// By the part that explains the faults: counts cases
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
            // With --cause, months count cases, as the other tables by cause do.
            GroupBy::Month if self.filter.cause.is_some() => StatKey::Cause,
            GroupBy::Month => StatKey::All,
        };
        if self.distances.is_some() && self.by != GroupBy::Month {
            return Err(Failure::usage(Asked::DistancesByMonth));
        }
        let distances = self.distances.as_deref().map(Distances::read).transpose()?;
        let query = StatQuery {
            by,
            filter: self.filter.filter(store)?,
            now_us: clock::now_us(),
            back_within_days: self.back_within,
        };
        let (stats, together) = match (self.by, self.output.form.is_table()) {
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
            if self.output.form.is_table() {
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
        let of_none = row(&FaultStat::default());
        self.output.form.print_columns(&keys(&of_none), &rows, || {
            let distances = distances.as_ref();
            self.table(&stats, (together.as_ref(), distances), all)
        })
    }

    /// What a row's share is of: number of cases where cases are counted, else of occurrences.
    fn counted(&self, stat: &FaultStat) -> u64 {
        match self.counts_cases() {
            true => u64::from(stat.faults),
            false => stat.occurrences,
        }
    }

    fn counts_cases(&self) -> bool {
        self.by == GroupBy::Cause || self.by == GroupBy::Month && self.filter.cause.is_some()
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
