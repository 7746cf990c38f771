//! Units that are tested from this window: what is chosen for each, and what is heard from it.

use std::collections::VecDeque;
use std::str::FromStr;

use btu_rig::procedure::UnitEvent;
use btu_rig::procedure::plan::Connection;
use protocol::message::Identity;
use protocol::signal::Signal;
use serde::{Deserialize, Serialize};

use super::desk::Messages;
use super::library::{Asked, Library};
use crate::failure::Failure;
use crate::link::Endpoint;
use crate::run::{BenchSetup, Choice};
use crate::station::{News, Phase, Progress, RunNews, RunOrder, Station, Wake};
use crate::words::{Words, fill};

/// Entries of a unit's log that are shown.
const LOG: usize = 500;

/// What is chosen for a unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct UnitChoice {
    /// `sim`, `serial:PATH[@BAUD]` or `tcp:HOST:PORT`.
    pub endpoint: String,
    /// The laptop on the maintenance port, which has no bench harness.
    pub as_ptu: bool,
    /// Line.
    pub line: String,
    /// Unit configuration.
    pub unit_config: String,
    /// Train.
    pub train: String,
    /// Serial number expected, or given to the embedded unit; empty = any.
    pub serial: String,
    /// Faults injected; nobody wants to find one left over from yesterday.
    #[serde(skip)]
    pub faults: Vec<String>,
    /// Seed of everything random.
    pub seed: u64,
    /// Good units differ.
    pub scatter: bool,
    /// Runs on the embedded unit take as long as on a real one.
    pub realtime: bool,
}

impl Default for UnitChoice {
    fn default() -> Self {
        Self {
            endpoint: "sim".into(),
            as_ptu: false,
            line: "line8".into(),
            unit_config: "sg100".into(),
            train: "line6".into(),
            serial: String::new(),
            faults: Vec::new(),
            seed: 1,
            scatter: false,
            realtime: false,
        }
    }
}

impl UnitChoice {
    /// The embedded unit.
    pub fn is_simulated(&self) -> bool {
        self.endpoint == "sim"
    }

    /// How it is connected.
    pub fn connection(&self) -> Connection {
        if self.as_ptu {
            Connection::Ptu
        } else {
            Connection::Btu
        }
    }

    /// As the command line would have it.
    ///
    /// # Errors
    /// The endpoint is none.
    pub fn named(&self) -> Result<Choice, Failure> {
        let unit = Endpoint::from_str(&self.endpoint).map_err(Failure::usage)?;
        let faults = match unit {
            Endpoint::Sim => self.faults.clone(),
            _ => Vec::new(),
        };
        Ok(Choice {
            unit,
            line: self.line.clone(),
            unit_config: self.unit_config.clone(),
            train: self.train.clone(),
            settings: Vec::new(),
            serial: (!self.serial.is_empty()).then(|| self.serial.clone()),
            faults,
            seed: self.seed,
            scatter: self.scatter.then_some(None),
            realtime: self.realtime,
        })
    }
}

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
    runs_ended: usize,
    /// The person knows that it cannot be reached.
    lost: bool,
    /// It was let go without its outputs being confirmed safe.
    not_safe: bool,
}

impl Unit {
    fn new(id: u64, choice: UnitChoice, wake: Wake) -> Result<Self, Failure> {
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
    fn poll(&mut self, words: &Words, said: &mut Said<'_>) {
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
struct Said<'a> {
    unit: Option<String>,
    messages: &'a mut Messages,
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

/// All units of the window; there is always one.
pub struct Units {
    first: Unit,
    more: Vec<Unit>,
    chosen: usize,
    next_id: u64,
    /// Counts the times everything was stopped: what was ordered before is not begun after.
    stops: u64,
    wake: Wake,
}

impl Units {
    /// One unit that is not connected.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn new(choice: UnitChoice, wake: Wake) -> Result<Self, Failure> {
        Ok(Self {
            first: Unit::new(0, choice, wake.clone())?,
            more: Vec::new(),
            chosen: 0,
            next_id: 1,
            stops: 0,
            wake,
        })
    }

    /// One more beside those there are, and chooses it.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn add(&mut self, choice: UnitChoice) -> Result<(), Failure> {
        let unit = Unit::new(self.next_id, choice, self.wake.clone())?;
        self.next_id += 1;
        self.more.push(unit);
        self.chosen = self.more.len();
        Ok(())
    }

    /// Takes away one that is not connected, but never the last.
    pub fn remove(&mut self, place: usize) {
        let offline = |unit: &Unit| unit.phase() == Phase::Offline;
        if self.more.is_empty() || !self.iter().nth(place).is_some_and(offline) {
            return;
        }
        if place == 0 {
            std::mem::swap(&mut self.first, &mut self.more[0]);
            self.more.remove(0);
        } else if place <= self.more.len() {
            self.more.remove(place - 1);
        }
        self.chosen = self.chosen.min(self.more.len());
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Unit> {
        std::iter::once(&self.first).chain(&self.more)
    }

    /// All of them, to be changed.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Unit> {
        std::iter::once(&mut self.first).chain(&mut self.more)
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        1 + self.more.len()
    }

    /// The place of the one the pages show.
    pub fn chosen_place(&self) -> usize {
        self.chosen
    }

    /// The pages show this one from now on.
    pub fn choose(&mut self, place: usize) {
        self.chosen = place.min(self.more.len());
    }

    /// The one the pages show.
    pub fn chosen(&self) -> &Unit {
        match self.chosen {
            0 => &self.first,
            more => self.more.get(more - 1).unwrap_or(&self.first),
        }
    }

    /// The one the pages show, to be changed.
    pub fn chosen_mut(&mut self) -> &mut Unit {
        match self.chosen {
            0 => &mut self.first,
            more => self.more.get_mut(more - 1).unwrap_or(&mut self.first),
        }
    }

    /// Runs that have ended here: what the database holds has changed when this has.
    pub fn runs_ended(&self) -> usize {
        self.iter().map(|unit| unit.runs_ended).sum()
    }

    /// Whether the signals of the chosen one are looked at.
    pub(super) fn watch(&self, looked_at: bool) {
        for (place, unit) in self.iter().enumerate() {
            unit.station
                .board()
                .watch(looked_at && place == self.chosen);
        }
    }

    /// The one of this number, if it is still there.
    pub fn of_id(&mut self, id: u64) -> Option<&mut Unit> {
        self.iter_mut().find(|unit| unit.id == id)
    }

    /// Stops every run, takes every stimulus away and disarms, at all units.
    pub fn stop_all(&mut self) {
        self.stops += 1;
        for unit in self.iter() {
            unit.station.stop_all();
        }
    }

    /// Times everything was stopped.
    pub fn stops(&self) -> u64 {
        self.stops
    }

    /// One of them was let go without its outputs being confirmed safe.
    pub(super) fn any_not_safe(&self) -> bool {
        self.iter().any(|unit| unit.not_safe)
    }

    /// Takes what happened at all of them.
    pub(super) fn poll(&mut self, words: &Words, messages: &mut Messages) {
        let several = !self.more.is_empty();
        for (place, unit) in (1..).zip(self.iter_mut()) {
            let unit_said = several.then(|| format!("{place} {}", unit.name()));
            let mut said = Said {
                unit: unit_said,
                messages,
            };
            unit.poll(words, &mut said);
        }
    }

    /// Stops all and lets all go; true once every bench's thread has ended.
    pub(super) fn close(&mut self) -> bool {
        let mut closed = true;
        for unit in self.iter_mut() {
            // Each is told, however many are still at it.
            closed &= unit.station.close();
        }
        closed
    }
}
