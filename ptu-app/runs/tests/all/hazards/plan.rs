//! A plan of a scene: its beginning, its acts with their times, the parts that have failed. A plan follows from its
//! number alone, so that a part of it can be left out and the rest played again.

use std::fmt;

use btu_rig::lever::Lever;
use btu_rig::stimulus::{StationData, Stimulus};
use protocol::injection::FaultMode;
use protocol::message::ModeSwitch;
use protocol::{Duration, Random};

use super::acts::{KINDS, Kind};
use ptu_runs::run::BenchSetup;

/// One thing that is done.
#[derive(Clone, Copy, Debug)]
pub enum Act {
    Do(Stimulus),
    /// The unit's supply.
    Supply(bool),
    /// Two codes, or two positions of the mode switch or the reverser, by turns, each for its time, until another is put in.
    Alternate([(Stimulus, Duration); 2]),
}

impl fmt::Display for Act {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Do(stimulus) => write!(f, "{stimulus}"),
            Self::Supply(on) => write!(f, "supply {on}"),
            Self::Alternate([(first, one), (second, other)]) => {
                let (one, other) = (one.as_ms(), other.as_ms());
                write!(
                    f,
                    "{first} for {one} ms and {second} for {other} ms by turns"
                )
            }
        }
    }
}

/// Beginning of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scene {
    /// A driver in the cab, the train at a platform.
    Standing,
    /// A driver in the cab, the train under way by a notch of the controller.
    ByHand,
    /// Driven by hand at yard or emergency.
    Slowly(ModeSwitch),
    /// The bench turns the wheels.
    OnBench,
    /// From platform to platform by ATO: the wayside gives station data and departure as it should.
    Ride(ModeSwitch),
}

/// Step from a pair of kinds to the next; it has no divisor in common with their number.
const STRIDE: usize = 100;

const SCENES: [Scene; 10] = [
    Scene::Standing,
    Scene::ByHand,
    Scene::ByHand,
    Scene::Slowly(ModeSwitch::Yard),
    Scene::Slowly(ModeSwitch::Emergency),
    Scene::OnBench,
    Scene::Ride(ModeSwitch::Automatic),
    Scene::Ride(ModeSwitch::Automatic),
    Scene::Ride(ModeSwitch::Driverless),
    Scene::Ride(ModeSwitch::Driverless),
];

/// A scene and what is done in it.
#[derive(Clone, Debug)]
pub struct Plan {
    pub number: u64,
    pub scene: Scene,
    /// Place in the line of the section that the train is on.
    pub section: usize,
    pub faults: Vec<FaultMode>,
    /// Distance of each section's markers beyond their places, m.
    pub displaced_m: [f64; 4],
    /// Place in the line of the section whose data the wayside gives after the first arrival, instead of the next.
    pub data_of: Option<usize>,
    pub adhesion: Option<f64>,
    pub length_ms: u32,
    /// Acts, with their times in ms after the begin.
    pub acts: Vec<(u32, Act)>,
}

/// Choices from which a plan is drawn.
pub struct Draw<'a> {
    pub setup: &'a BenchSetup,
    pub random: Random,
    pub section: usize,
    pub station: StationData,
    pub drawn: Vec<(u32, Act)>,
}

impl Plan {
    /// The plan of a number. Scenes and pairs of kinds come by turns, so that each meets each; or `first` meets each, and
    /// then one fault alone is in each plan.
    pub fn draw(
        setup: &BenchSetup,
        catalogue: &[FaultMode],
        first: Option<Kind>,
        number: u64,
    ) -> Self {
        let turn = number as usize;
        let scene = SCENES[turn % SCENES.len()];
        let mut random = Random::new(number);
        let sections = &setup.line.content.sections;
        let section = match scene {
            // A ride ends within the time of a plan.
            Scene::Ride(_) => {
                let short = |at: &usize| sections[*at].length_m < 1_000.0;
                let short: Vec<_> = (0..sections.len()).filter(short).collect();
                short[random.below(short.len())]
            }
            _ => random.below(sections.len()),
        };
        let ride = matches!(scene, Scene::Ride(_));
        let length_ms = match ride {
            true => [70_000, 130_000, 260_000][random.below(3)],
            false => 60_000,
        };
        let always = first.is_some() && catalogue.len() == 1;
        let faults = faults(catalogue, always, &mut random);
        let displaced_m = displaced(&mut random, ride);
        let data_of = (ride && random.chance(0.2)).then(|| random.below(sections.len()));
        let adhesion = random
            .chance(0.15)
            .then(|| [0.08, 0.12, 0.18][random.below(3)]);
        let mut draw = Draw {
            setup,
            random,
            section,
            station: StationData::at_departure(&sections[section]),
            drawn: Vec::new(),
        };
        // In steps that meet all kinds soon, and each pair once in a turn.
        let pair = turn / SCENES.len() * STRIDE;
        let mut kinds: Vec<Kind> = Vec::new();
        let quiet = ride && displaced_m != [0.0; 4] && draw.random.chance(0.6);
        if !quiet {
            kinds.extend([
                first.unwrap_or(KINDS[pair % KINDS.len()]),
                KINDS[pair / KINDS.len() % KINDS.len()],
            ]);
            let more = [0, 0, 2, 5, 12][draw.random.below(5)];
            kinds.extend((0..more).map(|_| draw.one_of(&KINDS)));
        }
        let first_ms = draw.random.below(length_ms as usize * 3 / 4) as u32;
        for (place, kind) in kinds.into_iter().enumerate() {
            let at_ms = match place {
                0 => first_ms,
                1 => first_ms + [0, 300, 2_000, 6_000][draw.random.below(4)],
                _ => draw.random.below(length_ms as usize) as u32,
            };
            draw.act(kind, at_ms);
        }
        // Somebody acknowledges, and tries to go on.
        for _ in 0..draw.random.below(5) {
            let at_ms = draw.random.below(length_ms as usize) as u32;
            draw.at(at_ms, Stimulus::Acknowledge);
            if !ride && draw.random.chance(0.5) {
                draw.act(Kind::Lever, at_ms + 1_500);
            }
        }
        let mut acts = draw.drawn;
        acts.sort_by_key(|(at_ms, _)| *at_ms);
        Self {
            number,
            scene,
            section,
            faults,
            displaced_m,
            data_of,
            adhesion,
            length_ms,
            acts,
        }
    }

