use std::fs;

use super::*;

#[path = "../../../scripts/embedded.rs"]
mod embedded;

fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("under it")).expect("made");
        fs::write(path, text).expect("written");
    }
    folder
}

fn text(found: Option<Found>) -> String {
    match found.expect("there") {
        Found::File(path) => fs::read_to_string(path).expect("read"),
        Found::Embedded(_, bytes) => String::from_utf8(bytes.to_vec()).expect("UTF-8"),
    }
}

/// Goal: who adds a file under `scripts/` learns that the programs have to carry it.
#[test]
fn the_program_carries_all_that_the_repository_ships() {
    embed(embedded::FILES);
    let carried = ScriptFiles::layered([]);
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts");
    let shipped = ScriptFiles::find(Some(&shipped)).expect("there");
    let names = shipped.all().expect("listed").into_keys();
    let names: Vec<String> = names.collect();
    let missing = names.iter().filter(|name| carried.file(name).is_none());
    let missing: Vec<&String> = missing.collect();
    assert!(
        missing.is_empty(),
        "not in scripts/embedded.rs: {missing:?}"
    );
    assert_eq!(embedded::FILES.len(), names.len(), "each once, data alone");
    let carried_names: Vec<String> = carried.all().expect("listed").into_keys().collect();
    assert_eq!(carried_names, names);
    let lines = carried.names("lines", "toml");
    assert_eq!(lines, shipped.names("lines", "toml"));
    assert!(lines.contains("line8"));
    let line8 = [&carried, &shipped].map(|files| text(files.file("lines/line8.toml")));
    assert_eq!(line8[0], line8[1]);
}

#[test]
fn an_own_file_counts_before_the_systems_and_that_before_the_embedded_one() {
    let own = folder(&[("atp/mine.star", "mine"), ("lines/line8.toml", "own line")]);
    let depot = folder(&[
        ("lines/line8.toml", "depot line"),
        ("lines/depot.toml", "more"),
    ]);
    let missing = own.path().join("missing");
    embed(embedded::FILES);
    let places = [own.path(), &missing, depot.path()].map(Path::to_owned);
    let files = ScriptFiles::layered(places);
    assert_eq!(files.places().len(), 3);
    assert_eq!(text(files.file("lines/line8.toml")), "own line");
    assert_eq!(text(files.file("lines/depot.toml")), "more");
    assert!(text(files.file("units/sg100.toml")).contains("overspeed"));
    assert!(files.file("units/none.toml").is_none());
    assert_eq!(files.files("lines/line8.toml").count(), 3);
    let all = files.all().expect("listed");
    assert!(all.contains_key("atp/mine.star") && all.contains_key("atp/overspeed.star"));
    assert!(files.names("lines", "toml").contains("depot"));
}
