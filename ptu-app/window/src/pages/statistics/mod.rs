//! Statistics of the fault history: which causes, how often, how long repairs take and whether they hold. Each bar leads to
//! its faults.

mod control;
mod counted;
mod distances;
mod figures;
mod life;

use eframe::egui::{RichText, ScrollArea, Ui};
use egui_material_icons::icons::ICON_BAR_CHART;
use fault_db::FaultStat;

use crate::page_context::{Destination, FaultsOf};
use crate::parts::bars::{Bar, Chart};
use crate::parts::{
    SavedSaid, UnitFilter, caption, empty, ground, look_back, saved_questions, segments,
};
use crate::request::{FollowingResponse, Request};
use crate::settings::StatisticsQuestion;
use crate::{PageContext, Palette, Sizes};
use counted::{Asked, Counted};
use ptu_report::fault_months::Month;
use ptu_report::words::{Words, fill};

/// Number of causes that have a bar of their own.
const MOST_CAUSES: usize = 10;
/// Number of months that are shown, the last ones.
const MOST_MONTHS: usize = 24;
/// Page width below which the charts stand one above the other, points.
const BESIDE: f32 = 900.0;

#[derive(Default)]
pub struct StatisticsPage {
    units: UnitFilter,
    /// Days to look back; none = all there is.
    days: Option<i64>,
    counted: FollowingResponse<Asked, Counted>,
    pub life: life::LifeView,
    control: control::ControlChart,
    distances: distances::DistancesFile,
    /// The chart by month shows faults per distance run, not counts.
    by_distance: bool,
    /// Name under which the question is to be saved, as typed.
    question: String,
}

impl StatisticsPage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        ui.horizontal_wrapped(|ui| {
            look_back::look_back(ui, words, &mut self.days);
            self.units.show(ui, context, &[]);
            self.life.search(ui, words);
            self.questions(ui, context);
        });
        ui.separator();
        if self.life.show(ui, context) {
            return;
        }
        self.keep_up(context);
        match self.counted.get() {
            Request::Ready(counted) if counted.causes.is_empty() => {
                empty(
                    ui,
                    ICON_BAR_CHART,
                    (words.statistics.nothing, &of(words, counted)),
                    None,
                );
            }
            Request::Ready(_) => {
                let area = ScrollArea::vertical().auto_shrink(false);
                area.show(ui, |ui| {
                    self.charts(ui, context);
                    self.control.show(ui, words);
                });
            }
            missing => {
                if missing.missing(ui, words, words.statistics.not_read) {
                    self.counted.read_again();
                }
            }
        }
    }

    /// Draws the figures, the chart of causes, and beside it the chart of months.
    fn charts(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        let said = &words.statistics;
        let Some(counted) = self.counted.get().value() else {
            return;
        };
        figures::figures(ui, words, &counted.all);
        let columns = if ui.available_width() < BESIDE { 1 } else { 2 };
        let mut again = false;
        ui.columns(columns, |columns| {
            let chart = Chart {
                title: said.by_cause,
                sums: true,
            };
            let heading = RichText::new(said.by_cause).size(Sizes::of(&columns[0]).lead);
            let cause = ground(&Palette::of(&columns[0])).show(&mut columns[0], |ui| {
                ui.set_width(ui.available_width());
                ui.label(heading);
                caption(ui, &of(words, counted));
                let clicked = chart.by_name(ui, &cause_bars(words, counted))?;
                counted.causes.iter().take(MOST_CAUSES).nth(clicked)
            });
            let of_cause = |cause: &FaultStat| FaultsOf {
                cause: Some(cause.key.clone()),
                days: counted.asked.days,
                units: self.units.clone(),
                ..FaultsOf::default()
            };
            let to = cause.inner.map(of_cause).map(Destination::Faults);
            context.go_to.extend(to);
            let last = columns.len() - 1;
            let ui = &mut columns[last];
            ground(&Palette::of(ui)).show(ui, |ui| {
                ui.set_width(ui.available_width());
                let ways = [(false, said.a_month), (true, said.each_10000_km)];
                ui.horizontal_wrapped(|ui| {
                    ui.label(RichText::new(said.by_month).size(Sizes::of(ui).lead));
                    segments(ui, &mut self.by_distance, ways);
                });
                if self.by_distance {
                    again = self.distances.show(ui, (counted, &self.units), context);
                    return;
                }
                let chart = Chart {
                    title: said.by_month,
                    sums: true,
                };
                let months = shown_months(counted);
                let bar = |month: &Month| Bar::new(&month.name, u64::from(month.stat.faults));
                let bars: Vec<_> = months.iter().map(bar).collect();
                let month = chart.in_time(ui, &bars).and_then(|place| months.get(place));
                let to = month.map(|month| Destination::Faults(of_month(month, &self.units)));
                context.go_to.extend(to);
            });
        });
        if again {
            self.counted.read_again();
        }
    }

    /// Draws the saved questions; a click on one asks it.
    fn questions(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let now = StatisticsQuestion {
            days: self.days,
            measured: self.control.of.clone(),
        };
        let saved = (&mut context.settings.statistics, &mut self.question);
        if let Some(asked) = saved_questions(ui, &SavedSaid::questions(context.words), saved, &now)
        {
            (self.days, self.control.of) = (asked.days, asked.measured);
        }
    }

    /// Counts again when the data, the span, the unit or the file of distances have changed.
    fn keep_up(&mut self, context: &PageContext<'_>) {
        let asked = Asked {
            unit: self.units.taken.as_deref().map(str::to_owned),
            days: self.days,
            distances: context.settings.distances.clone(),
        };
        // The counts of another question are not shown while the new ones are read.
        (self.counted).keep_up((asked.clone(), false), context, Counted::read);
        self.control.keep_up(asked, context);
    }
}

fn of(words: &Words, counted: &Counted) -> String {
    match &counted.asked.unit {
        Some(unit) => fill(words.statistics.of_unit, &[("unit", unit)]),
        None => words.statistics.all_units.to_owned(),
    }
}

fn shown_months(counted: &Counted) -> &[Month] {
    let earlier = counted.months.len().saturating_sub(MOST_MONTHS);
    &counted.months[earlier..]
}

fn of_month(month: &Month, units: &UnitFilter) -> FaultsOf {
    FaultsOf {
        first_seen_us: Some(month.span_us.clone()),
        month: month.name.clone(),
        units: units.clone(),
        ..FaultsOf::default()
    }
}

/// The causes with most cases, and all others together.
fn cause_bars(words: &Words, counted: &Counted) -> Vec<Bar> {
    let all = u64::from(counted.all.faults).max(1);
    let percent = |part: u64| format!("{:.0}", 100.0 * part as f64 / all as f64);
    let mut sum = 0;
    let mut bar = |name: &str, count: u64| {
        sum += count;
        let (share, sum) = (percent(count), percent(sum));
        let more = fill(words.statistics.of_all, &[("share", &share), ("sum", &sum)]);
        Bar {
            more,
            ..Bar::new(name, count)
        }
    };
    let shown = counted.causes.iter().take(MOST_CAUSES);
    let mut bars: Vec<Bar> = shown
        .map(|stat| {
            let name = counted.parts.name(&stat.key, words.language);
            bar(name, u64::from(stat.faults))
        })
        .collect();
    let others = counted.causes.iter().skip(MOST_CAUSES);
    let others: u64 = others.map(|stat| u64::from(stat.faults)).sum();
    if others > 0 {
        bars.push(bar(words.statistics.others, others));
    }
    bars
}
