//! The documents are true: links lead somewhere, files and functions that are named exist, command lines are ones the
//! programs take, and those in code blocks marked `sh run` end with the exit code that stands behind them.

mod command_line;
mod installed;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use command_line::{CommandLine, words};
use fault_db::FaultState;
use ptu_report::words::Language;

/// Longest README, lines, and its longest line, characters.
const README_LINES: usize = 110;
const README_COLUMNS: usize = 120;
/// Longest other document, lines.
const DOCUMENT_LINES: usize = 400;
/// Code blocks with this information string are run; those with the first word of it alone are only read.
const RUN: &str = "sh run";
const SHOWN: &str = "sh";
/// Endings of files that are looked for when a document names them.
const ENDINGS: [&str; 9] = [
    "rs", "md", "star", "toml", "py", "json", "zst", "png", "txt",
];

struct Document {
    path: PathBuf,
    text: String,
}

/// A code block: its information string, and its lines with their numbers.
struct Block<'a> {
    info: &'a str,
    lines: Vec<(usize, &'a str)>,
}

impl Document {
    fn read(path: PathBuf) -> Self {
        let text = fs::read_to_string(&path).expect("a document");
        Self { path, text }
    }

    /// README.md and what is in docs/.
    fn guides() -> Vec<Self> {
        let all = Self::all();
        let folder = root().join("docs");
        let readme = root().join("README.md");
        let is_guide = |path: &Path| path == readme || path.starts_with(&folder);
        all.into_iter().filter(|doc| is_guide(&doc.path)).collect()
    }

    /// Every Markdown file of the project.
    fn all() -> Vec<Self> {
        let mut folders = vec![root()];
        let mut all = Vec::new();
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(&folder).expect("a folder") {
                let path = entry.expect("an entry").path();
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                if path.is_dir() && !name.starts_with('.') && name != "target" {
                    folders.push(path);
                } else if name.ends_with(".md") {
                    all.push(Self::read(path));
                }
            }
        }
        all.sort_by(|a, b| a.path.cmp(&b.path));
        assert!(all.len() > 4, "documents are found");
        all
    }

    fn at(&self, line: usize) -> String {
        format!(
            "{}:{line}",
            self.path.strip_prefix(root()).expect("inside").display()
        )
    }

    /// Lines outside code blocks, with their numbers.
    fn prose(&self) -> Vec<(usize, &str)> {
        let mut inside = false;
        let mut prose = Vec::new();
        for (number, line) in (1..).zip(self.text.lines()) {
            if line.trim_start().starts_with("```") {
                inside = !inside;
            } else if !inside {
                prose.push((number, line));
            }
        }
        prose
    }

    fn blocks(&self) -> Vec<Block<'_>> {
        let mut open: Option<Block<'_>> = None;
        let mut blocks = Vec::new();
        for (number, line) in (1..).zip(self.text.lines()) {
            match (line.trim_start().strip_prefix("```"), &mut open) {
                (Some(_), Some(_)) => blocks.extend(open.take()),
                (Some(info), None) => {
                    open = Some(Block {
                        info: info.trim(),
                        lines: Vec::new(),
                    });
                }
                (None, Some(block)) => block.lines.push((number, line)),
                (None, None) => {}
            }
        }
        assert!(open.is_none(), "{}: a code block has no end", self.at(1));
        blocks
    }

    /// Inline code, with the lines it is in.
    fn codes(&self) -> impl Iterator<Item = (usize, &str)> {
        let prose = self.prose().into_iter();
        prose.flat_map(|(number, line)| codes_of(line).map(move |code| (number, code)))
    }

    /// Names of its headings in links, as GitHub makes them.
    fn anchors(&self) -> Vec<String> {
        let mut times: BTreeMap<String, u32> = BTreeMap::new();
        let headings = self.prose().into_iter().filter_map(|(_, line)| {
            let text = line.trim_start_matches('#');
            (text.len() < line.len()).then_some(text.strip_prefix(' ')?)
        });
        let anchors = headings.map(|heading| {
            let kept = heading.to_lowercase().replace(' ', "-");
            let kept: String = kept
                .chars()
                .filter(|c| c.is_alphanumeric() || matches!(c, '-' | '_'))
                .collect();
            let before = times.entry(kept.clone()).or_default();
            *before += 1;
            match *before {
                1 => kept,
                again => format!("{kept}-{}", again - 1),
            }
        });
        anchors.collect()
    }
}

