//! Test: all parts of the window on one page, each in its states; pictures of the page are compared with kept ones.

use btu_rig::procedure::{Measurement, Verdict};
use eframe::egui::{Grid, Ui};
use egui_kittest::Harness;
use egui_material_icons::icons::{ICON_BOLT, ICON_CANCEL, ICON_LINK, ICON_SCIENCE};

use super::bars::{Bar, Chart};
use super::*;
use crate::picture::{Picture, Textures};
use crate::{Density, Palette, Sizes, fonts, theme};
use ptu_report::words::Language;

/// Least difference of a colour channel that makes a pixel differ, and most pixels that may: letters are rounded.
const DIFFERS: u8 = 16;
const OTHERS: usize = 40;

/// A window with the gallery, in this language, density and theme.
fn gallery(language: Language, density: Density, dark: bool) -> Picture {
    let textures = Textures::default();
    let mut is_set = false;
    let show = move |ui: &mut Ui| {
        if is_set {
            parts(ui, language);
            return;
        }
        // Fonts can be used from the next frame on.
        is_set = true;
        let context = ui.ctx();
        fonts::set(context);
        theme::set(context);
        density.keep(context);
        context.set_theme(eframe::egui::Theme::from_dark_mode(dark));
    };
    let harness = Harness::builder().renderer(textures.clone());
    let mut harness = harness.with_size([1280.0, 800.0]).build_ui(show);
    harness.run_steps(4);
    let ground = theme::ground(&harness.ctx.global_style().visuals);
    textures.picture(
        &harness.ctx,
        harness.output(),
        ground.to_normalized_gamma_f32(),
    )
}

fn measured(value: f64, low: Option<f64>, high: Option<f64>) -> Measurement {
    let within = low.is_none_or(|low| value >= low) && high.is_none_or(|high| value <= high);
    Measurement {
        name: "eb_reaction".into(),
        value: Some(value),
        unit: "ms",
        low,
        high,
        uncertainty: None,
        limit_source: None,
        verdict: if within {
            Verdict::Passed
        } else {
            Verdict::Failed
        },
    }
}

fn parts(ui: &mut Ui, language: Language) {
    let words = language.words();
    ui.columns(3, |columns| {
        let [buttons, states, cards] = columns else {
            unreachable!("three columns");
        };
        faces(buttons, words);
        some_states(states, words);
        some_cards(cards, words);
    });
}

fn faces(ui: &mut Ui, words: &ptu_report::words::Words) {
    let frame = &words.frame;
    Grid::new("faces").num_columns(2).show(ui, |ui| {
        for (look, text) in [
            (Look::Primary, frame.connect),
            (Look::Secondary, frame.setup),
            (Look::Quiet, words.case.back),
            (Look::Chosen, frame.dark),
            (Look::Danger, words.procedures.stop),
            (Look::Acting, frame.stop_all),
            (Look::Outlined, frame.arm),
        ] {
            Face::new(look, text).icon(ICON_BOLT).show(ui);
            let why = words.procedures.connect_first;
            ui.horizontal(|ui| {
                Face::new(look, text)
                    .icon(ICON_BOLT)
                    .off(Some(why))
                    .show(ui);
            });
            ui.end_row();
        }
        for (look, text, icon) in [
            (Look::State, frame.not_connected, ICON_LINK),
            (Look::Warned, frame.link_gone, ICON_LINK),
            (Look::Dashed, frame.practice, ICON_SCIENCE),
        ] {
            Face::new(look, text).icon(icon).show(ui);
            Face::new(look, text).icon(icon).small("F9").show(ui);
            ui.end_row();
        }
    });
    let all = [(true, frame.dark), (false, frame.light)];
    segments(ui, &mut true, all);
    let mut typed = "EBR-20931".to_owned();
    Grid::new("fields").num_columns(2).show(ui, |ui| {
        let focused = field(ui, words.case.serial_new, name_edit(&mut typed, 200.0));
        focused.request_focus();
        field(ui, words.case.serial_old, name_edit(&mut typed, 200.0));
    });
}

