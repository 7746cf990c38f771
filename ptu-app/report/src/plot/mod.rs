//! Line plots: axes with round ticks, light grid, legend, named places as vertical lines. A plot
//! becomes marks, which SVG or any other output can draw.

mod curve;
mod mark;
mod raster;
mod scale;
mod svg;

use maud::Markup;

pub use mark::{Anchor, Mark, Role, Style};
pub use raster::{Raster, colour};

use mark::room;
use scale::Scale;

/// Size of the drawing on a page, in units of the drawing.
const WIDTH: f64 = 1000.0;
const HEIGHT: f64 = 300.0;
/// Width left beside the plot for labels.
const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 46.0;
const BOTTOM: f64 = 42.0;
/// Height of a row of place names above the plot.
const ROW: f64 = 12.0;
/// Share of an axis left free at each end.
const FREE: f64 = 0.04;
/// Least width of a shaded stretch.
const THINNEST: f64 = 1.0;
/// Width left of the plot beside the longest name at the vertical axis.
const BESIDE_TICKS: f64 = 26.0;
/// Length of the line before a name in the legend, and the width that this line and the gaps take.
const SAMPLE: f64 = 20.0;
const SAMPLE_ROOM: f64 = 34.0;

#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Colour, 0 to 5.
    pub colour: usize,
    pub style: Style,
    /// Points of the curve; a point that is not a number interrupts it.
    pub points: Vec<(f64, f64)>,
}

/// A place on the horizontal axis.
#[derive(Clone, Debug)]
pub struct AxisMark {
    pub x: f64,
    pub name: String,
}

/// Note on a curve at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Note {
    pub at: (f64, f64),
    /// The note is written if it ends before this x.
    pub until: f64,
    pub text: String,
}

#[derive(Clone, Debug, Default)]
pub struct Plot {
    pub title: String,
    /// Horizontal axis with its unit.
    pub x_label: String,
    /// Vertical axis with its unit.
    pub y_label: String,
    /// Ends of the horizontal axis; `None` = as far as the points.
    pub x_range: Option<(f64, f64)>,
    /// Range that the vertical axis covers at least.
    pub y_reach: Option<(f64, f64)>,
    /// Cells behind the curves; pages of paper do not have them.
    pub raster: Option<Raster>,
    /// Curves, the last on top.
    pub series: Vec<Series>,
    pub places: Vec<AxisMark>,
    /// Stretches of the horizontal axis that are shaded, each from its first end to its second.
    pub shaded: Vec<(f64, f64)>,
    /// Names at the vertical axis instead of numbers, each with its place on that axis.
    pub names: Vec<(f64, String)>,
    pub notes: Vec<Note>,
    /// Least width left of the plot, so that plots below each other begin at the same place.
    pub beside: Option<f64>,
    /// Height, in units of the drawing; none = 300.
    pub height: Option<f64>,
}

/// Where the plot is within its drawing.
struct Edges {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Plot {
    /// The drawing for a page.
    pub fn svg(&self) -> Markup {
        svg::svg(&self.title, self.size(WIDTH), &self.marks(WIDTH))
    }

    /// Width and height of the drawing when it is so wide.
    pub fn size(&self, width: f64) -> (f64, f64) {
        (width, self.height.unwrap_or(HEIGHT))
    }

    /// Width left beside the plot for the names of its lanes.
    pub fn left(&self) -> f64 {
        let names = self.names.iter().map(|name| room(&name.1) + BESIDE_TICKS);
        names.fold(self.beside.unwrap_or(LEFT), f64::max)
    }

    /// All there is to draw, from back to front.
    pub fn marks(&self, width: f64) -> Vec<Mark> {
        let (width, height) = self.size(width);
        let edges = Edges {
            left: self.left(),
            right: width - RIGHT,
            top: TOP,
            bottom: height - BOTTOM,
        };
        let free = if self.x_range.is_some() { 0.0 } else { FREE };
        let x = Scale::new(self.x_extent(), (edges.left, edges.right), free);
        let y = Scale::new(self.y_extent(&x), (edges.bottom, edges.top), FREE);
        let middle = |a: f64, b: f64| (a + b) / 2.0;
        let (across, down) = (
            middle(edges.left, edges.right),
            middle(edges.top, edges.bottom),
        );
        let mut marks = vec![text(Role::Title, Anchor::Start, (LEFT, 13.0), &self.title)];
        marks.extend(self.legend(&edges));
        marks.extend(self.raster.as_ref().map(|raster| raster.mark(&x, &y)));
        marks.extend(self.shades(&x, &edges));
        marks.extend(self.grid(&x, &y, &edges));
        marks.extend(self.named_places(&x, &edges, width));
        for series in &self.series {
            marks.extend(curve::drawn(series, &x, &y));
        }
        marks.extend(self.said(&x, &y));
        let below = (across, height - 6.0);
        marks.push(text(Role::Label, Anchor::Middle, below, &self.x_label));
        marks.push(Mark::Text {
            role: Role::Label,
            at: (13.0, down),
            anchor: Anchor::Middle,
            turned: true,
            text: self.y_label.clone(),
        });
        marks
    }

