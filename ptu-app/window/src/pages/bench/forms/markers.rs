//! Form for the markers along the track.

use btu_rig::stimulus::Stimulus;
use protocol::line::Line;

#[derive(Clone, Debug)]
pub struct MarkerForm {
    pub section: u16,
    /// Marker that is moved, 1 to 4.
    pub psm: u8,
    /// Distance by which the marker is moved beyond its place, m.
    pub by_m: f64,
}

impl MarkerForm {
    /// A form for the line's first section.
    pub fn new(line: &Line) -> Self {
        Self {
            section: line.sections.first().map_or(0, |first| first.section),
            psm: 1,
            by_m: 5.0,
        }
    }

    /// Lays the section's markers along the way, from the train's present place.
    pub fn lay(&self) -> Stimulus {
        Stimulus::MarkersAlong {
            section: Some(self.section),
        }
    }

    pub fn moved(&self) -> Stimulus {
        Stimulus::MarkerMoved {
            psm: self.psm,
            by_m: Some(self.by_m),
        }
    }

    pub fn missing(&self) -> Stimulus {
        Stimulus::MarkerMoved {
            psm: self.psm,
            by_m: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_marker_chosen_is_moved_or_missing() {
        let form = MarkerForm {
            section: 61,
            psm: 3,
            by_m: -2.5,
        };
        assert_eq!(form.lay(), Stimulus::MarkersAlong { section: Some(61) });
        let moved = |by_m| Stimulus::MarkerMoved { psm: 3, by_m };
        assert_eq!(form.moved(), moved(Some(-2.5)));
        assert_eq!(form.missing(), moved(None));
    }
}
