//! Motion of the wheels: by the generators, or by the train model, whose true state the rig also reports.

use protocol::{Duration, Random, SCAN};

use crate::conditions::{Conditions, Sensors};
use crate::tcms::Tcms;
use crate::train::{Train, TrainData, TrainInputs, TrainState};

use super::Rig;
use super::train_side::TrueMotion;
use crate::stimulus::DoorState;

/// The train is integrated in two steps a scan: 5 ms each.
const TRAIN_STEP: Duration = Duration::from_us(SCAN.as_us() / 2);

impl Rig {
    /// Puts another train under the rig, at the speed the present one has.
    pub fn set_train(&mut self, data: TrainData) {
        let mut train = Train::new(&data, &self.conditions);
        train.place(self.train.velocity_mps());
        train.set_faults(self.faults.equipment);
        self.train = train;
        self.cars = data.weight_shares(self.cars_load_kg);
        self.tcms = Tcms::new(&data);
        self.train_orders = TrainInputs::default();
        self.pair_cars = data.first_pairs();
        self.train_data = data;
    }

    /// Changes how train and track differ from what the unit is configured for, from now on.
    pub fn set_conditions(&mut self, conditions: Conditions) {
        self.train.set_conditions(&conditions);
        self.markers.offsets_m = conditions.marker_offsets_m;
        let pulse_m = self.metres_per_pulse * conditions.wheel_factor;
        let distance_m = self.wheel.axle.distance_m;
        for tacho in &mut self.tachos {
            tacho.set_metres_per_pulse(pulse_m, distance_m);
        }
        self.conditions = conditions;
    }

    /// Changes how sensors and antenna differ from ideal ones, from now on.
    pub fn set_sensors(&mut self, sensors: &Sensors) {
        self.antenna.set_sensors(*sensors);
        let random = &mut Random::new(sensors.teeth_seed);
        for tacho in &mut self.tachos {
            tacho.set_sensors(sensors, self.pulses_per_turn, random);
        }
    }

    /// Passengers aboard unless a procedure says otherwise, kg; never more than the train can carry.
    pub fn set_usual_load(&mut self, passengers_kg: f64) {
        let load_kg = passengers_kg.clamp(0.0, self.train.full_load_kg);
        self.tcms_port.usual_load_kg = load_kg;
        self.tcms_port.load_kg = load_kg;
    }

    /// What the train really does at the scan's end.
    pub fn truth(&self) -> TrueMotion {
        let motion = &self.wheel.motion;
        let track = self.track.as_ref();
        let state = &self.train_state;
        TrueMotion {
            speed_mps: self.wheel.velocity_mps(),
            accel_mps2: motion.last().accel_mps2,
            position_m: track.map_or(motion.position_m, |t| t.in_section_m(motion.position_m)),
            to_stop_m: track.map(|t| t.to_stop_m(motion.position_m)),
            tractive_power_w: state.tractive_power_w,
            traction_n: state.traction_n,
            electric_brake_n: state.electric_brake_n,
            air_brake_n: state.air_brake_n,
            sliding: state.sliding,
        }
    }

    /// Doors of the left and of the right that stand open, whatever their lines say.
    pub fn doors_open(&self) -> [bool; 2] {
        self.desk.doors.map(|doors| doors == DoorState::Open)
    }

    /// Turns the wheels through one scan.
    pub(super) fn roll(&mut self, orders: TrainInputs) {
        let inputs = self.on_track(orders);
        if self.train_driven {
            let dt = TRAIN_STEP.as_secs();
            // Two calls instead of a loop: the compiler then builds each state in its place, which takes a twentieth off the time
            // of a whole run.
            let states = [self.train.step(dt, &inputs), self.train.step(dt, &inputs)];
            self.wheel.follow(&states);
            self.train_state = states[1];
            self.braking = self.train_state.braking;
        } else {
            self.wheel.step();
            self.train_state = TrainState::default();
            self.braking = inputs.emergency || inputs.security || inputs.demand < 0.0;
        }
        self.speeds.push(self.wheel.velocity_mps());
    }

    /// Adds what acts on the train besides its orders.
    fn on_track(&mut self, mut inputs: TrainInputs) -> TrainInputs {
        if inputs.load_kg != self.cars_load_kg {
            self.cars_load_kg = inputs.load_kg;
            self.cars = self.train_data.weight_shares(inputs.load_kg);
        }
        if let Some(track) = self.track.as_ref().filter(|_| self.train_driven) {
            let head_m = self.wheel.motion.position_m;
            let under = track.under(head_m, &self.cars);
            inputs.gradient_permille = under.gradient_permille;
            inputs.curvature_per_m = under.curvature_per_m;
            inputs.open_air = under.open_air;
            if track.is_neutral(head_m) {
                inputs.without_voltage();
            }
        }
        inputs
    }
}