fn some_states(ui: &mut Ui, words: &ptu_report::words::Words) {
    for verdict in [
        Verdict::Passed,
        Verdict::Failed,
        Verdict::Error,
        Verdict::Inconclusive,
        Verdict::Aborted,
        Verdict::Skipped,
    ] {
        verdict_chip(ui, verdict, words);
    }
    for (number, (is_here, is_done, can_go)) in (1..).zip([
        (false, true, true),
        (true, false, true),
        (false, false, true),
        (false, false, false),
    ]) {
        let step = Step {
            number,
            name: words.case.stage_repair,
            below: if can_go { "" } else { words.case.after_result },
            is_here,
            is_done,
            can_go,
        };
        step.show(ui, 64.0);
    }
    link(ui, words.procedures.to_report);
    fact(ui, words.common.unit, "SIM-0001");
    share_bar(ui, 0.62, Palette::of(ui).accent);
}

fn some_cards(ui: &mut Ui, words: &ptu_report::words::Words) {
    let card = Card {
        icon: ICON_CANCEL,
        word: words.case.is_failed,
        colour: Palette::of(ui).bad,
        count: "26 / 491",
        headline: words.case.no_part_explains,
    };
    let name = words.case.run;
    card.show(ui, |ui| {
        limit_scale(ui, words, (name, &measured(640.0, None, Some(472.0))));
        limit_scale(ui, words, (name, &measured(240.0, None, Some(472.0))));
        limit_scale(ui, words, (name, &measured(90.0, Some(100.0), Some(190.0))));
    });
    for measured in [
        measured(640.0, None, Some(472.0)),
        measured(240.0, None, Some(472.0)),
        measured(90.0, Some(100.0), Some(190.0)),
    ] {
        limit_bar(ui, words, (name, &measured));
    }
    let size = [ui.available_width(), Sizes::of(ui).target.max(40.0)];
    choice(ui, (words.case.unknown, ""), false, size);
    choice(
        ui,
        (words.frame.simulated, words.case.practice_hint),
        true,
        size,
    );
    let chart = Chart {
        title: words.statistics.by_cause,
        sums: true,
    };
    chart.by_name(ui, &[Bar::new("EB relay", 4347), Bar::new("FSK", 1200)]);
    let missing = (words.drive.nothing, words.drive.explained);
    empty(ui, ICON_LINK, missing, Some(words.case.back));
}

fn kept(file: &std::path::Path) -> Picture {
    let file = std::io::BufReader::new(std::fs::File::open(file).expect("a picture"));
    let mut reader = png::Decoder::new(file).read_info().expect("a picture");
    let mut rgb = vec![0; reader.output_buffer_size().expect("its size")];
    let of = reader.next_frame(&mut rgb).expect("pixels");
    Picture {
        width: of.width,
        height: of.height,
        rgb,
    }
}

/// Goal: every part looks as intended. Method: the gallery against pictures that a person has checked;
/// `SNAPSHOTS=overwrite` writes the pictures anew.
#[test]
fn the_gallery_of_parts_looks_as_its_pictures() {
    for (name, language, density, dark) in [
        ("gallery-dark", Language::English, Density::Engineer, true),
        ("gallery-light", Language::Korean, Density::Operator, false),
    ] {
        let picture = gallery(language, density, dark);
        let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let file = file.join(format!("tests/pictures/{name}.png"));
        if std::env::var_os("SNAPSHOTS").is_some_and(|how| how == "overwrite") {
            picture.write(&file);
        }
        let others = picture.other_pixels(&kept(&file), DIFFERS);
        if others > OTHERS {
            picture.write(&std::env::temp_dir().join(format!("{name}.png")));
        }
        assert!(others <= OTHERS, "{name}: {others} pixels");
    }
}
