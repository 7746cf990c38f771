//! One unit: its bench, what is heard from it, what its run came to.

use std::collections::VecDeque;

use btu_rig::procedure::UnitEvent;
use protocol::message::Identity;
use protocol::signal::Signal;

use super::UnitChoice;
use crate::failure::Failure;
use crate::gui::desk::Messages;
use crate::gui::library::{Asked, Library};
use crate::run::BenchSetup;
use crate::station::{News, Phase, Progress, RunNews, RunOrder, Station, Wake};
use crate::words::{Words, fill};

/// Entries of a unit's log that are shown.
const LOG: usize = 500;

/// One unit.
pub struct Unit {
    /// Its own number in this window, never used again for another.
    pub id: u64,
    /// What is chosen for it.
    pub choice: UnitChoice,
    /// Its bench.
    pub station: Station,
    /// What its bench is made of, once it was asked to connect.
    pub setup: Asked<BenchSetup>,
    /// What it and TCMS logged outside runs, oldest first.
    pub log: VecDeque<UnitEvent>,
    /// Its present or last run.
    pub run: Option<Progress>,
    /// Runs that have ended.
    pub(super) runs_ended: usize,
    /// The person knows that it cannot be reached.
    lost: bool,
    /// It was let go without its outputs being confirmed safe.
    pub(super) not_safe: bool,
}

impl Unit {
    pub(super) fn new(id: u64, choice: UnitChoice, wake: Wake) -> Result<Self, Failure> {
        Ok(Self {
            id,
            choice,
            station: Station::new(wake)?,
            setup: Asked::Not,
            log: VecDeque::new(),
            run: None,
            runs_ended: 0,
            lost: false,
            not_safe: false,
        })
    }

    /// What its bench's thread is at.
    pub fn phase(&self) -> Phase {
        match self.setup {
            Asked::Pending(_) => Phase::Connecting,
            _ => self.station.live().phase,
        }
    }

    /// A unit is there, run or not.
    pub fn is_connected(&self) -> bool {
        matches!(self.phase(), Phase::Idle | Phase::Running)
    }

    /// Who it is.
    pub fn identity(&self) -> Option<Identity> {
        self.station.live().identity
    }

    /// What it is called: its serial number, or where it is.
    pub fn name(&self) -> String {
        match self.identity() {
            Some(identity) => crate::run::text(&identity.serial),
            None => self.choice.endpoint.clone(),
        }
    }

    /// Reaches it.
    pub fn connect(&mut self, library: &Library) {
        let choice = self.choice.clone();
        self.setup =
            Asked::Pending(library.ask(move |shelf| choice.named()?.setup(&shelf.scripts)));
    }

    /// Lets it go, or gives up reaching it.
    pub fn disconnect(&mut self) {
        if matches!(self.setup, Asked::Pending(_)) {
            self.setup = Asked::Not;
        }
        self.station.disconnect();
    }

    /// Begins a run, if nothing else has the bench; whether it did.
    pub fn begin(&mut self, order: RunOrder) -> bool {
        if self.phase() != Phase::Idle {
            return false;
        }
        self.run = Some(Progress::new(&order.plan, self.name()));
        self.station.run(order);
        true
    }

    /// Answers what the run's script asks; it asks nothing more then.
    pub fn answer(&mut self, yes: bool) {
        if let Some(present) = self.run.as_mut().and_then(|run| run.present.as_mut())
            && present.prompt.take().is_some()
        {
            self.station.board().answer(yes);
        }
    }

    /// Test signals act on it.
    pub fn is_armed(&self) -> bool {
        self.station.live().sample.get(Signal::Armed) == Some(1.0)
    }

    /// Takes what happened since the last time, and tells the person what matters.
    pub(super) fn poll(&mut self, words: &Words, said: &mut Said<'_>) {
        if self.setup.poll() {
            match &self.setup {
                Asked::There(setup) => self
                    .station
                    .connect(setup.clone(), self.choice.connection()),
                Asked::Failed(why) => said.trouble(words.frame.cannot_connect, why.clone()),
                _ => {}
            }
        }
        let news: Vec<_> = self.station.news().collect();
        for news in news {
            self.hear(news, words, said);
        }
    }

    fn hear(&mut self, news: News, words: &Words, said: &mut Said<'_>) {
        let frame = &words.frame;
        match news {
            News::Connected { serial } => {
                self.log.clear();
                self.lost = false;
                self.not_safe = false;
                // What another unit's run came to is not this one's.
                if self.run.as_ref().is_some_and(|run| run.unit != serial) {
                    self.run = None;
                }
                said.tell(fill(frame.is_connected, &[("unit", &serial)]));
            }
            News::NotConnected(why) => said.trouble(frame.cannot_connect, why),
            News::Disconnected { safe: true } => said.tell(frame.is_disconnected),
            News::Disconnected { safe: false } | News::NotSafe => {
                self.not_safe = true;
                said.trouble(frame.not_safe, "");
            }
            News::LinkLost(why) => self.lose(why, words, said),
            News::Broken => {
                self.not_safe = true;
                said.trouble(frame.broken, "");
                if let Some(run) = self.run.as_mut().filter(|run| run.is_running()) {
                    run.end(None);
                }
            }
            News::UnitRestarted => said.trouble(frame.unit_restarted, ""),
            News::NotDone { asked, why } => {
                said.trouble(fill(frame.not_done, &[("what", &asked)]), why);
            }
            News::Logged(entry) => {
                if self.log.len() == LOG {
                    self.log.pop_front();
                }
                self.log.push_back(entry);
            }
            News::Run { procedure, what } => {
                if let RunNews::LinkLost(why) = &what {
                    self.lose(why.clone(), words, said);
                }
                if let Some(run) = &mut self.run {
                    run.hear(&procedure, &what);
                }
            }
            News::RunEnded(outcome) => {
                self.runs_ended += 1;
                let verdict = words.common.verdict(outcome.verdict);
                said.tell(fill(frame.run_ended, &[("verdict", &verdict)]));
                if let Some(run) = &mut self.run {
                    run.end(Some(outcome));
                }
            }
            News::RunFailed(why) => {
                self.runs_ended += 1;
                said.trouble(frame.run_failed, why);
                if let Some(run) = &mut self.run {
                    run.end(None);
                }
            }
        }
    }

    /// Said once, though every procedure of a run finds it out for itself.
    fn lose(&mut self, why: String, words: &Words, said: &mut Said<'_>) {
        if !std::mem::replace(&mut self.lost, true) {
            said.trouble(words.frame.link_lost, why);
        }
    }
}

/// Messages that say which unit they are about when there are several.
pub(super) struct Said<'a> {
    pub unit: Option<String>,
    pub messages: &'a mut Messages,
}

impl Said<'_> {
    fn named(&self, text: impl Into<String>) -> String {
        let text = text.into();
        match &self.unit {
            Some(unit) => format!("{unit}: {text}"),
            None => text,
        }
    }

    fn trouble(&mut self, text: impl Into<String>, detail: impl Into<String>) {
        let text = self.named(text);
        self.messages.trouble(text, detail);
    }

    fn tell(&mut self, text: impl Into<String>) {
        let text = self.named(text);
        self.messages.tell(text);
    }
}
