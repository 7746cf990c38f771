//! The section the train is on: gradient and curve by position.

use protocol::line::Section;

/// A section laid along the rig's way.
#[derive(Clone, Debug)]
pub struct Track {
    section: Section,
    /// Position of the section's start on the rig's own scale, m.
    starts_at_m: f64,
}

impl Track {
    /// Lays a section so that it starts at `starts_at_m`.
    pub fn new(section: Section, starts_at_m: f64) -> Self {
        Self {
            section,
            starts_at_m,
        }
    }

    fn in_section_m(&self, position_m: f64) -> f64 {
        position_m - self.starts_at_m + self.section.start_m
    }

    /// Gradient, ‰, uphill positive; level before the first that is listed.
    pub fn gradient_permille(&self, position_m: f64) -> f64 {
        let at = self.in_section_m(position_m);
        let passed = self.section.gradients.iter().rev().find(|g| g.at_m <= at);
        passed.map_or(0.0, |g| g.permille)
    }

    /// Curve radius, m; 0 = straight.
    pub fn curve_radius_m(&self, position_m: f64) -> f64 {
        let at = self.in_section_m(position_m);
        let passed = self.section.curves.iter().rev().find(|c| c.at_m <= at);
        passed.map_or(0.0, |c| c.radius_m)
    }
}

#[cfg(test)]
mod tests {
    use protocol::line::Line;

    use super::*;

    #[test]
    fn gradients_lie_where_the_section_has_them() {
        let line = Line::from_toml(include_str!("../../../scripts/lines/line8.toml")).unwrap();
        let track = Track::new(line.section(61).unwrap().clone(), 1000.0);
        let at = [0.0, 1199.9, 1200.0, 1500.0, 1900.0];
        assert_eq!(
            at.map(|m| track.gradient_permille(m)),
            [0.0, 0.0, -3.0, 4.0, 0.0]
        );
        assert_eq!(track.curve_radius_m(1500.0), 0.0);
    }
}
