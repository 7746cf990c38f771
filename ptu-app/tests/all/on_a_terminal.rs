//! Answers on a terminal: within its width, in colour where that is wanted, and in a pager where they are longer.

use unicode_width::UnicodeWidthStr as _;

use crate::common::Place;
use crate::common::terminal::Terminal;

const WIDTH: u16 = 80;

/// Lines of an answer that a terminal of 12 rows shows.
fn shown(place: &Place, words: &str, variables: &[(&str, &str)]) -> String {
    let terminal = Terminal::open();
    terminal.resize([12, WIDTH]);
    let mut command = place.command(words);
    // Empty is as if it were not set.
    command.env("NO_COLOR", "").env("TERM", "xterm");
    command.envs(variables.iter().copied());
    terminal.until_end(&mut terminal.start(&command))
}

/// Goal: a narrow terminal shows a table that can be read, and says by colour what did not pass. Method: no line is wider than the
/// terminal, the columns at the right stand for themselves, and colours come and go with the options and variables.
#[test]
fn a_table_fits_the_terminal_and_has_colours_where_they_are_wanted() {
    let place = Place::with_bad_unit();
    let plain = shown(&place, "runs list --color never", &[]);
    assert!(
        plain.starts_with("RUN ") && !plain.contains('\x1b'),
        "{plain}"
    );
    for line in plain.lines() {
        assert!(line.trim_end().width() <= usize::from(WIDTH), "{line}");
    }
    let red = "\x1b[1;31mfailed\x1b[0m";
    assert!(shown(&place, "runs list", &[]).contains(red));
    assert!(!shown(&place, "runs list", &[("NO_COLOR", "1")]).contains('\x1b'));
    assert!(shown(&place, "runs list --color always", &[("NO_COLOR", "1")]).contains(red));
    let piped = place.ptu("runs list").exits(0).out;
    assert!(!piped.contains('\x1b') && piped.lines().any(|line| line.len() > usize::from(WIDTH)));
    let forced = place.ptu_where(("CLICOLOR_FORCE", "1"), "runs list");
    forced.prints(&[red]);
}

#[test]
fn a_long_answer_is_paged_and_a_short_one_is_not() {
    let place = Place::new();
    let pager = [("PAGER", "sed s/^/paged:/")];
    let long = shown(&place, "catalog signals", &pager);
    assert!(long.starts_with("paged:name"), "{long}");
    let plain = shown(&place, "catalog signals --no-pager", &pager);
    assert!(plain.starts_with("name"), "{plain}");
    let short = shown(&place, "catalog signals twc_sent", &pager);
    assert!(short.starts_with("name"), "{short}");
    let plain = shown(&place, "catalog signals --json", &pager);
    assert!(plain.starts_with('['), "{plain}");
}
