//! A list of runs to choose from, the latest first.

use crate::parts::selectable;
use eframe::egui::{FontId, RichText, Role, ScrollArea, Sense, Ui, WidgetInfo, vec2};
use egui_material_icons::icons::{ICON_DO_NOT_DISTURB_ON, ICON_PLAY_CIRCLE};
use fault_db::{Id, RunFilter, RunState, RunSummary};

use super::lane::cut_text;
use super::{Side, find_edit, verdict_look};
use crate::request::FollowingResponse;
use crate::{PageContext, Palette, Sizes};
use ptu_report::count_text;
use ptu_report::naming::DOT;
use ptu_report::words::{Words, fill};
use ptu_runs::clock;
use ptu_runs::coverage::counts_of;
use ptu_runs::stored::from_stored;

/// Number of runs that are listed.
const MOST: u32 = 2_000;

#[derive(Default)]
pub struct RunList {
    runs: FollowingResponse<(), Vec<RunSummary>>,
    find: String,
    /// Run chosen by a person, until a run ends or another unit is connected.
    chosen: Option<Id>,
    followed: Followed,
    shown: Option<Id>,
}

/// Unit and number of ended runs that decide which run is shown while no run is chosen.
#[derive(Clone, Default, PartialEq)]
struct Followed {
    unit: Option<String>,
    runs_ended: usize,
}

impl RunList {
    /// Shows the list at the side of a page. Returns the run to show: the chosen run, or the latest ended run of the
    /// connected unit.
    pub fn show(&mut self, ui: &mut Ui, context: &PageContext<'_>) -> Option<Id> {
        self.keep_up(context);
        let side = Side {
            name: context.words.common.runs,
            wide: [268.0, 320.0],
            at_right: false,
        };
        if let Some(clicked) = side.show(ui, |ui| self.list(ui, context)) {
            self.choose(clicked, context);
        }
        self.shown
    }

    /// Shows this run, whichever unit it is of.
    pub fn choose(&mut self, run: Id, context: &PageContext<'_>) {
        self.follow(context);
        self.chosen = Some(run);
        self.shown = Some(run);
    }

    /// The other runs of the same unit as this run, the latest first.
    pub fn of_same_unit(&self, run: Id) -> impl Iterator<Item = &RunSummary> {
        let all = self.runs.items().iter();
        let unit = all.clone().find(|other| other.id == run);
        let unit = unit.map(|run| run.unit_serial.as_str());
        all.filter(move |other| Some(other.unit_serial.as_str()) == unit && other.id != run)
    }

    /// Two runs of the list, the earlier first.
    pub fn in_time(&self, runs: [Id; 2]) -> [Id; 2] {
        let place = |run: Id| self.runs.items().iter().position(|other| other.id == run);
        match place(runs[0]) < place(runs[1]) {
            true => [runs[1], runs[0]],
            false => runs,
        }
    }

    /// Names the unit whose run is shown, if another unit is connected.
    pub fn tell_other_unit(&self, ui: &mut Ui, words: &Words) {
        let Some(connected) = &self.followed.unit else {
            return;
        };
        let mut shown = (self.runs.items().iter()).filter(|run| Some(run.id) == self.shown);
        if let Some(run) = shown.find(|run| run.unit_serial != *connected) {
            let named: [(&str, &dyn std::fmt::Display); 2] =
                [("unit", &run.unit_serial), ("connected", connected)];
            let said = format!("⚠ {}", fill(words.common.other_unit, &named));
            ui.label(RichText::new(said).color(Palette::of(ui).warn).strong());
        }
    }

    /// Draws the list; returns the run that was clicked.
    fn list(&mut self, ui: &mut Ui, context: &PageContext<'_>) -> Option<Id> {
        let chosen = self.shown;
        let words = context.words;
        find_edit(ui, &mut self.find, words.procedures.find, f32::INFINITY);
        let runs = self.runs.get().shown(ui, words)?;
        let find = self.find.trim().to_lowercase();
        let shown: Vec<_> = runs.iter().filter(|run| matches(run, &find)).collect();
        if shown.is_empty() {
            ui.label(words.common.nothing);
        }
        let height = row_high(ui);
        ui.spacing_mut().item_spacing.y = 0.0;
        let mut clicked = None;
        let area = ScrollArea::vertical().auto_shrink(false);
        area.show_rows(ui, height, shown.len(), |ui, range| {
            for run in shown.get(range).into_iter().flatten() {
                if row(ui, words, run, chosen == Some(run.id)) {
                    clicked = Some(run.id);
                }
            }
        });
        clicked
    }

