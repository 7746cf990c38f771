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
    first: Unit,
    more: Vec<Unit>,
    chosen: usize,
    next_id: u64,
    stops: u64,
    wake: Wake,
}

impl Units {
    /// Counts the times everything was stopped: what was ordered before is not begun after.
    pub fn stops(&self) -> u64 {
        self.stops
    }

    /// One unit that is not connected.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(choice: BenchChoice, wake: Wake) -> Result<Self, Failure> {
        Ok(Self {
            first: Unit::new(0, choice, wake.clone())?,
            more: Vec::new(),
            chosen: 0,
            next_id: 1,
            stops: 0,
            wake,
        })
    }

    /// One more beside those there are, and chooses it.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn add(&mut self, choice: BenchChoice) -> Result<(), Failure> {
        let unit = Unit::new(self.next_id, choice, self.wake.clone())?;
        self.next_id += 1;
        self.more.push(unit);
        self.chosen = self.more.len();
        Ok(())
    }

    /// Takes away one that is not connected, but never the last.
    pub fn remove(&mut self, place: usize) {
        let offline = |unit: &Unit| unit.phase() == Phase::Offline;
        if self.more.is_empty() || !self.iter().nth(place).is_some_and(offline) {
            return;
        }
        if place == 0 {
            std::mem::swap(&mut self.first, &mut self.more[0]);
            self.more.remove(0);
        } else if place <= self.more.len() {
            self.more.remove(place - 1);
        }
        self.chosen = self.chosen.min(self.more.len());
    }

    pub fn iter(&self) -> impl Iterator<Item = &Unit> {
        std::iter::once(&self.first).chain(&self.more)
    }

    /// All of them, to be changed.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Unit> {
        std::iter::once(&mut self.first).chain(&mut self.more)
    }

    pub fn count(&self) -> usize {
        1 + self.more.len()
    }

    /// The place of the one the pages show.
    pub fn chosen_place(&self) -> usize {
        self.chosen
    }

    /// The pages show this one from now on.
    pub fn choose(&mut self, place: usize) {
        self.chosen = place.min(self.more.len());
    }

    pub fn chosen(&self) -> &Unit {
        match self.chosen {
            0 => &self.first,
            more => self.more.get(more - 1).unwrap_or(&self.first),
        }
    }

    /// The one the pages show, to be changed.
    pub fn chosen_mut(&mut self) -> &mut Unit {
        match self.chosen {
            0 => &mut self.first,
            more => self.more.get_mut(more - 1).unwrap_or(&mut self.first),
        }
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

    /// The one of this number, if it is still there.
    pub fn of_id(&mut self, id: u64) -> Option<&mut Unit> {
        self.iter_mut().find(|unit| unit.id == id)
    }

    /// Stops every run, takes every stimulus away and disarms, at all units.
    pub fn stop_all(&mut self) {
        self.stops += 1;
        for unit in self.iter_mut() {
            unit.stop_all();
        }
    }

    /// Nothing is connected, begun or armed while `locked`; what is under way goes on.
    pub(super) fn lock(&mut self, locked: bool) {
        for unit in self.iter_mut() {
            if locked && !unit.locked {
                unit.disarm();
            }
            unit.locked = locked;
        }
    }

    /// One of them was let go without its outputs being confirmed safe.
    pub(super) fn any_not_safe(&self) -> bool {
        self.iter().any(|unit| unit.not_safe)
    }

    /// Takes what happened at all of them.
    pub(super) fn poll(&mut self, words: &Words, messages: &mut Messages) {
        let several = !self.more.is_empty();
        for (place, unit) in (1..).zip(self.iter_mut()) {
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
        for unit in self.iter_mut() {
            // Each is told, however many are still at it.
            closed &= unit.bench.close();
        }
        closed
    }
}
