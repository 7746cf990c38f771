//! All files that `scripts/package` and `scripts/windows` put together are there, so that a moved file is found
//! before a package is built; the manuals among it lead nowhere else.

use crate::common::{Place, workspace};

/// Made by `ptu help-files` for the package.
const MADE_BY_PROGRAM: &str = "../target/package/help/";
/// Made by `scripts/package` itself, or built.
const MADE: [&str; 2] = ["../target/", "target/"];

#[test]
fn every_file_of_the_package_is_there() {
    let place = Place::new();
    write_help(&place);
    let manifest = workspace().join("ptu-app/Cargo.toml");
    let manifest = std::fs::read_to_string(manifest).expect("a manifest");
    let manifest: toml::Value = toml::from_str(&manifest).expect("TOML");
    let deb = &manifest["package"]["metadata"]["deb"];
    let assets = deb["assets"].as_array().expect("assets");
    let mut missing = Vec::new();
    for asset in assets {
        let from = asset[0].as_str().expect("a path");
        let looked_for = match from.strip_prefix(MADE_BY_PROGRAM) {
            Some(made) => place.path("help").join(made),
            None if MADE.iter().any(|made| from.starts_with(made)) => continue,
            None => workspace().join("ptu-app").join(from),
        };
        let pattern = looked_for.to_str().expect("UTF-8");
        let mut found = glob::glob(pattern).expect("a pattern");
        if found.next().is_none() {
            missing.push(from);
        }
    }
    assert!(missing.is_empty(), "not there: {missing:?}");
    let types = place.read("help/ptu.xml");
    let id = format!("value=\"0x{:08x}\"", fault_db::APPLICATION_ID);
    assert!(types.contains(&id), "{types}");
}

fn write_help(place: &Place) {
    let sources = workspace().display().to_string();
    let asked = ["help-files", "help", "--documents", &sources];
    place.ptu(&asked).exits(0);
}

/// Goal: who opens an installed manual can follow it. Method: what each link and picture of each page names is there, with
/// the heading.
#[test]
fn links_of_the_installed_manuals_lead_somewhere() {
    let place = Place::new();
    write_help(&place);
    let pages = glob::glob(&place.text_path("help/html/**/*.html")).expect("a pattern");
    let pages: Vec<_> = pages.map(|page| page.expect("a page")).collect();
    let (mut wrong, mut links, mut pictures) = (Vec::new(), 0, 0);
    for page in &pages {
        let text = std::fs::read_to_string(page).expect("a page");
        let targets = ["href=\"", "src=\""].map(|kind| text.split(kind).skip(1));
        pictures += targets[1].clone().count();
        for target in targets.into_iter().flatten() {
            let target = target.split('"').next().expect("a quote");
            if target.contains("://") {
                continue;
            }
            links += 1;
            let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
            let to = match file {
                "" => page.clone(),
                file => page.parent().expect("a folder").join(file),
            };
            let heading = format!("id=\"{}\"", decoded(anchor));
            let there = match anchor {
                "" => to.is_file(),
                _ => std::fs::read_to_string(&to).is_ok_and(|text| text.contains(&heading)),
            };
            if !there {
                wrong.push(format!("{}: {target}", page.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(
        links > 100 && pictures >= 18,
        "{links} links, {pictures} pictures"
    );
    for (page, language) in [("manual.html", "en"), ("manual.ko.html", "ko")] {
        let text = place.read(&format!("help/html/docs/{page}"));
        assert!(
            text.contains(&format!("<html lang=\"{language}\">")),
            "{page}"
        );
        assert!(
            text.contains("<table>") && text.contains("manual.ko.html") != (language == "ko"),
            "{page}"
        );
    }
}

/// An anchor as it stands in its page.
fn decoded(anchor: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = anchor;
    while let Some(letter) = rest.chars().next() {
        let code = rest.strip_prefix('%').and_then(|code| code.get(..2));
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &rest[3..];
            }
            None => {
                bytes.extend(letter.to_string().bytes());
                rest = &rest[letter.len_utf8()..];
            }
        }
    }
    String::from_utf8(bytes).expect("UTF-8")
}

/// A path in a shell script of the repository that is gone stops the script after a long build.
#[test]
fn every_file_that_packaging_names_is_there() {
    let mut gone = Vec::new();
    for script in [
        "scripts/package",
        "scripts/windows",
        "packaging/debian/try",
        "ptu-app/windows/try_under_wine",
    ] {
        let text = std::fs::read_to_string(workspace().join(script)).expect("a script");
        let words = text.split(|c: char| c.is_whitespace() || "\"'()=;".contains(c));
        let folders = [
            "packaging/",
            "ptu-app/",
            "fault-db/",
            "scripts/",
            "protocol/",
            "ato-under-test/",
            "docs/",
        ];
        for word in words.filter(|word| folders.iter().any(|folder| word.starts_with(folder))) {
            // Messages name the script itself with a colon behind it.
            let word = word.trim_end_matches(':');
            let made = word.contains("sbom") || word.contains('$');
            let mut found =
                glob::glob(workspace().join(word).to_str().expect("UTF-8")).expect("a pattern");
            if !made && found.next().is_none() {
                gone.push(format!("{script}: {word}"));
            }
        }
    }
    assert!(gone.is_empty(), "{gone:?}");
}

/// A desktop starts a program that the package has.
#[test]
fn desktop_entries_start_a_program_of_the_package() {
    let manifest =
        std::fs::read_to_string(workspace().join("ptu-app/Cargo.toml")).expect("a manifest");
    for entry in ["ptu.desktop", "ptu-history.desktop"] {
        let text =
            std::fs::read_to_string(workspace().join("packaging").join(entry)).expect("an entry");
        let command = text
            .lines()
            .find_map(|line| line.strip_prefix("Exec="))
            .expect("a command");
        let program = command.split(' ').next().expect("a program");
        let asset = format!("[\"target/release/{program}\", \"usr/bin/\"");
        assert!(manifest.contains(&asset), "{entry}: {program}");
    }
}
