//! Places pieces on pages, in order: a piece is never cut, a heading never the last of its page, and a
//! table's heading is on every page the table is on.

use super::item::{BOTTOM, HEIGHT, Item, Piece, TOP};

/// Room of a page.
const ROOM: f32 = HEIGHT - TOP - BOTTOM;

pub fn pages(pieces: &[Piece]) -> Vec<Vec<Item>> {
    let mut pages = vec![Vec::new()];
    let mut used = 0.0;
    let mut heading: Option<&Piece> = None;
    for (place, piece) in pieces.iter().enumerate() {
        if piece.repeated {
            heading = Some(piece);
        } else if !piece.under_repeated {
            heading = None;
        }
        let is_full = used + needed(&pieces[place..]) > ROOM;
        if used > 0.0 && (is_full || piece.on_new_page) {
            pages.push(Vec::new());
            used = 0.0;
            if let Some(again) = heading.filter(|_| piece.under_repeated) {
                put(&mut pages, again, &mut used);
            }
        }
        put(&mut pages, piece, &mut used);
    }
    pages
}

/// Height of the first piece and of all that must stand with it.
fn needed(pieces: &[Piece]) -> f32 {
    let bound = pieces.iter().take_while(|piece| piece.with_next);
    let together = bound.clone().count() + 1;
    let all = pieces.iter().take(together).map(|piece| piece.height);
    let height: f32 = all.sum();
    // Pieces that together are longer than a page cannot stay together.
    if height > ROOM {
        pieces.first().map_or(0.0, |piece| piece.height)
    } else {
        height
    }
}

fn put(pages: &mut [Vec<Item>], piece: &Piece, used: &mut f32) {
    if let Some(page) = pages.last_mut() {
        let by = TOP + *used;
        for item in piece.items.iter().map(|item| item.clone().lowered(by)) {
            match (page.last_mut(), item) {
                (Some(Item::Text(before)), Item::Text(after)) if piece.goes_on => {
                    before.lines.extend(after.lines);
                }
                (_, item) => page.push(item),
            }
        }
    }
    *used += piece.height;
}

#[cfg(test)]
mod tests {
    use super::super::item::Ink;
    use super::*;

    fn piece(name: &str, height: f32) -> Piece {
        Piece {
            items: vec![Item::text(0.0, height, 8.0, Ink::Black, name)],
            height,
            ..Piece::default()
        }
    }

    fn names(page: &[Item]) -> Vec<&str> {
        page.iter()
            .filter_map(|item| match item {
                Item::Text(text) => Some(&text.lines),
                _ => None,
            })
            .flatten()
            .map(|(_, words)| words.as_str())
            .collect()
    }

    #[test]
    fn a_table_repeats_its_heading_and_every_item_is_on_a_page() {
        let heading = Piece {
            repeated: true,
            with_next: true,
            ..piece("heading", 20.0)
        };
        let row = Piece {
            under_repeated: true,
            ..piece("row", 15.0)
        };
        let mut pieces = vec![piece("before", 100.0), heading];
        pieces.extend(std::iter::repeat_n(row, 150));
        pieces.push(piece("after", 40.0));
        let pages = pages(&pieces);
        assert_eq!(pages.len(), 4);
        for page in &pages {
            assert!(names(page).contains(&"heading"));
            for item in page {
                let Item::Text(text) = item else { continue };
                let (y, _) = text.lines[0];
                assert!((TOP..=HEIGHT - BOTTOM).contains(&y), "{item:?}");
            }
        }
        let rows = pages.iter().flat_map(|page| names(page));
        assert_eq!(rows.filter(|name| *name == "row").count(), 150);
        assert_eq!(names(&pages[3]).last(), Some(&"after"));
    }

    #[test]
    fn lines_of_a_paragraph_are_one_text_on_each_page() {
        let line = |name, goes_on| Piece {
            goes_on,
            ..piece(name, 20.0)
        };
        let mut pieces = vec![piece("full", ROOM - 40.0), line("a ", false)];
        pieces.extend(["b ", "c ", "d"].map(|name| line(name, true)));
        let pages = pages(&pieces);
        assert_eq!([pages[0].len(), pages[1].len()], [2, 1]);
        assert_eq!(names(&pages[0]), ["full", "a ", "b "]);
        assert_eq!(names(&pages[1]), ["c ", "d"]);
    }

    #[test]
    fn a_heading_stays_with_the_text_after_it() {
        let heading = Piece {
            with_next: true,
            ..piece("heading", 30.0)
        };
        let pieces = [piece("full", ROOM - 40.0), heading, piece("text", 20.0)];
        let pages = pages(&pieces);
        assert_eq!(names(&pages[1]), ["heading", "text"]);
    }
}
