//! A test sheet as PDF. The same run gives the same bytes.

use std::collections::BTreeSet;

use krilla::Document;
use krilla::color::rgb::Color;
use krilla::geom::{Path, PathBuilder, Point, Rect, Transform};
use krilla::metadata::{DateTime, Metadata};
use krilla::page::PageSettings;
use krilla::paint::{Fill, Stroke, StrokeDash};
use krilla::surface::Surface;
use krilla::text::Font;
use protocol::display_text;

use super::page::font::FontMetrics;
use super::page::{self, DASH, HEIGHT, Ink, Item, Text, WIDTH};
use super::{Paper, Printed};
use crate::fonts::PRETENDARD;
use crate::words::Words;
use ptu_runs::clock;
use ptu_runs::failure::{Failure, FileTrouble, Why};

/// Width of the line around bold letters, as a share of their size: the shipped font has one weight alone.
const WEIGHT: f32 = 0.035;
/// Distance of a curve's control point from the end of a quarter circle, as a share of the radius.
const QUARTER: f32 = 0.5523;

/// The document, and the letters that stand in it as codes because the shipped font lacks them.
///
/// # Errors
/// The shipped font does not serve, or the document cannot be made of it.
pub fn pdf(sheet: &impl Printed, words: &Words) -> Result<(Vec<u8>, BTreeSet<char>), Failure> {
    let paper = sheet.paper(words);
    let (pages, coded) = page::pages_of(&paper, words)?;
    let letters = FontMetrics::new()?;
    let failed = |what: &str| Failure::bench(FileTrouble::NotPrinted("the PDF", Why::of(what)));
    let font = Font::new(PRETENDARD.into(), 0).ok_or_else(|| failed("the shipped font"))?;
    let size = || PageSettings::from_wh(WIDTH, HEIGHT).ok_or_else(|| failed("the page size"));
    let mut document = Document::new();
    document.set_metadata(metadata(&paper, words));
    for items in &pages {
        let mut page = document.start_page_with(size()?);
        let mut surface = page.surface();
        for item in items {
            draw(item, &mut surface, &font, &letters);
        }
        surface.finish();
        page.finish();
    }
    let document = document.finish();
    let document = document.map_err(|error| failed(&format!("{error:?}")))?;
    Ok((document, coded))
}

/// Metadata with the time and number of the content, so that the document is the same each time it is made.
fn metadata(paper: &Paper, words: &Words) -> Metadata {
    let (year, of_year) = clock::utc_fields(paper.at_us);
    let [month, day, hour, minute, second] = of_year;
    let at = DateTime::new(year).month(month).day(day).hour(hour);
    Metadata::new()
        .title(format!(
            "{} {} {}",
            paper.name,
            display_text::line(&paper.unit),
            paper.short
        ))
        .language(words.language.code().to_owned())
        .creator(paper.program.clone())
        .document_id(paper.number.clone())
        .creation_date(at.minute(minute).second(second).utc_offset_hour(0))
}

fn draw(item: &Item, surface: &mut Surface<'_>, font: &Font, letters: &FontMetrics) {
    match item {
        Item::Text(text) => words(text, surface, font, letters),
        Item::Line {
            points,
            ink,
            width,
            dashed,
        } => {
            surface.set_fill(None);
            surface.set_stroke(Some(stroke(*ink, *width, *dashed)));
            put(surface, through(points));
        }
        Item::Area(x, y, wide, high, ink) => {
            surface.set_stroke(None);
            surface.set_fill(Some(fill(*ink)));
            let area = Rect::from_xywh(*x, *y, *wide, *high);
            put(surface, area.and_then(rectangle));
        }
        Item::Disc(x, y, radius, ink) => {
            surface.set_stroke(None);
            surface.set_fill(Some(fill(*ink)));
            put(surface, disc(*x, *y, *radius));
        }
        // A drawing is made up of the items after it; cells are for a screen alone.
        Item::Drawing(..) | Item::Cells(..) => {}
    }
}

fn words(text: &Text, surface: &mut Surface<'_>, font: &Font, letters: &FontMetrics) {
    let Text {
        x,
        size,
        ink,
        strong,
        turned,
        ..
    } = *text;
    for (y, line) in &text.lines {
        let line = line.trim_end();
        if line.is_empty() {
            continue;
        }
        let back = letters.width(line, size) * text.anchor.share();
        surface.set_fill(Some(fill(ink)));
        surface.set_stroke(strong.then(|| stroke(ink, WEIGHT * size, false)));
        let glyphs = letters.glyphs(line);
        let (x, y) = if turned {
            (x, y + back)
        } else {
            (x - back, *y)
        };
        if turned {
            surface.push_transform(&Transform::from_rotate_at(-90.0, x, y));
        }
        let at = Point::from_xy(x, y);
        surface.draw_glyphs(at, &glyphs, font.clone(), line, size, false);
        if turned {
            surface.pop();
        }
    }
}

/// Draws a path; an empty one draws nothing.
fn put(surface: &mut Surface<'_>, path: Option<Path>) {
    if let Some(path) = path {
        surface.draw_path(&path);
    }
}

fn through(points: &[(f32, f32)]) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (number, (x, y)) in points.iter().enumerate() {
        if number == 0 {
            path.move_to(*x, *y);
        } else {
            path.line_to(*x, *y);
        }
    }
    path.finish()
}

fn rectangle(area: Rect) -> Option<Path> {
    let mut path = PathBuilder::new();
    path.push_rect(area);
    path.finish()
}

fn disc(x: f32, y: f32, r: f32) -> Option<Path> {
    let k = QUARTER * r;
    let mut path = PathBuilder::new();
    path.move_to(x + r, y);
    path.cubic_to(x + r, y + k, x + k, y + r, x, y + r);
    path.cubic_to(x - k, y + r, x - r, y + k, x - r, y);
    path.cubic_to(x - r, y - k, x - k, y - r, x, y - r);
    path.cubic_to(x + k, y - r, x + r, y - k, x + r, y);
    path.close();
    path.finish()
}

fn fill(ink: Ink) -> Fill {
    Fill {
        paint: colour(ink).into(),
        ..Fill::default()
    }
}

fn stroke(ink: Ink, width: f32, dashed: bool) -> Stroke {
    Stroke {
        paint: colour(ink).into(),
        width,
        dash: dashed.then(|| StrokeDash {
            array: DASH.into(),
            offset: 0.0,
        }),
        ..Stroke::default()
    }
}

/// The page's colours, light.
fn colour(ink: Ink) -> Color {
    const CURVES: [[u8; 3]; 6] = [
        [0x00, 0x72, 0xb2],
        [0xd5, 0x5e, 0x00],
        [0x00, 0x9e, 0x73],
        [0xcc, 0x79, 0xa7],
        [0x8a, 0x8f, 0x98],
        [0xb8, 0x86, 0x0b],
    ];
    let [red, green, blue] = match ink {
        Ink::Black => [0x1b, 0x1f, 0x24],
        Ink::Soft => [0x5b, 0x64, 0x70],
        Ink::Good => [0x0a, 0x7a, 0x4b],
        Ink::Bad => [0xb3, 0x26, 0x1e],
        Ink::Rule => [0x9a, 0xa3, 0xad],
        Ink::Grid => [0xdc, 0xdf, 0xe3],
        Ink::Band => [0xcf, 0xe8, 0xdc],
        Ink::Shade => [0xee, 0xe1, 0xc2],
        Ink::Curve(place) => CURVES[place % CURVES.len()],
    };
    Color::new(red, green, blue)
}
