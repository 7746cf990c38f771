//! The bar of the unit, one line: its name, its connection, its run, whether it is armed, and the stop of all units.

use btu_rig::stimulus::Stimulus;
use eframe::egui::{Align, Layout, Popup, Rect, Response, Ui, UiBuilder, pos2, vec2};
use egui_material_icons::icons::{
    ICON_ADD, ICON_BOLT, ICON_EXPAND_MORE, ICON_HELP, ICON_LINK, ICON_LINK_OFF, ICON_MEMORY,
    ICON_NOTIFICATIONS, ICON_PAUSE_CIRCLE, ICON_PLAY_CIRCLE, ICON_SCIENCE, ICON_SEARCH,
    ICON_STOP_CIRCLE, ICON_WARNING,
};
use protocol::signal::{Sample, Signal};

use super::find::Find;
use super::keys::{FIND, STOP_ALL};
use super::lock::only_look;
use super::messages;
use super::unit_menu::unit_menu;
use crate::parts::{ActionPlace, Face, Look, progress, running_text};
use crate::units::Unit;
use crate::{Page, PageContext, Sizes};
use ptu_report::naming::DOT;
use ptu_report::words::{self, fill};
use ptu_runs::bench_worker::Phase;
use ptu_runs::table::cut;

/// Gap between two items of the bar, points.
const GAP: f32 = 8.0;
/// Width of the progress bar of a run, points.
const RUN_BAR: f32 = 72.0;
/// Most letters of a name that are shown.
const NAME: usize = 24;

/// Parts that a narrow bar leaves out, in this order; each value leaves out the earlier parts, too.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Without {
    Nothing,
    Subtitle,
    Practice,
    FindKey,
    RunBar,
    LinkWord,
    Find,
    Keys,
    OtherUnits,
    States,
}

impl Without {
    const ALL: [Self; 10] = [
        Self::Nothing,
        Self::Subtitle,
        Self::Practice,
        Self::FindKey,
        Self::RunBar,
        Self::LinkWord,
        Self::Find,
        Self::Keys,
        Self::OtherUnits,
        Self::States,
    ];
}

/// An item of the bar, by what a click on it does.
#[derive(Clone, Copy, PartialEq, Eq)]
enum What {
    Unit(usize),
    Add,
    State,
    Cancel,
    Run,
    RunBar,
    Find,
    Bell,
    Arm,
    Disarm,
    StopAll,
}

