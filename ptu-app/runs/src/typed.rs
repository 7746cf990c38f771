//! Lines of standard input, read on a thread of their own, so that train and bench keep their time. Their end ends
//! nothing: a train may run under a supervisor.

use std::io::{BufRead, IsTerminal, Read, stdin};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use crate::platform::in_foreground;
use crate::stdio;

/// Lines that wait for the next scan; a writer of more waits.
const WAITING: usize = 16;
/// Longest line, bytes; what is longer is no order.
const LONGEST: u64 = 200;

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
                .spawn(move || read(stdin().lock(), &send));
        }
        Self { lines }
    }

    /// Those that have come since.
    pub fn lines(&self) -> Vec<String> {
        self.lines.try_iter().take(WAITING).collect()
    }
}

/// Somebody at a terminal can be asked: its lines come here, and what is asked is shown there.
pub fn somebody_is_there() -> bool {
    stdin().is_terminal() && in_foreground() && stdio::draws()
}

pub(crate) fn read(mut input: impl BufRead, send: &SyncSender<String>) {
    let mut bytes = Vec::new();
    loop {
        bytes.clear();
        match (&mut input).take(LONGEST).read_until(b'\n', &mut bytes) {
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
        let line = String::from_utf8_lossy(&bytes);
        let line = line.trim();
        if !line.is_empty() && send.send(line.to_owned()).is_err() {
            return;
        }
    }
}
