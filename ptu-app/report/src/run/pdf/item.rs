//! Items on a PDF page with their positions, in points (1/72 inch) from the upper left corner.

use protocol::display_text;

/// Width of A4.
pub const WIDTH: f32 = 595.28;
/// Height of A4.
pub const HEIGHT: f32 = 841.89;
/// Left and right of what is printed.
pub const MARGIN: f32 = 42.0;
/// Above what flows: the header is within it.
pub const TOP: f32 = 54.0;
/// Below what flows: the footer is within it.
pub const BOTTOM: f32 = 48.0;
/// Width of what is printed.
pub const INSIDE: f32 = WIDTH - 2.0 * MARGIN;

/// What something is drawn in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Words.
    Black,
    /// Less weight.
    Soft,
    /// Passed.
    Good,
    /// Did not pass.
    Bad,
    /// Edges and rules.
    Rule,
    /// Grids.
    Grid,
    /// What is allowed.
    Band,
    /// A shaded stretch.
    Shade,
    /// A curve of this colour.
    Curve(usize),
}

/// Something on a page.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A line of words; its place is the beginning of its base line.
    Text {
        /// From the left.
        x: f32,
        /// From above.
        y: f32,
        /// Height of letters.
        size: f32,
        /// Colour.
        ink: Ink,
        /// Drawn with weight.
        strong: bool,
        /// Runs upwards.
        turned: bool,
        /// The words.
        text: String,
    },
    /// A line through points.
    Line {
        /// The points.
        points: Vec<(f32, f32)>,
        /// Colour.
        ink: Ink,
        /// Thickness.
        width: f32,
        /// Broken.
        dashed: bool,
    },
    /// A filled rectangle: left, top, width and height.
    Area(f32, f32, f32, f32, Ink),
    /// A filled disc: its middle and radius.
    Disc(f32, f32, f32, Ink),
}

impl Item {
    /// A line of words; what cannot be seen is spelled.
    pub fn text(x: f32, y: f32, size: f32, ink: Ink, text: &str) -> Self {
        Self::Text {
            x,
            y,
            size,
            ink,
            strong: false,
            turned: false,
            text: display_text::line(text).into_owned(),
        }
    }

    /// The same with weight, where it is words.
    pub fn strong(mut self) -> Self {
        if let Self::Text { strong, .. } = &mut self {
            *strong = true;
        }
        self
    }

    /// A level line.
    pub fn rule(x: f32, y: f32, long: f32, ink: Ink) -> Self {
        Self::Line {
            points: vec![(x, y), (x + long, y)],
            ink,
            width: 0.5,
            dashed: false,
        }
    }

    /// The same, so much further down.
    pub fn lowered(mut self, by: f32) -> Self {
        match &mut self {
            Self::Text { y, .. } | Self::Area(_, y, ..) | Self::Disc(_, y, ..) => *y += by,
            Self::Line { points, .. } => points.iter_mut().for_each(|point| point.1 += by),
        }
        self
    }
}

/// Items that stay together, from 0 down to `height`.
#[derive(Clone, Debug, Default)]
pub struct Piece {
    /// What is drawn; left edges are the page's, heights the piece's own.
    pub items: Vec<Item>,
    /// Height.
    pub height: f32,
    /// Stays on a page with at least the beginning of what follows.
    pub with_next: bool,
    /// Drawn again at the top of each page on which its table goes on.
    pub repeated: bool,
    /// Belongs to the last piece that is repeated.
    pub under_repeated: bool,
}
