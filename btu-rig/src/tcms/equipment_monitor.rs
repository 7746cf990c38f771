//! Monitoring of the train's equipment: inverters and brake control units that do not answer, cylinders that
//! do not follow their demand, brakes that are not released (S4).
//!
//! A failure that was found is kept until its opposite has lasted as long (a unit answers again, cylinders follow a
//! full demand), so that it does not come and go. Cutting out the equipment of the car ends it at once.

use protocol::{Duration, Instant};

use crate::train::{CarSet, Equipment, MAX_CARS, PerCar};

use super::data::TcmsData;
use super::not_released::{NotReleased, ReleaseCheck};
use super::timer::OnDelayCars;

/// Demand on a car's air brake that shows whether its cylinders follow again, share of full service.
/// Less would hide cylinders that get only part of their pressure.
const FULL_DEMAND: f64 = 0.9;

/// Inputs of the monitor in one scan.
#[derive(Clone, Copy, Debug)]
pub struct MonitorInputs<'a> {
    pub equipment: &'a Equipment,
    /// Air brake that TCMS asks of each car, N.
    pub air_n: &'a PerCar,
    /// No brake is ordered but by this monitor itself: no service, holding, full service, emergency, security or
    /// parking brake.
    pub nobody_brakes: bool,
    /// Cars without a brake: cut out.
    pub brakes_cut_out: CarSet,
    pub inverters_cut_out: CarSet,
    /// The driver releases brakes by force.
    pub forced_release: bool,
}

/// Failures of the equipment found so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EquipmentFailures {
    /// Inverters that do not answer and are not cut out (BCXVVVFF).
    pub inverters: CarSet,
    /// Brake control units that do not answer and are not cut out (BCXECUF).
    pub brake_units: CarSet,
    /// Cars whose cylinders do not follow (BCXBCCSF).
    pub cylinders: CarSet,
    /// Cars whose brake is not released.
    pub not_released: CarSet,
    /// Brakes that are not released order the full service brake (BCXNRB), except while they are asked to release
    /// again.
    pub not_released_brakes: bool,
}

/// A failure of cars, latched once it has lasted and until its opposite has lasted as long.
#[derive(Clone, Debug, Default)]
struct LatchedFault {
    wrong: OnDelayCars,
    right: OnDelayCars,
    found: CarSet,
}

impl LatchedFault {
    fn update(&mut self, now: Instant, wrong: CarSet, right: CarSet, after: Duration) -> CarSet {
        let lasting = self.wrong.update(now, wrong, after);
        if !self.found.is_empty() {
            let mended = self.right.update(now, right, after);
            self.found = self.found.without(mended);
        } else if !lasting.is_empty() {
            self.right.clear();
        }
        self.found = self.found.with(lasting);
        self.found
    }

    fn drop(&mut self, cars: CarSet) {
        self.found = self.found.without(cars);
    }
}

/// Finds failed equipment from what it reports, scan by scan.
#[derive(Clone, Debug)]
pub struct EquipmentMonitor {
    silent_after: Duration,
    not_released_above: f64,
    not_following_above: f64,
    not_following_after: Duration,
    full_service_n: PerCar,
    cars: CarSet,
    inverters: LatchedFault,
    brake_units: LatchedFault,
    cylinders: LatchedFault,
    not_released: NotReleased,
}

impl EquipmentMonitor {
    /// A monitor that has found nothing. `full_service_n` is each car's share of full service, N.
    pub fn new(data: &TcmsData, full_service_n: PerCar) -> Self {
        let mut monitor = Self {
            silent_after: Duration::from_secs(data.silent_after_s),
            not_released_above: data.not_released_above / 100.0,
            not_following_above: data.not_following_above / 100.0,
            not_following_after: Duration::from_secs(data.not_following_after_s),
            full_service_n,
            cars: CarSet::NONE,
            inverters: LatchedFault::default(),
            brake_units: LatchedFault::default(),
            cylinders: LatchedFault::default(),
            not_released: NotReleased::new(Duration::from_secs(data.not_released_after_s)),
        };
        monitor.weigh(full_service_n);
        monitor
    }

