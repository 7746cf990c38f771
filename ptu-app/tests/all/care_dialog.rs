//! The care of the history in the window: import of another file, backup, check.

use crate::common::window::{Window, settings};
use crate::common::{Place, list, record_bad_unit, scripts};
use ptu_app::gui::{Page, Settings};
use ptu_report::words::{Language, fill};

/// Goal: a depot without a terminal brings in another laptop's history, copies its own and checks it, and is told in its
/// language what came of each. Method: two laptops that saw one unit each; what the dialog says is what the files hold.
#[test]
fn another_history_is_imported_and_the_file_is_backed_up_and_checked() {
    for language in Language::ALL {
        let words = &language.words().care;
        let other = Place::new();
        record_bad_unit(&other);
        let place = Place::new();
        place.recorded_run();
        let settings = Settings {
            language,
            ..settings(Page::Statistics)
        };
        let mut window = Window::with(place, scripts(), settings);
        window.click(words.title);
        window.wait_for(words.never_synced);
        // Nothing is named yet: nothing can be imported.
        assert!(!window.enabled(words.import) && !window.enabled(words.sync));

        let missing = other.text_path("nothing.db");
        window.write(words.other_file, &missing);
        window.click(words.import);
        window.wait_for_part(words.failed);
        window.write_over(words.other_file, &other.text_path("history.db"));
        window.click(words.import);
        let added = words.imported.split("{runs}").next().unwrap_or_default();
        window.wait_for_part(added);
        let runs = window.place.json(&["runs", "list", "--json"]);
        assert_eq!(list(&runs).len(), 2, "{runs}");

        let copy = window.place.text_path("copy.db");
        window.write_over(words.other_file, &copy);
        window.click(words.backup);
        window.wait_for(&fill(words.backed_up, &[("file", &copy)]));
        let copied = other.json(&["runs", "list", "--json", "--db", &copy]);
        assert_eq!(list(&copied).len(), 2, "{copied}");
        // A copy is never written over.
        window.click(words.backup);
        window.until("refused", |window| {
            !window.shows_part(&fill(words.backed_up, &[("file", &copy)]))
        });

        window.click(words.check);
        let sound = words.sound.split("{traces}").next().unwrap_or_default();
        window.wait_for_part(sound);
        let chain = words.chain.split('{').next().unwrap_or_default();
        assert!(window.shows_part(chain), "{:#?}", window.shown());
    }
}
