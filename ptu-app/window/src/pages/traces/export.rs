//! Exports the view as a picture or as a table.

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver};

use eframe::egui::{Button, ColorImage, Rect, Ui};
use egui_material_icons::icons::ICON_DOWNLOAD;
use fault_db::Id;

use crate::PageContext;
use crate::parts::{Face, Look, menu, name_input, path_edit, usual_folder};
use crate::query_worker::Pending;
use ptu_report::trace_view::csv::csv;
use ptu_report::trace_view::{Kind, TracePlot};
use ptu_report::words::fill;
use ptu_runs::new_file::{NewFile, cannot_write};

/// File name of the export, and exports under way.
#[derive(Default)]
pub struct Export {
    /// Path without extension.
    pub name: String,
    /// Screenshot of the window that was requested, the part of it to save, and its pixels per point.
    picture: Option<(Receiver<Arc<ColorImage>>, Rect, f32)>,
    writing: Vec<Pending<PathBuf>>,
}

impl Export {
    /// The menu that saves; `rect` = part of the window for the picture.
    pub fn bar(
        &mut self,
        ui: &mut Ui,
        scene: &TracePlot,
        (rect, roomy): (Rect, bool),
        context: &PageContext<'_>,
    ) {
        let save = context.words.traces.save;
        let face = Face::new(Look::Quiet, if roomy { save } else { "" });
        let face = face.icon(ICON_DOWNLOAD).named(save).hint(save);
        menu(ui, &face, |ui| self.menu(ui, scene, rect, context));
    }

    fn menu(&mut self, ui: &mut Ui, scene: &TracePlot, rect: Rect, context: &PageContext<'_>) {
        let words = &context.words.traces;
        ui.label(context.words.common.file);
        let edit = ui.add(path_edit(&mut self.name, 260.0));
        name_input(&edit, words.file_name);
        let edit = edit.on_hover_text(words.file_name);
        let named = !self.name.trim().is_empty();
        if ui.add_enabled(named, Button::new(words.save_png)).clicked() {
            // The text cursor is not to be part of the picture.
            edit.surrender_focus();
            ui.close();
            let (sender, receiver) = mpsc::channel();
            let wake = context.queries.wake.clone();
            ui.ctx().request_screenshot(move |image| {
                // The receiver is gone if another trace was opened meanwhile.
                let _ = sender.send(image);
                wake();
            });
            self.picture = Some((receiver, rect, ui.pixels_per_point()));
        }
        if ui.add_enabled(named, Button::new(words.save_csv)).clicked() {
            self.write_csv(scene, context);
            ui.close();
        }
    }

    pub fn poll(&mut self, context: &mut PageContext<'_>) {
        let taken = self
            .picture
            .as_ref()
            .and_then(|(receiver, rect, scale)| Some((receiver.try_recv().ok()?, *rect, *scale)));
        if let Some((image, rect, scale)) = taken {
            self.picture = None;
            let name = self.name.clone();
            let question = move |_: &_| {
                let part = image.region(&rect, Some(scale));
                let place = with_ending(&name, "png");
                let mut file = NewFile::begin_beside(&place)?;
                encode(&part, &mut file).map_err(|error| cannot_write(&place, &error))?;
                file.finish_beside()
            };
            self.writing.push(context.queries.run(question));
        }
        let words = context.words;
        self.writing.retain(|pending| match pending.take() {
            None => true,
            Some(Ok(path)) => {
                let file = path.display().to_string();
                context
                    .messages
                    .note(fill(words.common.saved, &[("file", &file)]));
                false
            }
            Some(Err(failure)) => {
                context
                    .messages
                    .trouble(words.traces.cannot_save, failure.message);
                false
            }
        });
    }

    fn write_csv(&mut self, scene: &TracePlot, context: &PageContext<'_>) {
        let opened = scene.opened.clone();
        let channels: Vec<usize> = scene.lanes.iter().filter_map(|lane| lane.place).collect();
        let rows = scene.rows_in_view();
        let axis = (scene.axis.kind() == Kind::Distance).then(|| scene.axis.clone());
        let name = self.name.clone();
        let question = move |_: &_| {
            let place = with_ending(&name, "csv");
            let mut file = NewFile::begin_beside(&place)?;
            let data = opened.view.data();
            let written = csv(&mut file, data, &channels, rows, axis.as_ref());
            written.map_err(|error| cannot_write(&place, &error))?;
            file.finish_beside()
        };
        self.writing.push(context.queries.run(question));
    }
}

/// Proposed path for exports of a trace, without extension.
pub fn usual_name(id: Id) -> String {
    let file = usual_folder().join(format!("trace-{}", id.short()));
    file.display().to_string()
}

/// The name with this extension, added unless it was typed.
fn with_ending(name: &str, ending: &str) -> PathBuf {
    let name = name.trim();
    let name = name.strip_suffix(&format!(".{ending}")).unwrap_or(name);
    format!("{name}.{ending}").into()
}

fn encode(image: &ColorImage, file: impl Write) -> Result<(), png::EncodingError> {
    let [width, height] = image.size.map(|n| u32::try_from(n).unwrap_or(u32::MAX));
    let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let pixels: Vec<u8> = image.pixels.iter().flat_map(|p| p.to_array()).collect();
    encoder.write_header()?.write_image_data(&pixels)
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use super::*;

    #[test]
    fn a_typed_file_extension_is_not_added_twice() {
        for (typed, made) in [("a", "a.csv"), (" b.csv ", "b.csv"), ("c.v2", "c.v2.csv")] {
            assert_eq!(with_ending(typed, "csv"), PathBuf::from(made));
        }
    }

    #[test]
    fn a_written_picture_is_read_back_unchanged() {
        let image = ColorImage::filled([3, 2], eframe::egui::Color32::from_rgb(1, 2, 3));
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("picture.png");
        encode(&image, File::create(&path).expect("file")).expect("encoded");
        let file = std::io::BufReader::new(File::open(&path).expect("file"));
        let mut reader = png::Decoder::new(file).read_info().expect("a picture");
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut pixels).expect("a frame");
        assert_eq!((info.width, info.height), (3, 2));
        assert_eq!(pixels[..4], [1, 2, 3, 255]);
    }
}
