//! How a recording looks: what was heard as a list, and beside it waveform, waterfall and spectrum of a channel.

use eframe::egui::{
    Color32, ColorImage, Context, FontId, Grid, Painter, Rect, RichText, Role, ScrollArea, Sense,
    TextureHandle, TextureOptions, Ui, WidgetInfo, pos2, vec2,
};

use crate::Palette;
use crate::parts::lane;
use ptu_report::plot::colour;
use ptu_report::signal as report;
use ptu_report::ticks;
use ptu_report::trace_view::{Column, Window};
use ptu_report::words::{Words, fill};
use ptu_runs::signal::{Picture, Reading, Span};

/// Left of the curves: the scale's numbers.
const SCALE: f32 = 52.0;
/// Heights of waveform and spectrum, of the waterfall, and of what was heard above it, points; the waterfall takes what
/// is left.
const LANE: f32 = 92.0;
const WATERFALL: f32 = 120.0;
const HEARD: f32 = 20.0;
/// Most rows of what was heard, and columns of a spectrum.
const MOST: usize = 200;
const SPECTRUM: usize = 512;

/// What was read or recorded, ready to be drawn.
#[derive(Default)]
pub struct Seen {
    reading: Reading,
    channels: Vec<Channel>,
}

/// How a channel looks.
struct Channel {
    wave: Curve,
    envelope: Curve,
    spectrum: Curve,
    waterfall: ColorImage,
    waterfall_s: (f64, f64),
    highest_hz: f64,
}

/// A quantity, with the ends of its axes.
struct Curve {
    columns: Vec<Column>,
    to: f64,
    range: (f64, f64),
}

impl Curve {
    fn new(columns: Vec<Column>, to: f64) -> Self {
        let known = columns.iter().filter(|column| column.is_known());
        let extent = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), column| {
            (low.min(column.low.into()), high.max(column.high.into()))
        });
        let extent = if extent.0 > extent.1 {
            (0.0, 1.0)
        } else {
            extent
        };
        Self {
            columns,
            to,
            range: ticks::range(extent),
        }
    }

    fn of_spans((spans, each_s): (&[Span], f64)) -> Self {
        // Each reaches the one before it: between them the curve goes on.
        let before = spans.first().into_iter().chain(spans);
        let columns = spans.iter().zip(before).map(|(span, before)| Column {
            low: span.low.min(before.high),
            high: span.high.max(before.low),
        });
        Self::new(columns.collect(), spans.len() as f64 * each_s)
    }
}

impl Seen {
    /// Reduces pictures to what is drawn.
    pub fn of(reading: Reading, pictures: &[Picture]) -> Self {
        let channels = pictures.iter().map(|picture| {
            let (columns, shades, _) = report::shades(picture);
            let rows = shades.len().checked_div(columns).unwrap_or(0);
            let pixels = shades.iter().map(|shade| {
                let [red, green, blue] = colour(*shade);
                Color32::from_rgb(red, green, blue)
            });
            let (levels, row_hz) = picture.mean_spectrum();
            let together = levels.len().div_ceil(SPECTRUM).max(1);
            let spectrum = levels.chunks(together).map(|levels| {
                let mut column = Column::EMPTY;
                levels
                    .iter()
                    .for_each(|level| column.add(f64::from(*level)));
                column
            });
            Channel {
                wave: Curve::of_spans(picture.wave()),
                envelope: Curve::of_spans(picture.envelope()),
                spectrum: Curve::new(spectrum.collect(), levels.len() as f64 * row_hz),
                waterfall: ColorImage::new([columns, rows], pixels.collect()),
                waterfall_s: picture.spectra_s(),
                highest_hz: picture.row_hz() * rows as f64,
            }
        });
        Self {
            channels: channels.collect(),
            reading,
        }
    }
}

/// What is shown, and of which channel.
#[derive(Default)]
pub struct View {
    seen: Option<Seen>,
    channel: usize,
    textures: Vec<Option<TextureHandle>>,
}

