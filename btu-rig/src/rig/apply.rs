//! Carries out each stimulus on the rig.

use protocol::Instant;

use crate::procedure::Refusal;
use crate::stimulus::{CarFailure, CutOut, MAX_GRADIENT_PERMILLE, Stimulus, TachoCondition};
use crate::train::TrainData;

use super::Rig;
use super::session::{Request, test_signals};
use super::wayside::{Track, in_antenna};
use crate::stimulus::ranges::{U16_MAX, in_range, positive};

/// Fastest wheel, km/h: the range of the signals `speed` and `train_speed`.
const MAX_SPEED_KMH: f64 = 200.0;
/// Hardest acceleration of a wheel, m/s²: far beyond any train, for tests of plausibility.
const MAX_ACCEL_MPS2: f64 = 100.0;
/// Longest distance of one travel, m.
const MAX_TRAVEL_M: f64 = 100_000.0;
/// Farthest a marker can be moved, m.
const MAX_MOVE_M: f64 = 100.0;
/// Most spurious pulses, 1/s.
const MAX_NOISE_PER_S: f64 = 5_000.0;
/// Greatest factor between a channel and its wheel.
const MAX_FACTOR: f64 = 10.0;
/// Fastest drift: what the whole range in a second would take.
const MAX_DRIFT_PER_S: f64 = U16_MAX;

impl Rig {
    /// Does something to the unit, from the next scan on. What making safe still had to do is done
    /// at once, so wait for [`Self::safe`] first where the wheels turn.
    ///
    /// # Errors
    /// What the bench cannot do, in words for the technician.
    pub fn apply(&mut self, now: Instant, stimulus: &Stimulus) -> Result<(), Refusal> {
        if !self.harness.is_there() && !stimulus.way().by_tester() {
            return Err(Refusal(format!(
                "only the maintenance port is connected: the bench harness gives this ({stimulus})"
            )));
        }
        if self.making_safe {
            self.rest_quiescent();
        }
        self.quiescent = false;
        // What the unit refused or did not answer before this stimulus is told no longer.
        self.tester.exchange.failure = None;
        match *stimulus {
            Stimulus::Code(signal) => {
                self.antenna.set(in_antenna(signal)?);
                self.codes_along = false;
            }
            Stimulus::Crosstalk(signal) => {
                self.antenna.set_second(self.now, in_antenna(signal)?);
            }
            Stimulus::CodeDrift {
                rate_hz_per_s,
                level_mv_per_s,
            } => {
                let limit = MAX_DRIFT_PER_S;
                in_range(
                    "drift of the code rate",
                    rate_hz_per_s,
                    -limit,
                    limit,
                    "Hz/s",
                )?;
                in_range("drift of the level", level_mv_per_s, -limit, limit, "mV/s")?;
                self.antenna.drift(rate_hz_per_s, level_mv_per_s);
            }
            Stimulus::CodeOff => {
                self.antenna.off();
                self.codes_along = false;
            }
            Stimulus::CodesAlong { on } => self.set_codes_along(on)?,
            Stimulus::Speed { to, accel_mps2 } => {
                self.need_generator()?;
                in_range("speed", to.kmh(), 0.0, MAX_SPEED_KMH, "km/h")?;
                positive("acceleration", accel_mps2, MAX_ACCEL_MPS2, "m/s²")?;
                self.wheel.go_to(to, accel_mps2);
                self.awaits_motion = true;
            }
            Stimulus::Travel {
                distance_m,
                speed,
                accel_mps2,
            } => {
                self.need_generator()?;
                positive("distance", distance_m, MAX_TRAVEL_M, "m")?;
                positive("speed", speed.kmh(), MAX_SPEED_KMH, "km/h")?;
                positive("acceleration", accel_mps2, MAX_ACCEL_MPS2, "m/s²")?;
                self.wheel.travel(distance_m, speed, accel_mps2)?;
                self.awaits_motion = true;
            }
            Stimulus::Direction { backward } => {
                self.need_generator()?;
                self.wheel.set_backward(backward)?;
            }
            Stimulus::Tacho { channel, condition } => self.set_tacho(channel, condition)?,
            Stimulus::TrainDriven { on } => self.drive_train(on),
            Stimulus::Adhesion { coefficient } => self.set_adhesion(coefficient)?,
            Stimulus::Gradient { permille } => self.set_gradient(permille)?,
            Stimulus::Marker { psm } => {
                in_range("marker", f64::from(psm), 1.0, 4.0, "")?;
                self.markers.pulse(psm)?;
            }
            Stimulus::MarkerMoved { psm, by_m } => {
                let by_m = by_m
                    .map(|by| in_range("marker move", by, -MAX_MOVE_M, MAX_MOVE_M, "m"))
                    .transpose()?;
                self.markers.move_one(psm, by_m)?;
            }
            Stimulus::MarkersAlong { section } => self.lay_section(section)?,
            Stimulus::Station(data) => self.wayside.data = data,
            Stimulus::Orders(orders) => self.wayside.orders.set(orders),
            Stimulus::Wayside(condition) => self.wayside.condition = condition,
            _ => return self.apply_desk(now, stimulus),
        }
        Ok(())
    }

