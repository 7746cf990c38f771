//! A plot as SVG that stands alone in a page. Colours and line widths are the page's, by class.

use std::fmt::Write;

use maud::{Markup, html};

use super::mark::{Anchor, Mark, Role, Style};

pub fn svg(title: &str, size: (f64, f64), marks: &[Mark]) -> Markup {
    html! {
        svg viewBox=(format!("0 0 {} {}", size.0, size.1)) role="img" aria-label=(title) {
            @for mark in marks { (drawn(mark)) }
        }
    }
}

fn drawn(mark: &Mark) -> Markup {
    match mark {
        Mark::Text {
            role,
            at,
            anchor,
            turned: false,
            text,
        } => html! {
            text class=(class(*role)) x=(num(at.0)) y=(num(at.1)) text-anchor=[word(*anchor)] { (text) }
        },
        Mark::Text {
            role,
            at,
            anchor,
            text,
            ..
        } => html! {
            text class=(class(*role)) transform=(format!("translate({} {}) rotate(-90)", num(at.0), num(at.1)))
                text-anchor=[word(*anchor)] { (text) }
        },
        Mark::Line { role, pieces } => html! {
            path class=(class(*role)) d=(pieces.iter().map(|piece| path(piece)).collect::<String>()) {}
        },
        Mark::Area { role, at, size } => html! {
            rect class=(class(*role)) x=(num(at.0)) y=(num(at.1)) width=(num(size.0)) height=(num(size.1)) {}
        },
        Mark::Raster {
            at,
            size,
            columns,
            shades,
        } => html! {
            image x=(num(at.0)) y=(num(at.1)) width=(num(size.0)) height=(num(size.1))
                preserveAspectRatio="none" href=[super::raster::address(*columns, shades)] {}
        },
        Mark::Dot { role, at } => html! {
            circle class=(class(*role)) cx=(num(at.0)) cy=(num(at.1)) r="2" {}
        },
    }
}

fn class(role: Role) -> String {
    match role {
        Role::Title => "title".into(),
        Role::Label => "label".into(),
        Role::Tick => "tick".into(),
        Role::Legend => "legend".into(),
        Role::AxisMark => "place".into(),
        Role::Note => "note".into(),
        Role::Grid => "grid".into(),
        Role::Zero => "zero".into(),
        Role::Frame => "frame".into(),
        Role::Shaded => "shaded".into(),
        Role::Values(style, colour) => {
            let style = match style {
                Style::Line => "curve",
                Style::Dashed => "curve dashed",
                Style::Dots => "dots",
                Style::Bars => "bars",
            };
            format!("{style} c{colour}")
        }
    }
}

fn word(anchor: Anchor) -> Option<&'static str> {
    match anchor {
        Anchor::Start => None,
        Anchor::Middle => Some("middle"),
        Anchor::End => Some("end"),
    }
}

fn path(points: &[(f64, f64)]) -> String {
    let mut text = String::new();
    for (i, (x, y)) in points.iter().enumerate() {
        // Writing to a text cannot fail.
        let _ = write!(text, "{}{x:.1} {y:.1}", if i == 0 { "M" } else { "L" });
    }
    text
}

/// A coordinate with as many decimals as can be seen.
fn num(value: f64) -> String {
    format!("{value:.1}")
}
