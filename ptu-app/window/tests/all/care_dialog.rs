//! The care of the history in the window: import of another file, backup, check.

use crate::common::is_english;
use crate::common::window::{Window, settings_in};
use crate::common::{Place, list, record_bad_unit, scripts};
use fault_db::ProblemKind;
use ptu_options::Page;
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
        let settings = settings_in(language, Page::Statistics);
        let mut window = Window::with(place, scripts(), settings);
        window.click_for(words.title, words.never_synced);
        // Nothing is named yet: nothing can be imported.
        assert!(!window.enabled(words.import) && !window.enabled(words.sync));

        let missing = other.text_path("nothing.db");
        window.write(words.other_file, &missing);
        window.click_for_part(words.import, words.failed);
        window.write_over(words.other_file, &other.text_path("history.db"));
        window.click(words.import);
        let added = words.imported.split("{runs}").next().unwrap_or_default();
        window.wait_for_part(added);
        let runs = window.place.json("runs list --json");
        assert_eq!(list(&runs).len(), 2, "{runs}");

        let copy = window.place.text_path("copy.db");
        window.write_over(words.other_file, &copy);
        window.click_for(words.backup, &fill(words.backed_up, &[("file", &copy)]));
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

/// Goal: Stop stops, and what was not done to its end is not there. Method: another program holds the file while an import is
/// begun and stopped; when it lets go, nothing has come in.
#[test]
fn an_import_ends_when_it_is_stopped() {
    let language = Language::Korean;
    let words = language.words();
    let other = Place::new();
    record_bad_unit(&other);
    let place = Place::new();
    place.recorded_run();
    let settings = settings_in(language, Page::Statistics);
    let holder = rusqlite::Connection::open(place.path("history.db")).expect("the file");
    let mut window = Window::with(place, scripts(), settings);
    window.click_for(words.care.title, words.care.never_synced);
    window.write(words.care.other_file, &other.text_path("history.db"));
    holder.execute_batch("BEGIN IMMEDIATE").expect("held");
    window.click(words.care.import);
    window.click(words.memory.stop);
    holder.execute_batch("ROLLBACK").expect("let go");
    window.wait_for(words.care.nothing_done);
    let runs = window.place.json("runs list --json");
    assert_eq!(list(&runs).len(), 1, "{runs}");
}

/// Goal: who reads Korean is told what is wrong with a file, and is sent to no command. Method: a row is changed and one taken
/// out, then the window's check; an import of what is no history.
#[test]
fn what_is_wrong_with_a_file_is_told_without_commands_in_both_languages() {
    for language in Language::ALL {
        let words = language.words();
        let place = Place::with_bad_unit();
        let damage = rusqlite::Connection::open(place.path("history.db")).expect("the file");
        let done = damage.execute_batch(
            "PRAGMA foreign_keys = OFF;
             DELETE FROM fault_event; UPDATE fault SET occurrences = 9; CREATE TABLE stray(x)",
        );
        done.expect("damaged");
        drop(damage);
        let no_history = place.write("list.txt", "no history at all, but a text of some length");
        let settings = settings_in(language, Page::Statistics);
        let mut window = Window::with(place, scripts(), settings);
        window.click_for(words.care.title, words.care.never_synced);
        window.write(words.care.other_file, &no_history);
        window.click_for_part(words.care.import, words.care.failed);
        if language == Language::Korean {
            window.wait_for_part("이 프로그램의 것이 아님: 테이블");
        }
        window.click_for_part(
            words.care.check,
            words.care.damaged.split('{').next().unwrap_or_default(),
        );
        let told = window.shown();
        let commands = told
            .iter()
            .find(|text| text.contains("db ") && text.contains('`'));
        assert_eq!(commands, None);
        let of_seals: Vec<_> = told
            .iter()
            .filter(|text| text.contains(words.problem_kind(ProblemKind::Seal)))
            .collect();
        assert!(!of_seals.is_empty(), "{told:#?}");
        let english = told.iter().find(|text| is_english(text));
        assert!(
            language == Language::English || english.is_none(),
            "{english:?}"
        );
    }
}
