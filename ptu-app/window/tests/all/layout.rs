//! Where the window's widgets are: none out of reach, none over another, none too low to be hit, no text cut.

use std::collections::BTreeMap;

use crate::common::window::{Window, settings};
use crate::common::{Place, record_bad_unit, scripts};
use eframe::egui::accessibility::is_input;
use eframe::egui::epaint::ClippedShape;
use eframe::egui::{Key, Rect, Role, Shape, WidgetRect};
use egui_kittest::kittest::{NodeT, Queryable};
use fuzzing::draw;
use ptu_options::Page;
use ptu_report::words::{Language, Words};
use ptu_window::Density;

/// The usual window, the smallest, the usual one at 150 %, and a wide one, points.
pub const SIZES: [[f32; 2]; 4] = [
    [1280.0, 800.0],
    [900.0, 600.0],
    [853.0, 533.0],
    [1920.0, 1080.0],
];
/// Least height of anything that can be clicked, points.
const LOWEST: f32 = 28.0;
/// Tolerance for lines and rounding, points.
const SLACK: f32 = 1.5;
/// Least height of a part of a page that scrolls, points; a lower one was made for one line of text.
const SCROLLS: f32 = 60.0;

/// Goal: everything on every page can be read and clicked in every window. Method: a unit with a slow relay is tested; each page, the
/// setup and the form of a repair are laid out at four sizes in both languages and densities, of which the check draws a quarter, half of
/// them in a dark window, and what lies wrong is listed.
#[test]
fn every_page_can_be_read_and_clicked_at_every_size() {
    let mut wrong = Vec::new();
    let densities = [Density::Operator, Density::Engineer];
    let looks = Language::ALL.map(|language| densities.map(|density| (language, density)));
    let all = SIZES
        .into_iter()
        .flat_map(|size| looks.as_flattened().iter().map(move |look| (size, *look)));
    for (size, (language, density)) in draw::drawn(all, 4) {
        let dark = (density == Density::Engineer) == (language == Language::English);
        let said = format!("{} {language:?} {density:?} dark {dark}", size[0]);
        laid_out(size, (language, density, dark), &mut |window, what| {
            let found = complaints(window).into_iter();
            wrong.extend(found.map(|found| format!("{said} {what}: {found}")));
            window.keep_picture(&format!("{what} {said}"));
        });
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

fn laid_out(
    size: [f32; 2],
    (language, density, dark): (Language, Density, bool),
    look: &mut dyn FnMut(&mut Window, &str),
) {
    let place = Place::new();
    // In a train whose distance is known.
    let in_train = "run tcms/link --serial-no OLD-1 --train-no 612";
    place.ptu(in_train).exits(0);
    record_bad_unit(&place);
    let words = language.words();
    let mut settings = settings(Page::Faults);
    (settings.language, settings.density) = (language, density);
    settings.dark = Some(dark);
    settings.operator = "kim".into();
    settings.unit.faults = vec!["eb_relay.slow".into()];
    let readings = "train,date,km\n612,2020-01-01,0\n612,2099-01-01,9000000\n";
    settings.distances = place.write("odometers.csv", readings);
    let mut window = Window::sized(size, place, scripts(), settings);
    let relay = language.choose(["EB relay · ", "비상제동 계전기 · "]);
    window.wait_for_part(relay);
    look(&mut window, "faults");
    window.click_part(relay);
    window.wait_for(words.faults.what_was_done);
    look(&mut window, "fault");
    window.click_for(words.faults.repair, words.faults.serial_new);
    look(&mut window, "repair");
    window.key(Key::Escape);
    let sheet = language.choose(["Unit BAD-1, run", "장치 BAD-1, 시험"]);
    for (page, said) in [
        (Page::Traces, words.traces.events),
        (Page::Diagnosis, words.diagnosis.reasons),
        (Page::Report, sheet),
        (Page::Statistics, words.statistics.mtbf_is),
    ] {
        window.page(page);
        window.wait_for_part(said);
        look(&mut window, page.name(words));
        if page == Page::Traces {
            window.click_last(words.traces.signals);
            window.wait_for(words.traces.layouts);
            look(&mut window, "signals of a trace");
            window.click_last(words.traces.signals);
            window.click(words.traces.cursor_a);
            window.write(words.traces.note_field, &"a note of many words ".repeat(12));
            window.click_for_part(words.report.note_save, " s a note of many words");
            // The bar of messages, which says that it is stored, takes some frames to open.
            window.harness().run_steps(30);
            look(&mut window, "note on a trace");
            let hovered = eframe::egui::HoveredFile::default();
            window.harness().input_mut().hovered_files.push(hovered);
            look(&mut window, "file over the traces");
            window.harness().input_mut().hovered_files.clear();
        }
    }
    window.page(Page::Drive);
    window.click_for(words.drive.drive, words.drive.report);
    look(&mut window, "drive");
    window.page(Page::Signals);
    window.click_for(words.signals.generator, words.signals.made);
    look(&mut window, "generator");
    window.click(words.signals.recording_of);
    for make in [
        ["code", "55", "signal.wav"],
        ["twc", "01 fe 3c 01 fe 3c 01 fe 3c", "twc.wav"],
    ] {
        let made = window.place.ptu(&[&["signal", "make"][..], &make].concat());
        made.exits(0);
        let file = window.place.text_path(make[2]);
        window.name_file(words.common.file, &file);
        window.click_for_part(words.signals.open, make[1]);
        look(&mut window, make[2]);
    }
    window.page(Page::Statistics);
    window.write(words.life.search, "BAD-1");
    window.click_for(words.life.show, words.life.stored);
    look(&mut window, "life");
    // A low window has it in the menu.
    if !window.shows(words.care.title) {
        window.click(words.frame.menu);
    }
    window.click_for(words.care.title, words.care.never_synced);
    look(&mut window, "care");
    window.key(Key::Escape);
    window.set_up();
    window.wait_for(words.frame.serial);
    look(&mut window, "setup");
    window.click_for(words.frame.practice, "eb_relay.slow");
    look(&mut window, "practice");
    window.key(Key::Escape);
    window.click(words.frame.menu);
    window.step();
    look(&mut window, "menu");
    window.key(Key::Escape);
    window.connect_simulated();
    window.page(Page::Bench);
    window.wait_for(words.bench.group_atp);
    look(&mut window, "bench");
    armed(&mut window, words);
    look(&mut window, "armed");
    window.page(Page::Procedures);
    // In a narrow window the tree is a drawer.
    let is_drawer = size[0] < 1_100.0;
    if is_drawer {
        window.step();
        window.click_last(words.procedures.title);
    }
    window.wait_for(words.language.choose([
        "Overspeed: alarm, service brake, emergency brake",
        "과속에 따른 ATP 제동 체결",
    ]));
    look(&mut window, "procedures");
    if is_drawer {
        window.key(Key::Escape);
    }
    window.click(words.procedures.live_signals);
    window.step();
    look(&mut window, "live signals");
    window.click(words.procedures.run);
    // The rail has a page of the name of the button that leads to the sheet.
    window.until("the end of the run", |window| window.run_id().is_some());
    window.wait_for_part("(eb_relay, ");
    look(&mut window, "results");
}

fn armed(window: &mut Window, words: &Words) {
    window.hold(words.frame.arm, 1.3);
    window.wait_for(words.frame.armed);
    // How a window says it is, is part of the bar's layout.
    window.step();
}

/// Everything in the last frame that cannot be read or clicked.
pub fn complaints(window: &mut Window) -> Vec<String> {
    complaints_of(window, LOWEST)
}

/// Complaints where each thing that can be clicked has to be at least `lowest` points high.
pub fn complaints_of(window: &mut Window, lowest: f32) -> Vec<String> {
    window.step();
    let harness = window.harness();
    let known: BTreeMap<u64, (Role, String)> = harness
        .query_all_by(|_| true)
        .map(|node| {
            let node = node.accesskit_node();
            let name = node.label().or_else(|| node.value()).unwrap_or_default();
            // The number of the tree stands behind that of the widget.
            ((u128::from(node.id()) >> 64) as u64, (node.role(), name))
        })
        .collect();
    let widgets: Vec<WidgetRect> = harness.ctx.viewport(|viewport| {
        let all = viewport.prev_pass.widgets.layers();
        all.flat_map(|(_, widgets)| widgets).copied().collect()
    });
    let screen = harness.ctx.content_rect();
    let bars: Vec<Rect> = widgets
        .iter()
        .filter(|widget| {
            let role = known.get(&widget.id.value()).map(|(role, _)| *role);
            role.map_or(widget.sense.senses_drag(), |role| role == Role::ScrollBar)
        })
        .map(|widget| widget.rect)
        .collect();
    let mut wrong = Vec::new();
    let inputs: Vec<Input<'_>> = widgets
        .iter()
        .filter_map(|widget| {
            let (role, name) = known.get(&widget.id.value())?;
            // A divider is a line.
            let is_meant = is_input(*role) && !matches!(role, Role::Splitter | Role::ScrollBar);
            is_meant.then_some(Input {
                widget,
                role: *role,
                name,
            })
        })
        .collect();
    for (place, input) in inputs.iter().enumerate() {
        wrong.extend(input.misplaced(screen, &bars, lowest));
        for other in inputs.iter().skip(place + 1) {
            let both = input
                .widget
                .interact_rect
                .intersect(other.widget.interact_rect);
            let seen = both.is_positive() && both.size().min_elem() > SLACK;
            if input.widget.layer_id == other.widget.layer_id && seen {
                wrong.push(format!("{} and {} overlap", input.name, other.name));
            }
        }
    }
    let fields: Vec<Rect> = inputs
        .iter()
        .filter(|input| matches!(input.role, Role::TextInput | Role::MultilineTextInput))
        .map(|input| input.widget.rect)
        .collect();
    for ClippedShape {
        clip_rect, shape, ..
    } in &harness.output().shapes
    {
        texts(shape, *clip_rect, &bars, &fields, &mut wrong);
    }
    wrong
}

/// Something to click or to write in.
struct Input<'a> {
    widget: &'a WidgetRect,
    role: Role,
    name: &'a str,
}

impl Input<'_> {
    fn misplaced(&self, screen: Rect, bars: &[Rect], lowest: f32) -> Option<String> {
        let rect = self.widget.rect;
        let seen = self.widget.interact_rect.intersect(screen);
        let what = if rect.height() < lowest - 0.1 {
            format!("is {} high", rect.height())
        } else if seen.width() < rect.width() - SLACK && !scrolls_sideways(seen, bars) {
            format!("is cut at its side: {rect} seen {seen}")
        } else if seen.height() < rect.height() - SLACK && !scrolls(rect, bars) {
            format!("is out of reach: {rect} seen {seen}")
        } else {
            return None;
        };
        Some(format!("{:?} {:?} {what}", self.role, self.name))
    }
}

