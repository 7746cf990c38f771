//! Forms that are filled in by hand, and their stimuli. Speeds are km/h and accelerations km/h/s, as
//! people say them; a stimulus has metres and seconds.

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
    /// The TEST board's signal.
    pub test_code: CodeForm,
    /// The TEST board's speed.
    pub test_motion: MotionForm,
    /// The TEST board's TWC frame.
    pub test_station: StationForm,
    /// Text by which stimuli are looked for.
    pub find: String,
}

impl Forms {
    /// Filled in for the first section of a bench's line and its unit's code table.
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
