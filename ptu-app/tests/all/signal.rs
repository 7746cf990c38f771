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