/// The widget ends where an area that scrolls up and down ends.
fn ends_with_scrolling(clip: Rect, bars: &[Rect]) -> bool {
    bars.iter().any(|bar| {
        let ends = (bar.top() - clip.top(), bar.bottom() - clip.bottom());
        bar.width() <= 20.0 && ends.0.abs().min(ends.1.abs()) < 12.0
    })
}

/// Whether a bar scrolls this area up and down.
fn scrolls(rect: Rect, bars: &[Rect]) -> bool {
    bars.iter()
        .any(|bar| bar.width() <= 20.0 && bar.height() >= 40.0 && bar.center().x >= rect.left())
}

/// Whether a bar scrolls this area to the side.
fn scrolls_sideways(seen: Rect, bars: &[Rect]) -> bool {
    bars.iter()
        .any(|bar| bar.height() <= 20.0 && bar.width() >= 40.0 && bar.center().y >= seen.top())
}

fn texts(shape: &Shape, clip: Rect, bars: &[Rect], fields: &[Rect], wrong: &mut Vec<String>) {
    let text = match shape {
        Shape::Vec(shapes) => {
            for shape in shapes {
                texts(shape, clip, bars, fields, wrong);
            }
            return;
        }
        Shape::Text(text) if text.angle == 0.0 => text,
        _ => return,
    };
    let rect = text.visual_bounding_rect();
    let in_field = fields
        .iter()
        .any(|field| field.expand(SLACK).contains_rect(clip));
    if !rect.is_positive() || !rect.intersects(clip) || in_field {
        return;
    }
    let beside = (clip.left() - rect.left()).max(rect.right() - clip.right());
    let beyond = (clip.top() - rect.top()).max(rect.bottom() - clip.bottom());
    let sideways = beside > SLACK && !scrolls_sideways(clip, bars);
    if sideways || (beyond > SLACK && clip.height() < SCROLLS && !ends_with_scrolling(clip, bars)) {
        wrong.push(format!(
            "text {:?} is cut: {rect} in {clip}",
            text.galley.text()
        ));
    }
}

