//! Curves: what can be seen of their points, as few as show the same.

use std::fmt::Write;

use maud::{Markup, html};

use super::scale::Scale;
use super::{Series, Style};

/// Points this near the line between their neighbours show nothing, in units of the drawing.
const UNSEEN: f64 = 0.25;

/// The curve.
pub fn drawn(series: &Series, x: &Scale, y: &Scale) -> Markup {
    let known = |point: &&(f64, f64)| point.1.is_finite() && x.holds(point.0);
    let place = |point: &(f64, f64)| (x.at(point.0), y.at(y.clamp(point.1)));
    match series.style {
        Style::Line | Style::Dashed => {
            let pieces = series.points.split(|point| !known(&point));
            let lines = pieces.map(|piece| simple(&piece.iter().map(place).collect::<Vec<_>>()));
            html! { path class=(class(series)) d=(lines.map(|line| path(&line)).collect::<String>()) {} }
        }
        Style::Dots => html! {
            @for (px, py) in series.points.iter().filter(known).map(place) {
                circle class=(class(series)) cx=(super::num(px)) cy=(super::num(py)) r="2" {}
            }
        },
        Style::Bars => {
            let apart = series
                .points
                .windows(2)
                .map(|p| p[1].0 - p[0].0)
                .next()
                .unwrap_or(1.0);
            let width = (x.at(apart) - x.at(0.0)).abs();
            let zero = y.at(y.clamp(0.0));
            html! {
                @for (px, py) in series.points.iter().filter(known).map(place) {
                    rect class=(class(series)) x=(super::num(px - width / 2.0)) y=(super::num(py.min(zero)))
                        width=(super::num(width * 0.96)) height=(super::num((zero - py).abs())) {}
                }
            }
        }
    }
}

/// CSS classes of a curve.
pub fn class(series: &Series) -> String {
    let style = match series.style {
        Style::Line => "curve",
        Style::Dashed => "curve dashed",
        Style::Dots => "dots",
        Style::Bars => "bars",
    };
    format!("{style} c{}", series.colour % 6)
}

fn path(points: &[(f64, f64)]) -> String {
    let mut text = String::new();
    for (i, (x, y)) in points.iter().enumerate() {
        // Writing to a text cannot fail.
        let _ = write!(text, "{}{x:.1} {y:.1}", if i == 0 { "M" } else { "L" });
    }
    text
}

/// The points without those that lie on the line between kept neighbours.
fn simple(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    let mut begin = 0;
    for end in 1..points.len() {
        let between = &points[begin + 1..end];
        if kept.is_empty() {
            kept.push(points[0]);
        }
        if between
            .iter()
            .any(|p| distance(*p, points[begin], points[end]) > UNSEEN)
        {
            begin = end - 1;
            kept.push(points[begin]);
        }
    }
    kept.extend(points.last());
    kept
}

/// Distance of a point from the line through two others.
fn distance(p: (f64, f64), a: (f64, f64), b: (f64, f64)) -> f64 {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = dx.hypot(dy);
    if length == 0.0 {
        return (p.0 - a.0).hypot(p.1 - a.1);
    }
    ((p.0 - a.0) * dy - (p.1 - a.1) * dx).abs() / length
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_stay_and_points_on_a_line_go() {
        let up = (0..=100).map(|i| (f64::from(i), f64::from(i)));
        let flat = (101..=200).map(|i| (f64::from(i), 100.0));
        let points: Vec<_> = up.chain(flat).collect();
        assert_eq!(
            simple(&points),
            [(0.0, 0.0), (100.0, 100.0), (200.0, 100.0)]
        );
        assert_eq!(simple(&points[..1]), [(0.0, 0.0)]);
    }
}
