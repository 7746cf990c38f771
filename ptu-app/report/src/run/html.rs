//! A test sheet as one HTML file without external parts, for screen and print.

use maud::{DOCTYPE, Markup, PreEscaped, html as markup};

use super::Printed;
use super::block::{Align, Block, Cell, Column, Gauge, Row, RowKind, Table, Tone};
use crate::page_text;
use crate::words::Words;

/// The sheet as an HTML page.
pub fn html(sheet: &impl Printed, words: &Words) -> String {
    let paper = sheet.paper(words);
    let page = markup! {
        (DOCTYPE)
        html lang=(words.language.code()) {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (paper.name) " " (paper.unit) " " (paper.short) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                @if let Some(across) = &paper.across { div.across aria-hidden="true" { (across) } }
                @for block in &paper.blocks { (drawn(block)) }
                footer { (paper.program) ", " (paper.number) }
            }
        }
    };
    page_text(page)
}

fn drawn(block: &Block) -> Markup {
    match block {
        Block::Title(title, below) => markup! { h1 { (title) } p.soft { (below) } },
        Block::Heading(text) => markup! { h2 { (text) } },
        Block::Subheading(text, end) => {
            markup! { h3 { (text) @if !end.is_empty() { " " small { (end) } } } }
        }
        Block::Verdict(tone, verdict, beside) => markup! {
            p class=(format!("verdict {}", class(*tone))) { strong { (verdict) } span { (beside) } }
        },
        Block::Facts(facts) => markup! {
            dl { @for (name, value) in facts {
                div { dt { (name) } @if value.is_empty() { dd { span.line {} } } @else { dd { (value) } } }
            } }
        },
        Block::Text(tone, text) => markup! { p class=(class(*tone)) { (text) } },
        Block::Table(of) => table(of),
        Block::Plot(plot) => markup! { figure { (plot.svg()) } },
        Block::Code(code, below) => markup! { div.code { (code.svg()) p.soft { (below) } } },
        Block::NewPage => markup! { div.new-page {} },
        Block::Signatures(who, date) => markup! {
            div.signatures {
                @for name in who { div { span.line {} p { (name) } } div { span.line {} p { (date) } } }
            }
        },
    }
}

fn table(table: &Table) -> Markup {
    markup! {
        table {
            colgroup { @for column in &table.columns {
                col style=(format!("width:{:.0}%", 100.0 * column.share));
            } }
            @if table.has_headings() {
                thead { tr { @for column in &table.columns {
                    th class=[side(column)] scope="col" { (column.name) }
                } } }
            }
            tbody { @for row in &table.rows { (line(row, &table.columns)) } }
        }
    }
}

fn line(row: &Row, columns: &[Column]) -> Markup {
    let mut place = 0;
    let cells: Vec<_> = row
        .cells
        .iter()
        .map(|(cell, span)| {
            let column = columns.get(place);
            place += span;
            (cell, (*span > 1).then_some(*span), column)
        })
        .collect();
    markup! {
        tr.detail[row.kind == RowKind::Detail] {
            @for (cell, span, column) in cells {
                td colspan=[span] class=[column.and_then(side)] { (content(cell)) }
            }
        }
    }
}

fn side(column: &Column) -> Option<&'static str> {
    (column.align == Align::Right).then_some("number")
}

fn content(cell: &Cell) -> Markup {
    match cell {
        Cell::Text(Tone::Plain, text) => markup! { (text) },
        Cell::Text(tone, text) => markup! { span class=(class(*tone)) { (text) } },
        Cell::Gauge(None) => markup! {},
        Cell::Gauge(Some(gauge)) => bar(gauge),
    }
}

/// Bar with the limits as a band, and the value as a mark: a disc inside, a square outside.
fn bar(gauge: &Gauge) -> Markup {
    let at = |share: f64| format!("{:.1}", 3.0 + 94.0 * share);
    let (from, to) = gauge.band;
    let middle = 3.0 + 94.0 * gauge.value;
    markup! {
        svg.gauge viewBox="0 0 100 12" aria-hidden="true" {
            path.axis d="M3 6H97" {}
            rect.band x=(at(from)) y="3" width=(format!("{:.1}", (94.0 * (to - from)).max(1.0))) height="6" {}
            @if gauge.good {
                circle.good cx=(format!("{middle:.1}")) cy="6" r="3.4" {}
            } @else {
                rect.bad x=(format!("{:.1}", middle - 3.0)) y="0.5" width="6" height="11" {}
            }
        }
    }
}

fn class(tone: Tone) -> &'static str {
    match tone {
        Tone::Plain => "plain",
        Tone::Soft => "soft",
        Tone::Good => "good",
        Tone::Bad => "bad",
    }
}

/// A browser runs nothing that stands in the page, and asks nobody for anything.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";
/// Look of the page: light, dark and on paper.
const STYLE: &str = include_str!("style.css");