fn root() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    root.canonicalize().expect("the project's folder")
}

fn codes_of(line: &str) -> impl Iterator<Item = &str> {
    line.split('`').skip(1).step_by(2)
}

/// Targets of the links in a line.
fn links_of(line: &str) -> impl Iterator<Item = &str> {
    let targets = line.split("](").skip(1);
    targets.filter_map(|rest| rest.split_once(')').map(|(target, _)| target))
}

/// Reason for which a link leads nowhere; none if it works.
fn broken(document: &Document, target: &str) -> Option<String> {
    if target.contains("://") {
        return None;
    }
    let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
    let path = match file {
        "" => document.path.clone(),
        file => document.path.parent().expect("a folder").join(file),
    };
    if !path.exists() {
        return Some(format!("there is no {file}"));
    }
    if anchor.is_empty() {
        return None;
    }
    let anchors = Document::read(path).anchors();
    let known = anchors.iter().any(|known| known == anchor);
    (!known).then(|| {
        format!(
            "no heading is called #{anchor}; there are #{}",
            anchors.join(", #")
        )
    })
}

/// A file or folder of the project, by what is written: no pattern and nothing to fill in.
fn named_path(code: &str) -> Option<&str> {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
    let inside = code
        .split('/')
        .next()
        .is_some_and(|first| !first.is_empty() && first != "target" && root().join(first).is_dir());
    let ending = code.rsplit('.').next().unwrap_or_default();
    let whole = code.ends_with('/') || ENDINGS.contains(&ending);
    let to_fill_in = code.contains("NAME");
    (code.contains('/') && code.chars().all(plain) && inside && whole && !to_fill_in)
        .then_some(code)
}

#[track_caller]
fn none(wrong: &[String]) {
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let mut wrong = Vec::new();
    for document in Document::all() {
        for (number, line) in document.prose() {
            let why = links_of(line).filter_map(|target| broken(&document, target));
            wrong.extend(why.map(|why| format!("{}: {why}", document.at(number))));
        }
    }
    none(&wrong);
}

#[test]
fn every_file_that_a_guide_names_exists() {
    let mut wrong = Vec::new();
    for document in Document::guides() {
        let paths = document
            .codes()
            .filter_map(|(number, code)| Some((number, named_path(code)?)));
        let missing = paths.filter(|(_, path)| !root().join(path).exists());
        wrong.extend(missing.map(|(number, path)| format!("{}: no {path}", document.at(number))));
    }
    none(&wrong);
}

/// Goal: who follows a pulse, a fault or a click through the code finds each function where the table says.
/// Method: a row with files and `function()`s: each is defined in one of them.
#[test]
fn every_function_that_a_row_of_the_architecture_names_is_in_its_file() {
    let document = Document::read(root().join("docs/architecture.md"));
    let (mut wrong, mut found) = (Vec::new(), 0);
    for (number, line) in document.prose() {
        let files = codes_of(line).filter_map(named_path);
        let sources: Vec<String> = files
            .filter(|path| path.ends_with(".rs"))
            .map(|path| fs::read_to_string(root().join(path)).unwrap_or_default())
            .collect();
        let functions = codes_of(line).filter_map(|code| code.strip_suffix("()"));
        for function in functions {
            let defines = |source: &String| {
                source.contains(&format!("fn {function}("))
                    || source.contains(&format!("fn {function}<"))
            };
            if sources.iter().any(defines) {
                found += 1;
            } else {
                wrong.push(format!(
                    "{}: no {function}() in the file",
                    document.at(number)
                ));
            }
        }
    }
    none(&wrong);
    assert!(found > 40, "{found} functions");
}

#[test]
fn every_command_line_is_one_that_the_programs_take() {
    let (mut wrong, mut read) = (Vec::new(), 0);
    let mut examine = |place: String, line: &str, whole: bool| {
        read += 1;
        let why = CommandLine::of(line).wrong(whole);
        wrong.extend(why.map(|why| format!("{place}: {line}\n  {why}")));
    };
    for document in Document::guides() {
        for block in document.blocks() {
            if matches!(block.info, RUN | SHOWN) {
                for (number, line) in &block.lines {
                    examine(document.at(*number), line, true);
                }
            }
        }
        for (number, code) in document.codes().filter(|(_, code)| !code.contains('…')) {
            examine(document.at(number), code, false);
        }
    }
    none(&wrong);
    assert!(read > 100, "{read} command lines");
}

