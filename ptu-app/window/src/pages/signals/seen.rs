//! View of a recording: list of detected signals, and below it the pictures of one channel, as in the report.

use std::sync::{Arc, Mutex};

use eframe::egui::{
    Color32, ColorImage, Context, RichText, ScrollArea, TextureHandle, TextureOptions, Ui, Vec2,
    vec2,
};
use egui_material_icons::icons::ICON_GRAPHIC_EQ;

use crate::parts::{Cell, Column, Table, drawings, empty, segments, show_drawings};
use crate::{Palette, Sizes};
use ptu_report::naming::DOT;
use ptu_report::plot::colour;
use ptu_report::run::page::{Item, Page};
use ptu_report::signal as report;
use ptu_report::words::{Language, Words, fill};
use ptu_runs::signal::{Picture, Reading};

/// Most rows of detected signals.
const MOST: usize = 200;
/// Number of drawings in view at once.
const IN_VIEW: f32 = 3.0;
/// Width of the scroll bar beside the drawings, points.
const BAR: f32 = 16.0;

/// Reading of a file or recording, with a picture of each channel.
pub struct Seen {
    pub reading: Reading,
    pub pictures: Vec<Picture>,
}

/// Slot into which a thread that reads or records puts its latest picture.
pub type Slot = Arc<Mutex<Option<Seen>>>;

/// The reading that is shown, and the chosen channel.
#[derive(Default)]
pub struct View {
    seen: Option<Seen>,
    channel: usize,
    drawn: Option<Drawn>,
}

/// Drawings of a channel, made for a language and a size of each drawing, and the picture of their cells.
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
    /// Takes a reading, which is shown from now on.
    pub fn take(&mut self, seen: Seen) {
        self.channel = self.channel.min(seen.pictures.len().saturating_sub(1));
        self.seen = Some(seen);
        self.drawn = None;
    }

    /// List of detected signals, and below it the pictures of a channel.
    pub fn show(&mut self, ui: &mut Ui, words: &Words) {
        let said = &words.signals;
        let Some(seen) = &self.seen else {
            empty(ui, ICON_GRAPHIC_EQ, (said.none_open, said.explained), None);
            return;
        };
        let Seen { reading, pictures } = seen;
        let room = vec2(ui.available_width() - BAR, ui.available_height() / IN_VIEW);
        let area = ScrollArea::vertical().id_salt("signals drawn");
        area.auto_shrink(false).show(ui, |ui| {
            let length = format!("{:.2} s", reading.duration_s);
            let heading = RichText::new(fill(said.heard_in, &[("time", &length)]));
            ui.label(heading.size(Sizes::of(ui).lead));
            match reading.sources.is_empty() {
                true => drop(ui.label(said.nothing)),
                false => heard(ui, reading, words),
            }
            let more = reading.sources.len().saturating_sub(MOST);
            if more > 0 {
                ui.label(fill(said.more, &[("n", &more)]));
            }
            for of in &reading.levels {
                ui.label(report::level(of, words));
            }
            for of in reading.not_understood.iter().take(MOST) {
                let said = report::not_understood(of, words);
                ui.label(RichText::new(said).color(Palette::of(ui).warn));
            }
            ui.add_space(8.0);
            if pictures.len() > 1 {
                let name = |place: usize| fill(said.of_channel, &[("n", &(place + 1))]);
                let names: Vec<_> = (0..pictures.len()).map(name).collect();
                let names = names.iter().enumerate();
                let names = names.map(|(place, name)| (place, &**name));
                segments(ui, &mut self.channel, names);
            }
            let now = (self.channel, words.language, room);
            let drawn = self.drawn.take().filter(|drawn| drawn.of == now);
            self.drawn = drawn.or_else(|| Drawn::new(seen, (self.channel, room), words, ui.ctx()));
            if let Some(drawn) = &self.drawn {
                let cells = drawn.cells.as_ref().map(TextureHandle::id);
                show_drawings(ui, &drawn.drawings, cells);
            }
        });
    }
}

/// List of detected signals; a narrow table leaves out columns of less use.
fn heard(ui: &mut Ui, reading: &Reading, words: &Words) {
    let [channel, from, to, kind, what, carrier, rate, level, snr] = report::heads(words);
    let number = |name, wide| Column::new(name, wide).right();
    let columns = [
        number(channel, 60.0).from(680.0),
        number(from, 56.0),
        number(to, 56.0),
        Column::new(kind, 72.0),
        Column::new(what, 0.0),
        number(carrier, 84.0).from(600.0),
        number(rate, 72.0).from(760.0),
        number(level, 72.0),
        number(snr, 56.0).from(560.0),
    ];
    let table = Table {
        columns: &columns,
        end: 0.0,
    };
    table.head(ui, 0.0);
    ui.spacing_mut().item_spacing.y = 0.0;
    let ink = Palette::of(ui).ink;
    for source in reading.sources.iter().take(MOST) {
        let cells = report::row(source, words);
        let name = cells.join(DOT);
        let cells = cells.map(|cell| Cell::Text(cell.into(), ink));
        table.row(ui, (&name, false), &cells).on_hover_text(name);
    }
}
