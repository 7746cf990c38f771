//! Loading check procedures: the good ones give the plan on file, the bad ones say where and why.
//!
//! `UPDATE_GOLDEN=1 cargo test -p btu-rig --test all procedure_loader` rewrites what is on file.

use std::collections::BTreeMap;
use std::path::Path;

use btu_rig::procedure::loader::{Loaded, Scripts, load};
use btu_rig::train::TrainData;
use proptest::prelude::*;
use protocol::lru::shown;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn load_all(scripts: &Scripts) -> Loaded {
    let (unit, line) = crate::shipped();
    load(scripts, &unit, &line, &TrainData::line6())
}

fn folder(name: &str) -> Scripts {
    let folder = root().join("tests/scripts").join(name);
    let mut scripts = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "star") {
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            scripts.insert(name, std::fs::read_to_string(&path).unwrap());
        }
    }
    scripts
}

/// Compares with `expected.txt` beside the scripts.
fn compare(name: &str, found: &str) {
    let path = root().join("tests/scripts").join(name).join("expected.txt");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, found).unwrap();
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(
        found,
        expected,
        "UPDATE_GOLDEN=1 rewrites {}",
        path.display()
    );
}

fn lines(lines: impl IntoIterator<Item = String>) -> String {
    lines.into_iter().map(|line| line + "\n").collect()
}

#[test]
fn good_scripts_give_the_plan_on_file() {
    let loaded = load_all(&folder("good"));
    assert_eq!(loaded.errors, []);
    compare(
        "good",
        &lines(loaded.procedures.iter().flat_map(|p| p.describe())),
    );
}

/// Goal: what was loaded in one process is the same in another. Method: the shipped scripts and those on file,
/// as JSON and back.
#[test]
fn a_plan_is_the_same_after_it_was_written_down() {
    let mut texts = folder("good");
    collect(&root().join("../scripts"), "", &mut texts);
    let loaded = load_all(&texts);
    assert_eq!(loaded.errors, []);
    assert!(loaded.procedures.len() > 20);
    for procedure in &loaded.procedures {
        let written = serde_json::to_string(&**procedure).unwrap();
        let read: btu_rig::procedure::Procedure = serde_json::from_str(&written).unwrap();
        assert_eq!(read, **procedure);
        // Many of them are handed over together.
        assert!(
            written.len() < 200_000,
            "{}: {}",
            procedure.id,
            written.len()
        );
    }
}

#[test]
fn a_step_suspects_the_procedures_part_unless_it_says_otherwise() {
    let suspects = |head: &str, step: &str| {
        let script =
            format!("procedure(title = 'x'{head})\nstep('a', measure = value('v', speed){step})");
        let loaded = load_all(&Scripts::from([("a.star".to_owned(), script)]));
        let errors: Vec<_> = loaded.errors.iter().map(ToString::to_string).collect();
        assert_eq!(errors, [""; 0]);
        shown(loaded.procedures[0].steps[0].suspect.as_ref()).to_owned()
    };
    for (head, step, expected) in [
        ("", "", "-"),
        (", suspect = '-'", ", suspect = 'tra'", "tra"),
        (", suspect = 'ato_cpu'", "", "ato_cpu"),
        (", suspect = 'ato_cpu'", ", suspect = 'tra'", "tra"),
        (", suspect = 'ato_cpu'", ", suspect = '-'", "-"),
    ] {
        assert_eq!(suspects(head, step), expected, "{head}{step}");
    }
}

#[test]
fn bad_scripts_are_refused_with_place_and_reason() {
    let scripts = folder("bad");
    let loaded = load_all(&scripts);
    assert!(loaded.procedures.is_empty(), "{:?}", loaded.procedures);
    for path in scripts.keys() {
        let named = loaded.errors.iter().any(|error| error.file == *path);
        assert!(named, "{path} has no error");
    }
    compare("bad", &lines(loaded.errors.iter().map(ToString::to_string)));
}