impl View {
    /// Takes what is to be shown from now on.
    pub fn take(&mut self, seen: Seen, context: &Context) {
        let texture = |(place, channel): (usize, &Channel)| {
            let image = channel.waterfall.clone();
            let there = image.size.iter().all(|size| *size > 0);
            there.then(|| {
                context.load_texture(format!("waterfall {place}"), image, TextureOptions::LINEAR)
            })
        };
        self.textures = seen.channels.iter().enumerate().map(texture).collect();
        self.channel = self.channel.min(seen.channels.len().saturating_sub(1));
        self.seen = Some(seen);
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

    /// Waveform, waterfall and spectrum of a channel.
    pub fn draw(&mut self, ui: &mut Ui, words: &Words) {
        let Some(seen) = &self.seen else { return };
        if seen.channels.len() > 1 {
            ui.horizontal_wrapped(|ui| {
                for place in 0..seen.channels.len() {
                    let name = fill(words.signals.of_channel, &[("n", &(place + 1))]);
                    ui.selectable_value(&mut self.channel, place, name);
                }
            });
        }
        let Some(channel) = seen.channels.get(self.channel) else {
            return;
        };
        let said = &words.signals;
        let lanes = 3.0 * (LANE + lane::AXIS_HEIGHT + 26.0);
        let left = ui.available_height() - lanes - HEARD - lane::AXIS_HEIGHT - 30.0;
        curve(ui, (said.waveform, said.millivolts, "s"), &channel.wave);
        self.waterfall(ui, words, (seen, channel), left.max(WATERFALL));
        curve(
            ui,
            (said.envelope, said.millivolts_rms, "s"),
            &channel.envelope,
        );
        curve(ui, (said.spectrum, said.decibels, "Hz"), &channel.spectrum);
    }

    /// The waterfall with what the receivers heard above it.
    fn waterfall(
        &self,
        ui: &mut Ui,
        words: &Words,
        (seen, channel): (&Seen, &Channel),
        height: f32,
    ) {
        let palette = Palette::of(ui);
        ui.label(RichText::new(words.signals.waterfall).color(palette.quiet));
        let all = HEARD + height + lane::AXIS_HEIGHT;
        let (area, curves) = allocate(ui, words.signals.waterfall, all);
        let window = Window {
            from: 0.0,
            to: seen.reading.duration_s.max(1e-3),
        };
        let painter = ui.painter_at(area);
        let heard = curves.with_max_y(curves.top() + HEARD);
        let image = Rect::from_min_max(
            pos2(curves.left(), heard.bottom()),
            pos2(curves.right(), area.bottom() - lane::AXIS_HEIGHT),
        );
        if let Some(Some(texture)) = self.textures.get(self.channel) {
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            let (from_s, to_s) = channel.waterfall_s;
            let at = |s: f64| lane::x_at(image, window, s.min(window.to));
            let there = Rect::from_x_y_ranges(at(from_s)..=at(to_s), image.y_range());
            painter.image(texture.id(), there, whole, Color32::WHITE);
        }
        let gutter = Rect::from_x_y_ranges(area.left()..=curves.left(), image.y_range());
        lane::y_axis(
            &painter,
            gutter,
            image,
            (0.0, channel.highest_hz / 1_000.0),
            &palette,
        );
        let axis = Rect::from_min_max(image.left_bottom(), area.right_bottom());
        lane::x_axis(&painter, axis, window, "s", &palette);
        for source in &seen.reading.sources {
            if source.channel != self.channel + 1 {
                continue;
            }
            let from = lane::x_at(heard, window, source.from_s);
            let to = lane::x_at(heard, window, source.to_s).max(from + 2.0);
            let place = Rect::from_x_y_ranges(from..=to, heard.y_range()).shrink2(vec2(0.0, 1.0));
            let ink = palette.curves[usize::from(source.kind != "code")];
            painter.rect_filled(place, 2.0, ink.gamma_multiply(0.35));
            let [.., what, _, _, _, _] = report::row(source, words);
            let font = FontId::proportional(lane::TEXT);
            if place.width() > 18.0 {
                let inner = place.shrink2(vec2(3.0, 0.0));
                lane::cut_text(&painter, inner, what, font, palette.ink);
            }
        }
    }
}

/// A curve with its name above it.
fn curve(ui: &mut Ui, (name, unit, along): (&str, &str, &str), curve: &Curve) {
    let palette = Palette::of(ui);
    ui.label(RichText::new(format!("{name}, {unit}")).color(palette.quiet));
    let (area, curves) = allocate(ui, name, LANE + lane::AXIS_HEIGHT);
    let curves = curves.with_max_y(area.bottom() - lane::AXIS_HEIGHT);
    let painter = ui.painter_at(area);
    draw(&painter, (area, curves), curve, along, &palette);
}

fn draw(
    painter: &Painter,
    (area, curves): (Rect, Rect),
    of: &Curve,
    along: &str,
    palette: &Palette,
) {
    let window = Window {
        from: 0.0,
        to: of.to.max(1e-3),
    };
    lane::grid(painter, curves, window, palette);
    let gutter = curves.with_max_x(curves.left()).with_min_x(area.left());
    lane::y_axis(painter, gutter, curves, of.range, palette);
    lane::quantity(painter, curves, &of.columns, of.range, palette.curves[0]);
    let axis = Rect::from_min_max(curves.left_bottom(), area.right_bottom());
    lane::x_axis(painter, axis, window, along, palette);
}

/// Room for a drawing, and the part right of its scale.
fn allocate(ui: &mut Ui, name: &str, height: f32) -> (Rect, Rect) {
    let size = vec2(ui.available_width(), height);
    let (area, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, name));
    (area, area.with_min_x(area.left() + SCALE))
}

/// A waveform that is not recorded: what the generator makes.
pub fn sketch(ui: &mut Ui, (name, unit): (&str, &str), samples: &[f32], each_s: f64) {
    let together = samples.len().div_ceil(SPECTRUM).max(1);
    let columns = samples.chunks(together).map(|samples| {
        let mut column = Column::EMPTY;
        samples.iter().for_each(|mv| column.add(f64::from(*mv)));
        column
    });
    let of = Curve::new(columns.collect(), samples.len() as f64 * each_s);
    curve(ui, (name, unit, "s"), &of);
}
