//! Items on a page with their positions, in points (1/72 inch) from the upper left corner.

use protocol::display_text;

use crate::plot::Anchor;

/// Width of A4.
pub const WIDTH: f32 = 595.28;
/// Height of A4.
pub const HEIGHT: f32 = 841.89;
/// Length of a dash and of the gap after it.
pub const DASH: [f32; 2] = [3.0, 2.2];
/// Width of the left and of the right margin.
pub const MARGIN: f32 = 42.0;
/// Height of the top margin, which holds the header.
pub(super) const TOP: f32 = 54.0;
/// Height of the bottom margin, which holds the footer.
pub(super) const BOTTOM: f32 = 48.0;
/// Width of what is printed.
pub(super) const INSIDE: f32 = WIDTH - 2.0 * MARGIN;

/// Colour of a drawn item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Words.
    Black,
    /// Less important text.
    Soft,
    /// Passed.
    Good,
    /// Did not pass.
    Bad,
    /// Edges and rules.
    Rule,
    Grid,
    Band,
    Shade,
    /// A curve of this colour.
    Curve(usize),
}

/// Something on a page.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// Words.
    Text(Text),
    Line {
        points: Vec<(f32, f32)>,
        /// Colour.
        ink: Ink,
        /// Thickness.
        width: f32,
        /// The line is dashed with the lengths of [`DASH`].
        dashed: bool,
    },
    /// A filled rectangle: left, top, width and height.
    Area(f32, f32, f32, f32, Ink),
    /// A filled disc: its middle and radius.
    Disc(f32, f32, f32, Ink),
    /// Beginning of a drawing (left, top, width and height), which the items after it make up, and the drawing's
    /// title for those who cannot see it.
    Drawing(f32, f32, f32, f32, String),
    /// Cells: left, top, width and height, how many are in a row, and their shades, row by row.
    Cells(f32, f32, f32, f32, usize, Vec<u8>),
}

/// Words on a page.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Distance from the left edge of the page to the anchor.
    pub x: f32,
    /// Point of each line of text that lies at `x`.
    pub anchor: Anchor,
    /// Height of letters.
    pub size: f32,
    /// Colour.
    pub ink: Ink,
    /// In bold type.
    pub strong: bool,
    /// Runs upwards.
    pub turned: bool,
    /// Part of a drawing: a screen reader reads the drawing's title instead of this text.
    pub in_drawing: bool,
    /// For each line, the distance of its base line from the top of the page, and its words. The lines together are
    /// the whole text: a line keeps the space or line feed at which it was broken.
    pub lines: Vec<(f32, String)>,
}

impl Item {
    /// A line of text; characters that cannot be seen are written as codes.
    pub(crate) fn text(x: f32, y: f32, size: f32, ink: Ink, text: &str) -> Self {
        Self::lines(
            x,
            size,
            ink,
            vec![(y, display_text::line(text).into_owned())],
        )
    }

    /// Lines of words, each with its base line.
    pub(crate) fn lines(x: f32, size: f32, ink: Ink, lines: Vec<(f32, String)>) -> Self {
        Self::Text(Text {
            x,
            anchor: Anchor::Start,
            size,
            ink,
            strong: false,
            turned: false,
            in_drawing: false,
            lines,
        })
    }

    /// The item in bold type, if it is text.
    pub(crate) fn strong(mut self) -> Self {
        if let Self::Text(text) = &mut self {
            text.strong = true;
        }
        self
    }

    /// The item with each line set to its right end, if it is text.
    pub(crate) fn ending(mut self) -> Self {
        if let Self::Text(text) = &mut self {
            text.anchor = Anchor::End;
        }
        self
    }

    pub(crate) fn rule(x: f32, y: f32, long: f32, ink: Ink) -> Self {
        Self::Line {
            points: vec![(x, y), (x + long, y)],
            ink,
            width: 0.5,
            dashed: false,
        }
    }

    /// A frame, by its upper left corner and its size.
    pub(crate) fn frame(
        (x, y): (f32, f32),
        (wide, high): (f32, f32),
        ink: Ink,
        width: f32,
    ) -> Self {
        let (right, bottom) = (x + wide, y + high);
        Self::Line {
            points: vec![(x, y), (right, y), (right, bottom), (x, bottom), (x, y)],
            ink,
            width,
            dashed: false,
        }
    }

    /// The item moved down by `by`.
    pub(crate) fn lowered(mut self, by: f32) -> Self {
        match &mut self {
            Self::Text(text) => text.lines.iter_mut().for_each(|line| line.0 += by),
            Self::Area(_, y, ..)
            | Self::Disc(_, y, ..)
            | Self::Drawing(_, y, ..)
            | Self::Cells(_, y, ..) => *y += by,
            Self::Line { points, .. } => points.iter_mut().for_each(|point| point.1 += by),
        }
        self
    }
}

/// Items that stay together on one page, from 0 down to `height`.
#[derive(Clone, Debug, Default)]
pub struct Piece {
    /// Items of the piece: x from the page's left edge, y from the top of the piece.
    pub items: Vec<Item>,
    pub height: f32,
    /// Stays on a page with at least the beginning of what follows.
    pub with_next: bool,
    /// Drawn again at the top of each page on which its table goes on.
    pub repeated: bool,
    /// Row of a table, below the last piece that is `repeated`.
    pub under_repeated: bool,
    /// Begins a page.
    pub on_new_page: bool,
    /// The text goes on from the piece before, and is one text with that piece where both are on one page.
    pub goes_on: bool,
}
