//! What people do about faults, each at its time.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use fault_db::{FaultState, RepairRecord, Store, StoreError};

use crate::bench::CHECKS;
use crate::catalogue::{KINDS, others};
use crate::chance::Chance;
use crate::fleet::Fleet;
use crate::words;

pub const HOUR_US: f64 = 3_600e6;

/// What somebody means to do.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Act {
    Acknowledge,
    Note,
    Repair,
    Verify,
    Close,
}

/// When, in what order, what, and to which fault: its unit, kind and turn.
type Plan = (i64, u64, Act, usize, usize, u32);

/// All that people mean to do.
#[derive(Default)]
pub struct People {
    plans: BinaryHeap<Reverse<Plan>>,
    planned: u64,
}

impl People {
    /// Somebody will do it so many hours later.
    fn plan(&mut self, at_us: i64, hours: f64, act: Act, unit: usize, kind: usize, turn: u32) {
        self.planned += 1;
        let at_us = at_us + (hours * HOUR_US) as i64;
        self.plans
            .push(Reverse((at_us, self.planned, act, unit, kind, turn)));
    }

    /// When the next is due.
    pub fn next_us(&self) -> Option<i64> {
        self.plans.peek().map(|Reverse(plan)| plan.0)
    }

    /// A fault was opened, or opened again after a repair.
    pub fn see(
        &mut self,
        fleet: &Fleet,
        (unit, kind): (usize, usize),
        at_us: i64,
        again: bool,
        chance: &mut Chance,
    ) {
        let slot = &fleet.units[unit].slots[kind];
        let turn = slot.turn;
        let pressing = match KINDS[kind].severity {
            "critical" => 0.3,
            "major" => 0.7,
            _ => 1.4,
        };
        let mut plan = |hours: f64, act| self.plan(at_us, hours * pressing, act, unit, kind, turn);
        if chance.happens(0.5) && !again {
            plan(chance.between(1.0, 30.0), Act::Acknowledge);
        }
        if chance.happens(0.12) {
            plan(chance.between(2.0, 60.0), Act::Note);
        }
        // Some lie about for months.
        let idle = if chance.happens(0.01) { 12.0 } else { 1.0 };
        if slot.broken.is_some() || again || chance.happens(0.08) {
            plan(chance.between(6.0, 160.0) * idle, Act::Repair);
        } else {
            plan(chance.between(3.0, 70.0), Act::Close);
        }
    }

    /// A run passed after the repair.
    pub fn pass(
        &mut self,
        fleet: &Fleet,
        unit: usize,
        kind: usize,
        at_us: i64,
        chance: &mut Chance,
    ) {
        let turn = fleet.units[unit].slots[kind].turn;
        self.plan(
            at_us,
            chance.between(0.05, 4.0),
            Act::Verify,
            unit,
            kind,
            turn,
        );
    }

    /// Does what is due next.
    pub fn act(
        &mut self,
        store: &Store,
        fleet: &mut Fleet,
        chance: &mut Chance,
    ) -> Result<(), StoreError> {
        let Some(Reverse((at_us, _, act, unit, kind, turn))) = self.plans.pop() else {
            return Ok(());
        };
        let slot = &fleet.units[unit].slots[kind];
        let Some(fault) = slot.fault.filter(|_| slot.turn == turn) else {
            return Ok(());
        };
        let (state, who) = (slot.state, words::person(chance));
        use FaultState::{Acknowledged, Closed, Open, Repaired, Verified};
        let after = match (act, state) {
            (Act::Acknowledge, Open) => {
                let note = if chance.happens(0.2) {
                    words::seen(chance)
                } else {
                    ""
                };
                store.acknowledge(fault, who, note, at_us)?
            }
            (Act::Note, _) => {
                store.add_note(fault, who, words::seen(chance), at_us)?;
                state
            }
            (Act::Repair, Open | Acknowledged) => {
                let repair = self.repair(fleet, unit, kind, at_us, chance);
                store.record_repair(fault, &repair, who, at_us)?
            }
            (Act::Verify, Repaired) => {
                self.plan(
                    at_us,
                    chance.between(1.0, 60.0),
                    Act::Close,
                    unit,
                    kind,
                    turn,
                );
                match store.set_state(fault, Verified, who, "", at_us) {
                    // A run that passed was first.
                    Err(StoreError::Transition { .. }) => Verified,
                    other => other?,
                }
            }
            (Act::Close, Verified) => store.set_state(fault, Closed, who, "", at_us)?,
            (Act::Close, Open | Acknowledged) => {
                store.set_state(fault, Closed, who, words::nothing(chance), at_us)?
            }
            // Something else came first.
            _ => state,
        };
        let slot = &mut fleet.units[unit].slots[kind];
        slot.state = after;
        if after == Closed {
            slot.fault = None;
            slot.turn += 1;
        }
        Ok(())
    }

    /// Changes a part: more often than not the right one.
    fn repair(
        &self,
        fleet: &mut Fleet,
        unit: usize,
        kind: usize,
        at_us: i64,
        chance: &mut Chance,
    ) -> RepairRecord {
        let lru = KINDS[kind].lru;
        let unit = &mut fleet.units[unit];
        let slot = &mut unit.slots[kind];
        let guess = if lru == "unknown" {
            chance.one_of(others(lru))
        } else {
            lru
        };
        let part = match slot.broken {
            Some(part) if chance.happens(0.8) => part,
            _ => guess,
        };
        if slot.broken == Some(part) {
            slot.broken = None;
        }
        // A new part is new for all that it does.
        for (slot, kind) in unit.slots.iter_mut().zip(KINDS) {
            if kind.lru == part {
                slot.new_since_us = at_us;
            }
        }
        for (wear, check) in unit.wear.iter_mut().zip(CHECKS) {
            if check.lru == part {
                wear.renew();
            }
        }
        let has_serials = chance.happens(0.7);
        RepairRecord {
            part: part.to_owned(),
            serial_old: has_serials.then(|| words::part_serial(part, chance)),
            serial_new: has_serials.then(|| words::part_serial(part, chance)),
            note: words::repaired(chance).to_owned(),
        }
    }
}
