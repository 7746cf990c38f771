//! Line plots as SVG that stands alone in a page: axes with round ticks, light grid, legend, named
//! places as vertical lines. Colours are CSS variables of the page.

mod curve;
mod scale;

use maud::{Markup, html};

use scale::Scale;

/// Size of the drawing, in its own units.
const WIDTH: f64 = 1000.0;
const HEIGHT: f64 = 300.0;
/// What is left around the plot: room for labels.
const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 46.0;
const BOTTOM: f64 = 42.0;
/// Rows above the plot for names of places.
const ROW: f64 = 12.0;
/// Share of an axis left free beyond what is shown.
const FREE: f64 = 0.04;
/// Width of the thinnest stretch that can be seen.
const THINNEST: f64 = 1.0;
/// Room a letter of a name takes.
const LETTER: f64 = 6.4;

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// A line between points.
    Line,
    /// A thin dashed line.
    Dashed,
    /// Dots.
    Dots,
    /// Bars from 0, as wide as points are apart.
    Bars,
}

/// A curve.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Colour, 0 to 5.
    pub colour: usize,
    /// How it is drawn.
    pub style: Style,
    /// Its points; those that are not numbers interrupt it.
    pub points: Vec<(f64, f64)>,
}

/// A place on the horizontal axis.
#[derive(Clone, Debug)]
pub struct Place {
    /// Where.
    pub x: f64,
    /// Its name.
    pub name: String,
}

/// A plot.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    /// What it shows.
    pub title: String,
    /// Horizontal axis with its unit.
    pub x_label: String,
    /// Vertical axis with its unit.
    pub y_label: String,
    /// The horizontal axis reaches from here to there; none = as far as the points.
    pub x_range: Option<(f64, f64)>,
    /// The vertical axis reaches at least so far.
    pub y_reach: Option<(f64, f64)>,
    /// Curves, the last on top.
    pub series: Vec<Series>,
    /// Places.
    pub places: Vec<Place>,
    /// Stretches of the horizontal axis that are shaded, each from its first end to its second.
    pub shaded: Vec<(f64, f64)>,
}

impl Plot {
    /// Shades where cars slip or slide, and says so.
    pub fn shade_slides<R>(
        &mut self,
        rows: &[R],
        sliding: impl Fn(&R) -> bool,
        x: impl Fn(&R) -> f64,
    ) {
        self.shaded = rows
            .chunk_by(|a, b| sliding(a) == sliding(b))
            .filter(|stretch| sliding(&stretch[0]))
            .map(|stretch| (x(&stretch[0]), x(&stretch[stretch.len() - 1])))
            .collect();
        if !self.shaded.is_empty() {
            self.title += " (shaded: a car slips or slides)";
        }
    }

    /// The drawing.
    pub fn svg(&self) -> Markup {
        let free = if self.x_range.is_some() { 0.0 } else { FREE };
        let x = Scale::new(self.x_extent(), (LEFT, WIDTH - RIGHT), free);
        let y = Scale::new(self.y_extent(&x), (HEIGHT - BOTTOM, TOP), FREE);
        html! {
            svg viewBox=(format!("0 0 {WIDTH} {HEIGHT}")) role="img" aria-label=(self.title) {
                text.title x=(LEFT) y="13" { (self.title) }
                (self.legend())
                (self.shades(&x))
                (grid(&x, &y))
                (self.named_places(&x))
                @for series in &self.series { (curve::drawn(series, &x, &y)) }
                text.label x=((LEFT + WIDTH - RIGHT) / 2.0) y=(HEIGHT - 6.0) text-anchor="middle" { (self.x_label) }
                text.label transform=(format!("translate(13 {}) rotate(-90)", (TOP + HEIGHT - BOTTOM) / 2.0))
                    text-anchor="middle" { (self.y_label) }
            }
        }
    }

    fn x_extent(&self) -> (f64, f64) {
        let points = self.series.iter().flat_map(|series| &series.points);
        self.x_range
            .unwrap_or_else(|| extent(points.map(|point| point.0)))
    }

