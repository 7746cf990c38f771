//! Every input that the bench has, by kind: each kind draws what people, track, train or wayside do, and mostly take back
//! later.

use btu_rig::lever::Lever;
use btu_rig::stimulus::{
    CodeSignal, CutOut, DoorLine, DoorState, StationData, Stimulus, TachoCondition, TcmsCondition,
    TrainSwitch,
};
use protocol::message::ModeSwitch;
use protocol::{Duration, Speed};

use super::plan::{Act, Draw};

macro_rules! kinds {
    ($($name:ident => $act:ident;)*) => {
        /// A kind of input.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Kind { $($name,)* }

        pub const KINDS: [Kind; [$(Kind::$name,)*].len()] = [$(Kind::$name,)*];

        impl Draw<'_> {
            /// Draws what is done at a time.
            pub fn act(&mut self, kind: Kind, at_ms: u32) {
                match kind { $(Kind::$name => self.$act(at_ms),)* }
            }
        }
    };
}

kinds! {
    Code => code;
    Flicker => flicker;
    Neighbour => neighbour;
    Wheels => wheels;
    Direction => direction;
    Lever => lever;
    LeverContacts => lever_contacts;
    Switch => switch;
    SwitchPasses => switch_passes;
    Reverser => reverser;
    Doors => doors;
    DoorLine => door_line;
    Station => station;
    Departure => departure;
    Start => start;
    Acknowledge => acknowledge;
    Wayside => wayside;
    Tcms => tcms;
    Tachometer => tachometer;
    Marker => marker;
    Gradient => gradient;
    Cab => cab;
    TrainDriven => train_driven;
    Supply => supply;
    Line => line;
    Brakes => brakes;
    Orders => orders;
    WheelDiameter => wheel_diameter;
    Tests => tests;
}

