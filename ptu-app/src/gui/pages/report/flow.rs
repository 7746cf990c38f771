//! Where each piece of a sheet stands when the sheet is so wide, so that only what is in view needs to
//! be laid out and drawn. All lengths in points.

use ptu_report::run::{Align, Block, Cell, Column, Row, RowKind, Table, Tone};

/// Sizes of letters.
pub const TITLE: f32 = 24.0;
pub const HEADING: f32 = 18.0;
pub const SUBHEADING: f32 = 15.5;
pub const TEXT: f32 = 14.0;
pub const CELL: f32 = 13.5;
/// Free above a heading and a subheading, and below all kinds of words.
pub const ABOVE_HEADING: f32 = 20.0;
pub const ABOVE_SUBHEADING: f32 = 10.0;
pub const BELOW: f32 = 6.0;
/// Around the verdict, within its frame.
pub const INSIDE_FRAME: f32 = 10.0;
/// Names of facts take so much.
pub const NAMES: f32 = 210.0;
/// Free above and below a row's words, between columns, and before details.
pub const AROUND_ROW: f32 = 3.0;
pub const BETWEEN: f32 = 10.0;
pub const INDENT: f32 = 14.0;
/// Lines to sign on.
pub const SIGNATURES: f32 = 90.0;

/// Height of a text in letters of this size when it is so wide.
pub type Measure<'a> = dyn FnMut(&str, f32, f32) -> f32 + 'a;

/// A block, or a line of it, and where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Place of its block in the sheet.
    pub block: usize,
    /// Place in the block: a fact, or a table's row with 0 for the heading.
    pub line: usize,
    /// From the top of the sheet.
    pub top: f32,
    /// Its own height.
    pub height: f32,
}

/// A sheet of this width.
pub struct Flow {
    /// Its width.
    pub width: f32,
    /// Its height.
    pub height: f32,
    pieces: Vec<Piece>,
}

impl Flow {
    /// Places all of it.
    pub fn new(blocks: &[Block], width: f32, measure: &mut Measure<'_>) -> Self {
        let mut flow = Self {
            width,
            height: 0.0,
            pieces: Vec::new(),
        };
        for (place, block) in blocks.iter().enumerate() {
            for line in 0..lines(block) {
                let height = height(block, line, width, measure);
                flow.pieces.push(Piece {
                    block: place,
                    line,
                    top: flow.height,
                    height,
                });
                flow.height += height;
            }
            flow.height += match block {
                Block::Facts(_) | Block::Table(_) => BELOW,
                _ => 0.0,
            };
        }
        flow
    }

    /// What is seen between these heights, in part or as a whole.
    pub fn within(&self, from: f32, to: f32) -> &[Piece] {
        let first = self.pieces.partition_point(|p| p.top + p.height < from);
        let end = self.pieces.partition_point(|p| p.top <= to);
        self.pieces.get(first..end).unwrap_or_default()
    }
}

/// A cell and where it stands in its row.
pub struct Placed<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// From the left of the sheet.
    pub left: f32,
    /// Width for what is in it.
    pub width: f32,
    /// At which side that stands.
    pub align: Align,
}

/// The cells of a row when the table is so wide.
pub fn placed<'a>(row: &'a Row, columns: &[Column], width: f32) -> Vec<Placed<'a>> {
    let (mut place, mut left) = (0, 0.0);
    let cell = |(cell, span): &'a (Cell, usize)| {
        let covered = columns.iter().skip(place).take(*span);
        let wide: f32 = covered.map(|column| column.share * width).sum();
        let indent = match (place, row.kind) {
            (0, RowKind::Detail) => INDENT,
            _ => 0.0,
        };
        let align = columns
            .get(place)
            .map_or(Align::Left, |column| column.align);
        let placed = Placed {
            cell,
            left: left + indent,
            width: (wide - indent - BETWEEN).max(CELL),
            align,
        };
        place += span;
        left += wide;
        placed
    };
    row.cells.iter().map(cell).collect()
}

/// A table's heading as a row.
pub fn heading(table: &Table) -> Row {
    let names = table.columns.iter();
    Row {
        kind: RowKind::Head,
        cells: names
            .map(|column| (Cell::Text(Tone::Soft, column.name.clone()), 1))
            .collect(),
    }
}

fn lines(block: &Block) -> usize {
    match block {
        Block::Facts(facts) => facts.len(),
        Block::Table(table) => 1 + table.rows.len(),
        _ => 1,
    }
}