    /// Sets each car's full service brake, N.
    pub fn weigh(&mut self, full_service_n: PerCar) {
        self.full_service_n = full_service_n;
        for (car, full_n) in full_service_n.iter().enumerate() {
            self.cars.set(car, *full_n > 0.0);
        }
    }

    /// Forgets what was found.
    pub fn clear(&mut self) {
        for latched in [
            &mut self.inverters,
            &mut self.brake_units,
            &mut self.cylinders,
        ] {
            latched.found = CarSet::NONE;
            latched.wrong.clear();
        }
        self.not_released.clear();
    }

    pub fn step(&mut self, now: Instant, inputs: &MonitorInputs<'_>) -> EquipmentFailures {
        let equipment = inputs.equipment;
        let (no_inverter, no_brake) = (inputs.inverters_cut_out, inputs.brakes_cut_out);
        let silent = equipment.inverters_silent;
        self.inverters.drop(no_inverter);
        let inverters = self.inverters.update(
            now,
            silent.without(no_inverter),
            self.cars.without(silent),
            self.silent_after,
        );
        let silent = equipment.brake_units_silent;
        self.brake_units.drop(no_brake);
        let brake_units = self.brake_units.update(
            now,
            silent.without(no_brake),
            self.cars.without(silent),
            self.silent_after,
        );
        let asked = self.cars.without(no_brake).without(silent);
        self.cylinders.drop(no_brake);
        let cylinders = self.cylinders(now, inputs, asked);
        let (not_released, not_released_brakes) = self.not_released(now, inputs, asked);
        EquipmentFailures {
            inverters,
            brake_units,
            cylinders,
            not_released,
            not_released_brakes,
        }
    }

    /// Cars whose cylinders hold less than they were asked for. While other brakes act, this cannot be seen.
    fn cylinders(&mut self, now: Instant, inputs: &MonitorInputs<'_>, asked: CarSet) -> CarSet {
        let (mut low, mut full) = (CarSet::NONE, CarSet::NONE);
        if !inputs.equipment.other_brakes {
            let (air_n, demands_n) = (&inputs.equipment.air_n, inputs.air_n);
            let (full_n, part) = (&self.full_service_n, self.not_following_above);
            // Written so that not-a-number counts as not following.
            let follows = |car: usize| air_n[car] >= demands_n[car] - part * full_n[car];
            low = cars(|car| !follows(car));
            if !self.cylinders.found.is_empty() {
                full = cars(|car| demands_n[car] >= FULL_DEMAND * full_n[car]);
            }
        }
        let wrong = low.without(low.without(asked));
        let right = full.without(low);
        self.cylinders
            .update(now, wrong, right, self.not_following_after)
    }

    fn not_released(
        &mut self,
        now: Instant,
        inputs: &MonitorInputs<'_>,
        asked: CarSet,
    ) -> (CarSet, bool) {
        let nobody_brakes = inputs.nobody_brakes && !inputs.equipment.other_brakes;
        let mut pressed = CarSet::NONE;
        if nobody_brakes {
            let (air_n, full_n) = (&inputs.equipment.air_n, &self.full_service_n);
            let released = |car: usize| air_n[car] <= self.not_released_above * full_n[car];
            pressed = cars(|car| !released(car));
        }
        self.not_released.step(
            now,
            &ReleaseCheck {
                nobody_brakes,
                by_force: inputs.forced_release,
                pressed: pressed.without(pressed.without(asked)),
                cut_out: inputs.brakes_cut_out,
            },
        )
    }
}

/// The cars for which `holds` is true. Mostly there is none, which one pass over all cars finds out without a branch.
fn cars(holds: impl Fn(usize) -> bool) -> CarSet {
    let mut set = CarSet::NONE;
    if (0..MAX_CARS).fold(false, |any, car| any | holds(car)) {
        (0..MAX_CARS).for_each(|car| set.set(car, holds(car)));
    }
    set
}