type Item = (What, Face<'static>);

pub fn bar(find: &mut Find, ui: &mut Ui, context: &mut PageContext<'_>) {
    ui.spacing_mut().interact_size.y = Sizes::of(ui).bar - GAP;
    ui.spacing_mut().item_spacing.x = GAP;
    let all = |ui: &Ui, items: &[Item]| items.iter().map(|item| wide(ui, item) + GAP).sum::<f32>();
    let room = ui.max_rect();
    let both = |without| (left(context, without), right(context, without));
    let fits =
        |(left, right): &(Vec<Item>, Vec<Item>)| all(ui, left) + all(ui, right) <= room.width();
    let fitting = Without::ALL.into_iter().map(both).find(fits);
    let (left, right) = fitting.unwrap_or_else(|| both(Without::States));
    let from_right = all(ui, &right) - GAP;
    let high = ui.spacing().interact_size.y;
    for (items, mut x) in [(left, room.left()), (right, room.right() - from_right)] {
        for item in items {
            let size = vec2(wide(ui, &item), high);
            let place = Rect::from_min_size(pos2(x, room.center().y - high / 2.0), size);
            x += size.x + GAP;
            let place = UiBuilder::new().max_rect(place);
            let place = place.layout(Layout::left_to_right(Align::Center));
            ui.scope_builder(place, |ui| shown(find, ui, &item, context));
        }
    }
}

fn wide(ui: &Ui, (what, face): &Item) -> f32 {
    match what {
        What::RunBar => RUN_BAR,
        _ => face.wide(ui),
    }
}

fn shown(find: &mut Find, ui: &mut Ui, (what, face): &Item, context: &mut PageContext<'_>) {
    ui.scope(|ui| {
        if context.settings.is_locked() && !matches!(what, What::StopAll | What::Bell) {
            only_look(ui);
        }
        match what {
            What::RunBar => {
                if let Some(run) = &context.units.chosen().run {
                    progress(ui, vec2(RUN_BAR, 4.0), run, context.words);
                }
            }
            What::Arm => {
                let unit = context.units.chosen();
                let place = ActionPlace::new(ui, "arming", (unit.id, false));
                if face.held(ui, &place) {
                    unit.bench.arm();
                }
            }
            _ => {
                let response = face.show(ui);
                act(find, *what, &response, ui, context);
            }
        }
    });
}

fn act(find: &mut Find, what: What, response: &Response, ui: &Ui, context: &mut PageContext<'_>) {
    let chosen = context.units.chosen_place();
    match what {
        What::Unit(place) if place == chosen => {
            Popup::menu(response).show(|ui| unit_menu(ui, context));
        }
        What::Unit(place) if response.clicked() => context.units.choose(place),
        What::Find if response.clicked() => find.toggle(context),
        What::Bell => messages::bell(response, context),
        What::Run if response.clicked() => context.settings.page = Page::Procedures,
        What::StopAll if response.clicked() => context.units.stop_all(),
        What::Add if response.clicked() => {
            let choice = context.units.chosen().choice.clone();
            if let Err(failure) = context.units.add(choice) {
                let said = context.words.frame.cannot_connect;
                context.messages.trouble(said, failure.message);
            }
        }
        What::Cancel => {
            let unit = context.units.chosen_mut();
            let place = ActionPlace::new(ui, "connection", (unit.id, true));
            if place.clicked(response) {
                unit.disconnect();
            }
        }
        What::Disarm => {
            let unit = context.units.chosen();
            let place = ActionPlace::new(ui, "arming", (unit.id, true));
            if place.clicked(response) {
                // Refused only while a run has the bench, and then the button is disabled.
                let _ = unit.bench.apply(Stimulus::PtuDisarm);
            }
        }
        _ => {}
    }
}

fn left(context: &PageContext<'_>, without: Without) -> Vec<Item> {
    let words = &context.words.frame;
    let mut items = Vec::new();
    let chosen = context.units.chosen_place();
    for (place, unit) in context.units.iter().enumerate() {
        if place == chosen {
            items.push((What::Unit(place), unit_face(unit, words, without)));
        } else if without < Without::OtherUnits {
            let name = format!("{}: {}", place + 1, unit.name());
            items.push((What::Unit(place), Face::new(Look::Quiet, name)));
        }
    }
    let all = without < Without::States;
    if all {
        let add = Face::new(Look::Quiet, "").icon(ICON_ADD);
        items.push((What::Add, add.named(words.add_unit)));
    }
    let unit = context.units.chosen();
    link(unit, context.words, without, &mut items);
    let setup = unit.setup.value().filter(|_| all);
    if let Some(setup) = setup.filter(|setup| !setup.faults.is_empty()) {
        let said = fill(words.practice_faults, &[("n", &setup.faults.len())]);
        let face = shown_if(without < Without::Practice, &said);
        let face = Face::new(Look::Dashed, face).icon(ICON_SCIENCE);
        let names = setup.injected().unwrap_or_default();
        items.push((What::State, face.named(said).hint(names)));
    }
    run(unit, context.words, without, &mut items);
    states(context, all, &mut items);
    items
}

/// The words if there is room for them, else nothing.
fn shown_if(has_room: bool, said: &str) -> String {
    String::from(if has_room { said } else { "" })
}

fn unit_face(unit: &Unit, words: &words::Frame, without: Without) -> Face<'static> {
    let place = match unit.choice.is_simulated() {
        true => words.simulated.to_owned(),
        false => unit.choice.endpoint.clone(),
    };
    let serial = unit.serial();
    let name = serial.clone().unwrap_or_else(|| place.clone());
    let mut small = vec![place];
    if serial.is_none() {
        small.clear();
    }
    small.push(unit.choice.line.clone());
    let shown = shown_if(without < Without::States, &cut(&name, NAME));
    let face = Face::new(Look::Secondary, shown).icon(ICON_MEMORY);
    let face = face.named(name).end(ICON_EXPAND_MORE);
    match without < Without::Subtitle {
        true => face.small(small.join(DOT)),
        false => face,
    }
}

/// Connection of the unit, and its quality.
fn link(unit: &Unit, words: &words::Words, without: Without, items: &mut Vec<Item>) {
    let common = &words.common;
    let words = &words.frame;
    let share = unit.bench.live().link.share();
    let (look, icon, said) = match unit.phase() {
        _ if unit.lost => (Look::Warned, ICON_LINK_OFF, words.link_gone.to_owned()),
        Phase::Offline => (Look::State, ICON_LINK_OFF, words.not_connected.to_owned()),
        Phase::Connecting => (Look::State, ICON_LINK, words.connecting.to_owned()),
        _ if share.is_none() => (Look::State, ICON_LINK, words.connected.to_owned()),
        Phase::Idle | Phase::Running | Phase::MakingSafe => {
            let share = 100.0 * share.unwrap_or_default();
            let said = format!("{}", (share * 10.0).floor() / 10.0);
            let look = if share >= 99.95 {
                Look::State
            } else {
                Look::Warned
            };
            (look, ICON_LINK, fill(words.link_good, &[("share", &said)]))
        }
    };
    let shown = shown_if(without < Without::LinkWord, &said);
    if look == Look::Warned || without < Without::States {
        items.push((What::State, Face::new(look, shown).icon(icon).named(said)));
    }
    if unit.phase() == Phase::Connecting {
        items.push((What::Cancel, Face::new(Look::Quiet, common.cancel)));
    }
}