/// Goal: who reads of a button finds it. Method: what stands in bold begins a text of the window.
#[test]
fn what_the_manuals_have_in_bold_is_in_the_window() {
    for (file, language) in [
        ("manual.md", Language::English),
        ("manual.ko.md", Language::Korean),
    ] {
        let document = Document::read(root().join("docs").join(file));
        let catalogue = language.words();
        let states = FaultState::ALL
            .iter()
            .map(|state| catalogue.fault_state(*state));
        let texts = format!("{catalogue:?}{:?}", states.collect::<Vec<_>>());
        let (mut wrong, mut found) = (Vec::new(), 0);
        for (number, line) in document.prose() {
            for bold in line.split("**").skip(1).step_by(2) {
                found += 1;
                if !texts.contains(&format!("\"{bold}")) {
                    wrong.push(format!("{}: {bold}", document.at(number)));
                }
            }
        }
        none(&wrong);
        assert!(found > 50, "{found} texts");
    }
}

#[test]
fn both_manuals_have_the_same_sections_tables_and_pictures() {
    for name in ["manual", "checks"] {
        let [english, korean] = ["md", "ko.md"].map(|language| {
            let document = Document::read(root().join(format!("docs/{name}.{language}")));
            let parts = ["#", "|", "!["];
            parts.map(|part| {
                let lines = document.prose().into_iter();
                lines.filter(|(_, line)| line.starts_with(part)).count()
            })
        });
        assert_eq!(english, korean, "{name}");
    }
}

#[test]
fn the_readme_fits_two_screens_and_no_guide_is_a_book() {
    let readme = Document::read(root().join("README.md"));
    let lines = readme.text.lines().count();
    assert!(lines <= README_LINES, "README.md has {lines} lines");
    let mut wrong = Vec::new();
    for (number, line) in (1..).zip(readme.text.lines()) {
        let columns = line.chars().count();
        if columns > README_COLUMNS {
            wrong.push(format!("{}: {columns} columns", readme.at(number)));
        }
    }
    for guide in Document::guides() {
        let lines = guide.text.lines().count();
        if lines > DOCUMENT_LINES {
            wrong.push(format!("{} has {lines} lines", guide.at(lines)));
        }
    }
    none(&wrong);
}

#[test]
fn the_readers_of_documents_tell_right_from_wrong() {
    let document = Document {
        path: root().join("docs/example.md"),
        text: "# One thing: `a`\n## Two\n## Two\n```sh\n# no heading\n```\n".into(),
    };
    assert_eq!(document.anchors(), ["one-thing-a", "two", "two-1"]);
    assert!(broken(&document, "../README.md").is_none());
    assert!(broken(&document, "https://example.org/").is_none());
    assert!(broken(&document, "missing.md").is_some());
    assert!(broken(&document, "../README.md#missing").is_some());
    assert!(broken(&document, "../README.md#license").is_none());
    assert_eq!(named_path("ptu-app/src/cli/"), Some("ptu-app/src/cli/"));
    assert_eq!(named_path("scripts/lines/NAME.toml"), None);
    assert_eq!(named_path("atp/overspeed"), None);
    assert_eq!(
        words(r#"ptu db query "SELECT 1 # 2" 'a b'c   # exit 1"#),
        ["ptu", "db", "query", "SELECT 1 # 2", "a bc"]
    );
    assert_eq!(CommandLine::of("ptu run # exit 1: it fails").exit, 1);
    let wrong = |line: &str, whole| CommandLine::of(line).wrong(whole).is_some();
    for line in [
        "ptu run --no-such-flag",
        "ptu no-such-verb",
        "ato-under-test --no-such-flag",
        "cargo test -p no-such-crate",
        "cargo test -p ptu-app --test no_such_target",
        "cargo test -p ptu-app no_test_is_called_so",
    ] {
        assert!(wrong(line, true) && wrong(line, false), "{line}");
    }
    for line in ["ptu diagnose", "ptu drive --section"] {
        assert!(wrong(line, true) && !wrong(line, false), "{line}");
    }
    for line in [
        "ptu",
        "ptu help run",
        "FUZZ_RUNS=3 cargo test -p ptu-app --test all documents",
        "ato-under-test --pty --slower 4",
        "apt install postgresql",
    ] {
        assert!(!wrong(line, true), "{line}");
    }
}
