//! Watches the EB relay through the EB train line, which the relay opens.

use protocol::event::Event;
use protocol::message::TrainLines;
use protocol::{Duration, Instant};

use crate::kernel::EventLog;
use crate::timer::OnDelay;

/// Time for which the line is dead before others count as having opened it: a contact bounces for less [default].
const FALLS: Duration = Duration::from_ms(50);

/// The line must die with the relay, and live with it as long as it is fed: a button, the master controller,
/// low air or an empty cab opens it before the relay.
#[derive(Debug, Default)]
pub struct RelayWatch {
    welded: OnDelay,
    open: OnDelay,
    due: OnDelay,
    /// The line must be energised by now: for as long as it may take to follow, the relay is, and the line is fed.
    pub line_due: bool,
    /// Since the relay was energised, the line has been energised when it was due.
    followed: bool,
    fell: OnDelay,
    /// The line has followed the relay, which is energised still, and is dead now.
    pub line_fell: bool,
    failed: bool,
    feedback: Duration,
}

impl RelayWatch {
    /// The relay has followed ever since power-up; one failure is not forgotten before the next.
    pub fn sound(&self) -> bool {
        !self.failed
    }

    /// The brake line must follow the relay within `feedback`.
    pub fn new(feedback: Duration) -> Self {
        Self {
            feedback,
            ..Self::default()
        }
    }

    /// One scan: what is asked of the relay, and the lines, if they are read.
    pub fn step(
        &mut self,
        now: Instant,
        energised: bool,
        lines: Option<TrainLines>,
        log: &mut EventLog,
    ) {
        let line = |line| lines.is_some_and(|lines| lines.contains(line));
        let alive = line(TrainLines::EB_LOOP);
        let welded = !energised && alive;
        let open = energised && line(TrainLines::EB_LOOP_FED) && !alive;
        let due = energised && line(TrainLines::EB_LOOP_FED);
        self.line_due = self.due.update(now, due, self.feedback);
        self.followed = energised && (self.followed || self.line_due && alive);
        let fell = self.followed && lines.is_some() && !alive;
        self.line_fell = self.fell.update(now, fell, FALLS);
        let welded = self.welded.update(now, welded, self.feedback);
        let open = self.open.update(now, open, self.feedback);
        if (welded || open) && !self.failed {
            self.failed = true;
            let event = if welded {
                Event::EbRelayWelded
            } else {
                Event::EbRelayOpen
            };
            log.push(now, event, 0);
        }
    }
}
