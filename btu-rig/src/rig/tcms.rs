//! As much TCMS as the unit needs: an alive counter, ATO enable and load, and the commands it
//! hands on to the train.

use protocol::message::{AtcToTcms, AtcToTcmsBits, Mode, Outputs, TcmsToAtc, TcmsToAtcBits};
use protocol::{CYCLE, Duration, Instant};

use crate::stimulus::TcmsCondition;
use crate::train::TrainInputs;

use super::desk::Desk;

/// Age at which ATO's commands no longer count [default].
const COMMAND_TIMEOUT: Duration = Duration::from_ms(300);
/// Powering by notch P1..P4, share of full effort (S3).
const POWER_SHARES: [f64; 4] = [0.30, 0.50, 0.75, 1.00];
/// Braking by notch B1..B7, share of full service (S3).
const BRAKE_SHARES: [f64; 7] = [0.135, 0.275, 0.42, 0.565, 0.71, 0.855, 1.00];

/// The train control and monitoring system.
#[derive(Debug)]
pub struct Tcms {
    /// Condition of the link to the unit.
    pub condition: TcmsCondition,
    /// ATO is permitted.
    pub ato_enable: bool,
    /// Passengers, kg.
    pub load_kg: f64,
    alive: u8,
    next_due: Instant,
    command: Option<(Instant, AtcToTcms)>,
}

impl Default for Tcms {
    /// In order, ATO permitted, nobody aboard.
    fn default() -> Self {
        Self {
            condition: TcmsCondition::Good,
            ato_enable: true,
            load_kg: 0.0,
            alive: 0,
            next_due: Instant::ZERO,
            command: None,
        }
    }
}

impl Tcms {
    /// Good, ATO permitted, empty; the alive counter goes on.
    pub fn reset(&mut self) {
        self.condition = TcmsCondition::Good;
        self.ato_enable = true;
        self.load_kg = 0.0;
    }

    /// The message that is due this scan, if any.
    pub fn step(&mut self, now: Instant, braking: bool) -> Option<TcmsToAtc> {
        if now < self.next_due {
            return None;
        }
        self.next_due = now + CYCLE;
        if self.condition == TcmsCondition::Silent {
            return None;
        }
        if self.condition == TcmsCondition::Good {
            self.alive = self.alive.wrapping_add(1);
        }
        let mut bits = TcmsToAtcBits::empty();
        bits.set(TcmsToAtcBits::ATO_ENABLE, self.ato_enable);
        bits.set(TcmsToAtcBits::SERVICE_BRAKE_APPLIED, braking);
        let load_100kg = (self.load_kg / 100.0).round() as u16;
        Some(TcmsToAtc {
            bits,
            load_100kg,
            alive: self.alive,
        })
    }

    /// Takes the unit's commands. A silent link is one nothing comes through, either way.
    pub fn hear(&mut self, now: Instant, command: &AtcToTcms) {
        if self.condition != TcmsCondition::Silent {
            self.command = Some((now, *command));
        }
    }

    /// What the train is told: ATO's effort in automatic run, the master controller otherwise,
    /// power only with doors closed, cab active and nothing that cuts it (S4).
    pub fn train_inputs(&self, now: Instant, desk: &Desk, outputs: Option<Outputs>) -> TrainInputs {
        let contacts = outputs.unwrap_or(Outputs::empty());
        let command = self
            .command
            .filter(|(heard, _)| now.since(*heard) <= COMMAND_TIMEOUT)
            .map(|(_, command)| command);
        let ato = command.filter(|c| c.mode == Mode::AutomaticRun);
        let holds = ato.is_some_and(|c| c.bits.contains(AtcToTcmsBits::HOLDING_BRAKE));
        let holding = contacts.contains(Outputs::HOLDING_BRAKE) || holds;
        let may_power = desk.doors_closed
            && desk.hcr
            && desk.reverser != 0
            && outputs.is_some()
            && !contacts.contains(Outputs::POWER_CUT)
            && !holding;
        TrainInputs {
            demand: ato.map_or_else(|| notch_share(desk.controller), |c| ato_share(&c)),
            full_service: contacts.contains(Outputs::FSB),
            emergency: !desk.eb_loop(),
            holding,
            power_cut: !may_power,
            backward: desk.reverser < 0,
            load_kg: self.load_kg,
            ..TrainInputs::default()
        }
    }
}

/// Share of full effort of ATO's command; P and B both on: B wins and the value is B's (S4).
fn ato_share(command: &AtcToTcms) -> f64 {
    let effort = f64::from(command.effort);
    if command.bits.contains(AtcToTcmsBits::BRAKE) {
        -effort.abs() / 1024.0
    } else if command.bits.contains(AtcToTcmsBits::POWER) {
        effort.max(0.0) / 1023.0
    } else {
        0.0
    }
}

/// Share of full effort of a master controller notch.
fn notch_share(notch: i8) -> f64 {
    let place = usize::from(notch.unsigned_abs()).min(7);
    match notch {
        0 => 0.0,
        1.. => POWER_SHARES[place.min(4) - 1],
        _ => -BRAKE_SHARES[place - 1],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alive_counts_stands_or_is_not_sent() {
        let mut tcms = Tcms::default();
        let sent = |tcms: &mut Tcms, from_ms: u64| -> Vec<u8> {
            (0..10)
                .filter_map(|i| tcms.step(Instant::from_ms(from_ms + 10 * i), false))
                .map(|m| m.alive)
                .collect()
        };
        assert_eq!(sent(&mut tcms, 0), [1, 2]);
        tcms.condition = TcmsCondition::Stale;
        assert_eq!(sent(&mut tcms, 100), [2, 2]);
        tcms.condition = TcmsCondition::Silent;
        assert!(sent(&mut tcms, 200).is_empty());
    }

    #[test]
    fn commands_reach_the_train_as_the_tables_say() {
        let (power, brake) = (AtcToTcmsBits::POWER, AtcToTcmsBits::BRAKE);
        for (bits, effort, share) in [
            (power, 1023, 1.0),
            (power, -500, 0.0),
            (brake, -512, -0.5),
            (power | brake, 512, -0.5),
            (AtcToTcmsBits::empty(), 1023, 0.0),
        ] {
            let command = AtcToTcms {
                bits,
                effort,
                ..AtcToTcms::default()
            };
            assert_eq!(ato_share(&command), share, "{bits:?} {effort}");
        }
        assert_eq!(
            [-8, -7, -1, 0, 1, 4].map(notch_share),
            [-1.0, -1.0, -0.135, 0.0, 0.3, 1.0]
        );
    }

    #[test]
    fn power_needs_every_permission() {
        let now = Instant::ZERO;
        let (tcms, released) = (Tcms::default(), Some(Outputs::EB_RELAY));
        let desk = |change: fn(&mut Desk)| {
            let mut desk = Desk::default();
            desk.controller = 4;
            change(&mut desk);
            desk.step(Some(Outputs::EB_RELAY));
            desk
        };
        let cut = |desk: &Desk, outputs| tcms.train_inputs(now, desk, outputs).power_cut;
        assert!(!cut(&desk(|_| ()), released));
        assert!(cut(&desk(|d| d.doors_closed = false), released));
        assert!(cut(&desk(|d| d.hcr = false), released));
        assert!(cut(&desk(|d| d.reverser = 0), released));
        assert!(cut(
            &desk(|_| ()),
            Some(Outputs::EB_RELAY | Outputs::POWER_CUT)
        ));
        assert!(cut(&desk(|_| ()), None));
    }
}
