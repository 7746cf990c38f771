//! Maps the keys of a terminal to the actions of a driver.

use btu_rig::lever::Lever;
use btu_rig::stimulus::{Stimulus, TrainSwitch};

/// What a driver is shown before the start.
pub const HELP: &str = "up + one notch up   down - one notch down   n neutral   b full brake   \
                        e emergency   r regeneration on/off   q quit";

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    Act(Stimulus),
    Quit,
}

/// Bytes of a terminal become commands.
#[derive(Debug)]
pub struct Keys {
    lever: Lever,
    regeneration: bool,
    /// What has come of an escape sequence so far.
    escape: Vec<u8>,
}

impl Default for Keys {
    fn default() -> Self {
        Self {
            lever: Lever::Neutral,
            regeneration: true,
            escape: Vec::new(),
        }
    }
}

impl Keys {
    /// Takes a byte; a command once a key is whole and means one.
    pub fn press(&mut self, byte: u8) -> Option<Command> {
        if !self.escape.is_empty() || byte == ESC {
            return self.escaped(byte);
        }
        match byte.to_ascii_lowercase() {
            b'+' | b'=' => self.notch(1),
            b'-' | b'_' => self.notch(-1),
            b'n' => self.lever_to(Lever::Neutral),
            b'b' => self.lever_to(Lever::Brake(7)),
            b'e' => self.lever_to(Lever::Emergency),
            b'r' => {
                self.regeneration = !self.regeneration;
                Some(Command::Act(Stimulus::Switch {
                    switch: TrainSwitch::Regeneration,
                    on: self.regeneration,
                }))
            }
            b'q' => Some(Command::Quit),
            _ => None,
        }
    }

    /// Arrows: ESC, `[` or `O`, a letter. Other sequences end with their first letter, too.
    fn escaped(&mut self, byte: u8) -> Option<Command> {
        if byte == ESC {
            self.escape = vec![ESC];
            return None;
        }
        self.escape.push(byte);
        let introduced = self.escape.len() == 2 && matches!(byte, b'[' | b'O');
        let parameter = self.escape.len() > 2 && !(0x40..=0x7e).contains(&byte);
        if (introduced || parameter) && self.escape.len() < LONGEST_ESCAPE {
            return None;
        }
        let arrow = self.escape.len() == 3;
        self.escape.clear();
        match byte {
            b'A' if arrow => self.notch(1),
            b'B' if arrow => self.notch(-1),
            _ => None,
        }
    }

    /// A notch up or down. Emergency has a key of its own and is not reached by notches.
    fn notch(&mut self, by: isize) -> Option<Command> {
        let at = Lever::ALL.iter().position(|lever| *lever == self.lever)?;
        let to = Lever::ALL.get(at.checked_add_signed(by)?)?;
        let down = by < 0 && *to == Lever::Emergency;
        if down { None } else { self.lever_to(*to) }
    }

    fn lever_to(&mut self, lever: Lever) -> Option<Command> {
        if lever == self.lever {
            return None;
        }
        self.lever = lever;
        Some(Command::Act(Stimulus::Controller { lever }))
    }
}

const ESC: u8 = 0x1b;
/// Longer sequences are given up.
const LONGEST_ESCAPE: usize = 16;

#[cfg(test)]
mod tests {
    use btu_rig::drive::manual::words;

    use super::*;

    /// Actions of all keys in a text, as words.
    fn pressed(text: &str) -> Vec<String> {
        let mut keys = Keys::default();
        let commands = text.bytes().filter_map(|byte| keys.press(byte));
        let told = |command| match command {
            Command::Act(action) => words(&action),
            Command::Quit => "quit".into(),
        };
        commands.map(told).collect()
    }

    #[test]
    fn keys_move_the_lever_notch_by_notch() {
        assert_eq!(pressed("++="), ["P0.5", "P1", "P2"]);
        assert_eq!(pressed("\x1b[A\x1bOA\x1b[B"), ["P0.5", "P1", "P0.5"]);
        assert_eq!(pressed("bnE+q"), ["B7", "N", "EB", "B7", "quit"]);
        assert_eq!(
            pressed("rR"),
            ["regeneration cut-out", "regeneration again"]
        );
    }

    #[test]
    fn ends_of_the_lever_and_other_keys_do_nothing() {
        assert_eq!(pressed("++++++++").len(), 5);
        assert_eq!(pressed("b-"), ["B7"], "no notch leads to emergency");
        assert!(pressed("nxyz\r\n \u{e4}\x7f").is_empty());
        // Page up, F5, a lone escape before a key, and one that never ends.
        assert!(pressed("\x1b[5~\x1b[15~").is_empty());
        assert_eq!(pressed("\x1b\x1b[A"), ["P0.5"]);
        assert_eq!(pressed(&format!("\x1b[{}+", "1".repeat(40)))[..1], ["P0.5"]);
    }
}
