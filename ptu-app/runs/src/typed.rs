//! Lines of standard input, read on a thread of their own, so that train and bench keep their time. An end of input
//! ends nothing: a train may run under a supervisor.

use std::io::{BufRead, IsTerminal, Read, stdin};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Duration;

use crate::platform::in_foreground;
use crate::stdio;

/// Lines that wait for the next scan; a writer of more waits.
const WAITING: usize = 16;
/// Longest line, bytes; what is longer is no order, whatever it begins with.
const LONGEST: u64 = 200;
/// Stands behind the beginning of a line that is too long.
const CUT: char = '…';
/// Pause from an end of input at a terminal (Ctrl-D) until it is read again.
const AFTER_END: Duration = Duration::from_millis(100);

/// Lines as they come.
pub struct Typed {
    lines: Receiver<String>,
}

impl Typed {
    /// Listens, unless this process is in the background of its terminal, where reading would stop it.
    pub fn listen() -> Self {
        let (send, lines) = sync_channel(WAITING);
        if in_foreground() {
            // Without a thread nothing is heard, and all else goes on.
            let _ = std::thread::Builder::new()
                .name("typed".into())
                .spawn(move || read(stdin().lock(), || stdin().is_terminal(), &send));
        }
        Self { lines }
    }

    /// Lines that were typed since the last call.
    pub fn lines(&self) -> Vec<String> {
        self.lines.try_iter().take(WAITING).collect()
    }
}

/// Whether somebody at a terminal can be asked: lines come from there, and questions are shown there.
pub fn somebody_is_there() -> bool {
    stdin().is_terminal() && in_foreground() && stdio::draws()
}

/// Sends lines until nobody takes them or the input ends; after its end, input that `goes_on` (a terminal) is read
/// again.
pub(crate) fn read(mut input: impl BufRead, goes_on: impl Fn() -> bool, send: &SyncSender<String>) {
    let mut bytes = Vec::new();
    loop {
        bytes.clear();
        match (&mut input).take(LONGEST + 1).read_until(b'\n', &mut bytes) {
            Ok(0) if goes_on() => {
                std::thread::sleep(AFTER_END);
                continue;
            }
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
        let is_cut = bytes.len() as u64 > LONGEST && !bytes.ends_with(b"\n");
        let line = String::from_utf8_lossy(&bytes);
        let mut line = line.trim().to_owned();
        if is_cut {
            line.push(CUT);
            if input.skip_until(b'\n').is_err() {
                return;
            }
        }
        if !line.is_empty() && send.send(line).is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::io::BufReader;

    use super::*;

    /// Results of the reads in turn; an empty one is an end.
    struct Reads(Vec<String>);

    impl Read for Reads {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            if self.0.is_empty() {
                return Ok(0);
            }
            self.0.remove(0).as_bytes().read(into)
        }
    }

    #[test]
    fn lines_come_whole_a_long_one_is_no_answer_and_a_terminal_goes_on_after_its_end() {
        let padded = format!("{}yes and more\n", " ".repeat(198));
        let reads = [
            "key off\r\n\n  ack\n",
            "",
            &padded,
            &"y".repeat(5_000),
            "\nyes\nquit",
        ]
        .map(str::to_owned);
        let ends = Cell::new(0);
        let goes_on = || ends.replace(ends.get() + 1) < 1;
        let (send, lines) = sync_channel(WAITING);
        read(BufReader::new(Reads(reads.into())), goes_on, &send);
        let heard: Vec<_> = lines.try_iter().collect();
        let long = format!("{}{CUT}", "y".repeat(201));
        assert_eq!(heard, ["key off", "ack", "yes…", &long, "yes", "quit"]);
    }
}
