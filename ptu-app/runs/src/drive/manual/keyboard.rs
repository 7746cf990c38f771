//! Manual driving by keys in real time.

use btu_rig::drive::Row;
use btu_rig::drive::manual::{Ending, Outcome, Player};
use protocol::signal::Signal;

use super::ManualCase;
use super::keys::{Command, HELP, Keys};
use super::terminal::Terminal;
use crate::failure::Failure;
use crate::link::Pace;
use crate::stdio;
use crate::stop::Stop;

/// The status line changes every so many scans: 100 ms.
const SHOWN_EVERY: u64 = 10;

/// Drives by keys until the user quits or `stop` is pressed.
///
/// # Errors
/// There is no terminal.
pub fn drive_by_hand(case: &ManualCase, stop: &Stop) -> Result<Outcome, Failure> {
    let terminal = Terminal::open()?;
    stdio::note(HELP);
    terminal.show("the unit starts …");
    let mut bench = case.bench.fresh(case.seed);
    let mut player = Player::new(case.plan.clone());
    let mut keys = Keys::default();
    let mut pace = Pace::real();
    for scan in 0u64.. {
        pace.wait();
        let ticked = bench.tick();
        let now = bench.now();
        if let Err(failure) = ticked {
            return Ok(player.end(Ending::LinkLost(failure.to_string())));
        }
        if let Some(outcome) = player.step(now, bench.rig_mut()) {
            return Ok(outcome);
        }
        if stop.presses() > 0 {
            break;
        }
        // Keys that are pressed before the train may be driven are not kept.
        let driving = player.newest().is_some();
        for byte in terminal.typed() {
            match keys.press(byte) {
                Some(Command::Quit) => return Ok(player.end(Ending::ByHand)),
                Some(Command::Act(action)) if driving => {
                    if let Err(refusal) = player.act(now, bench.rig_mut(), action) {
                        return Ok(player.end(Ending::Refused(refusal.0)));
                    }
                }
                Some(Command::Act(_)) => keys = Keys::default(),
                None => {}
            }
        }
        if scan.is_multiple_of(SHOWN_EVERY)
            && let Some(row) = player.newest()
        {
            let mut line = status(row);
            if let Some(brake) = player.atp_brake() {
                line = format!("{line}   {brake}");
            }
            terminal.show(&line);
        }
    }
    Ok(player.end(Ending::ByHand))
}

/// Speed, limit, lever and efforts of the whole train.
fn status(row: &Row) -> String {
    // A size that is nothing has no sign.
    let kn = |signal| row.value(signal).max(0.0) / 1000.0 + 0.0;
    format!(
        "{:5.1} km/h (limit {:.0})   {:<4}  TE {:4.0} kN   electric {:4.0} kN   air {:4.0} kN",
        row.speed_kmh.abs(),
        row.value(Signal::Limit),
        row.lever.to_string(),
        kn(Signal::Traction),
        kn(Signal::ElectricBrake),
        kn(Signal::AirBrake),
    )
}
