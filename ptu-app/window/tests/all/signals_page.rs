//! The page of waveforms.

use crate::common::window::{Window, settings_in};
use crate::common::{Place, scripts};
use ptu_options::Page;
use ptu_report::words::{Language, fill};

/// Goal: who has no terminal sees what is in a recording, and makes one. Method: the generator saves bytes with noise, and the
/// page, in both languages, opens that file and shows the bytes and the drawings; a text is no recording, and that is said.
#[test]
fn what_the_generator_saves_is_opened_and_heard() {
    for language in Language::ALL {
        let words = language.words();
        let said = &words.signals;
        let settings = settings_in(language, Page::Signals);
        let place = Place::new();
        let file = place.text_path("made.wav");
        place.write("text.wav", "a text");
        let mut window = Window::with(place, scripts(), settings);
        window.click(said.generator);
        window.name_file(words.common.file, &file);
        window.click(said.twc);
        window.write_over(said.bytes, "01 fe 3x");
        window.wait_for(said.bytes_hint);
        assert!(!window.enabled(said.play), "there is nothing to play");
        window.write_over(said.bytes, "5a c3");
        window.click(said.noise);
        window.click(said.save);
        // The work has ended once it is told, some frames after the file is there.
        let saved = |path: &str| fill(words.common.saved, &[("file", &path)]);
        window.wait_for_part(&saved(&file));
        assert!(window.place.path("made.wav").is_file());
        window.click(said.recording_of);
        window.click_for_part(said.open, "5a c3");
        window.wait_for(said.waveform);
        window.keep_picture(&format!("waves {language:?}"));
        // Never over one that is there.
        window.click(said.generator);
        window.click(said.save);
        let another = window.place.text_path("made-2.wav");
        window.wait_for_part(&saved(&another));
        assert!(window.place.path("made-2.wav").is_file());
        window.click(said.recording_of);
        let text = window.place.text_path("text.wav");
        window.name_file(words.common.file, &text);
        window.click(said.open);
        window.wait_for_part(language.choose([
            "text.wav is no WAV file",
            "읽을 수 있는 WAV 파일이 아닙니다",
        ]));
        assert!(window.shows_part("5a c3"), "what was shown stays");
    }
}