impl Draw<'_> {
    fn code(&mut self, at_ms: u32) {
        if self.chance(0.3) {
            return self.at(at_ms, Stimulus::CodesAlong { on: true });
        }
        let code = self.any_code();
        self.at(at_ms, code);
        self.back(at_ms, Stimulus::CodesAlong { on: true });
    }

    /// Two codes by turns, or one and none, that stay from 10 ms to a second; or one burst.
    fn flicker(&mut self, at_ms: u32) {
        let mut one = || {
            let ms = self.one_of(&[10, 50, 100, 170, 250, 310, 340, 380, 450, 900]);
            (self.any_code(), Duration::from_ms(ms))
        };
        let turns = [one(), one()];
        self.drawn.push((at_ms, Act::Alternate(turns)));
        if self.chance(0.3) {
            self.at(at_ms + turns[0].1.as_ms() as u32, turns[1].0);
        }
    }

    /// A code of a neighbouring track, from 12 dB weaker to 6 dB stronger than a nominal one, or none any more.
    fn neighbour(&mut self, at_ms: u32) {
        let config = &self.setup.config.content;
        let code = config.codes[self.random.below(config.codes.len())].clone();
        let nominal_mv = config.receiver.level_nominal_mv;
        let times = self.one_of(&[0.0, 0.25, 0.5, 0.56, 0.7, 1.0, 1.4, 2.0]);
        self.at(
            at_ms,
            Stimulus::Crosstalk(CodeSignal::new(
                code.carrier_hz,
                code.rate_hz,
                times * nominal_mv,
            )),
        );
    }

    fn any_code(&mut self) -> Stimulus {
        let config = &self.setup.config.content;
        let code = config.codes[self.random.below(config.codes.len())].clone();
        let level_mv = config.receiver.level_nominal_mv;
        let signal = |rate_hz| Stimulus::Code(CodeSignal::new(code.carrier_hz, rate_hz, level_mv));
        match self.random.below(6) {
            0 => Stimulus::CodeOff,
            1 => signal(0.0),
            _ => signal(code.rate_hz),
        }
    }

    fn wheels(&mut self, at_ms: u32) {
        let most_kmh = self.one_of(&[1.0, 2.0, 6.0, 40.0, 85.0]);
        let to = Speed::from_kmh(most_kmh * self.random.unit());
        let accel_mps2 = 0.2 + 1.2 * self.random.unit();
        self.at(at_ms, Stimulus::Speed { to, accel_mps2 });
    }

    fn direction(&mut self, at_ms: u32) {
        let backward = self.chance(0.6);
        self.at(at_ms, Stimulus::Direction { backward });
    }

    fn lever(&mut self, at_ms: u32) {
        let lever = match self.chance(0.5) {
            true => Lever::Power(4),
            false => self.one_of(&Lever::ALL),
        };
        self.at(at_ms, Stimulus::Controller { lever });
    }

    fn lever_contacts(&mut self, at_ms: u32) {
        let (power, brake) = (self.chance(0.5), self.chance(0.5));
        self.at(
            at_ms,
            Stimulus::ControllerContacts {
                contacts: Some((power, brake)),
            },
        );
        self.back(at_ms, Stimulus::ControllerContacts { contacts: None });
    }

    fn any_switch(&mut self) -> ModeSwitch {
        self.one_of(&[
            ModeSwitch::Off,
            ModeSwitch::Yard,
            ModeSwitch::Manual,
            ModeSwitch::Automatic,
            ModeSwitch::Driverless,
            ModeSwitch::Emergency,
        ])
    }

    fn switch(&mut self, at_ms: u32) {
        let switch = self.any_switch();
        self.at(at_ms, Stimulus::ModeSwitch(switch));
    }

    /// Turned over several positions, or contacts that chatter without end.
    fn switch_passes(&mut self, at_ms: u32) {
        let step_ms = self.one_of(&[50, 120, 200, 400]);
        let between = [self.any_switch(), self.any_switch()].map(Stimulus::ModeSwitch);
        if self.one_of(&[false, false, true]) {
            return self.chatter(at_ms, between, step_ms);
        }
        for (step, switch) in (0..).zip(between) {
            self.at(at_ms + step * step_ms, switch);
        }
    }

    fn chatter(&mut self, at_ms: u32, between: [Stimulus; 2], step_ms: u32) {
        let stays = Duration::from_ms(u64::from(step_ms));
        let turns = between.map(|stimulus| (stimulus, stays));
        self.drawn.push((at_ms, Act::Alternate(turns)));
    }

    /// Turned, or contacts that chatter without end; somebody puts it right, mostly.
    fn reverser(&mut self, at_ms: u32) {
        match self.one_of(&[-1, -1, 0, 0, 1]) {
            1 => {
                let between = [1, 0].map(|position| Stimulus::Reverser { position });
                self.chatter(at_ms, between, 20);
            }
            position => self.at(at_ms, Stimulus::Reverser { position }),
        }
        self.back(at_ms, Stimulus::Reverser { position: 1 });
    }

    /// Doors of a side are opened by hand or forced, and closed again.
    fn doors(&mut self, at_ms: u32) {
        let left = self.chance(0.5);
        if self.chance(0.2) {
            let times = 1 + self.random.below(3) as u8;
            return self.at(at_ms, Stimulus::DoorObstacle { left, times });
        }
        let state = self.one_of(&[DoorState::Open, DoorState::Open, DoorState::Unlocked]);
        self.at(at_ms, Stimulus::SideDoors { left, state });
        let wait_ms = self.one_of(&[300, 1_500, 5_000, 12_000]);
        if self.chance(0.8) {
            self.at(
                at_ms + wait_ms,
                Stimulus::SideDoors {
                    left,
                    state: DoorState::Locked,
                },
            );
        }
    }

    fn door_line(&mut self, at_ms: u32) {
        let line = self.one_of(&DoorLine::ALL);
        let on = Some(self.chance(0.5));
        self.at(at_ms, Stimulus::DoorLine { line, on });
        self.back(at_ms, Stimulus::DoorLine { line, on: None });
    }

    fn start(&mut self, at_ms: u32) {
        self.at(at_ms, Stimulus::Start);
    }

    fn acknowledge(&mut self, at_ms: u32) {
        self.at(at_ms, Stimulus::Acknowledge);
    }

    fn tcms(&mut self, at_ms: u32) {
        if self.chance(0.3) {
            self.at(at_ms, Stimulus::AtoEnable { on: false });
            return self.back(at_ms, Stimulus::AtoEnable { on: true });
        }
        let condition = self.one_of(&[TcmsCondition::Silent, TcmsCondition::Stale]);
        self.at(at_ms, Stimulus::Tcms(condition));
        self.back(at_ms, Stimulus::Tcms(TcmsCondition::Good));
    }

    /// One tachometer, or both at once.
    fn tachometer(&mut self, at_ms: u32) {
        let condition = match self.random.below(5) {
            0..=2 => TachoCondition::Dead,
            3 => TachoCondition::Noisy { per_s: 50.0 },
            _ => TachoCondition::Scaled {
                factor: 0.8 + 0.4 * self.random.unit(),
            },
        };
        let both = condition == TachoCondition::Dead && self.chance(0.5);
        for channel in 1..=1 + u8::from(both) {
            self.at(at_ms, Stimulus::Tacho { channel, condition });
        }
        if self.chance(0.5) {
            for channel in 1..=2 {
                let good = Stimulus::Tacho {
                    channel,
                    condition: TachoCondition::Good,
                };
                self.at(at_ms + 4_000, good);
            }
        }
    }

    fn marker(&mut self, at_ms: u32) {
        let psm = 1 + self.random.below(4) as u8;
        self.at(at_ms, Stimulus::Marker { psm });
    }

    fn gradient(&mut self, at_ms: u32) {
        let permille = self.chance(0.8).then(|| 70.0 * (self.random.unit() - 0.5));
        self.at(at_ms, Stimulus::Gradient { permille });
    }

    fn cab(&mut self, at_ms: u32) {
        self.at(at_ms, Stimulus::Hcr { on: false });
        self.back(at_ms, Stimulus::Hcr { on: true });
    }

    fn train_driven(&mut self, at_ms: u32) {
        let on = self.chance(0.4);
        self.at(at_ms, Stimulus::TrainDriven { on });
        self.back(at_ms, Stimulus::TrainDriven { on: !on });
    }

    /// The supply dips or fails.
    fn supply(&mut self, at_ms: u32) {
        let wait_ms = self.one_of(&[30, 200, 1_500, 6_000]);
        self.drawn.push((at_ms, Act::Supply(false)));
        self.drawn.push((at_ms + wait_ms, Act::Supply(true)));
    }

    /// Somebody else than the unit opens the emergency brake line, and lets it close again.
    fn line(&mut self, at_ms: u32) {
        let switch = self.one_of(&[
            TrainSwitch::Button1,
            TrainSwitch::Button2,
            TrainSwitch::MainReservoirLow,
            TrainSwitch::OtherCab,
        ]);
        self.at(at_ms, Stimulus::Switch { switch, on: true });
        self.back(at_ms, Stimulus::Switch { switch, on: false });
    }

    /// The emergency brake, or brakes of cars, are cut out; or all are released by force.
    fn brakes(&mut self, at_ms: u32) {
        if self.chance(0.4) {
            let what = CutOut::Brake;
            for car in 1..=1 + self.random.below(3) as u8 {
                self.at(
                    at_ms,
                    Stimulus::CutOut {
                        what,
                        car,
                        on: true,
                    },
                );
            }
            return;
        }
        let switch = self.one_of(&[
            TrainSwitch::EbCutOut,
            TrainSwitch::EbCutOut,
            TrainSwitch::ForcedRelease,
            TrainSwitch::TurnBack,
        ]);
        self.at(at_ms, Stimulus::Switch { switch, on: true });
    }

    /// Wheels of the train's range, that of the configuration, or what no wheel has.
    fn wheel_diameter(&mut self, at_ms: u32) {
        let tacho = &self.setup.config.content.tacho;
        let worn_mm = tacho.wheel_diameter_mm - tacho.worn_mm;
        let new_mm = tacho.wheel_diameter_mm + tacho.over_mm;
        let diameter_mm = match self.random.below(6) {
            0 => 0.0,
            1..=3 => worn_mm + (new_mm - worn_mm) * self.random.unit(),
            4 => worn_mm * (0.7 + 0.29 * self.random.unit()),
            _ => new_mm * (1.01 + 0.2 * self.random.unit()),
        };
        self.at(at_ms, Stimulus::WheelDiameter { diameter_mm });
    }

    /// A tester arms the unit and gives test signals.
    fn tests(&mut self, at_ms: u32) {
        self.at(at_ms, Stimulus::MaintenanceKey { on: true });
        self.at(at_ms + 200, Stimulus::PtuAskToArm);
        for step in 1..=3 {
            let signal = match self.random.below(4) {
                0 => Stimulus::PtuMarker {
                    psm: 1 + self.random.below(4) as u8,
                },
                1 => {
                    let to = Speed::from_kmh(40.0 * self.random.unit());
                    Stimulus::PtuSpeed {
                        channels: 3,
                        backward: false,
                        to,
                        accel_mps2: 0.0,
                    }
                }
                2 => Stimulus::PtuTwc(StationData {
                    departure: true,
                    ..self.station
                }),
                _ => match self.any_code() {
                    Stimulus::Code(signal) => Stimulus::PtuCode(signal),
                    _ => Stimulus::PtuRelease,
                },
            };
            self.at(at_ms + 400 + step * 1_200, signal);
        }
        self.back(at_ms + 5_000, Stimulus::MaintenanceKey { on: false });
    }
}
