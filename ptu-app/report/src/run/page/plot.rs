//! A plot on a page, from the same marks as on the HTML page.

use protocol::display_text;

use super::item::{INSIDE, Ink, Item, MARGIN, Piece, Text};
use crate::plot::{Mark, Plot, Role, Style};

/// Width of the drawing on paper, in units of the drawing: its text is then as large as the text around it.
const WIDTH: f32 = 800.0;
/// Size of text in the drawing, in units of the drawing.
const SIZE: f32 = 11.5;
/// Radius of a dot, in units of the drawing.
const DOT: f32 = 2.0;
/// Space left free below the drawing on paper, points.
const BELOW: f32 = 6.0;

/// The drawing on paper, which is never cut.
pub fn piece(plot: &Plot) -> Piece {
    let drawing = drawing(plot, INSIDE, INSIDE / WIDTH);
    Piece {
        height: drawing.height + BELOW,
        ..drawing
    }
}

/// A drawing that is `wide` points wide, with `scale` points to a unit of the drawing.
pub fn drawing(plot: &Plot, wide: f32, scale: f32) -> Piece {
    let width = f64::from(wide / scale);
    let height = plot.size(width).1 as f32 * scale;
    let marks = plot.marks(width);
    let all = Item::Drawing(MARGIN, 0.0, wide, height, plot.title.clone());
    Piece {
        items: std::iter::once(all)
            .chain(marks.iter().flat_map(|mark| items(mark, scale)))
            .collect(),
        height,
        ..Piece::default()
    }
}

fn items(mark: &Mark, scale: f32) -> Vec<Item> {
    let place = |(x, y): (f64, f64)| (MARGIN + x as f32 * scale, y as f32 * scale);
    match mark {
        Mark::Text {
            role,
            at,
            anchor,
            turned,
            text,
        } => {
            let (x, y) = place(*at);
            vec![Item::Text(Text {
                x,
                anchor: *anchor,
                size: SIZE * scale,
                ink: ink(*role),
                strong: *role == Role::Title,
                turned: *turned,
                in_drawing: true,
                lines: vec![(y, display_text::line(text).into_owned())],
            })]
        }
        Mark::Line { role, pieces } => {
            let drawn = pieces.iter().filter(|piece| piece.len() > 1);
            drawn
                .map(|piece| Item::Line {
                    points: piece.iter().copied().map(place).collect(),
                    ink: ink(*role),
                    width: thickness(*role),
                    dashed: matches!(role, Role::Values(Style::Dashed, _) | Role::AxisMark),
                })
                .collect()
        }
        Mark::Area { role, at, size } => {
            let (x, y) = place(*at);
            let (wide, high) = (size.0 as f32 * scale, size.1 as f32 * scale);
            if *role == Role::Frame {
                let width = thickness(*role);
                return vec![Item::frame((x, y), (wide, high), Ink::Rule, width)];
            }
            vec![Item::Area(x, y, wide, high, ink(*role))]
        }
        Mark::Raster {
            at,
            size,
            columns,
            shades,
        } => {
            let (x, y) = place(*at);
            let (wide, high) = (size.0 as f32 * scale, size.1 as f32 * scale);
            vec![Item::Cells(x, y, wide, high, *columns, shades.clone())]
        }
        Mark::Dot { role, at } => {
            let (x, y) = place(*at);
            vec![Item::Disc(x, y, DOT * scale, ink(*role))]
        }
    }
}

fn ink(role: Role) -> Ink {
    match role {
        Role::Title => Ink::Black,
        Role::Label | Role::Tick | Role::Legend | Role::Note => Ink::Soft,
        Role::AxisMark => Ink::Bad,
        Role::Grid => Ink::Grid,
        Role::Zero | Role::Frame => Ink::Rule,
        Role::Shaded => Ink::Shade,
        Role::Values(_, colour) => Ink::Curve(colour),
    }
}

fn thickness(role: Role) -> f32 {
    match role {
        Role::Values(Style::Line, _) => 1.0,
        Role::Values(Style::Dashed, _) => 0.8,
        _ => 0.5,
    }
}
