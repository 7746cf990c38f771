//! A value that changes in steps along the way, and its integral: means over a stretch without
//! looking at each metre.

/// Values from positions on; 0 before the first.
#[derive(Clone, Debug, Default)]
pub struct StepProfile {
    /// Position, integral up to it, value from it on.
    steps: Vec<(f64, f64, f64)>,
}

impl StepProfile {
    /// A profile of values from positions on. A position before the one listed last is moved up to that one, whose
    /// value then has no length.
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

    /// Reads integrals at positions that fall from one to the next, as from the head to the tail of
    /// a train.
    pub fn descend(&self) -> Descent<'_> {
        Descent { steps: &self.steps }
    }
}

/// A reader of integrals at falling positions.
#[derive(Clone, Copy, Debug)]
pub struct Descent<'a> {
    /// Steps that may still lie before the next position.
    steps: &'a [(f64, f64, f64)],
}

impl Descent<'_> {
    /// Integral from before the first position up to `at`, which is not beyond the last one asked
    /// for.
    pub fn integral(&mut self, at: f64) -> f64 {
        while let Some((&(from, integral, value), before)) = self.steps.split_last() {
            if from <= at {
                return integral + value * (at - from);
            }
            self.steps = before;
        }
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_are_areas() {
        let profile = StepProfile::new([(10.0, 2.0), (15.0, -1.0), (20.0, 0.0)]);
        let mut descent = profile.descend();
        let at = [99.0, 20.0, 18.0, 15.0, 12.0, 10.0, 0.0];
        let areas = at.map(|m| descent.integral(m));
        assert_eq!(areas, [5.0, 5.0, 7.0, 10.0, 4.0, 0.0, 0.0]);
    }
}