fn height(block: &Block, line: usize, width: f32, measure: &mut Measure<'_>) -> f32 {
    match block {
        Block::Title(title, below) => {
            measure(title, TITLE, width) + measure(below, TEXT, width) + 2.0 * BELOW
        }
        Block::Heading(text) => ABOVE_HEADING + measure(text, HEADING, width) + 2.0 * BELOW,
        Block::Subheading(text, _) => ABOVE_SUBHEADING + measure(text, SUBHEADING, width) + BELOW,
        Block::Verdict(_, verdict, _) => {
            measure(verdict, TITLE, width) + 2.0 * INSIDE_FRAME + 2.0 * BELOW
        }
        Block::Facts(facts) => facts.get(line).map_or(0.0, |(name, value)| {
            let name = measure(name, TEXT, NAMES - BETWEEN);
            name.max(measure(value, TEXT, (width - NAMES).max(TEXT))) + AROUND_ROW
        }),
        Block::Text(_, text) => measure(text, TEXT, width) + BELOW,
        Block::Table(table) if line == 0 => row_height(&heading(table), table, width, measure),
        Block::Table(table) => table
            .rows
            .get(line - 1)
            .map_or(0.0, |row| row_height(row, table, width, measure)),
        Block::Plot(plot) => plot.size(f64::from(width)).1 as f32 + BELOW,
        Block::Signatures(..) => SIGNATURES,
    }
}

fn row_height(row: &Row, table: &Table, width: f32, measure: &mut Measure<'_>) -> f32 {
    let cells = placed(row, &table.columns, width).into_iter();
    let heights = cells.map(|placed| match placed.cell {
        Cell::Text(_, text) | Cell::Verdict(_, text) => measure(text, CELL, placed.width),
        Cell::Gauge(_) => CELL,
    });
    heights.fold(CELL, f32::max) + 2.0 * AROUND_ROW
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each letter as wide as its size, lines as high.
    fn measure(text: &str, size: f32, width: f32) -> f32 {
        let a_line = (width / size).floor().max(1.0);
        (text.chars().count() as f32 / a_line).ceil().max(1.0) * size
    }

    fn sheet(rows: usize) -> Vec<Block> {
        let columns = vec![
            Column::new("step", 0.6, Align::Left),
            Column::new("value", 0.4, Align::Right),
        ];
        let row = |n: usize| Row::words(RowKind::Detail, ["x".repeat(n), n.to_string()]);
        vec![
            Block::Title("Test sheet".into(), "unit".into()),
            Block::Table(Table {
                columns,
                rows: (0..rows).map(row).collect(),
            }),
            Block::Facts(vec![("a".into(), "b".into()); 3]),
        ]
    }

    #[test]
    fn pieces_follow_each_other_and_only_those_in_view_are_drawn() {
        let flow = Flow::new(&sheet(200), 600.0, &mut measure);
        let all = flow.within(0.0, flow.height);
        assert_eq!(all.len(), 1 + 201 + 3);
        for pair in all.windows(2) {
            assert!(pair[0].top + pair[0].height <= pair[1].top, "{pair:?}");
        }
        let seen = flow.within(1_000.0, 1_400.0);
        assert!(seen.len() < 40);
        assert!(seen[0].top <= 1_000.0 && seen[seen.len() - 1].top <= 1_400.0);
        assert!(flow.within(flow.height + 1.0, flow.height + 9.0).is_empty());
        assert!(flow.within(9.0, -9.0).is_empty(), "nothing, and no panic");
    }

    #[test]
    fn a_narrow_sheet_is_longer_and_an_empty_one_has_no_length() {
        let blocks = sheet(100);
        let wide = Flow::new(&blocks, 900.0, &mut measure);
        assert!(Flow::new(&blocks, 300.0, &mut measure).height > wide.height);
        assert_eq!(Flow::new(&[], 300.0, &mut measure).height, 0.0);
    }

    #[test]
    fn cells_are_in_their_columns_and_details_are_indented() {
        let columns = [
            Column::new("step", 0.6, Align::Left),
            Column::new("value", 0.4, Align::Right),
        ];
        let row = Row::words(RowKind::Detail, ["a".to_owned(), "1".to_owned()]);
        let cells = placed(&row, &columns, 500.0);
        assert_eq!(
            (cells[0].left, cells[0].width),
            (INDENT, 300.0 - INDENT - BETWEEN)
        );
        assert_eq!((cells[1].left, cells[1].align), (300.0, Align::Right));
    }
}
