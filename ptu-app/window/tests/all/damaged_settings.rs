//! Kept settings of the window that were damaged.

use fuzzing::Fuzz;
use ptu_window::Settings;

#[test]
fn damaged_settings_are_read_or_left() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("window.json");
    let kept = serde_json::to_vec_pretty(&Settings::default()).expect("JSON");
    Fuzz::new("window-settings", env!("CARGO_MANIFEST_DIR"), [kept]).run(20_000, |bytes| {
        std::fs::write(&file, bytes).expect("written");
        let settings = Settings::load(&file);
        assert!(settings.zoom.is_finite());
    });
}
