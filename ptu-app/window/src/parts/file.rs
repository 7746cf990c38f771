//! Choice of the file to read or write; first proposed is the folder for documents.

use std::path::{Path, PathBuf};

use eframe::egui::{Label, RichText, Ui};
use egui_material_icons::icons::ICON_FOLDER_OPEN;

use super::{Face, Look, caption, find_edit, menu};
use crate::Palette;

/// Width of the field for a path, points.
const FIELD: f32 = 420.0;

/// The folder for documents; if there is none, the folder in which the program was started.
pub fn usual_folder() -> PathBuf {
    directories::UserDirs::new()
        .and_then(|folders| folders.document_dir().map(Path::to_path_buf))
        .filter(|folder| folder.is_dir())
        .or_else(|| std::env::current_dir().ok())
        .unwrap_or_default()
}

/// A button that opens the field for the path, and beside it the name of the file.
pub fn file_place(ui: &mut Ui, path: &mut String, (name, hint): (&str, &str)) {
    ui.horizontal(|ui| {
        let face = Face::new(Look::Quiet, "").icon(ICON_FOLDER_OPEN);
        menu(ui, &face.named(name).hint(name), |ui| {
            caption(ui, hint);
            find_edit(ui, path, name, FIELD);
        });
        let file = Path::new(path.trim()).file_name().unwrap_or_default();
        let file = RichText::new(file.to_string_lossy()).color(Palette::of(ui).second);
        ui.add(Label::new(file).truncate())
            .on_hover_text(path.as_str());
    });
}
