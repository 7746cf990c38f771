//! The marks a plot consists of, for every output medium.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    Line,
    Dashed,
    Dots,
    /// Bars from 0, as wide as points are apart.
    Bars,
}

/// Purpose of a mark; its look follows from the purpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Name of the plot.
    Title,
    /// Name of an axis.
    Label,
    /// Value at an axis.
    Tick,
    /// Name of a curve.
    Legend,
    AxisMark,
    /// Note on a curve at a point.
    Note,
    /// Line of the grid.
    Grid,
    /// Line of the grid at 0.
    Zero,
    /// Edge of the plot.
    Frame,
    Shaded,
    /// Values, in this style and colour.
    Values(Style, usize),
}

/// Point of a text that lies at the place of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    /// Share of the text's width that lies before the anchor.
    pub fn share(self) -> f32 {
        match self {
            Self::Start => 0.0,
            Self::Middle => 0.5,
            Self::End => 1.0,
        }
    }
}

/// A mark, in units of the drawing from its upper left corner.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A text on a line.
    Text {
        role: Role,
        /// Place of the anchor, on the base line.
        at: (f64, f64),
        /// Point of the text that lies at `at`.
        anchor: Anchor,
        /// Runs upwards.
        turned: bool,
        text: String,
    },
    Line {
        role: Role,
        /// Points of each piece of the line.
        pieces: Vec<Vec<(f64, f64)>>,
    },
    Area {
        role: Role,
        /// Upper left corner.
        at: (f64, f64),
        /// Width and height.
        size: (f64, f64),
    },
    /// Cells, each of a shade.
    Raster {
        /// Upper left corner.
        at: (f64, f64),
        /// Width and height.
        size: (f64, f64),
        /// Cells in a row.
        columns: usize,
        /// Shades from the upper left corner on, row by row.
        shades: Vec<u8>,
    },
    Dot {
        role: Role,
        at: (f64, f64),
    },
}

/// About the room a text takes at the size plots are written in: Hangul is twice as wide as Latin.
pub fn room(text: &str) -> f64 {
    text.chars()
        .map(|letter| if letter >= '\u{1100}' { WIDE } else { NARROW })
        .sum()
}

/// Room a Latin letter takes.
const NARROW: f64 = 6.4;
/// Room a Hangul syllable takes.
const WIDE: f64 = 11.5;
