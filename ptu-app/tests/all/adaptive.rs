//! Adaptive runs overlook nothing unsafe. `searches` among the sessions has what they find and how they end.

use crate::common::Place;
use fuzzing::draw;

/// Modes that leave the train less protected and that one check alone shows, if any does: a search that is content with what is
/// likely would leave them out.
#[test]
fn a_search_overlooks_no_unsafe_mode() {
    for mode in draw::drawn(
        [
            "atp_cpu.door_bar_dead",
            "atp_cpu.jog_guard_dead",
            "atp_cpu.key_guard_dead",
            "atp_cpu.release_guard_dead",
            "atp_cpu.start_bar_dead",
        ],
        2,
    ) {
        let place = Place::new();
        place.ptu(&["run", "--adaptive", "--inject", mode]).exits(1);
    }
}
