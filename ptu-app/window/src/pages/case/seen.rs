//! The units of the latest runs: a click on one fills in its endpoint and serial number.

use eframe::egui::Ui;
use fault_db::{RunFilter, RunSummary};

use crate::parts::{ActionPlace, Face, Look, choice as choice_card, title};
use crate::request::FollowingResponse;
use crate::{PageContext, Sizes};
use ptu_report::naming::DOT;
use ptu_runs::clock;
use ptu_runs::run::BenchChoice;

/// Number of runs that are searched for units, the latest first.
const MOST: u32 = 200;
/// Number of units that are offered.
const SHOWN: usize = 4;
/// Least height of a unit's button, points.
const HIGH: f32 = 40.0;
/// Injected fault of the demonstration: a check finds it, and the repair of its part can be proved.
const DEMONSTRATED: &str = "eb_relay.slow";

/// The units of the latest runs, each with its latest run.
#[derive(Default)]
pub struct SeenUnits {
    runs: FollowingResponse<(), Vec<RunSummary>>,
}

impl SeenUnits {
    /// Shows the units while no unit is connected; if no unit was ever tested, offers a demonstration.
    pub fn show(&mut self, ui: &mut Ui, context: &mut PageContext<'_>) {
        self.keep_up(context);
        if self.runs.items().is_empty() {
            if self.runs.get().value().is_some() {
                demonstration(ui, context);
            }
            return;
        }
        let words = context.words;
        ui.add_space(8.0);
        title(ui, words.case.seen_last);
        let choice = &mut context.units.chosen_mut().choice;
        for run in self.runs.items() {
            let place = match run.source.as_str() {
                "sim" => words.frame.simulated,
                other => other,
            };
            let at = clock::local(run.started_at_us);
            let name = [&*run.unit_serial, place, &at].join(DOT);
            let on = choice.serial == run.unit_serial && choice.endpoint == run.source;
            let size = [ui.available_width(), Sizes::of(ui).target.max(HIGH)];
            if choice_card(ui, (&*name, ""), on, size).clicked() {
                choice.endpoint.clone_from(&run.source);
                choice.serial.clone_from(&run.unit_serial);
            }
        }
    }

    fn keep_up(&mut self, context: &PageContext<'_>) {
        self.runs.keep_up(((), true), context, |paths, ()| {
            if !paths.is_there() {
                return Ok(Vec::new());
            }
            let filter = RunFilter {
                limit: Some(MOST),
                ..RunFilter::default()
            };
            let runs = paths.read()?.runs(&filter)?;
            let mut seen: Vec<RunSummary> = Vec::new();
            for run in runs {
                let is_new = seen
                    .iter()
                    .all(|other| other.unit_serial != run.unit_serial);
                if seen.len() < SHOWN && is_new && is_place(&run.source) {
                    seen.push(run);
                }
            }
            Ok(seen)
        });
    }
}

/// Button that begins a demonstration: a whole case on the simulated unit with an injected fault.
fn demonstration(ui: &mut Ui, context: &mut PageContext<'_>) {
    let words = &context.words.case;
    ui.add_space(8.0);
    ui.label(words.first_start);
    let place = ActionPlace::new(ui, "demonstration", ());
    let begin = Face::new(Look::Secondary, words.demonstrate).show(ui);
    if place.clicked(&begin) {
        let unit = context.units.chosen_mut();
        unit.choice = BenchChoice {
            faults: vec![DEMONSTRATED.into()],
            ..BenchChoice::default()
        };
        unit.connect(context.queries);
    }
}

/// Whether a unit can be reached at this source of a run, unlike a file or lock step.
fn is_place(source: &str) -> bool {
    source == "sim" || source.starts_with("serial:") || source.starts_with("tcp:")
}
