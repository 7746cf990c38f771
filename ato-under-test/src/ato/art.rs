//! ART: the conditions under which the operating state changes [S0 §3.3].
//!
//! | from | to | when |
//! |---|---|---|
//! | any | inspection | a check fails, or something failed on the way |
//! | inspection | stop | every check passes and the train stands |
//! | stop | start | ATP has set Automatic Run and the train is not at the stop point |
//! | start | run | the train moves |
//! | start, run | stop | it stands at the stop point, or as near to it as jogging could bring it |
//! | start, run | stop | ATP has ended Automatic Run |

use protocol::message::{AtoFailure, AtoState};

/// KRN's checks of what ATO needs: processor, self-test, stored data, TRA.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Checks {
    /// The checks have not finished.
    #[default]
    Running,
    Passed,
    Failed(AtoFailure),
}

#[derive(Clone, Copy, Debug)]
pub struct ArtInputs {
    /// Every check passes and nothing has failed on the way.
    pub fit: bool,
    /// ATP has set Automatic Run.
    pub run: bool,
    /// Standing still.
    pub standstill: bool,
    /// The train is at the stop point, or the run has ended away from it.
    pub arrived: bool,
}

pub fn next(state: AtoState, inputs: ArtInputs) -> AtoState {
    match state {
        _ if !inputs.fit => AtoState::Inspection,
        AtoState::Inspection if inputs.standstill => AtoState::Stop,
        AtoState::Start | AtoState::Run if !inputs.run => AtoState::Stop,
        AtoState::Stop if inputs.run && !inputs.arrived => AtoState::Start,
        AtoState::Start if !inputs.standstill => AtoState::Run,
        AtoState::Start | AtoState::Run if inputs.standstill && inputs.arrived => AtoState::Stop,
        AtoState::Unknown(_) => AtoState::Inspection,
        state => state,
    }
}

pub fn drives(state: AtoState) -> bool {
    matches!(state, AtoState::Start | AtoState::Run)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_change_by_this_table() {
        use AtoState::{Inspection, Run, Start, Stop, Unknown};
        let at = |fit, run, standstill, arrived| ArtInputs {
            fit,
            run,
            standstill,
            arrived,
        };
        // fit, run, standstill, arrived
        let cases = [
            (Inspection, at(false, true, true, false), Inspection),
            (Inspection, at(true, true, false, false), Inspection),
            (Inspection, at(true, true, true, false), Stop),
            (Stop, at(true, false, true, false), Stop),
            (Stop, at(true, true, true, true), Stop),
            (Stop, at(true, true, true, false), Start),
            (Stop, at(false, true, true, false), Inspection),
            (Start, at(true, true, true, false), Start),
            (Start, at(true, true, true, true), Stop),
            (Start, at(true, true, false, false), Run),
            (Start, at(true, false, true, false), Stop),
            (Start, at(false, true, true, false), Inspection),
            (Run, at(true, true, false, true), Run),
            (Run, at(true, true, true, false), Run),
            (Run, at(true, true, true, true), Stop),
            (Run, at(true, false, false, false), Stop),
            (Run, at(false, true, false, false), Inspection),
            (Unknown(9), at(true, true, true, false), Inspection),
        ];
        for (state, inputs, expected) in cases {
            assert_eq!(next(state, inputs), expected, "{state:?} {inputs:?}");
        }
    }
}
