//! One way through the structure: from a sensor over a part to what a step judges.

use std::collections::{BTreeMap, VecDeque};

use btu_rig::procedure::Procedure;
use btu_rig::procedure::plan::{Connection, Expectation, Step};
use protocol::LruId;

use super::Structure;
use super::link::{Chain, Link, LinkOutput};

impl Structure {
    /// The shortest way by which a part fails what a step judges, with a way on to a sensor; none if the part is on no way
    /// of the step.
    pub fn chain(&self, procedure: &Procedure, step: &Step, part: &LruId) -> Option<Chain> {
        let judged = self.judged(step);
        let ways = judged.iter().filter_map(|made| self.down_from(*made, part));
        let way = ways.min_by_key(Vec::len);
        let needed = self.everywhere.contains(part)
            || procedure.needs == Connection::Ptu && self.on_the_train.contains(part);
        let (mut way, before) = match way {
            Some(way) => (way, None),
            None if needed => (vec![*judged.first()?], Some(part.clone())),
            None => return None,
        };
        let failing = way.len();
        self.on_to_a_sensor(&mut way, &judged);
        let failing = match before {
            Some(_) => 0,
            None => way.len() - failing,
        };
        way.reverse();
        let links = way.into_iter().filter_map(|made| {
            let parts = self.steps.get(&made)?.parts.clone();
            Some(Link { made, parts })
        });
        Some(Chain {
            before,
            links: links.collect(),
            failing,
        })
    }

    /// Signals that a step judges and that have a way: first those measured and expected, then those
    /// it only waits for.
    fn judged(&self, step: &Step) -> Vec<LinkOutput> {
        let mut judged = Vec::new();
        let mut add = |made: LinkOutput| {
            if self.steps.contains_key(&made) && !judged.contains(&made) {
                judged.push(made);
            }
        };
        for expectation in &step.expectations {
            if let Expectation::Logs { event, .. } = expectation {
                add(LinkOutput::Event(*event));
            }
        }
        let mut signals = Vec::new();
        step.for_each_signal(&mut |signal| signals.push(signal));
        signals
            .into_iter()
            .rev()
            .map(LinkOutput::Signal)
            .for_each(add);
        judged
    }

    /// From what is judged to the nearest link that the part makes, both included.
    fn down_from(&self, judged: LinkOutput, part: &LruId) -> Option<Vec<LinkOutput>> {
        let mut came_from = BTreeMap::new();
        let mut ahead = VecDeque::from([judged]);
        while let Some(made) = ahead.pop_front() {
            let step = self.steps.get(&made)?;
            if step.parts.contains(part) {
                let before = |made: &LinkOutput| came_from.get(made).copied();
                let mut way: Vec<_> = std::iter::successors(Some(made), before).collect();
                way.reverse();
                return Some(way);
            }
            for from in &step.from {
                let is_new = *from != judged && !came_from.contains_key(from);
                if is_new && self.steps.contains_key(from) {
                    came_from.insert(*from, made);
                    ahead.push_back(*from);
                }
            }
        }
        None
    }

    /// Goes on from the last link of a way to a sensor, a link that is made of no other: over signals that the step
    /// looks at where there are any, and otherwise over those that the file names first.
    fn on_to_a_sensor(&self, way: &mut Vec<LinkOutput>, looked_at: &[LinkOutput]) {
        while let Some(step) = way.last().and_then(|made| self.steps.get(made)) {
            let is_new = |from: &&LinkOutput| self.steps.contains_key(from) && !way.contains(from);
            let mut from = step.from.iter().filter(is_new);
            let first = from.clone().next();
            let Some(next) = from.find(|from| looked_at.contains(from)).or(first) else {
                return;
            };
            way.push(*next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{procedures, scripts, setup};

    fn chain(of: &str, part: &str) -> Option<String> {
        let structure = Structure::load(&scripts(), &scripts().faults().unwrap()).unwrap();
        let procedures = procedures(&setup(&[]));
        let (id, step) = of.split_once(": ").unwrap();
        let procedure = procedures.iter().find(|all| all.id == id).unwrap();
        let step = procedure.steps.iter().find(|all| all.name == step).unwrap();
        let part: LruId = part.parse().unwrap();
        let chain = structure.chain(procedure, step, &part)?;
        let links = chain.links.iter().enumerate().map(|(place, link)| {
            let made = match link.made {
                LinkOutput::Signal(signal) => signal.name(),
                LinkOutput::Event(event) => event.definition().name,
            };
            let mark = if place < chain.failing { "" } else { "!" };
            format!("{mark}{made}")
        });
        let links = links.collect::<Vec<_>>().join(" ");
        let before = chain.before.map(|part| format!("{part}: "));
        Some(before.unwrap_or_default() + &links)
    }

    /// Goal: the way that is drawn is that by which the part fails the check. Method: parts at the end and at the
    /// beginning of it, below all of it and beside it.
    #[test]
    fn a_chain_leads_from_a_sensor_over_the_part_to_what_is_judged() {
        let overspeed = "atp/overspeed: code 55: alarm, FSB, EB";
        for (part, expected) in [
            ("eb_relay", Some("speed1 speed eb_cause !eb")),
            ("speed_sensor_2", Some("!speed2 !speed !alarm")),
            (
                "power_supply",
                Some("power_supply: !speed1 !speed !eb_cause !eb"),
            ),
        ] {
            assert_eq!(chain(overspeed, part).as_deref(), expected, "{part}");
        }
        assert_eq!(
            chain("ptu/at_rest: nothing is heard where no loop is", "eb_relay"),
            None
        );
    }
}