    /// Stimuli of cab desk, train lines and TCMS.
    fn apply_desk(&mut self, now: Instant, stimulus: &Stimulus) -> Result<(), Refusal> {
        match *stimulus {
            Stimulus::Doors { closed } => {
                self.desk.set_doors(closed);
                self.door_gear.follow(false, self.desk.doors);
            }
            Stimulus::SideDoors { left, state } => {
                self.desk.doors[usize::from(!left)] = state;
                self.door_gear.follow(false, self.desk.doors);
            }
            Stimulus::DoorsFollow { on } => self.door_gear.follow(on, self.desk.doors),
            Stimulus::DoorObstacle { left, times } => self.door_gear.obstruct(left, times),
            Stimulus::DoorLine { line, on } => self.desk.line_said[line as usize] = on,
            Stimulus::Hcr { on } => self.desk.hcr = on,
            Stimulus::MaintenanceKey { on } => self.desk.maintenance_key = on,
            Stimulus::TrainNumber { number } => self.desk.number.key_in(now, number),
            Stimulus::WheelDiameter { diameter_mm } => {
                let most_mm = U16_MAX / 10.0;
                let diameter_mm = in_range("wheel diameter", diameter_mm, 0.0, most_mm, "mm")?;
                self.desk
                    .wheel
                    .key_in(now, (diameter_mm * 10.0).round() as u16);
            }
            Stimulus::ModeSwitch(position) => self.desk.mode_switch = position,
            Stimulus::Controller { lever } => self.desk.lever = lever,
            Stimulus::ControllerVolts { volts } => {
                self.desk.volts = volts
                    .map(|volts| in_range("controller voltage", volts, 0.0, 10.0, "V"))
                    .transpose()?;
            }
            Stimulus::ControllerContacts { contacts } => self.desk.contacts = contacts,
            Stimulus::Switch { switch, on } => self.desk.switches.set(switch, on),
            Stimulus::CutOut { what, car, on } => {
                let place = self.place_of(car, what == CutOut::Inverter)?;
                self.desk.cut_out(what, place, on);
            }
            Stimulus::Failure { what, car, on } => {
                let place = self.place_of(car, what == CarFailure::InverterSilent)?;
                self.made.set(what, place, on);
                self.fail_equipment();
            }
            Stimulus::Reverser { position } => {
                in_range("reverser position", f64::from(position), -1.0, 1.0, "")?;
                self.desk.reverser = position;
            }
            Stimulus::Acknowledge => self.desk.press_acknowledge(now),
            Stimulus::Start => self.desk.press_start(now),
            Stimulus::Tcms(condition) => self.tcms_port.condition = condition,
            Stimulus::AtoEnable { on } => self.tcms_port.ato_enable = on,
            Stimulus::Load { passengers_kg } => {
                let full_kg = self.train.full_load_kg;
                self.tcms_port.load_kg = in_range("load", passengers_kg, 0.0, full_kg, "kg")?;
            }
            _ => return self.apply_ptu(now, stimulus),
        }
        Ok(())
    }

    /// Stimuli by the tester at the maintenance port, most of them through the unit's TEST board.
    fn apply_ptu(&mut self, now: Instant, stimulus: &Stimulus) -> Result<(), Refusal> {
        let session = self.tester.session;
        let request = match *stimulus {
            Stimulus::PtuArm => Request::Arm {
                refusal_fails: true,
            },
            Stimulus::PtuAskToArm => Request::Arm {
                refusal_fails: false,
            },
            Stimulus::PtuDisarm => Request::Disarm,
            Stimulus::PtuSilent { on } => {
                self.tester.set_silent(now, on);
                return Ok(());
            }
            Stimulus::PtuCode(signal) => test_signals::code(session, signal)?,
            Stimulus::PtuSpeed {
                channels,
                backward,
                to,
                accel_mps2,
            } => test_signals::speed(session, channels, backward, to, accel_mps2)?,
            Stimulus::PtuMarker { psm } => test_signals::marker(session, psm),
            Stimulus::PtuTwc(data) => test_signals::station(session, &data, self.train_number),
            Stimulus::PtuRelease => test_signals::release(session),
            Stimulus::PtuSelfTest => test_signals::self_test(session),
            Stimulus::PtuClearLog => test_signals::clear_log(session),
            _ => return Err(Refusal(format!("this bench cannot do {stimulus:?}"))),
        };
        self.awaits_motion = false;
        self.tester.request(request)
    }

