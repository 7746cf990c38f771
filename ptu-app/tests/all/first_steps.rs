//! Schemas for editors. `first_steps` among the sessions has what else leads a newcomer.

use crate::common::{Place, copy_folder, scripts};
use crate::trace_files::run_python;

/// Goal: an editor tells a wrong key while it is written, and nothing that is right: by a foreign reader, on every data file
/// that is shipped or begun.
#[test]
#[ignore = "long suite: readers of other makers"]
fn every_data_file_fits_its_schema_and_a_wrong_key_does_not() {
    let place = Place::new();
    let folder = place.path("scripts");
    copy_folder(&scripts(), &folder);
    let folder = folder.to_string_lossy().into_owned();
    place.ptu(&["new", "schemas", "--in", &folder]).exits(0);
    for (what, name) in [
        ("unit", "sg200"),
        ("line", "line9"),
        ("fault", "eb_relay.late"),
    ] {
        place.ptu(&["new", what, name, "--in", &folder]).exits(0);
    }
    let said = run_python("check_schemas.py", &[&folder]);
    assert!(
        said.ends_with("each fits, and none with a wrong key\n"),
        "{said}"
    );
}