/// Goal: the bar is one line, in which all can be stopped, at every size. Method: an armed unit with an injected fault in the smallest
/// window, at 150 % too, and in the usual one, for an operator and an engineer; all pages are reached.
#[test]
fn the_bar_is_one_line_and_every_page_is_reached_at_every_size() {
    let sizes = SIZES.into_iter().chain([[600.0, 400.0]]);
    let densities = [Density::Operator, Density::Engineer];
    let all = sizes.flat_map(|size| densities.map(|density| (size, density)));
    for (size, density) in all {
        for language in draw::drawn(Language::ALL, 2) {
            let words = language.words();
            let mut settings = settings(Page::Statistics);
            (settings.language, settings.density) = (language, density);
            settings.unit.faults = vec!["eb_relay.slow".into()];
            let mut window = Window::sized(size, Place::new(), scripts(), settings);
            window.connect_simulated();
            armed(&mut window, words);
            window.wait_for(words.statistics.nothing);
            let said = format!("{size:?} {density:?} {language:?}");
            let wrong = complaints(&mut window);
            assert!(wrong.is_empty(), "{said}: {wrong:#?}");
            let harness = window.harness();
            for name in ["SIM-0001", words.frame.disarm, words.frame.stop_all] {
                let rect = harness.get_by_label(name).rect();
                // Below the margin of the harness.
                let bar = density.sizes().bar + 8.0;
                assert!(
                    rect.bottom() <= bar && rect.right() <= size[0],
                    "{said} {name} {rect}"
                );
            }
            for page in Page::ALL {
                window.click(page.name(words));
                assert_eq!(window.app().page(), page, "{said}");
            }
        }
    }
}
