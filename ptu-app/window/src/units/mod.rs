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
    /// Begins with one unit, which is not connected.
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

    /// Adds a unit to the window, and chooses the added unit.
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

    /// From now on the pages show the unit at this index.
    pub fn choose(&mut self, place: usize) {
        self.chosen = place.min(self.all.len() - 1);
    }

    pub fn chosen(&self) -> &Unit {
        &self.all[self.chosen]
    }

    pub fn chosen_mut(&mut self) -> &mut Unit {
        &mut self.all[self.chosen]
    }

    /// Number of stops of all units; a run ordered before a stop does not begin after it.
    pub fn stops(&self) -> u64 {
        self.stops
    }

    /// Number of runs that have ended in this window; when it changes, the database has changed.
    pub fn runs_ended(&self) -> usize {
        self.iter().map(|unit| unit.runs_ended).sum()
    }

    /// Tells the benches what the window shows: `watched` of the chosen unit, only the bar of the others.
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

    /// The unit of this number, if it has not been removed.
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

    /// While `locked`, no unit is connected or armed and no run begins; a run under way goes on.
    pub(super) fn lock(&mut self, locked: bool) {
        for unit in &mut self.all {
            if locked && !unit.locked {
                unit.disarm();
            }
            unit.locked = locked;
        }
    }

    /// Whether any unit was disconnected without its outputs being confirmed safe.
    pub(super) fn any_not_safe(&self) -> bool {
        self.iter().any(|unit| unit.not_safe)
    }

    /// Takes the events of all units' benches.
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

    /// Stops and disconnects all units; true once every bench's thread has ended.
    pub(super) fn close(&mut self) -> bool {
        let mut closed = true;
        for unit in &mut self.all {
            // Every bench is told to close, even while others have not ended.
            closed &= unit.bench.close();
        }
        closed
    }
}
