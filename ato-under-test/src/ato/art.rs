//! ART: the operating state and the conditions of its changes [S0 §3.3].

/// Operating states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AtoState {
    /// Being checked; cannot drive.
    Inspection,
    /// Standing, waiting for Automatic Run.
    Stop,
    /// Departing.
    Start,
    /// Between stations.
    Run,
}

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

impl AtoState {
    /// The next state.
    pub fn next(self, inputs: ArtInputs) -> Self {
        match self {
            _ if !inputs.healthy => Self::Inspection,
            _ if !inputs.run => Self::Stop,
            Self::Inspection | Self::Stop if !inputs.arrived => Self::Start,
            Self::Start if !inputs.standstill => Self::Run,
            Self::Run if inputs.standstill && inputs.arrived => Self::Stop,
            state => state,
        }
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
        let steps = [
            (at(false, true, false), AtoState::Stop),
            (at(true, true, false), AtoState::Start),
            (at(true, false, false), AtoState::Run),
            (at(true, true, false), AtoState::Run),
            (at(true, true, true), AtoState::Stop),
            (at(true, true, true), AtoState::Stop),
            (
                ArtInputs {
                    healthy: false,
                    ..at(true, true, true)
                },
                AtoState::Inspection,
            ),
        ];
        let mut state = AtoState::Inspection;
        for (inputs, expected) in steps {
            state = state.next(inputs);
            assert_eq!(state, expected, "{inputs:?}");
        }
    }
}
