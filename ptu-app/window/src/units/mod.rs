//! The units under test in this window, side by side.

mod unit;

pub use unit::Unit;

use super::messages::Messages;
use ptu_report::words::Words;
use ptu_runs::bench_worker::{Phase, Wake, Watched};
use ptu_runs::failure::Failure;
use ptu_runs::run::BenchChoice;
use unit::UnitMessages;

/// All units of the window; there is always one.
pub struct Units {
    all: Vec<Unit>,
    /// Place of the unit that the pages show.
    chosen: usize,
    next_id: u64,
    stops: u64,
    wake: Wake,
}

impl Units {
    /// One unit that is not connected.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(choice: BenchChoice, wake: Wake) -> Result<Self, Failure> {
        Ok(Self {
            all: vec![Unit::new(0, choice, wake.clone())?],
            chosen: 0,
            next_id: 1,
            stops: 0,
            wake,
        })
    }

    /// Adds a unit beside those there are, and chooses it.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn add(&mut self, choice: BenchChoice) -> Result<(), Failure> {
        let unit = Unit::new(self.next_id, choice, self.wake.clone())?;
        self.next_id += 1;
        self.chosen = self.all.len();
        self.all.push(unit);
        Ok(())
    }

    /// Takes the chosen unit away if it is not connected, but never the last unit.
    pub fn remove_chosen(&mut self) {
        if self.count() > 1 && self.chosen().phase() == Phase::Offline {
            self.all.remove(self.chosen);
            self.choose(self.chosen);
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = &Unit> {
        self.all.iter()
    }

    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// Place of the unit that the pages show.
    pub fn chosen_place(&self) -> usize {
        self.chosen
    }

    /// The pages show the unit of this place from now on.
    pub fn choose(&mut self, place: usize) {
        self.chosen = place.min(self.all.len() - 1);
    }

    pub fn chosen(&self) -> &Unit {
        &self.all[self.chosen]
    }

    pub fn chosen_mut(&mut self) -> &mut Unit {
        &mut self.all[self.chosen]
    }

    /// Counts the times everything was stopped: what was ordered before is not begun after.
    pub fn stops(&self) -> u64 {
        self.stops
    }

    /// Runs that have ended here: what the database holds has changed when this has.
    pub fn runs_ended(&self) -> usize {
        self.iter().map(|unit| unit.runs_ended).sum()
    }

    /// Tells the benches what the window watches: pages of the chosen unit, the bar of the others.
    pub(super) fn watch(&self, watched: Watched) {
        for (place, unit) in self.iter().enumerate() {
            let watched = if place == self.chosen {
                watched
            } else {
                Watched::Bar
            };
            unit.bench.live_state().watch(watched);
        }
    }

    /// The unit of this number, if it is still there.
    pub fn of_id(&mut self, id: u64) -> Option<&mut Unit> {
        self.all.iter_mut().find(|unit| unit.id == id)
    }

    /// Stops every run, takes every stimulus away and disarms, at all units.
    pub fn stop_all(&mut self) {
        self.stops += 1;
        for unit in &mut self.all {
            unit.stop_all();
        }
    }

    /// Nothing is connected, begun or armed while `locked`; what is under way goes on.
    pub(super) fn lock(&mut self, locked: bool) {
        for unit in &mut self.all {
            if locked && !unit.locked {
                unit.disarm();
            }
            unit.locked = locked;
        }
    }

    /// A unit was let go without its outputs being confirmed safe.
    pub(super) fn any_not_safe(&self) -> bool {
        self.iter().any(|unit| unit.not_safe)
    }

    /// Takes what happened at all of them.
    pub(super) fn poll(&mut self, words: &Words, messages: &mut Messages) {
        let several = self.count() > 1;
        for (place, unit) in (1..).zip(&mut self.all) {
            let unit_said = several.then(|| format!("{place} {}", unit.name()));
            let mut said = UnitMessages {
                unit: unit_said,
                messages,
            };
            unit.poll(words, &mut said);
        }
    }

    /// Stops all and lets all go; true once every bench's thread has ended.
    pub(super) fn close(&mut self) -> bool {
        let mut closed = true;
        for unit in &mut self.all {
            // Each is told, however many are still at it.
            closed &= unit.bench.close();
        }
        closed
    }
}
