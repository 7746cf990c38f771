//! Loading check procedures: the good ones give the plan on file, the bad ones say where and why.

use std::collections::BTreeMap;
use std::path::Path;

use btu_rig::procedure::loader::{Loaded, Scripts, load};
use protocol::config::UnitConfig;
use protocol::line::Line;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn load_all(scripts: &Scripts) -> Loaded {
    let read = |path: &str| std::fs::read_to_string(root().join("..").join(path)).unwrap();
    let unit = UnitConfig::from_toml(&read("scripts/units/sg100.toml")).unwrap();
    let line = Line::from_toml(&read("scripts/lines/line8.toml")).unwrap();
    load(scripts, &unit, &line)
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

#[test]
fn dev() {
    let loaded = load_all(&folder("good"));
    for e in &loaded.errors {
        println!("{e}");
    }
    for p in &loaded.procedures {
        for l in p.describe() {
            println!("{l}");
        }
    }
    let loaded = load_all(&folder("bad"));
    for e in &loaded.errors {
        println!("{e}");
    }
}
