//! What is done in a minute, drawn one act after the other.

use btu_rig::lever::Lever;
use btu_rig::stimulus::{
    OrderData, StationData, Stimulus, TachoCondition, TcmsCondition, TrainSwitch, WaysideCondition,
};
use protocol::Speed;
use protocol::message::{DoorSide, ModeSwitch, RunningMode, TrainOrder};

use super::Minute;

impl Minute<'_> {
    /// Does one thing.
    pub(super) fn act(&mut self) {
        let act = self.random.below(31);
        match act {
            0..=2 => self.change_code(),
            3 => {
                let to = Speed::from_kmh(85.0 * self.random.unit());
                let accel_mps2 = 0.2 + 1.2 * self.random.unit();
                self.apply(Stimulus::Speed { to, accel_mps2 });
            }
            4 => {
                let to = Speed::from_kmh(6.0 * self.random.unit());
                self.apply(Stimulus::Speed {
                    to,
                    accel_mps2: 0.8,
                });
            }
            5..=7 => {
                let lever = self.one_of(&Lever::ALL);
                self.apply(Stimulus::Controller { lever });
            }
            8 => {
                let closed = self.chance(0.6);
                self.apply(Stimulus::Doors { closed });
            }
            9 => {
                let switch = self.one_of(&[
                    ModeSwitch::Off,
                    ModeSwitch::Yard,
                    ModeSwitch::Manual,
                    ModeSwitch::Manual,
                    ModeSwitch::Automatic,
                    ModeSwitch::Automatic,
                    ModeSwitch::Driverless,
                    ModeSwitch::Emergency,
                ]);
                self.apply(Stimulus::ModeSwitch(switch));
            }
            10 | 11 => self.change_station(),
            12 => {
                self.started = Some(self.bench.now());
                self.apply(Stimulus::Start);
            }
            13 | 14 => self.apply(Stimulus::Acknowledge),
            15 => self.change_wayside(),
            16 => self.change_tachometer(),
            17 => {
                let psm = 1 + self.random.below(4) as u8;
                self.apply(Stimulus::Marker { psm });
            }
            18 => {
                let permille = self.chance(0.7).then(|| 70.0 * (self.random.unit() - 0.5));
                self.apply(Stimulus::Gradient { permille });
            }
            19 => {
                let position = self.one_of(&[1, 1, 0, -1]);
                self.apply(Stimulus::Reverser { position });
            }
            20 => {
                let backward = self.chance(0.5);
                self.apply(Stimulus::Direction { backward });
            }
            21 => self.change_cab(),
            22 => {
                let on = self.chance(0.6);
                self.apply(Stimulus::TrainDriven { on });
            }
            23 => self.change_power(),
            24 | 25 => self.let_code_flicker(),
            26 => self.open_line(),
            27 => self.give_order(),
            28 | 29 => self.let_neighbour_speak(),
            _ => self.key_in_wheels(),
        }
    }

    /// Somebody else than the unit opens the emergency brake line, or lets it close again.
    fn open_line(&mut self) {
        let switch = self.one_of(&[
            TrainSwitch::Button1,
            TrainSwitch::Button2,
            TrainSwitch::MainReservoirLow,
        ]);
        let on = self.chance(0.4);
        for switch in [
            TrainSwitch::Button1,
            TrainSwitch::Button2,
            TrainSwitch::MainReservoirLow,
        ] {
            self.apply(Stimulus::Switch { switch, on: false });
        }
        if on {
            self.apply(Stimulus::Switch { switch, on });
        }
    }

    /// The wayside puts the train away, wakes it, or orders nothing.
    fn give_order(&mut self) {
        let order = self.one_of(&[
            TrainOrder::PutAway,
            TrainOrder::WakeUp,
            TrainOrder::WakeUp,
            TrainOrder::None,
        ]);
        let orders = OrderData::of_section(order, None, 0.0);
        self.apply(Stimulus::Orders(Some(orders)));
    }

    fn change_station(&mut self) {
        let line = &self.setup.line.content;
        let mut station = match self.chance(0.5) {
            true => StationData::at_departure(&self.section),
            false => {
                let after = line.after(&self.section);
                StationData::at_arrival(&self.section, after.map_or(0, |next| next.to_station))
            }
        };
        station.departure = self.chance(0.6);
        if self.chance(0.2) {
            station.door_side = self.one_of(&[
                DoorSide::None,
                DoorSide::Left,
                DoorSide::Right,
                DoorSide::Both,
            ]);
        }
        if self.chance(0.1) {
            let section = &line.sections[self.random.below(line.sections.len())];
            station = StationData::at_departure(section);
        }
        if self.chance(0.2) {
            station.running_mode = match station.departure {
                true => RunningMode::Slow,
                false => RunningMode::Recovery,
            };
        }
        self.station = station;
        self.apply(Stimulus::Station(station));
    }

    fn change_wayside(&mut self) {
        let wayside = self.one_of(&[
            WaysideCondition::Silent,
            WaysideCondition::Good,
            WaysideCondition::Good,
            WaysideCondition::Corrupt,
        ]);
        self.apply(Stimulus::Wayside(wayside));
        let tcms = self.one_of(&[
            TcmsCondition::Good,
            TcmsCondition::Good,
            TcmsCondition::Silent,
            TcmsCondition::Stale,
        ]);
        self.tcms_good = tcms == TcmsCondition::Good;
        self.apply(Stimulus::Tcms(tcms));
        let on = self.chance(0.8);
        self.apply(Stimulus::AtoEnable { on });
    }

    /// A fault of the first tachometer, or both die at once; and its repair.
    fn change_tachometer(&mut self) {
        let good = self.chance(0.3);
        let condition = match self.random.below(4) {
            _ if good => TachoCondition::Good,
            0 | 1 => TachoCondition::Dead,
            2 => TachoCondition::Noisy { per_s: 50.0 },
            _ => TachoCondition::Scaled {
                factor: 0.8 + 0.4 * self.random.unit(),
            },
        };
        let both = good || condition == TachoCondition::Dead && self.chance(0.5);
        if !good && !self.scaled {
            if self.budget == 0 {
                return;
            }
            self.budget -= 1;
            self.scaled = true;
        }
        for channel in 1..=1 + u8::from(both) {
            self.apply(Stimulus::Tacho { channel, condition });
        }
    }

    fn change_cab(&mut self) {
        let on = self.chance(0.8);
        self.apply(Stimulus::Hcr { on });
        let passengers_kg = 1e5 * self.random.unit();
        self.apply(Stimulus::Load { passengers_kg });
    }

    /// Wheels of the train's range, that of the configuration, or what no wheel has.
    pub(super) fn key_in_wheels(&mut self) {
        let tacho = &self.setup.config.content.tacho;
        let (worn_mm, new_mm) = (
            tacho.wheel_diameter_mm - tacho.worn_mm,
            tacho.wheel_diameter_mm + tacho.over_mm,
        );
        let diameter_mm = match self.random.below(5) {
            0 => 0.0,
            1 => worn_mm + (new_mm - worn_mm) * self.random.unit(),
            2 | 3 => worn_mm * (0.7 + 0.29 * self.random.unit()),
            _ => new_mm * (1.01 + 0.2 * self.random.unit()),
        };
        self.apply(Stimulus::WheelDiameter { diameter_mm });
    }

    /// The supply fails, or comes back.
    fn change_power(&mut self) {
        self.powered = !self.powered || self.chance(0.7);
        let (now, on) = (self.bench.now(), self.powered);
        self.bench.link_mut().set_power(now, on);
        self.acts.push((now, format!("supply {on}")));
    }
}