    /// Whether every request to the unit has its outcome, and a ramp or travel begun after the last request is done. A
    /// ramp begun before that request may run on.
    ///
    /// # Errors
    /// What the unit refused or did not answer, until the next stimulus.
    pub fn settled(&self) -> Result<bool, Refusal> {
        Ok(self.tester.settled()? && (!self.awaits_motion || self.motion_settled()))
    }

    fn set_tacho(&mut self, channel: u8, condition: TachoCondition) -> Result<(), Refusal> {
        match condition {
            TachoCondition::Noisy { per_s } => {
                positive("spurious pulses", per_s, MAX_NOISE_PER_S, "1/s")?;
            }
            TachoCondition::Scaled { factor } => {
                in_range("tachometer factor", factor, 0.0, MAX_FACTOR, "")?;
            }
            TachoCondition::Good | TachoCondition::Dead | TachoCondition::Reversed => {}
        }
        let distance_m = self.wheel.axle.distance_m;
        let tacho = usize::from(channel)
            .checked_sub(1)
            .and_then(|i| self.tachos.get_mut(i));
        tacho
            .ok_or_else(|| Refusal(format!("there is no tachometer {channel}: use 1 or 2")))?
            .set_condition(condition, distance_m);
        Ok(())
    }

    fn set_adhesion(&mut self, coefficient: Option<f64>) -> Result<(), Refusal> {
        let mut conditions = self.conditions;
        if let Some(coefficient) = coefficient {
            conditions.adhesion = in_range("adhesion", coefficient, 0.01, 1.0, "")?;
        }
        self.train.set_conditions(&conditions);
        Ok(())
    }

    fn set_gradient(&mut self, permille: Option<f64>) -> Result<(), Refusal> {
        let mut conditions = self.conditions;
        if let Some(permille) = permille {
            let limit = MAX_GRADIENT_PERMILLE;
            conditions.gradient_offset_permille =
                in_range("gradient", permille, -limit, limit, "‰")?;
        }
        self.train.set_conditions(&conditions);
        Ok(())
    }

    /// Place from 0 of a car that people count from 1, of a motor car if its `inverter` is meant.
    fn place_of(&self, car: u8, inverter: bool) -> Result<usize, Refusal> {
        let TrainData::Cars(data) = &self.train_data else {
            return Err(Refusal(
                "a point mass has no cars with equipment of their own: take a train of cars"
                    .to_owned(),
            ));
        };
        let cars = data.cars.len();
        let place = usize::from(car).checked_sub(1).filter(|at| *at < cars);
        let place = place
            .ok_or_else(|| Refusal(format!("there is no car {car}: the train has 1 to {cars}")))?;
        if inverter && !data.motor_cars().contains(place) {
            return Err(Refusal(format!(
                "car {car} is a trailer: it has no inverter"
            )));
        }
        Ok(place)
    }

    /// Hands the train what is wrong with its equipment: injected faults, and failures made by stimuli.
    pub(super) fn fail_equipment(&mut self) {
        self.train
            .set_faults(self.faults.equipment.with(&self.made));
    }

    fn drive_train(&mut self, on: bool) {
        if on && !self.train_driven {
            self.tcms.rest();
            self.train.place(self.wheel.velocity_mps());
        }
        if self.train_driven && !on {
            // The generators take over the train's speed and bring it to rest.
            self.wheel.stop();
        }
        self.train_driven = on;
    }

    fn need_generator(&self) -> Result<(), Refusal> {
        if self.train_driven {
            return Err(Refusal(
                "the train model turns the wheels: switch it off to use the generators".to_owned(),
            ));
        }
        Ok(())
    }

    fn lay_section(&mut self, number: Option<u16>) -> Result<(), Refusal> {
        let Some(number) = number else {
            self.markers.lift();
            self.track = None;
            return Ok(());
        };
        let Some(section) = self.line.section(number) else {
            let known: Vec<_> = self
                .line
                .sections
                .iter()
                .map(|s| s.section.to_string())
                .collect();
            return Err(Refusal(format!(
                "line {} has no section {number}; it has {}",
                self.line.name,
                known.join(", ")
            )));
        };
        if self.codes_along {
            self.check_codes(section)?;
        }
        let position_m = self.wheel.motion.position_m;
        self.markers.lay(section, position_m);
        self.track = Some(Track::new(section.clone(), position_m));
        Ok(())
    }
}
