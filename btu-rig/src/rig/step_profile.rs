//! A value that changes in steps along the way, and its integral: means over a stretch without
//! looking at each metre.

/// Values from positions on; 0 before the first.
#[derive(Clone, Debug, Default)]
pub struct StepProfile {
    /// Position, integral up to it, value from it on.
    steps: Vec<(f64, f64, f64)>,
}

impl StepProfile {
    /// A profile of values from positions on. Positions out of order are taken as they come: what
    /// lies before the one before has no length.
    pub fn new(values: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut steps: Vec<(f64, f64, f64)> = Vec::new();
        for (at, value) in values {
            let (at, integral) = match steps.last() {
                Some(&(from, integral, last)) => {
                    let at = at.max(from);
                    (at, integral + last * (at - from))
                }
                None => (at, 0.0),
            };
            steps.push((at, integral, value));
        }
        Self { steps }
    }

    /// It is 0 everywhere.
    pub fn is_zero(&self) -> bool {
        self.steps.iter().all(|step| step.2 == 0.0)
    }

    /// Integral from before the first position up to `at`.
    pub fn integral(&self, at: f64) -> f64 {
        let passed = self.steps.iter().rev().find(|step| step.0 <= at);
        passed.map_or(0.0, |(from, integral, value)| {
            integral + value * (at - from)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_are_areas() {
        let profile = StepProfile::new([(10.0, 2.0), (15.0, -1.0), (20.0, 0.0)]);
        let at = [0.0, 10.0, 12.0, 15.0, 18.0, 20.0, 99.0];
        assert_eq!(
            at.map(|m| profile.integral(m)),
            [0.0, 0.0, 4.0, 10.0, 7.0, 5.0, 5.0]
        );
        assert!(StepProfile::new([(0.0, 0.0)]).is_zero());
    }
}
