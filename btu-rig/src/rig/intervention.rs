//! What others did to a unit on a train while it was tested.

use super::Rig;
use crate::procedure::finding::Finding;
use crate::procedure::plan::Connection;

impl Rig {
    /// What others than this tester did to the unit on a train since the last call, after which nothing can be judged:
    /// the unit was started again, or ended the session by itself. On a bench there is no other tester. A unit that
    /// restarts by itself says so in its log, which is read first.
    pub fn take_intervention(&mut self) -> Option<Finding> {
        let restarts = self.tester.restarts;
        let told = self.tester.restarted_itself(self.now);
        let new = told.filter(|_| self.restarts_told != restarts);
        let restarted = new == Some(false);
        if new.is_some() {
            self.restarts_told = restarts;
        }
        let ended = self.tester.take_session_ended();
        if self.connection() != Some(Connection::Ptu) {
            return None;
        }
        if restarted {
            return Some(Finding::StartedAgain);
        }
        ended.map(|refusal| Finding::TestModeEnded {
            refusal: refusal.code(),
        })
    }
}
