//! Reduces curves to the points that can be seen.

use super::mark::{Mark, Role};
use super::scale::Scale;
use super::{Series, Style};

/// Distance from the line between its neighbours below which a point cannot be seen, in units of the drawing.
const UNSEEN: f64 = 0.25;
/// Share of the room between two points that a bar takes.
const BAR: f64 = 0.96;

pub fn drawn(series: &Series, x: &Scale, y: &Scale) -> Vec<Mark> {
    let known = |point: &&(f64, f64)| point.1.is_finite() && x.holds(point.0);
    let place = |point: &(f64, f64)| (x.at(point.0), y.at(y.clamp(point.1)));
    let role = role(series);
    let places = || series.points.iter().filter(known).map(place);
    match series.style {
        Style::Line | Style::Dashed => {
            let pieces = series.points.split(|point| !known(&point));
            let pieces = pieces.map(|piece| simple(&piece.iter().map(place).collect::<Vec<_>>()));
            vec![Mark::Line {
                role,
                pieces: pieces.filter(|piece| !piece.is_empty()).collect(),
            }]
        }
        Style::Dots => places().map(|at| Mark::Dot { role, at }).collect(),
        Style::Bars => {
            let apart = series
                .points
                .windows(2)
                .map(|p| p[1].0 - p[0].0)
                .next()
                .unwrap_or(1.0);
            let width = (x.at(apart) - x.at(0.0)).abs();
            let zero = y.at(y.clamp(0.0));
            let bar = |(px, py): (f64, f64)| Mark::Area {
                role,
                at: (px - width / 2.0, py.min(zero)),
                size: (width * BAR, (zero - py).abs()),
            };
            places().map(bar).collect()
        }
    }
}

/// Role of a curve's marks.
pub fn role(series: &Series) -> Role {
    Role::Values(series.style, series.colour % 6)
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
    fn corners_of_a_curve_stay_and_points_on_a_line_are_removed() {
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
