//! The section the train is on: gradient and curve under the whole train, the distance to the stop point
//! and the speed code at the head.

use protocol::line::Section;

use super::step_profile::StepProfile;

/// A position farther behind a section's start than any train reaches, m.
const FAR_BEHIND_M: f64 = -1e4;

/// A section laid along the track ahead of the rig.
#[derive(Clone, Debug)]
pub struct Track {
    pub section: Section,
    /// Position of the section's start on the rig's own scale, m.
    starts_at_m: f64,
    /// Gradient, ‰, uphill positive; level before the first listed gradient.
    gradient: StepProfile,
    /// Curvature, 1/m.
    curvature: StepProfile,
    /// 1 in the open air, 0 in a tunnel; 0 everywhere on a section without a list of tunnels.
    open_air: StepProfile,
}

/// Track under the train, mean over its weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UnderTrain {
    /// Gradient, ‰, uphill positive.
    pub gradient_permille: f64,
    /// Curvature, 1/m.
    pub curvature_per_m: f64,
    /// Share in the open air.
    pub open_air: f64,
}

impl Track {
    /// Lays a section so that it starts at `starts_at_m`.
    pub fn new(section: Section, starts_at_m: f64) -> Self {
        let gradients = section.gradients.iter().map(|g| (g.at_m, g.permille));
        let bent = |radius_m: f64| if radius_m > 0.0 { 1.0 / radius_m } else { 0.0 };
        let curves = section.curves.iter().map(|c| (c.at_m, bent(c.radius_m)));
        let tunnels = section.tunnels.iter();
        let open_air = tunnels.flat_map(|tunnels| {
            let bounds = tunnels.iter();
            let bounds = bounds.flat_map(|tunnel| [(tunnel.from_m, 0.0), (tunnel.to_m, 1.0)]);
            std::iter::once((FAR_BEHIND_M, 1.0)).chain(bounds)
        });
        Self {
            open_air: StepProfile::new(open_air),
            gradient: StepProfile::new(gradients),
            curvature: StepProfile::new(curves),
            section,
            starts_at_m,
        }
    }

    /// Position in the section of a position on the rig's own scale, m.
    pub fn in_section_m(&self, position_m: f64) -> f64 {
        position_m - self.starts_at_m + self.section.start_m
    }

    /// Distance from a position on the rig's own scale to the stop point, m; negative past the stop
    /// point.
    pub fn to_stop_m(&self, position_m: f64) -> f64 {
        self.section.stop_m - self.in_section_m(position_m)
    }

    /// Mean track under a train whose head is at `position_m`; `cars` = length in m and share of
    /// the train's weight of each car.
    pub fn under(&self, position_m: f64, cars: &[(f64, f64)]) -> UnderTrain {
        let mut under = UnderTrain::default();
        let (mut heights, mut turns) = (self.gradient.descend(), self.curvature.descend());
        let mut airs = self.open_air.descend();
        let mut front_m = self.in_section_m(position_m);
        let (mut height, mut turn) = (heights.integral(front_m), turns.integral(front_m));
        let mut air = airs.integral(front_m);
        for &(length_m, weight_share) in cars {
            front_m -= length_m;
            let (lower, less) = (heights.integral(front_m), turns.integral(front_m));
            let share_per_m = weight_share / length_m;
            under.gradient_permille += (height - lower) * share_per_m;
            under.curvature_per_m += (turn - less) * share_per_m;
            let less_air = airs.integral(front_m);
            under.open_air += (air - less_air) * share_per_m;
            (height, turn, air) = (lower, less, less_air);
        }
        under
    }

    /// Whether the contact line has no voltage over a head at `position_m`.
    pub fn is_neutral(&self, position_m: f64) -> bool {
        let at = self.in_section_m(position_m);
        let mut neutral = self.section.neutral_sections.iter();
        neutral.any(|stretch| (stretch.from_m..stretch.to_m).contains(&at))
    }

    /// Name of the speed code under a head at `position_m`; the first code also counts before its own place.
    pub fn speed_code(&self, position_m: f64) -> Option<&str> {
        let at = self.in_section_m(position_m);
        let codes = &self.section.speed_codes;
        let passed = codes.iter().rev().find(|code| code.at_m <= at);
        passed.or(codes.first()).map(|code| code.code.as_str())
    }
}

