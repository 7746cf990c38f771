//! Drawing of the chain of parts from the sensor to the signal that the check judges; the failing part and all after
//! it are marked.

use eframe::egui::{
    Color32, FontId, Rect, Role, Sense, Shape, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};

use crate::Palette;
use crate::parts::lane::cut_text;
use ptu_report::naming::{self, PartNames};
use ptu_report::words::Words;
use ptu_runs::structure::{Chain, LinkOutput};

/// Size of a box, and of the arrow before it, points.
const BOX: [f32; 2] = [172.0, 62.0];
const ARROW: f32 = 26.0;
/// Size of the text in a box, points.
const TEXT: f32 = 13.5;

/// A box of the picture.
struct Shown {
    /// Names of parts, the suspected one first.
    parts: String,
    makes: String,
    mark: Mark,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Mark {
    None,
    Suspected,
    FailsWithIt,
}

impl Mark {
    fn word(self, words: &Words) -> &'static str {
        match self {
            Self::None => "",
            Self::Suspected => words.case.suspected,
            Self::FailsWithIt => words.case.fails_with_it,
        }
    }
}

/// Draws the chain that contains `part`, in as many rows as are needed.
pub fn chain(ui: &mut Ui, chain: &Chain, part: &str, names: &PartNames, words: &Words) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        for (place, shown) in boxes(chain, part, names, words).iter().enumerate() {
            draw(ui, shown, place > 0, words);
        }
    });
}

fn boxes(chain: &Chain, part: &str, names: &PartNames, words: &Words) -> Vec<Shown> {
    let name = |id: &str| names.name(id, words.language).to_owned();
    let before = chain.before.iter().map(|before| Shown {
        parts: name(before.as_str()),
        makes: words.case.needed_by_all.to_owned(),
        mark: Mark::Suspected,
    });
    let links = chain.links.iter().enumerate().map(|(place, link)| {
        let is_it = |id: &&protocol::LruId| id.as_str() == part;
        let suspected = link.parts.iter().filter(is_it);
        let others = link.parts.iter().filter(|id| !is_it(id));
        let parts: Vec<_> = suspected
            .chain(others)
            .map(|id| name(id.as_str()))
            .collect();
        let makes = match link.made {
            LinkOutput::Signal(signal) => naming::signal(signal.name(), words),
            LinkOutput::Event(event) => {
                let event = event.definition();
                naming::event(event.code.into(), event.name, words)
            }
        };
        let mark = match place >= chain.failing {
            true if link.parts.iter().any(|id| is_it(&id)) => Mark::Suspected,
            true => Mark::FailsWithIt,
            false => Mark::None,
        };
        Shown {
            parts: parts.join(", "),
            makes,
            mark,
        }
    });
    before.chain(links).collect()
}

fn draw(ui: &mut Ui, shown: &Shown, has_arrow: bool, words: &Words) {
    let palette = Palette::of(ui);
    let (ink, bad) = (ui.visuals().strong_text_color(), palette.bad);
    let (line, wide) = match shown.mark {
        Mark::None => (palette.quiet, 1.0),
        Mark::FailsWithIt => (bad, 1.0),
        Mark::Suspected => (bad, 3.0),
    };
    let arrow = if has_arrow { ARROW } else { 0.0 };
    let (all, response) = ui.allocate_exact_size(vec2(arrow + BOX[0], BOX[1]), Sense::hover());
    let said = [&*shown.parts, &*shown.makes, shown.mark.word(words)];
    let said: Vec<_> = said.into_iter().filter(|text| !text.is_empty()).collect();
    let said = said.join(naming::DOT);
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &said));
    response.on_hover_text(&said);
    let painter = ui.painter_at(all);
    let rect = Rect::from_min_max(pos2(all.left() + arrow, all.top()), all.max);
    if has_arrow {
        // The failure continues from the suspected part along the arrows.
        let colour = match shown.mark {
            Mark::FailsWithIt => bad,
            Mark::None | Mark::Suspected => palette.quiet,
        };
        let (from, to) = (all.left() + 3.0, rect.left() - 3.0);
        let y = all.center().y;
        painter.hline(from..=to, y, Stroke::new(2.0, colour));
        let head = [(0.0, 0.0), (-7.0, -5.0), (-7.0, 5.0)];
        let head = head.map(|(x, dy)| pos2(to + x, y + dy)).to_vec();
        painter.add(Shape::convex_polygon(head, colour, Stroke::NONE));
    }
    let ground = match shown.mark {
        Mark::Suspected => bad.gamma_multiply(0.18),
        Mark::None | Mark::FailsWithIt => Color32::TRANSPARENT,
    };
    let stroke = Stroke::new(wide, line);
    painter.rect(rect, 4.0, ground, stroke, StrokeKind::Inside);
    let sign = match shown.mark {
        Mark::None => String::new(),
        Mark::Suspected => format!("✗ {}", shown.mark.word(words)),
        Mark::FailsWithIt => format!("→ {}", shown.mark.word(words)),
    };
    let rows = [
        (&shown.parts, ink, TEXT),
        (&shown.makes, palette.quiet, TEXT - 1.0),
        (&sign, bad, TEXT - 1.0),
    ];
    let inner = rect.shrink2(vec2(8.0, 5.0));
    let high = inner.height() / 3.0;
    for (place, (text, colour, size)) in (0u8..).zip(rows) {
        let top = inner.top() + f32::from(place) * high;
        let area = Rect::from_x_y_ranges(inner.x_range(), top..=top + high);
        cut_text(
            &painter,
            area,
            text.clone(),
            FontId::proportional(size),
            colour,
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::signal::Signal;
    use ptu_report::words::Language;
    use ptu_runs::structure::Link;

    /// Goal: a technician does not take out the part next to the suspected one. Method: the suspected part and
    /// the parts after it are marked by words, the parts before it are not.
    #[test]
    fn the_part_and_all_after_it_are_marked_by_words() {
        let link = |signal, parts: &[&str]| Link {
            made: LinkOutput::Signal(signal),
            parts: parts.iter().map(|part| part.parse().unwrap()).collect(),
        };
        let chain = Chain {
            before: None,
            links: vec![
                link(Signal::Speed1, &["speed_sensor_1", "atp_cpu"]),
                link(Signal::EbCause, &["atp_cpu", "io_board"]),
                link(Signal::Eb, &["eb_relay"]),
            ],
            failing: 1,
        };
        for language in Language::ALL {
            let words = language.words();
            let shown = boxes(&chain, "io_board", &PartNames::default(), words);
            let marks: Vec<_> = shown.iter().map(|shown| shown.mark.word(words)).collect();
            let case = &words.case;
            assert_eq!(marks, ["", case.suspected, case.fails_with_it]);
            assert_eq!(shown[1].parts, "io_board, atp_cpu");
        }
    }
}
