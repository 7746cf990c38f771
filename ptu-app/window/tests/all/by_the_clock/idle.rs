//! What a window costs that nobody touches.

#![allow(
    clippy::print_stdout,
    reason = "figures, for whoever asks with --nocapture"
)]

use std::time::Instant;

use crate::common::Place;
use crate::common::display::{Display, PATIENCE, Shown};

/// The figures are measured in release mode; here only that it does not repaint without a pause.
#[test]
fn a_window_nobody_touches_is_idle() {
    let place = Place::new();
    let display = Display::new(&place);
    for (unit, most) in [(&[][..], 0.2), (&["--unit", "sim"], 0.3)] {
        let shown = Shown::open(
            &place,
            &display,
            &[&["--page", "procedures"], unit].concat(),
        );
        shown.settled();
        // One that repaints without a pause never gets there; another may still have something to finish.
        let began = Instant::now();
        let share = loop {
            let share = shown.idle_share();
            if share < most || began.elapsed() > PATIENCE {
                break share;
            }
        };
        // With --nocapture and in release mode these are the figures to quote.
        println!(
            "{unit:?}: first picture after {} ms, idle {:.1} % of a core, {:.0} MiB",
            shown.first_picture.as_millis(),
            100.0 * share,
            shown.resident_mib()
        );
        assert!(share < most, "{unit:?}: {:.1} % of a core", 100.0 * share);
        shown.close();
    }
}
