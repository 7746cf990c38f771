//! Fault dictionaries in the file.

use fault_db::DictionaryRecord;

/// The one with the exact provenance is preferred, then the one with the most fault modes.
#[test]
fn a_file_returns_the_best_matching_dictionary() {
    let folder = tempfile::tempdir().expect("folder");
    let store = crate::common::open(&folder.path().join("a.db"));
    assert!(store.dictionary("x").expect("reads").is_none());
    for (made_at_us, basis_sha256, modes) in [(1, "x", 3), (2, "x", 2), (3, "y", 5)] {
        let record = DictionaryRecord {
            made_at_us,
            app_version: "1".into(),
            basis_sha256: basis_sha256.into(),
            modes,
            data: vec![modes as u8],
        };
        store.put_dictionary(&record).expect("stores");
    }
    let found = |sha256: &str| store.dictionary(sha256).expect("reads").expect("one");
    assert_eq!(found("x"), [3]);
    assert_eq!(found("y"), [5]);
    assert_eq!(found("z"), [5]);
}
