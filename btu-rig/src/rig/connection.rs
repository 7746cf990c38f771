//! How the unit is reached, and what can be run there.

use super::Rig;
use super::link::{Harness, HarnessWatch, LatestSample, told_by_train_state};
use super::session::version;
use crate::procedure::plan::Connection;
use crate::procedure::{Finding, Procedure};

impl Rig {
    /// Takes what the user says about the harness; a new rig takes the harness to be connected. To be called before the
    /// first scan.
    pub fn set_harness(&mut self, asked: Harness) {
        self.harness = HarnessWatch::new(asked);
        self.latest = LatestSample::default();
        self.record();
    }

    /// Whether the bench harness is there, as far as that is known.
    pub(crate) fn has_harness(&self) -> bool {
        self.harness.is_there()
    }

    /// How the unit is reached, once that is known.
    pub fn connection(&self) -> Option<Connection> {
        self.harness.found.map(|harness| match harness {
            true => Connection::Btu,
            false => Connection::Ptu,
        })
    }

    /// Whether it is known which signals the unit reports.
    pub fn knows_what_is_told(&self) -> bool {
        self.harness.found.is_some() && self.subscription.settled()
    }

    /// Why a procedure cannot be run on this connection, if so: it needs the harness, or signals that this unit does
    /// not report.
    pub fn cannot_run(&self, procedure: &Procedure) -> Option<Finding> {
        let connection = self.connection()?;
        if let Some(why) = procedure.needs.lacks(connection) {
            return Some(why);
        }
        if !self.subscription.refused() {
            return None;
        }
        let untold = told_by_train_state(connection);
        let mut names = Vec::new();
        procedure.for_each_signal(&mut |signal| {
            if untold.contains(&signal) && !names.contains(&signal.name()) {
                names.push(signal.name());
            }
        });
        let software = || self.identity().map(|identity| version(identity.software));
        (!names.is_empty()).then(|| Finding::NotToldByUnit {
            software: software(),
            signals: names.into_iter().map(str::to_owned).collect(),
        })
    }
}