    /// Of what is to be seen.
    fn y_extent(&self, x: &Scale) -> (f64, f64) {
        let points = self.series.iter().flat_map(|series| &series.points);
        let seen = points.filter(|point| x.holds(point.0)).map(|point| point.1);
        let reach = self.y_reach.map(|(low, high)| [low, high]);
        extent(seen.chain(reach.into_iter().flatten()))
    }

    /// From the right edge, in the order of the curves; one entry a name.
    fn legend(&self) -> Markup {
        let mut entries: Vec<&Series> = Vec::new();
        for series in &self.series {
            if !series.name.is_empty() && entries.iter().all(|entry| entry.name != series.name) {
                entries.push(series);
            }
        }
        let mut right = WIDTH - RIGHT;
        let placed: Vec<_> = entries
            .into_iter()
            .rev()
            .map(|series| {
                right -= series.name.chars().count() as f64 * LETTER + 34.0;
                (right, series)
            })
            .collect();
        html! {
            @for (at, series) in placed {
                line class=(curve::class(series)) x1=(at) y1="9" x2=(at + 20.0) y2="9" {}
                text.legend x=(at + 25.0) y="13" { (series.name) }
            }
        }
    }

    fn shades(&self, x: &Scale) -> Markup {
        let seen = self
            .shaded
            .iter()
            .filter(|(from, to)| x.holds(*from) && x.holds(*to));
        html! {
            @for (from, to) in seen.map(|(from, to)| (x.at(*from), x.at(*to))) {
                rect.shaded x=(num(from)) y=(TOP) width=(num((to - from).max(THINNEST))) height=(HEIGHT - BOTTOM - TOP) {}
            }
        }
    }

    /// Names stand in the first row above the plot in which there is room.
    fn named_places(&self, x: &Scale) -> Markup {
        let mut ends = [f64::NEG_INFINITY; 2];
        let placed: Vec<_> = self
            .places
            .iter()
            .filter(|place| x.holds(place.x))
            .map(|place| {
                let at = x.at(place.x);
                let width = place.name.chars().count() as f64 * LETTER + 4.0;
                // Within the drawing, also where a long name belongs to its edge.
                let begin = (at - width / 2.0).min(WIDTH - width).max(LEFT);
                let row = ends.iter().position(|end| begin > *end);
                if let Some(row) = row {
                    ends[row] = begin + width;
                }
                (at, begin, row, &place.name)
            })
            .collect();
        html! {
            @for (at, begin, row, name) in placed {
                line.place x1=(num(at)) y1=(TOP) x2=(num(at)) y2=(HEIGHT - BOTTOM) {}
                @if let Some(row) = row {
                    text.place x=(num(begin)) y=(num(TOP - 4.0 - row as f64 * ROW)) { (name) }
                }
            }
        }
    }
}

fn grid(x: &Scale, y: &Scale) -> Markup {
    let (bottom, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
    html! {
        @for (value, text) in x.ticks() {
            line.grid x1=(num(x.at(value))) y1=(TOP) x2=(num(x.at(value))) y2=(bottom) {}
            text.tick x=(num(x.at(value))) y=(bottom + 15.0) text-anchor="middle" { (text) }
        }
        @for (value, text) in y.ticks() {
            line class=(if value == 0.0 { "zero" } else { "grid" })
                x1=(LEFT) y1=(num(y.at(value))) x2=(right) y2=(num(y.at(value))) {}
            text.tick x=(LEFT - 6.0) y=(num(y.at(value) + 4.0)) text-anchor="end" { (text) }
        }
        rect.frame x=(LEFT) y=(TOP) width=(right - LEFT) height=(bottom - TOP) {}
    }
}

/// Least and greatest of what is a number; 0 to 1 of nothing.
fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let known = values.filter(|value| value.is_finite());
    let (low, high) = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
        (l.min(v), h.max(v))
    });
    if low > high { (0.0, 1.0) } else { (low, high) }
}

/// A coordinate with as many decimals as can be seen.
fn num(value: f64) -> String {
    format!("{value:.1}")
}
