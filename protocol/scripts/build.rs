//! Lists the files of `scripts/` that the program carries with it.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let root = Path::new(&env::var_os("CARGO_MANIFEST_DIR").expect("set by cargo"))
        .join("../../scripts")
        .canonicalize()
        .expect("the folder scripts is in the repository");
    println!("cargo::rerun-if-changed={}", root.display());
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    let mut table = String::from("[\n");
    for file in &files {
        let name = file.strip_prefix(&root).expect("under it");
        let name = name.to_str().expect("UTF-8").replace('\\', "/");
        writeln!(table, "    ({name:?}, include_bytes!({file:?})),").expect("written to memory");
    }
    table += "]\n";
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("set by cargo")).join("embedded.rs");
    fs::write(out, format!("&{table}")).expect("the build folder can be written");
}

/// Procedures, data files and dictionaries; not the shell scripts and documents beside them.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("readable") {
        let path = entry.expect("readable").path();
        let ending = path.extension().and_then(|ending| ending.to_str());
        if path.is_dir() {
            println!("cargo::rerun-if-changed={}", path.display());
            collect(&path, files);
        } else if matches!(ending, Some("star" | "toml" | "zst")) {
            files.push(path);
        }
    }
}
