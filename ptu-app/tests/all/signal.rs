//! `ptu signal`: what is made is read, and what is wrong is said.

use crate::common::{Place, text};

/// Goal: a technician makes a code with noise, reads it, and sees its name, level and noise; a program gets the same as
/// JSON.
#[test]
fn a_code_and_bytes_that_were_made_are_read() {
    let place = Place::new();
    let make = [
        "signal", "make", "code", "55", "--level", "300", "--snr", "20", "c.wav",
    ];
    let said = place.ptu(&make).exits(0);
    assert!(said.out.contains("c.wav: 2.00 s"), "{}", said.all());
    let reading = place.json(&["signal", "read", "c.wav", "--json"]);
    let source = &reading["sources"][0];
    assert_eq!(
        (text(&source["kind"]), text(&source["what"])),
        ("code", "55")
    );
    let level = source["level_mv"].as_f64().expect("a number");
    assert!((level - 300.0).abs() < 25.0, "{level}");
    let said = place.ptu(&["signal", "read", "c.wav"]).exits(0);
    assert!(
        said.out.contains("SNR dB") && said.out.contains("55"),
        "{}",
        said.all()
    );

    place
        .ptu(&["signal", "make", "twc", "01 fe3c", "t.wav"])
        .exits(0);
    let reading = place.json(&["signal", "read", "t.wav", "--json"]);
    assert_eq!(text(&reading["sources"][0]["what"]), "01 fe 3c");
    assert_eq!(reading["not_understood"].as_array().map(Vec::len), Some(0));
}

/// Goal: what was heard is a table for other programs, and a page for people, in their language. Method: the page of a
/// code and of bytes has the drawings with what is only in theirs.
#[test]
fn what_was_heard_is_a_table_and_a_page() {
    let place = Place::new();
    place
        .ptu(&["signal", "make", "code", "55", "c.wav"])
        .exits(0);
    place
        .ptu(&["signal", "make", "twc", &"01 fe 3c ".repeat(60), "t.wav"])
        .exits(0);
    let said = place.ptu(&["signal", "read", "c.wav", "--csv"]).exits(0);
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
    place
        .ptu(&["signal", "read", "c.wav", "--report", "c.pdf"])
        .exits(2)
        .explains(&["ends in .html"]);
}

#[test]
fn what_cannot_be_made_or_read_is_said() {
    let place = Place::new();
    place
        .ptu(&["signal", "make", "code", "54", "x.wav"])
        .exits(2)
        .explains(&["no code \"54\"", "55"]);
    for wrong in ["", "1", "xy", "0 1 2"] {
        place
            .ptu(&["signal", "make", "twc", wrong, "x.wav"])
            .exits(2);
    }
    for level in ["0", "-5", "nan", "1e9"] {
        let make = [
            "signal",
            "make",
            "code",
            "55",
            "x.wav",
            &format!("--level={level}"),
        ];
        place.ptu(&make).exits(2);
    }
    place
        .ptu(&["signal", "read", "none.wav"])
        .exits(3)
        .explains(&["none.wav"]);
    place.write("text.wav", "a text");
    place
        .ptu(&["signal", "read", "text.wav"])
        .exits(2)
        .explains(&["text.wav is no WAV file"]);
    let loud = ["signal", "make", "code", "55", "l.wav", "--level", "4000"];
    let said = place.ptu(&loud).exits(0);
    assert!(said.out.contains("raise --full-scale"), "{}", said.all());
}
