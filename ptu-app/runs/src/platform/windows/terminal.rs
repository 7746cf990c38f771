//! Keys of the console as they are typed, and what the console is like.

use std::io::Result;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use console::{Key, Term};

/// Keys that wait for the next scan; more are waited with.
const WAITING: usize = 64;

/// The console's keys, taken by a thread that ends with the next key once this is dropped.
pub struct KeyTerminal {
    keys: Receiver<Vec<u8>>,
}

impl KeyTerminal {
    /// Takes keys as they are typed, without waiting for a line or showing them. Ctrl-C still interrupts.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn open() -> Result<Self> {
        let (send, keys) = sync_channel(WAITING);
        std::thread::Builder::new()
            .name("keys".into())
            .spawn(move || take(&send))?;
        Ok(Self { keys })
    }

    /// What was typed since it was last asked, as a terminal of Unix sends it.
    pub fn typed(&self) -> Vec<u8> {
        self.keys.try_iter().flatten().collect()
    }
}

fn take(keys: &SyncSender<Vec<u8>>) {
    let console = Term::stderr();
    while let Ok(key) = console.read_key() {
        if keys.send(bytes(&key)).is_err() {
            return;
        }
    }
}

fn bytes(key: &Key) -> Vec<u8> {
    match key {
        Key::Char(letter) => letter.to_string().into_bytes(),
        Key::ArrowUp => b"\x1b[A".to_vec(),
        Key::ArrowDown => b"\x1b[B".to_vec(),
        _ => Vec::new(),
    }
}

/// Width of the console behind standard error, if it says.
pub fn columns() -> Option<usize> {
    let (_, columns) = Term::stderr().size_checked()?;
    Some(usize::from(columns)).filter(|columns| *columns > 0)
}

/// Reading a console stops no process.
pub fn in_foreground() -> bool {
    true
}
