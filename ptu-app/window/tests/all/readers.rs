//! The readers' monitor in the window: made runs, each as its pages tell it to a screen reader.

use ptu_options::Page;
use ptu_report::naming::DOT;
use ptu_report::words::Language;
use ptu_runs::clock;

use crate::common::made_runs::Maker;
use crate::common::told::{Monitor, Told, candidates, conclusion, count, fact, sheet, verdict};
use crate::common::window::{Window, settings_in};
use crate::common::{Place, scripts};

/// Goal: the window tells of a run what every other reader of it tells. Method: made runs of six kinds, one of which can be
/// diagnosed, in a window so tall that all of a sheet is in view; the list of runs, the sheet and the diagnosis of each in
/// both languages.
#[test]
fn the_window_tells_the_facts_of_every_run() {
    let place = Place::new();
    let mut maker = Maker::new(place.path("history.db"), &scripts());
    let mut made: Vec<_> = [3, 6, 8, 9, 11, 13].map(|seed| maker.make(seed)).into();
    let store = maker.store();
    let mut monitor = Monitor::default();
    let mut place = Some(place);
    for language in Language::ALL {
        let settings = settings_in(language, Page::Report);
        let size = [1280.0, 9_000.0];
        let mut window = Window::sized(size, place.take().expect("a place"), scripts(), settings);
        // Names have letters of which the font has no picture.
        let tofu = eframe::egui::MissingGlyphPolicy::Tofu;
        window.harness().ctx.set_missing_glyph_policy(tofu);
        for run in &mut made {
            let began = clock::local(store.run(run.id).expect("recorded").run.started_at_us);
            let name = [&*began, &*format!("M-{}", run.seed)].join(DOT);
            window.page(Page::Report);
            window.click_for(&name, &run.id.to_string());
            let shown = window.shown();
            let row = shown.iter().position(|text| *text == name).expect("listed");
            let state = verdict(&shown[row + 1], language).expect("a verdict");
            // A list of runs reads no steps, and cannot say what the others need.
            let mut told = count(&shown[row + 2], language).expect("a count");
            told.retain(|(name, _)| {
                !["need the bench", "folders on the bench"].contains(&&**name)
                    && !name.starts_with("sentence")
            });
            told.push(fact("verdict", state));
            monitor.hold(&mut run.facts, "list in the window", told);
            let begins = shown.iter().position(|text| text.contains(&run.id.short()));
            let of_sheet = &shown[begins.expect("the head of the sheet")..];
            let told = sheet(of_sheet, language);
            monitor.hold(&mut run.facts, "sheet in the window", told);
            window.page(Page::Diagnosis);
            window.click(&name);
            let heading = run.facts.known[&format!("conclusion {}", language.code())].clone();
            window.wait_for(&heading);
            let shown = window.shown();
            monitor.hold(&mut run.facts, "diagnosis in the window", possible(&shown));
            monitor.hold(
                &mut run.facts,
                "headline in the window",
                conclusion(&heading, language),
            );
        }
        place = Some(window.place);
    }
    monitor.finish(375);
}

/// What may be the cause, behind its share: a part's fault by its identifier, "eb_relay.slow", or else no fault.
fn possible(shown: &[String]) -> Told {
    let share = |at: &usize| {
        shown[*at]
            .strip_suffix(" %")
            .filter(|share| share.parse::<f64>().is_ok())
    };
    let rows = (0..shown.len()).filter_map(|at| Some((at, share(&at)?)));
    let rows = rows.filter_map(|(at, share)| {
        let is_fault = |text: &&String| !text.contains(' ') && text.contains('.');
        let fault = shown[at + 1..].iter().take(3).find(is_fault);
        let part = fault
            .and_then(|fault| fault.split('.').next())
            .unwrap_or("no fault");
        (!shown[at + 1].contains(" + ")).then(|| (part.to_owned(), share.to_owned()))
    });
    candidates(rows.collect())
}
