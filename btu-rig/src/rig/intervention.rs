//! What others did to a unit on a train while it was tested.

use protocol::message::ArmRefusal;

use super::Rig;
use crate::procedure::plan::Connection;

impl Rig {
    /// What was done to the unit on a train since this was last asked, by others than this tester, after which nothing
    /// can be judged: it was started again, or ended the session by itself. On a bench there is no other tester. A unit that
    /// restarts by itself says so in its log, which is read first.
    pub fn take_intervention(&mut self) -> Option<String> {
        let restarts = self.tester.restarts();
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
            return Some("the unit was started again: its supply was interrupted".to_owned());
        }
        ended.map(|refusal| {
            format!(
                "the unit ended test mode by itself: {}",
                session_end(refusal)
            )
        })
    }
}

/// Why a unit ends a session, in words a technician can act on.
fn session_end(refusal: ArmRefusal) -> &'static str {
    match refusal {
        ArmRefusal::KeyOff => "the maintenance key was turned off",
        ArmRefusal::Moving | ArmRefusal::TrainMoved => "the train moved",
        ArmRefusal::CodeChanged => "the speed code in the rail changed",
        ArmRefusal::ModeChanged => "the mode switch was turned",
        ArmRefusal::BrakesReleased => "the train does not prove that its brakes are applied",
        ArmRefusal::TesterSilent => "it did not hear the tester for a second",
        other => other.label(),
    }
}
