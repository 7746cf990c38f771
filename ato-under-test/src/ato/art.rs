//! ART: the conditions under which the operating state changes [S0 §3.3].

use protocol::message::AtoState;

/// What the state depends on.
#[derive(Clone, Copy, Debug)]
pub struct ArtInputs {
    /// The processor works.
    pub healthy: bool,
    /// ATP has set Automatic Run.
    pub run: bool,
    /// Standing still.
    pub standstill: bool,
    /// At the stop point.
    pub arrived: bool,
}

/// The next state.
pub fn next(state: AtoState, inputs: ArtInputs) -> AtoState {
    match state {
        _ if !inputs.healthy => AtoState::Inspection,
        _ if !inputs.run => AtoState::Stop,
        AtoState::Inspection | AtoState::Stop if !inputs.arrived => AtoState::Start,
        AtoState::Start if !inputs.standstill => AtoState::Run,
        AtoState::Run if inputs.standstill && inputs.arrived => AtoState::Stop,
        state => state,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_goes_through_start_and_ends_at_the_stop_point() {
        let at = |run, standstill, arrived| ArtInputs {
            healthy: true,
            run,
            standstill,
            arrived,
        };
        let unhealthy = ArtInputs {
            healthy: false,
            ..at(true, true, true)
        };
        let steps = [
            (at(false, true, false), AtoState::Stop),
            (at(true, true, false), AtoState::Start),
            (at(true, false, false), AtoState::Run),
            (at(true, true, false), AtoState::Run),
            (at(true, true, true), AtoState::Stop),
            (at(true, true, true), AtoState::Stop),
            (unhealthy, AtoState::Inspection),
        ];
        let mut state = AtoState::Inspection;
        for (inputs, expected) in steps {
            state = next(state, inputs);
            assert_eq!(state, expected, "{inputs:?}");
        }
    }
}
