//! A state as an icon and a word: grey if all is in order, else in a colour.

use btu_rig::procedure::Verdict;
use eframe::egui::{Color32, Response, Ui};
use egui_material_icons::MaterialIcon;
use egui_material_icons::icons::{
    ICON_CANCEL, ICON_CHECK, ICON_DO_NOT_DISTURB_ON, ICON_HELP, ICON_SKIP_NEXT, ICON_WARNING,
};

use super::{Face, Look};
use crate::Palette;
use ptu_report::words::Words;

/// An icon and a word in a colour.
pub fn chip(ui: &mut Ui, (icon, text): (MaterialIcon, &str), colour: Color32) -> Response {
    Face::new(Look::State, text).icon(icon).ink(colour).show(ui)
}

pub fn verdict_chip(ui: &mut Ui, verdict: Verdict, words: &Words) -> Response {
    let (icon, colour) = verdict_look(verdict, &Palette::of(ui));
    chip(ui, (icon, words.common.verdict(verdict)), colour)
}

pub fn verdict_look(verdict: Verdict, palette: &Palette) -> (MaterialIcon, Color32) {
    match verdict {
        Verdict::Passed => (ICON_CHECK, palette.second),
        Verdict::Failed => (ICON_CANCEL, palette.bad),
        Verdict::Error => (ICON_WARNING, palette.warn),
        Verdict::Inconclusive => (ICON_HELP, palette.warn),
        Verdict::Aborted => (ICON_DO_NOT_DISTURB_ON, palette.warn),
        Verdict::Skipped => (ICON_SKIP_NEXT, palette.quiet),
    }
}