    /// The latest ended run of the connected unit, or of any unit while none was connected.
    fn foremost(&self) -> Option<Id> {
        let unit = self.followed.unit.as_ref();
        let mut runs = self.runs.items().iter();
        let is_it = |run: &&RunSummary| {
            run.verdict.is_some() && unit.is_none_or(|unit| run.unit_serial == *unit)
        };
        Some(runs.find(is_it)?.id)
    }

    /// Drops the chosen run when a run has ended or another unit is connected.
    fn follow(&mut self, context: &PageContext<'_>) {
        let connected = context.units.chosen().serial();
        let followed = Followed {
            unit: connected.or_else(|| self.followed.unit.clone()),
            runs_ended: context.units.runs_ended(),
        };
        if followed != self.followed {
            self.followed = followed;
            self.chosen = None;
        }
    }

    /// Reads the list at first, and again when the data have changed.
    fn keep_up(&mut self, context: &PageContext<'_>) {
        self.runs.keep_up(((), true), context, |paths, ()| {
            let filter = RunFilter {
                limit: Some(MOST),
                ..RunFilter::default()
            };
            Ok(paths.read()?.runs(&filter)?)
        });
        self.follow(context);
        // The shown run stays until the newer list is there.
        if !self.runs.is_stale() {
            self.shown = self.chosen.or_else(|| self.foremost());
        }
    }
}

/// Height of a row of two lines (time and unit; verdict and counts), points.
fn row_high(ui: &Ui) -> f32 {
    let sizes = Sizes::of(ui);
    (2.2 * (sizes.body + sizes.caption)).max(sizes.target)
}

fn row(ui: &mut Ui, words: &Words, run: &RunSummary, chosen: bool) -> bool {
    let (palette, sizes) = (Palette::of(ui), Sizes::of(ui));
    let name = [&*clock::local(run.started_at_us), &*run.unit_serial].join(DOT);
    let common = &words.common;
    let ((icon, colour), verdict) = match (run.verdict, run.state) {
        (Some(verdict), _) => {
            let verdict = from_stored(verdict);
            (verdict_look(verdict, &palette), common.verdict(verdict))
        }
        (None, RunState::Running) => ((ICON_PLAY_CIRCLE, palette.accent), common.running),
        (None, _) => ((ICON_DO_NOT_DISTURB_ON, palette.warn), common.interrupted),
    };
    let size = vec2(ui.available_width(), row_high(ui));
    let (rect, response) = selectable(ui, size, (&name, chosen));
    let (first, second) = rect
        .shrink2(vec2(8.0, 4.0))
        .split_top_bottom_at_fraction(0.5);
    let painter = ui.painter();
    let body = FontId::proportional(sizes.body);
    cut_text(painter, first, name, body, palette.ink);
    let sign = FontId::new(sizes.icon, icon.font_family());
    let x = cut_text(painter, second, icon.codepoint.into(), sign, colour) + 6.0;
    let caption = FontId::proportional(sizes.caption);
    let second = second.with_min_x(second.left() + x);
    let x = cut_text(painter, second, verdict.into(), caption.clone(), colour) + 8.0;
    let counts = count_text(&counts_of(run), words);
    let second = second.with_min_x(second.left() + x);
    cut_text(painter, second, counts.clone(), caption, palette.quiet);
    // Screen readers get the painted texts, too.
    for said in [verdict, &*counts] {
        let read = ui.interact(second, response.id.with(said), Sense::hover());
        read.widget_info(|| WidgetInfo::labeled(Role::Label, true, said));
    }
    response.on_hover_text(run.id.to_string()).clicked()
}

fn matches(run: &RunSummary, find: &str) -> bool {
    [
        run.id.to_string(),
        run.unit_serial.clone(),
        run.operator.clone(),
        run.line.clone(),
        clock::local(run.started_at_us),
        run.verdict
            .map(|verdict| verdict.to_string())
            .unwrap_or_default(),
    ]
    .iter()
    .any(|text| text.to_lowercase().contains(find))
}
