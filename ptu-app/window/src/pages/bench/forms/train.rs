//! Form for cab desk, TCMS and the train's conditions.

use btu_rig::lever::Lever;
use btu_rig::stimulus::Stimulus;

/// Cab desk, TCMS and the train's conditions.
#[derive(Clone, Debug)]
pub struct TrainForm {
    /// Index of the lever's position in `Lever::ALL`, from full brake to full power.
    pub lever: usize,
    /// Voltage of the controller's potentiometer, V.
    pub volts: f64,
    /// Passengers, t.
    pub load_t: f64,
    /// Gradient added to the track's, ‰, uphill positive.
    pub gradient_permille: f64,
    /// Coefficient of adhesion at standstill.
    pub adhesion: f64,
    /// Car whose equipment is cut out, counted from 1 at the head.
    pub car: u8,
}

impl Default for TrainForm {
    fn default() -> Self {
        let neutral = Lever::ALL
            .iter()
            .position(|lever| *lever == Lever::Neutral)
            .unwrap_or(0);
        Self {
            lever: neutral,
            volts: 5.0,
            load_t: 0.0,
            gradient_permille: 10.0,
            adhesion: 0.1,
            car: 1,
        }
    }
}

impl TrainForm {
    /// The lever's position.
    pub fn lever(&self) -> Lever {
        Lever::ALL.get(self.lever).copied().unwrap_or_default()
    }

    /// Puts the lever into the entered position.
    pub fn controller(&self) -> Stimulus {
        Stimulus::Controller {
            lever: self.lever(),
        }
    }

    /// Loads the train with the entered mass of passengers.
    pub fn load(&self) -> Stimulus {
        Stimulus::Load {
            passengers_kg: self.load_t * 1000.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lever_has_every_position_and_tonnes_become_kilograms() {
        let mut form = TrainForm::default();
        assert_eq!(form.lever(), Lever::Neutral);
        for (at, lever) in Lever::ALL.into_iter().enumerate() {
            form.lever = at;
            assert_eq!(form.controller(), Stimulus::Controller { lever });
        }
        form.lever = usize::MAX;
        assert_eq!(form.lever(), Lever::Neutral);
        form.load_t = 12.5;
        assert_eq!(
            form.load(),
            Stimulus::Load {
                passengers_kg: 12_500.0
            }
        );
    }
}
