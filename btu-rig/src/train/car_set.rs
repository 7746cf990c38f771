//! Cars of a train: a set of them, a value for each.

/// Cars a train may have.
pub const MAX_CARS: usize = 12;

/// A value for each car; those beyond the train's last are 0.
pub type PerCar = [f64; MAX_CARS];

/// Cars of a train by their place from 0, the first at the head.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CarSet(u16);

impl CarSet {
    pub const NONE: Self = Self(0);

    /// The set of the car at this place; empty for a place that no train has.
    pub fn one(car: usize) -> Self {
        let mut set = Self::NONE;
        set.set(car, true);
        set
    }

    /// Adds the car at a place, or removes it. Places that no train has are left out.
    pub fn set(&mut self, car: usize, on: bool) {
        if car < MAX_CARS {
            let bit = 1 << car;
            self.0 = if on { self.0 | bit } else { self.0 & !bit };
        }
    }

    pub fn contains(self, car: usize) -> bool {
        car < MAX_CARS && self.0 & (1 << car) != 0
    }

    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Sum of a value over the cars of the set.
    pub fn sum(self, of: &PerCar) -> f64 {
        self.iter().map(|car| of[car]).sum()
    }

    /// Cars of this set or the other.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Cars of this set and not of the other.
    #[must_use]
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// The set as bits; bit 0 = the first car.
    pub fn bits(self) -> u16 {
        self.0
    }

    /// Places of the cars, from the head.
    pub fn iter(self) -> impl Iterator<Item = usize> {
        let mut left = self.0;
        std::iter::from_fn(move || {
            let car = left.trailing_zeros() as usize;
            // Removes the first car; scans go through sets many times.
            left &= left.wrapping_sub(1);
            (car < MAX_CARS).then_some(car)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cars_can_be_added_to_and_removed_from_a_set() {
        let mut set = CarSet::one(3).with(CarSet::one(7));
        assert_eq!(set.iter().collect::<Vec<_>>(), [3, 7]);
        assert_eq!(set.bits(), 0b1000_1000);
        set.set(3, false);
        assert!(!set.contains(3) && set.contains(7));
        assert!(set.without(CarSet::one(7)).is_empty());
        assert!(CarSet::one(MAX_CARS).is_empty());
        assert!(!set.contains(400));
    }
}
