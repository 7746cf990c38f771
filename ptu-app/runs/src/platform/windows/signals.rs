//! Requests to stop, as events of the console and of the session.

use std::io::Result;

use tokio::signal::windows::{
    CtrlBreak, CtrlC, CtrlClose, CtrlLogoff, CtrlShutdown, ctrl_break, ctrl_c, ctrl_close,
    ctrl_logoff, ctrl_shutdown,
};

/// Ctrl-C, Ctrl-Break, a closed console, the end of the session and of the system. Windows ends the process some
/// seconds after each of the last three.
pub struct StopSignals {
    interrupt: CtrlC,
    terminate: CtrlBreak,
    closed: CtrlClose,
    logged_off: CtrlLogoff,
    shut_down: CtrlShutdown,
}

impl StopSignals {
    /// From now on none of these events ends the process at once.
    ///
    /// # Errors
    /// The system's.
    pub fn listen() -> Result<Self> {
        Ok(Self {
            interrupt: ctrl_c()?,
            terminate: ctrl_break()?,
            closed: ctrl_close()?,
            logged_off: ctrl_logoff()?,
            shut_down: ctrl_shutdown()?,
        })
    }

    /// Waits for the next event.
    pub async fn next(&mut self) {
        tokio::select! {
            _ = self.interrupt.recv() => {}
            _ = self.terminate.recv() => {}
            _ = self.closed.recv() => {}
            _ = self.logged_off.recv() => {}
            _ = self.shut_down.recv() => {}
        }
    }
}

/// A write that finds no room fails here anyway.
pub fn survive_file_limit() {}
