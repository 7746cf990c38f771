//! `ptu signal`: what is made is read, and what is wrong is said.

use crate::common::Place;

/// Goal: what was heard is a table for other programs, and a page for people, in their language. Method: the page of a
/// code and of bytes has the drawings with what is only in theirs.
#[test]
fn what_was_heard_is_a_table_and_a_page() {
    let place = Place::new();
    place.ptu("signal make code 55 c.wav").exits(0);
    place
        .ptu(&["signal", "make", "twc", &"01 fe 3c ".repeat(60), "t.wav"])
        .exits(0);
    let said = place.ptu("signal read c.wav --csv").exits(0);
    let lines: Vec<_> = said.out.lines().collect();
    let heads = "channel,from_s,to_s,kind,what,carrier_hz,rate_hz,level_mv,snr_db,bad_bytes";
    assert_eq!((lines.len(), lines[0]), (2, heads));
    assert!(lines[1].starts_with("1,0.0,") && lines[1].contains(",code,55,"));

    let read = ["signal", "read", "t.wav", "--report", "t.html"];
    place.ptu(&read).exits(0);
    let page = place.read("t.html");
    for said in [
        "01 fe 3c",
        "Spectrum over time",
        "Envelope of the carrier",
        "Eye of the TWC bits",
        "data:image/png;base64,",
        "--report t.html",
    ] {
        assert!(page.contains(said), "no {said}");
    }
    let read = [
        "signal", "read", "c.wav", "--report", "c.html", "--lang", "ko",
    ];
    place.ptu(&read).exits(0);
    let page = place.read("c.html");
    assert!(page.contains("반송파 포락선") && page.contains("<html lang=\"ko\">"));
    assert!(!page.contains("아이 패턴"), "there are no bits in a code");
}