/// State of the unit's run, on every page.
fn run(unit: &Unit, words: &words::Words, without: Without, items: &mut Vec<Item>) {
    let Some(run) = unit.run.as_ref().filter(|run| run.is_running()) else {
        return;
    };
    let present = run.present.as_ref();
    let (look, icon, said) = if present.is_some_and(|present| present.prompt.is_some()) {
        (Look::Warned, ICON_HELP, words.frame.asks.to_owned())
    } else if present.is_some_and(|present| present.paused.is_some()) {
        (
            Look::Warned,
            ICON_PAUSE_CIRCLE,
            words.frame.is_paused.to_owned(),
        )
    } else {
        (Look::Quiet, ICON_PLAY_CIRCLE, running_text(run, words))
    };
    let is_button = look == Look::Quiet || present.is_some_and(|present| present.prompt.is_some());
    let look = if is_button { Look::Quiet } else { look };
    items.push((What::Run, Face::new(look, said).icon(icon)));
    if without < Without::RunBar {
        items.push((What::RunBar, Face::new(Look::State, "")));
    }
}

/// Other states that need a look, with their words or as icons alone.
fn states(context: &PageContext<'_>, with_words: bool, items: &mut Vec<Item>) {
    let words = context.words;
    let unit = context.units.chosen();
    let warned = |said: String, hint: String| {
        let shown = if with_words { &*said } else { "" };
        let shown = cut(shown, NAME).into_owned();
        let face = Face::new(Look::Warned, shown).icon(ICON_WARNING);
        (What::State, face.named(said).hint(hint))
    };
    let sample = &unit.bench.live().sample;
    if let Some(differs) = differs_from_record(sample, &words.frame).filter(|_| unit.is_connected())
    {
        items.push(warned(differs.clone(), differs));
    }
    if context.only_reads().is_some() {
        let server = context.queries.paths.database.display().to_string();
        let said = fill(words.care.reads, &[("server", &server)]);
        let hint = format!("{said}. {}", words.care.is_server);
        items.push(warned(said, hint));
    }
    if context.units.iter().any(|unit| unit.stopping) {
        items.push(warned(
            words.frame.stopping.to_owned(),
            words.frame.stopping.to_owned(),
        ));
    }
}

/// Difference of the unit from the record of its train, as text.
fn differs_from_record(sample: &Sample, frame: &words::Frame) -> Option<String> {
    let compared = [
        (Signal::IdentitySerial, frame.recorded_serial),
        (Signal::IdentitySoftware, frame.recorded_software),
        (Signal::IdentityConfig, frame.recorded_config),
        (Signal::IdentityLine, frame.recorded_line),
    ];
    let differs = |(signal, _): &(Signal, &str)| sample.get(*signal) == Some(0.0);
    let parts: Vec<_> = compared.into_iter().filter(differs).collect();
    let what: Vec<_> = parts.iter().map(|(_, name)| *name).collect();
    (!what.is_empty()).then(|| fill(frame.not_as_recorded, &[("what", &what.join(", "))]))
}

fn right(context: &PageContext<'_>, without: Without) -> Vec<Item> {
    let words = &context.words.frame;
    let mut items = Vec::new();
    if without < Without::Find {
        let key = if without < Without::FindKey { FIND } else { "" };
        let find = Face::new(Look::Quiet, "").icon(ICON_SEARCH).small(key);
        items.push((What::Find, find.named(words.find_anything)));
    }
    let n = context.messages.all.len();
    let count = if n > 0 { n.to_string() } else { String::new() };
    let bell = Face::new(Look::Quiet, count).icon(ICON_NOTIFICATIONS);
    items.push((What::Bell, bell.named(words.messages)));
    let chosen = context.units.chosen_place();
    for (place, other) in context.units.iter().enumerate() {
        if place != chosen && other.is_armed() {
            let said = fill(words.armed_unit, &[("unit", &other.name())]);
            items.push((What::State, Face::new(Look::Acting, said).icon(ICON_BOLT)));
        }
    }
    let unit = context.units.chosen();
    let keys = without < Without::Keys;
    let small = |text: &'static str| if keys { text } else { "" };
    if unit.is_armed() && unit.is_connected() {
        let sign = Face::new(Look::Acting, words.armed).icon(ICON_BOLT);
        items.push((What::State, sign.hint(words.armed_hint)));
        let may = unit.bench.permits(&Stimulus::PtuDisarm).is_ok();
        let face = Face::new(Look::Secondary, words.disarm);
        let face = face.because((!may).then_some(context.words.case.under_way));
        items.push((What::Disarm, face));
    } else if !matches!(unit.phase(), Phase::Offline | Phase::Connecting) {
        let face = Face::new(Look::Outlined, words.arm).icon(ICON_BOLT);
        let face = face.small(small(words.hold)).hint(words.arm_hint);
        let why_not = match unit.phase() {
            Phase::Idle => None,
            Phase::Running => Some(context.words.case.under_way),
            _ => Some(words.stopping),
        };
        items.push((What::Arm, face.because(why_not)));
    }
    let acts = |unit: &Unit| unit.phase() == Phase::Running || unit.is_armed() || unit.stopping;
    let look = match context.units.iter().any(acts) {
        true => Look::Acting,
        false => Look::Danger,
    };
    let stop = Face::new(look, words.stop_all).icon(ICON_STOP_CIRCLE);
    items.push((What::StopAll, stop.small(small(STOP_ALL.name()))));
    items
}