#[test]
fn an_error_in_a_library_names_the_line_that_calls_it() {
    let library = "def place(section):\n    at = section.stop\n    return at\n";
    let script =
        "load('//_lib.star', 'place')\nprocedure(title = 'x')\nstep('a', do = wait(place('61')))";
    let texts = [("_lib.star", library), ("a.star", script)];
    let loaded = load_all(
        &texts
            .map(|(name, text)| (name.to_owned(), text.to_owned()))
            .into(),
    );
    let errors: Vec<_> = loaded.errors.iter().map(ToString::to_string).collect();
    let told = "_lib.star:2:10: Object of type `string` has no attribute `stop`, did you mean `strip`? — place() is called at a.star:3:21";
    assert_eq!(errors, [told]);
}

#[test]
fn errors_of_one_script_do_not_hide_another() {
    let mut scripts = folder("good");
    scripts.extend(folder("bad"));
    let loaded = load_all(&scripts);
    assert_eq!(
        loaded.procedures.len(),
        load_all(&folder("good")).procedures.len()
    );
    assert!(loaded.errors.len() > 30);
}

#[test]
fn the_hash_is_of_the_text_and_the_same_text_gives_the_same_plan() {
    let first = load_all(&folder("good"));
    let mut scripts = folder("good");
    assert_eq!(first.procedures, load_all(&scripts).procedures);
    for text in scripts.values_mut() {
        text.push_str("# a remark\n");
    }
    let second = load_all(&scripts);
    assert_ne!(first.procedures[0].sha256, second.procedures[0].sha256);
    assert_eq!(first.procedures[0].steps, second.procedures[0].steps);
    assert_eq!(first.procedures[0].sha256.len(), 64);
}

#[test]
fn the_examples_of_the_reference_load() {
    let mut scripts = Scripts::new();
    collect(&root().join("../scripts"), "", &mut scripts);
    let reference = std::fs::read_to_string(root().join("../scripts/README.md")).unwrap();
    for (number, example) in reference.split("```python\n").enumerate().skip(1) {
        let example = example.split("```").next().unwrap();
        scripts.insert(format!("atp/example_{number}.star"), example.into());
    }
    let loaded = load_all(&scripts);
    assert_eq!(loaded.errors, []);
    let examples = loaded.procedures.iter();
    let examples = examples.filter(|one| one.id.starts_with("atp/example_"));
    let steps: Vec<_> = examples.map(|one| one.steps.len()).collect();
    assert_eq!(steps, [18, 6]);
}

fn collect(folder: &Path, prefix: &str, scripts: &mut Scripts) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = format!("{prefix}{}", path.file_name().unwrap().to_str().unwrap());
        if path.is_dir() {
            collect(&path, &format!("{name}/"), scripts);
        } else if name.ends_with(".star") {
            scripts.insert(name, std::fs::read_to_string(&path).unwrap());
        }
    }
}

#[test]
fn the_scripts_that_ship_load() {
    let mut scripts = Scripts::new();
    collect(&root().join("../scripts"), "", &mut scripts);
    let loaded = load_all(&scripts);
    assert_eq!(loaded.errors, []);
    let found: Vec<_> = (loaded.procedures.iter())
        .flat_map(|procedure| procedure.without_source())
        .collect();
    assert_eq!(found, [""; 0], "each limit names its source");
    // A fault and a line of a table have the name alone.
    let steps = loaded.procedures.iter().flat_map(|p| &p.steps);
    let leans = |name: &str| {
        let first = |part: &str| part.split([' ', ',', ':']).next().unwrap_or("").to_owned();
        let with_subject = ["it", "its", "so"].contains(&&*first(name));
        let mut parts = name.split(": ");
        with_subject || parts.any(|part| ["and", "again", "then", "nor"].contains(&&*first(part)))
    };
    let leaning: Vec<_> = steps.map(|step| &*step.name).filter(|n| leans(n)).collect();
    assert_eq!(leaning, [""; 0], "the name of a step stands alone");
}

