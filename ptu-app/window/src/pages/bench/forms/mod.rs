//! Forms that a person fills in, and their stimuli. Forms have speeds in km/h and accelerations in km/h/s; stimuli
//! have metres and seconds.

mod code;
mod markers;
mod motion;
mod station;
mod train;

pub use code::{CodeForm, NO_DRIFT};
pub use markers::MarkerForm;
pub use motion::MotionForm;
pub use station::StationForm;
pub use train::TrainForm;

use ptu_runs::run::BenchSetup;

/// The path of a stimulus to the unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StimulusPath {
    /// The bench harness, in place of train and wayside.
    Harness,
    /// The unit's own TEST board.
    TestBoard,
}

#[derive(Debug)]
pub struct Forms {
    pub code: CodeForm,
    pub motion: MotionForm,
    pub markers: MarkerForm,
    pub station: StationForm,
    pub train: TrainForm,
    /// The TEST board's ATP signal.
    pub test_code: CodeForm,
    /// The TEST board's speed.
    pub test_motion: MotionForm,
    /// The TEST board's TWC frame.
    pub test_station: StationForm,
    /// Text of the search for stimuli.
    pub find: String,
}

impl Forms {
    /// Forms filled in for the first section of the bench's line and the unit's code table.
    pub fn new(setup: &BenchSetup) -> Self {
        let code = CodeForm::new(&setup.config.content);
        let station = StationForm::new(&setup.line.content);
        Self {
            code: code.clone(),
            motion: MotionForm::default(),
            markers: MarkerForm::new(&setup.line.content),
            station: station.clone(),
            train: TrainForm::default(),
            test_code: code,
            test_motion: MotionForm::default(),
            test_station: station,
            find: String::new(),
        }
    }
}
