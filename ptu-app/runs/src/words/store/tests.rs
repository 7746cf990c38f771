//! Each error of the store in both languages.

use std::sync::Arc;

use super::*;
use crate::failure::{Failure, Near, RunTrouble, Trouble, Unknown};

const SOURCE: &str = include_str!("../store.rs");
const ERRORS: &str = include_str!("../../../../../fault-db/src/error/mod.rs");
/// English and Korean, as a window says them.
const WINDOW: [TextStyle; 2] = [
    TextStyle {
        korean: false,
        commands: false,
    },
    TextStyle {
        korean: true,
        commands: false,
    },
];

/// The sentences of a window: what helps at a command line stands before them.
fn told() -> &'static str {
    let begin = SOURCE.find("pub(super) fn in_window").expect("there");
    &SOURCE[begin..]
}

fn names_a_command(text: &str) -> bool {
    ["`", "--", "ptu ", "db ", "createdb"]
        .iter()
        .any(|command| text.contains(command))
}

/// Goal: words with a command, or with English in the Korean, fail. Method: all texts of the sources.
#[test]
fn no_text_names_a_command_and_the_korean_is_korean() {
    let sources = [told(), include_str!("../damage.rs")];
    let all = sources.map(|source| source.split("#[cfg(test)]").next().unwrap_or(source));
    let lines = all.iter().flat_map(|source| source.lines());
    for text in lines.flat_map(|line| line.split('"').skip(1).step_by(2)) {
        assert!(!names_a_command(text), "{text}");
        if !text.contains(|letter: char| ('가'..='힣').contains(&letter)) {
            continue;
        }
        // What stands before a closing brace is a place.
        let parts = text
            .split('{')
            .map(|part| part.rsplit('}').next().unwrap_or(part));
        let mut words = parts.flat_map(|part| part.split(|c: char| !c.is_ascii_lowercase()));
        let of_files = [
            "postgres",
            "sslmode",
            "disable",
            "sslrootcert",
            "wal",
            "train",
            "date",
            "bit",
            "sim",
            "serial",
            "tcp",
            "lockstep",
        ];
        let english = words.find(|word| word.len() > 2 && !of_files.contains(word));
        assert_eq!(english, None, "{text}");
    }
}

/// Goal: an error whose own English names a command, and that has no other English here, fails.
#[test]
fn what_is_said_with_a_command_is_said_without_one_in_a_window() {
    let mut all = 0;
    for error in ERRORS.split("#[error(").skip(1) {
        let (english, variant) = error.split_once(")]\n    ").expect("a variant");
        if !names_a_command(english) {
            continue;
        }
        let name = variant.split([' ', '(', ',']).next().expect("a name");
        let mut ends = ["(", " "].iter();
        let arm = ends.find_map(|end| told().split_once(&format!("::{name}{end}")));
        let told = arm.and_then(|arm| arm.1.split_once("=> ")).expect(name).1;
        assert!(!told.starts_with("same("), "{name}");
        all += 1;
    }
    assert!(all > 8);
}

#[test]
fn an_error_keeps_its_file_and_loses_its_option() {
    let failure = Failure::from(StoreError::Missing("/data/history.db".into()));
    assert_eq!(
        failure.message.say(WINDOW[0]),
        "there is no database /data/history.db; a first run creates it, or choose another file"
    );
}

#[test]
fn what_is_known_is_told_without_commands_and_in_korean() {
    let path = || "/h.db".into();
    let id = fault_db::Id::from_bytes([7; 16]);
    let error = || Arc::new(StoreError::Locked(path()));
    for (trouble, english, korean) in [
        (
            Trouble::Store(Arc::new(StoreError::Malformed(path()))),
            "/h.db is damaged; check the history",
            "파일이 손상되었습니다: /h.db. 이력을 검사한 후 백업으로 계속하십시오",
        ),
        (
            Trouble::RestKept {
                error: error(),
                rest: "/r.db".into(),
            },
            "what was measured since is kept in /r.db: import that file",
            "그 후의 측정은 /r.db에 보관했으니",
        ),
        (
            Trouble::NotStored {
                run: id,
                error: error(),
                left_out: 2,
                kept: Some("/k.db".into()),
            },
            "the last 2 of its traces are lost: ",
            "마지막 기록 2개 없음. ",
        ),
        (
            Trouble::NotStored {
                run: id,
                error: error(),
                left_out: 0,
                kept: None,
            },
            "is not in the history, and lost: ",
            "이력에 없고 보관하지도 못했습니다: ",
        ),
        (
            RunTrouble::NeverCalibrated("tachometer".to_owned(), "T7".to_owned()).into(),
            "tachometer T7 was never calibrated; nothing was driven. Have it calibrated",
            "교정한 적이 없습니다: tachometer T7. ",
        ),
        (
            Unknown::Fault("x9".to_owned(), Near(Some("n9".to_owned()))).into(),
            "no fault \"x9\" (did you mean \"n9\"?)",
            "고장 모드 \"x9\"이(가) 없습니다 (\"n9\"?)",
        ),
        (
            Trouble::Told("what another program said".to_owned()),
            "what another program said",
            "what another program said",
        ),
    ] {
        let told = WINDOW.map(|how| trouble.say(how));
        assert!(
            told[0].contains(english) && told[1].contains(korean),
            "{told:?}"
        );
        assert!(
            !told
                .iter()
                .any(|told| told.contains('`') || told.contains("--")),
            "{told:?}"
        );
    }
}
