//! Fonts: the shipped one for text, the toolkit's for scripts and symbols, and one of icons.

use eframe::egui::{Context, FontData, FontDefinitions, FontFamily};

use ptu_report::fonts::PRETENDARD;

const NAME: &str = "Pretendard";

pub fn set(context: &Context) {
    let mut fonts = FontDefinitions::default();
    fonts
        .font_data
        .insert(NAME.into(), FontData::from_static(PRETENDARD).into());
    for (family, place) in [(FontFamily::Proportional, 0), (FontFamily::Monospace, 1)] {
        let fallbacks = fonts.families.entry(family).or_default();
        fallbacks.insert(place.min(fallbacks.len()), NAME.into());
    }
    context.set_fonts(fonts);
    egui_material_icons::initialize(context);
}