#[test]
fn a_limit_without_a_source_is_named_with_its_place() {
    let loaded = load_all(&folder("good"));
    let of_file = |name: &str| {
        let procedure = loaded.procedures.iter().find(|p| p.path == name);
        procedure.expect("loaded").without_source()
    };
    let step = "limits.star:20: step \"by the file, and a measurement by nothing\"";
    let missing = ["none", "half"]
        .map(|name| format!("{step}, measurement \"{name}\": a limit names no source"));
    assert_eq!(of_file("limits.star"), missing);
    let without = of_file("atp_overspeed.star");
    assert!(
        without
            .iter()
            .any(|found| found.ends_with("what it expects: a limit names no source")),
        "{without:?}"
    );
}

#[test]
fn print_is_kept_and_bounded() {
    let text = "procedure(title = 'x')\nstep('a', measure = value('v', speed))\nfor i in range(5000):\n    print(i)\n";
    let loaded = load_all(&Scripts::from([("a.star".into(), text.into())]));
    assert_eq!(loaded.errors, []);
    assert_eq!(loaded.printed.len(), 1001);
}

#[test]
fn nothing_to_load_is_no_error_here() {
    let loaded = load_all(&Scripts::new());
    assert!(loaded.procedures.is_empty() && loaded.errors.is_empty());
}

/// Nesting of every kind, around and far beyond the limit: refused or loaded, never a stack overflow.
#[test]
fn deep_nesting_is_refused() {
    for n in [30, 45, 47, 100, 1000] {
        let kinds = [
            "[".repeat(n) + &"]".repeat(n),
            "-".repeat(n) + "1",
            "not ".repeat(n) + "1",
            "1 + ".repeat(n) + "1",
            "str".to_owned() + &"(str".repeat(n) + &")".repeat(n),
            "lambda: ".repeat(n) + "1",
            "1 if 0 else ".repeat(n) + "1",
            "line".to_owned() + &".name".repeat(n),
            "1\nif 0:\n    pass\n".to_owned() + &"elif 0:\n    pass\n".repeat(n),
            "1\n".to_owned()
                + &(0..n)
                    .map(|k| " ".repeat(k) + "if 1:\n")
                    .collect::<String>()
                + &" ".repeat(n)
                + "pass\n",
        ];
        for deep in kinds {
            let text = format!(
                "procedure(title = 'x')\nstep('a', measure = value('v', speed))\nx = {deep}\n"
            );
            let loaded = load_all(&Scripts::from([("a.star".into(), text)]));
            assert_eq!(
                loaded.errors.len() + loaded.procedures.len(),
                1,
                "{:?}",
                loaded.errors
            );
            let deep = "nested too deeply";
            assert!(
                n < 1000 || loaded.errors[0].message == deep,
                "{:?}",
                loaded.errors
            );
        }
    }
}

/// Words that bring random text past the parser now and then.
const WORDS: &str = "step(¦procedure(¦title = ¦'a'¦\"b\"¦)¦(¦,¦[¦]¦\n¦\n    ¦if ¦False¦:¦for i in ¦range(3)¦def f(x):¦return ¦lambda x: ¦\
    kmh(¦ms(¦3¦-1.5¦+¦*¦/¦==¦eb¦speed¦tacho.¦ramp(¦to = ¦do = ¦codes¦unit.¦measured('a')¦load(\"//a.star\", \"b\")¦not ¦x = ";

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_text_makes_the_loader_panic(words in prop::collection::vec(prop::sample::select(WORDS.split('¦').collect::<Vec<_>>()), 0..40)) {
        let text = format!("procedure(title = 'x')\nstep('s', measure = value('v', speed))\n{}", words.concat());
        load_all(&Scripts::from([("a.star".into(), text)]));
    }

    #[test]
    fn no_characters_make_the_loader_panic(text in any::<String>()) {
        load_all(&Scripts::from([("a.star".into(), text)]));
    }
}
