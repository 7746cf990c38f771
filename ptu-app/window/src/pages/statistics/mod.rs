//! Statistics of the fault history: which causes, how often, how long repairs take and whether they hold. Each bar leads to
//! its faults.

mod control;
mod counted;
mod distances;
mod figures;
mod life;

use eframe::egui::{RichText, ScrollArea, Ui};

use crate::page_context::{Destination, FaultsOf};
use crate::parts::bars::{Bar, Chart};
use crate::parts::{SavedSaid, UnitFilter, look_back, saved_questions};
use crate::request::{CachedResponse, Request};
use crate::settings::StatisticsQuestion;
use crate::{PageContext, Palette};
use counted::{Asked, Counted};
use ptu_report::fault_months::Month;
use ptu_report::words::{Words, fill};

/// As many causes have a bar of their own.
const MOST_CAUSES: usize = 10;
/// As many months are shown, the last ones.
const MOST_MONTHS: usize = 24;

#[derive(Default)]
pub struct StatisticsPage {
    units: UnitFilter,
    /// Days to look back; none = all there is.
    days: Option<i64>,
    counted: CachedResponse<Counted>,
    /// What was asked last, and of which data.
    asked: Option<(Asked, (usize, u64))>,
    life: life::LifeView,
    control: control::ControlChart,
    distances: distances::DistancesFile,
    /// Name for a question, as it is typed.
    question: String,
}

impl StatisticsPage {
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let words = context.words;
        ui.horizontal_wrapped(|ui| {
            look_back::look_back(ui, words, &mut self.days);
            self.units.show(ui, context);
            self.life.search(ui, words);
        });
        ui.horizontal_wrapped(|ui| self.questions(ui, context));
        if self.life.show(ui, context) {
            return;
        }
        self.keep_up(context);
        match self.counted.get() {
            Request::Ready(counted) => {
                let mut to = None;
                ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                    to = content(ui, words, counted, &self.units);
                    if self.distances.show(ui, (counted, &self.units), context) {
                        self.asked = None;
                    }
                    ui.separator();
                    self.control.show(ui, words);
                });
                context.go_to.extend(to.map(Destination::Faults));
            }
            Request::Failed(why) => {
                let said = RichText::new(words.statistics.not_read).color(Palette::of(ui).bad);
                ui.label(said.strong());
                ui.label(&*words.trouble(why));
                if ui.button(words.common.refresh).clicked() {
                    self.asked = None;
                }
            }
            Request::Idle | Request::Pending(_) => {
                ui.label(words.common.loading);
            }
        }
    }

    /// Questions that were given a name.
    fn questions(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        let (measurement, step) = self.control.chosen();
        let now = StatisticsQuestion {
            days: self.days,
            measurement,
            step,
        };
        let saved = (&mut context.settings.statistics, &mut self.question);
        if let Some(asked) = saved_questions(ui, &SavedSaid::questions(context.words), saved, &now)
        {
            self.days = asked.days;
            self.control.choose(asked.measurement, asked.step);
        }
    }

    /// Shows the life of what has this serial number.
    pub fn show_life(&mut self, serial: &str) {
        self.life.open(serial);
    }

    /// Asks again when the data, the span or the unit are others.
    fn keep_up(&mut self, context: &PageContext<'_>) {
        let asked = Asked {
            unit: self.units.taken().map(str::to_owned),
            days: self.days,
            distances: context.settings.distances.clone(),
        };
        let wanted = (asked, context.data_version());
        if self.asked.as_ref() != Some(&wanted) {
            let asked = wanted.0.clone();
            let pending = context
                .queries
                .run(move |paths| Counted::read(paths, asked));
            // Counts of another unit are not shown as this one's meanwhile.
            match self.asked.replace(wanted.clone()) {
                Some((before, _)) if before == wanted.0 => self.counted.request(pending),
                _ => self.counted.request_other(pending),
            }
        }
        self.counted.poll();
        if let Some((asked, _)) = &self.asked {
            self.control.keep_up(asked.clone(), context);
        }
    }
}

/// Figures and charts; the faults of the bar that was clicked.
fn content(ui: &mut Ui, words: &Words, counted: &Counted, units: &UnitFilter) -> Option<FaultsOf> {
    let of = match &counted.asked.unit {
        Some(unit) => fill(words.statistics.of_unit, &[("unit", unit)]),
        None => words.statistics.all_units.to_owned(),
    };
    ui.label(RichText::new(of).strong().size(19.0));
    if counted.causes.is_empty() {
        ui.label(words.statistics.nothing);
        return None;
    }
    figures::figures(ui, words, &counted.all);
    ui.separator();
    let chart = |title| Chart {
        title,
        width: ui.available_width(),
        leads: true,
        sums: true,
    };
    let (by_cause, by_month) = (
        chart(words.statistics.by_cause),
        chart(words.statistics.by_month),
    );
    let cause = by_cause.by_name(ui, &cause_bars(words, counted));
    ui.separator();
    let months = shown_months(counted);
    let bars = months
        .iter()
        .map(|month| Bar::new(&month.name, u64::from(month.stat.faults)));
    let month = by_month.in_time(ui, &bars.collect::<Vec<_>>());
    let cause = cause
        .and_then(|place| counted.causes.iter().take(MOST_CAUSES).nth(place))
        .map(|cause| FaultsOf {
            cause: Some(cause.key.clone()),
            days: counted.asked.days,
            units: units.clone(),
            ..FaultsOf::default()
        });
    let month = month
        .and_then(|place| months.get(place))
        .map(|month| of_month(month, units));
    cause.or(month)
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