    /// Each plan with one thing less.
    pub fn shorter(&self) -> impl Iterator<Item = Self> + '_ {
        let acts = (0..self.acts.len()).rev().map(|at| {
            let mut less = self.clone();
            less.acts.remove(at);
            less
        });
        let faults = (0..self.faults.len()).map(|at| {
            let mut less = self.clone();
            less.faults.remove(at);
            less
        });
        let without = [
            Self {
                displaced_m: [0.0; 4],
                ..self.clone()
            },
            Self {
                data_of: None,
                ..self.clone()
            },
            Self {
                adhesion: None,
                ..self.clone()
            },
        ];
        let size = self.size();
        acts.chain(faults)
            .chain(without)
            .filter(move |less| less.size() < size)
    }

    fn size(&self) -> usize {
        let displaced = self.displaced_m.iter().filter(|by_m| **by_m != 0.0).count();
        let others = [
            displaced > 0,
            self.data_of.is_some(),
            self.adhesion.is_some(),
        ];
        self.acts.len() + self.faults.len() + others.iter().filter(|there| **there).count()
    }
}

/// Draws none, one or two parts that have failed. A time base may be off by any factor.
fn faults(catalogue: &[FaultMode], always: bool, random: &mut Random) -> Vec<FaultMode> {
    use protocol::injection::{Effect, Place};
    let count = match [0, 0, 0, 1, 1, 2][random.below(6)] {
        _ if always => 1,
        count => count,
    };
    let mut draw = || {
        let mut mode = catalogue[random.below(catalogue.len())].clone();
        if let (Place::Clock, Effect::Gain { factor }) = (mode.place, &mut mode.effect) {
            *factor = 0.5 + random.unit();
        }
        mode
    };
    (0..count).map(|_| draw()).collect()
}

/// Markers alike, or one or two of them.
fn displaced(random: &mut Random, ride: bool) -> [f64; 4] {
    let mut displaced_m = [0.0; 4];
    if ride && random.chance(0.35) {
        let most_m = [1.5, 6.0, 20.0, 50.0][random.below(4)];
        let by_m = most_m * (2.0 * random.unit() - 1.0);
        for place in [0..4, 1..4, 2..4, 3..4, 1..2, 2..3][random.below(6)].clone() {
            displaced_m[place] = by_m;
        }
    }
    displaced_m
}

impl Draw<'_> {
    pub fn at(&mut self, at_ms: u32, stimulus: Stimulus) {
        self.drawn.push((at_ms, Act::Do(stimulus)));
    }

    pub fn one_of<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.random.below(of.len())]
    }

    pub fn chance(&mut self, p: f64) -> bool {
        self.random.chance(p)
    }

    /// Takes something back a while later, mostly.
    pub fn back(&mut self, at_ms: u32, stimulus: Stimulus) {
        if self.chance(0.7) {
            let wait_ms = self.one_of(&[300, 1_500, 5_000, 12_000]);
            self.at(at_ms + wait_ms, stimulus);
        }
    }
}

impl Scene {
    /// Position of the mode switch with which it begins.
    pub fn switch(self) -> ModeSwitch {
        match self {
            Self::Slowly(switch) | Self::Ride(switch) => switch,
            Self::Standing | Self::ByHand | Self::OnBench => ModeSwitch::Manual,
        }
    }

    /// Stimulus by which the train of the scene begins to move.
    pub fn begins(self) -> Option<Stimulus> {
        let lever = |notch| Stimulus::Controller {
            lever: Lever::Power(notch),
        };
        match self {
            Self::ByHand => Some(lever(4)),
            Self::Slowly(_) => Some(lever(1)),
            _ => None,
        }
    }
}