    fn x_extent(&self) -> (f64, f64) {
        let points = self.series.iter().flat_map(|series| &series.points);
        self.x_range
            .unwrap_or_else(|| extent(points.map(|point| point.0)))
    }

    /// Range of the y axis over the x values in view.
    fn y_extent(&self, x: &Scale) -> (f64, f64) {
        let points = self.series.iter().flat_map(|series| &series.points);
        let seen = points.filter(|point| x.holds(point.0)).map(|point| point.1);
        let reach = self.y_reach.map(|(low, high)| [low, high]);
        extent(seen.chain(reach.into_iter().flatten()))
    }

    /// Legend from the right edge, in the order of the curves; one entry for each name.
    fn legend(&self, edges: &Edges) -> Vec<Mark> {
        let mut entries: Vec<&Series> = Vec::new();
        for series in &self.series {
            if !series.name.is_empty() && entries.iter().all(|entry| entry.name != series.name) {
                entries.push(series);
            }
        }
        let mut at = edges.right;
        let mut marks = Vec::new();
        for series in entries.into_iter().rev() {
            at -= room(&series.name) + SAMPLE_ROOM;
            marks.push(Mark::Line {
                role: curve::role(series),
                pieces: vec![vec![(at, 9.0), (at + SAMPLE, 9.0)]],
            });
            let beside = (at + SAMPLE + 5.0, 13.0);
            marks.push(text(Role::Legend, Anchor::Start, beside, &series.name));
        }
        marks
    }

    fn shades(&self, x: &Scale, edges: &Edges) -> Vec<Mark> {
        let seen = self
            .shaded
            .iter()
            .filter(|(from, to)| x.holds(*from) && x.holds(*to));
        seen.map(|(from, to)| Mark::Area {
            role: Role::Shaded,
            at: (x.at(*from), edges.top),
            size: (
                (x.at(*to) - x.at(*from)).max(THINNEST),
                edges.bottom - edges.top,
            ),
        })
        .collect()
    }

    /// Lines at the places of the axis. A name stands in the first row above the plot that has room for it.
    fn named_places(&self, x: &Scale, edges: &Edges, width: f64) -> Vec<Mark> {
        let mut ends = [f64::NEG_INFINITY; 2];
        let mut marks = Vec::new();
        for place in self.places.iter().filter(|place| x.holds(place.x)) {
            let at = x.at(place.x);
            marks.push(line(Role::AxisMark, (at, edges.top), (at, edges.bottom)));
            let long = room(&place.name) + 4.0;
            // A name at the edge stays within the drawing, however long it is.
            let begin = (at - long / 2.0).min(width - long).max(edges.left);
            if let Some(row) = ends.iter().position(|end| begin > *end) {
                ends[row] = begin + long;
                let above = edges.top - 4.0 - row as f64 * ROW;
                let at = (begin, above);
                marks.push(text(Role::AxisMark, Anchor::Start, at, &place.name));
            }
        }
        marks
    }

    fn grid(&self, x: &Scale, y: &Scale, edges: &Edges) -> Vec<Mark> {
        let mut marks = Vec::new();
        for (value, name) in x.ticks() {
            let at = x.at(value);
            marks.push(line(Role::Grid, (at, edges.top), (at, edges.bottom)));
            let below = (at, edges.bottom + 15.0);
            marks.push(text(Role::Tick, Anchor::Middle, below, &name));
        }
        let values = if self.names.is_empty() {
            y.ticks()
        } else {
            self.names.clone()
        };
        for (value, name) in values {
            let at = y.at(value);
            if self.names.is_empty() {
                let role = if value == 0.0 { Role::Zero } else { Role::Grid };
                marks.push(line(role, (edges.left, at), (edges.right, at)));
            }
            let beside = (edges.left - 6.0, at + 4.0);
            marks.push(text(Role::Tick, Anchor::End, beside, &name));
        }
        marks.push(Mark::Area {
            role: Role::Frame,
            at: (edges.left, edges.top),
            size: (edges.right - edges.left, edges.bottom - edges.top),
        });
        marks
    }

    /// Notes for which there is room.
    fn said(&self, x: &Scale, y: &Scale) -> Vec<Mark> {
        let fits = |note: &&Note| {
            x.holds(note.at.0)
                && x.at(note.at.0) + room(&note.text) + 4.0 < x.at(x.clamp(note.until))
        };
        let written = self.notes.iter().filter(fits);
        written
            .map(|note| {
                let at = (x.at(note.at.0) + 3.0, y.at(note.at.1));
                text(Role::Note, Anchor::Start, at, &note.text)
            })
            .collect()
    }
}

fn text(role: Role, anchor: Anchor, at: (f64, f64), text: &str) -> Mark {
    Mark::Text {
        role,
        at,
        anchor,
        turned: false,
        text: text.to_owned(),
    }
}

fn line(role: Role, from: (f64, f64), to: (f64, f64)) -> Mark {
    Mark::Line {
        role,
        pieces: vec![vec![from, to]],
    }
}

/// Least and greatest finite value; 0 and 1 if there is none.
fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let known = values.filter(|value| value.is_finite());
    let (low, high) = known.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
        (l.min(v), h.max(v))
    });
    if low > high { (0.0, 1.0) } else { (low, high) }
}
