//! How a recording looks: what was heard as a list, and beside it the drawings of a channel, as in its report.

use eframe::egui::{
    Color32, ColorImage, Context, Grid, RichText, ScrollArea, TextureHandle, TextureOptions, Ui,
    Vec2, vec2,
};

use crate::Palette;
use crate::parts::{drawings, show_drawings};
use ptu_report::plot::colour;
use ptu_report::run::page::{Item, Page};
use ptu_report::signal as report;
use ptu_report::words::{Language, Words, fill};
use ptu_runs::signal::{Picture, Reading};

/// Most rows of what was heard.
const MOST: usize = 200;
/// So many drawings are in view at once.
const IN_VIEW: f32 = 4.0;

/// What was read or recorded, a picture of each channel.
pub struct Seen {
    pub reading: Reading,
    pub pictures: Vec<Picture>,
}

/// What is shown, and of which channel.
#[derive(Default)]
pub struct View {
    seen: Option<Seen>,
    channel: usize,
    drawn: Option<Drawn>,
}

/// The drawings of a channel in a language and with so much room for each, and the picture of their cells.
struct Drawn {
    of: (usize, Language, Vec2),
    drawings: (Page, f32),
    cells: Option<TextureHandle>,
}

impl Drawn {
    fn new(seen: &Seen, of: (usize, Vec2), words: &Words, context: &Context) -> Option<Self> {
        let (channel, room) = of;
        let picture = seen.pictures.get(channel)?;
        let drawings = drawings(
            report::plots(picture, (&seen.reading, channel), words),
            room,
        );
        let image = drawings.0.iter().find_map(|item| {
            let Item::Cells(.., columns, shades) = item else {
                return None;
            };
            let rows = shades
                .len()
                .checked_div(*columns)
                .filter(|rows| *rows > 0)?;
            let pixels = shades.iter().map(|shade| {
                let [red, green, blue] = colour(*shade);
                Color32::from_rgb(red, green, blue)
            });
            Some(ColorImage::new([*columns, rows], pixels.collect()))
        });
        Some(Self {
            of: (channel, words.language, room),
            drawings,
            cells: image.map(|image| context.load_texture("cells", image, TextureOptions::LINEAR)),
        })
    }
}

impl View {
    /// Takes what is to be shown from now on.
    pub fn take(&mut self, seen: Seen) {
        self.channel = self.channel.min(seen.pictures.len().saturating_sub(1));
        self.seen = Some(seen);
        self.drawn = None;
    }

    /// The list of what was heard, and what was not understood.
    pub fn heard(&self, ui: &mut Ui, words: &Words) {
        let Some(Seen { reading, .. }) = &self.seen else {
            ui.label(words.signals.explained);
            return;
        };
        let length = format!("{:.2} s", reading.duration_s);
        ui.label(RichText::new(fill(words.signals.heard_in, &[("time", &length)])).strong());
        if reading.sources.is_empty() {
            ui.label(words.signals.nothing);
        } else {
            let area = ScrollArea::horizontal().id_salt("heard");
            area.show(ui, |ui| {
                Grid::new("heard").striped(true).show(ui, |ui| {
                    for head in report::heads(words) {
                        ui.label(RichText::new(head).color(Palette::of(ui).quiet));
                    }
                    ui.end_row();
                    for source in reading.sources.iter().take(MOST) {
                        for cell in report::row(source, words) {
                            ui.label(cell);
                        }
                        ui.end_row();
                    }
                });
            });
        }
        let more = reading.sources.len().saturating_sub(MOST);
        if more > 0 {
            ui.label(fill(words.signals.more, &[("n", &more)]));
        }
        for of in reading.not_understood.iter().take(MOST) {
            let said = report::not_understood(of, words);
            ui.label(RichText::new(said).color(Palette::of(ui).warn));
        }
    }

    /// The drawings of a channel.
    pub fn draw(&mut self, ui: &mut Ui, words: &Words) {
        let Some(seen) = &self.seen else { return };
        if seen.pictures.len() > 1 {
            ui.horizontal_wrapped(|ui| {
                for place in 0..seen.pictures.len() {
                    let name = fill(words.signals.of_channel, &[("n", &(place + 1))]);
                    ui.selectable_value(&mut self.channel, place, name);
                }
            });
        }
        let room = vec2(ui.available_width(), ui.available_height() / IN_VIEW);
        let now = (self.channel, words.language, room);
        let drawn = self.drawn.take().filter(|drawn| drawn.of == now);
        self.drawn = drawn.or_else(|| Drawn::new(seen, (self.channel, room), words, ui.ctx()));
        if let Some(drawn) = &self.drawn {
            let cells = drawn.cells.as_ref().map(TextureHandle::id);
            show_drawings(ui, &drawn.drawings, cells);
        }
    }
}
