//! Data from the unit, and the evidence by which they can be trusted.

use protocol::Instant;
use protocol::link::Counters;
use protocol::message::{Identity, SelfTest, SelfTestItem};
use protocol::signal::{Sample, Signal};

use super::{LinkTrouble, Rig};
use crate::procedure::{Evidence, UnitEvent};

impl Rig {
    /// The present value of every signal; unknown where the unit has been silent for 500 ms.
    pub fn sample(&self) -> &Sample {
        &self.latest.sample
    }

    /// New entries of the unit's log in the order of their indices, each once, then new events of TCMS. The indices
    /// begin from the start when the unit is started again.
    pub fn take_events(&mut self) -> Vec<UnitEvent> {
        let mut events = self.tester.log.take();
        events.append(&mut self.tcms_events);
        events
    }

    /// Entries the log had when the unit was first heard: those with a lower index are older than
    /// this bench's work. 0 after a restart of the unit, `None` before it is heard.
    pub fn events_at_contact(&self) -> Option<u32> {
        self.tester.events_at_contact
    }

    /// Every event the unit says it has logged has been read.
    pub fn log_up_to_date(&self) -> bool {
        self.tester.log.up_to_date()
    }

    /// Number of log entries that were overwritten or cleared in the unit before they could be read, and of events of
    /// TCMS that were not taken in time.
    pub fn events_overwritten(&self) -> u64 {
        self.tester.log.overwritten + self.tcms_dropped + u64::from(self.tcms.events_lost())
    }

    /// Identity of the unit, once the unit has told it.
    pub fn identity(&self) -> Option<&Identity> {
        self.tester.identity.as_ref()
    }

    /// Time at which the last frame of the unit came, and the unit's clock when the frame was made,
    /// ms.
    pub fn unit_stamp_ms(&self) -> Option<(Instant, u32)> {
        self.unit_stamp
    }

    /// Times the unit was started again since it was first heard.
    pub fn unit_restarts(&self) -> u32 {
        self.tester.restarts
    }

    /// Trouble because of which nothing can be judged, after a time allowed for first contact: of the
    /// connection, of the unit that answers, or of reading the unit's log.
    pub fn link_error(&self) -> Option<LinkTrouble> {
        let line = self.line_watch.error(self.now);
        let silence = || {
            let asks_since = self.tester.speaks_since();
            let harness = self.harness.is_there();
            self.watch.error(self.now, &self.link, asks_since, harness)
        };
        line.or_else(silence)
            .or_else(|| self.tester.error(self.now))
            .or_else(|| self.tester.missed())
    }

    /// Evidence by which data from the unit can be trusted.
    pub fn evidence(&self) -> Evidence {
        Evidence {
            log: self.tester.log_state(self.now),
            not_kept: self.tester.log.not_kept,
            line: self.line_watch.state(),
            clock_wrong_by_permille: self.line_watch.rate.wrong_by_permille(),
            self_test: self.tester.self_test,
            unit_time: self.subscription.unit_time(),
        }
    }

    /// Results of the last requested self-test, item by item, as far as they came.
    pub fn self_test_items(&self) -> &[SelfTestItem] {
        &self.tester.exchange.self_test
    }

    pub fn self_test_item(&self, item: SelfTest) -> Option<SelfTestItem> {
        let items = self.self_test_items().iter();
        items.copied().find(|one| one.item == item)
    }

    /// Detail behind a signal which says only whether the unit matches its record.
    pub fn said(&self, signal: Signal) -> Option<&str> {
        self.identity.said(signal)
    }

    /// Trouble with which the unit turned this bench away, if it did: another tester has the unit.
    pub fn turned_away(&self) -> Option<LinkTrouble> {
        self.watch.turned_away()
    }

    /// Frames taken and refused by the rig.
    pub fn counters(&self) -> &Counters {
        self.link.counters()
    }
}