#[cfg(test)]
mod tests {
    use protocol::line::{Curve, Gradient, Line, Stretch};

    use super::*;

    fn section() -> Section {
        let line = Line::from_toml(include_str!("../../../../scripts/lines/line8.toml")).unwrap();
        let mut section = line.section(61).unwrap().clone();
        section.gradients = vec![
            Gradient {
                at_m: 0.0,
                permille: 0.0,
            },
            Gradient {
                at_m: 200.0,
                permille: -30.0,
            },
        ];
        section.curves = vec![
            Curve {
                at_m: 400.0,
                radius_m: 350.0,
                limit_kmh: None,
            },
            Curve {
                at_m: 500.0,
                radius_m: 0.0,
                limit_kmh: None,
            },
        ];
        section
    }

    /// A step of the gradient is a ramp over the train: half of eight equal cars of 20 m lie on it
    /// when the head is 80 m past it, 70 m of 160 when it is 70 m past.
    #[test]
    fn a_step_of_the_gradient_is_a_ramp_over_the_length_of_the_train() {
        let track = Track::new(section(), 1000.0);
        let cars = [(20.0, 0.125); 8];
        for (head_m, permille) in [
            (1200.0, 0.0),
            (1270.0, -13.125),
            (1280.0, -15.0),
            (1360.0, -30.0),
        ] {
            let under = track.under(head_m, &cars);
            assert!(
                (under.gradient_permille - permille).abs() < 1e-9,
                "{head_m}: {under:?}"
            );
        }
        // 100 m of 160 bent at 350 m, and none once the last car is through.
        let bent = track.under(1500.0, &cars).curvature_per_m;
        assert!((bent - 100.0 / 160.0 / 350.0).abs() < 1e-12, "{bent}");
        assert!(track.under(1660.0, &cars).curvature_per_m.abs() < 1e-12);
    }

    #[test]
    fn a_heavy_car_weighs_more() {
        let track = Track::new(section(), 0.0);
        let under = track.under(220.0, &[(20.0, 0.75), (20.0, 0.25)]);
        assert!((under.gradient_permille + 22.5).abs() < 1e-9, "{under:?}");
    }

    #[test]
    fn codes_change_where_the_head_is() {
        let mut section = section();
        let code = |at_m, code: &str| protocol::line::CodeFrom {
            at_m,
            code: code.to_owned(),
        };
        section.speed_codes = vec![code(0.0, "55"), code(235.0, "45")];
        let track = Track::new(section, 100.0);
        let at = [99.0, 100.0, 334.9, 335.0];
        assert_eq!(
            at.map(|m| track.speed_code(m)),
            [Some("55"), Some("55"), Some("55"), Some("45")]
        );
        assert_eq!(track.to_stop_m(950.03), 0.0);
    }

    /// Two of eight cars are in a tunnel of 100 m when the head is 40 m in; the head alone counts for the contact line.
    #[test]
    fn tunnels_and_neutral_sections_are_where_they_are_listed() {
        let stretch = |from_m, to_m| Stretch { from_m, to_m };
        let mut section = section();
        let cars = [(20.0, 0.125); 8];
        let all_along = Track::new(section.clone(), 0.0);
        assert_eq!(all_along.under(340.0, &cars).open_air, 0.0);
        section.tunnels = Some(vec![stretch(300.0, 400.0)]);
        section.neutral_sections = vec![stretch(300.0, 320.0)];
        let track = Track::new(section, 0.0);
        for (head_m, open_air) in [(200.0, 1.0), (340.0, 0.75), (430.0, 0.375), (700.0, 1.0)] {
            let found = track.under(head_m, &cars).open_air;
            assert!((found - open_air).abs() < 1e-9, "{head_m}: {found}");
        }
        let neutral = [299.0, 300.0, 319.0, 320.0].map(|head_m| track.is_neutral(head_m));
        assert_eq!(neutral, [false, true, true, false]);
    }
}
