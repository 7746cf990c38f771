//! The settings saved between starts of the window.

use std::path::Path;

use fault_db::read_regular_file;
use serde::{Deserialize, Serialize};

use super::{Density, Page, SavedQuestion};
use ptu_report::words::Language;
use ptu_runs::clock;
use ptu_runs::failure::Failure;
use ptu_runs::run::BenchChoice;
use ptu_runs::whole_file::LONGEST_FILE;

/// Age at which the operator's name is asked for again, because another shift has begun, µs.
const SHIFT_US: i64 = 10 * 3_600_000_000;

/// Settings that the window keeps between starts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    pub language: Language,
    /// Dark window, as for a dark cab; none = as the desktop has it.
    pub dark: Option<bool>,
    /// The reader that the window is laid out for.
    pub density: Density,
    pub zoom: Zoom,
    /// Size of the window, points.
    pub window_size: Option<[f32; 2]>,
    /// Page shown last.
    pub page: Page,
    /// Name of the operator.
    pub operator: String,
    #[serde(flatten)]
    pub shift: Shift,
    /// Depot that units are brought to, for the sheet of a case.
    pub depot: String,
    /// Server of the last replication.
    pub server: String,
    /// File with readings of trains' odometers.
    pub distances: String,
    pub unit: BenchChoice,
    /// Signals of the rolling plot, by name.
    pub plotted: Vec<String>,
    /// The live plot is shown on the page Procedures, too.
    pub live_plot: bool,
    /// Lanes of the trace page, by channel.
    pub lanes: Vec<String>,
    /// Named layouts of the trace page's lanes.
    pub layouts: Vec<SavedQuestion<Vec<String>>>,
    /// Saved questions of the page Statistics.
    pub statistics: Vec<SavedQuestion<StatisticsQuestion>>,
    /// Saved questions of the page Faults.
    pub faults: Vec<SavedQuestion<FaultsQuestion>>,
}

/// Scale of the whole window, 0.7 to 2.5; 1 = the desktop's scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "f32", into = "f32")]
pub struct Zoom(f32);

impl From<f32> for Zoom {
    fn from(zoom: f32) -> Self {
        Self(zoom.clamp(0.7, 2.5))
    }
}

impl From<Zoom> for f32 {
    fn from(Zoom(zoom): Zoom) -> Self {
        zoom
    }
}

/// When the operator gave a name, and whether the window is locked until the next one does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Shift {
    /// When the name was written, µs since 1970; 0 = not known.
    operator_at_us: i64,
    /// The window is locked: nothing is begun, armed or written until a person gives a name.
    locked: bool,
}

/// Choices of the page Statistics.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct StatisticsQuestion {
    /// Days to look back; none = all there is.
    pub days: Option<i64>,
    #[serde(flatten)]
    pub measured: Measured,
}

/// The measurement of the control chart, of one step or of all.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Measured {
    pub measurement: Option<String>,
    /// Procedure and step.
    pub step: Option<(String, String)>,
}

/// Choices of the page Faults.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct FaultsQuestion {
    /// Serial number.
    pub unit: Option<String>,
    /// Part to which the faults point.
    pub part: Option<String>,
    /// Fault state, by its word.
    pub state: Option<String>,
    /// Days to look back; none = all there is.
    pub days: Option<i64>,
    /// Text that the faults shown contain.
    pub text: String,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            language: Language::shown(),
            dark: None,
            density: Density::default(),
            zoom: Zoom(1.0),
            window_size: None,
            page: Page::default(),
            operator: String::new(),
            shift: Shift::default(),
            depot: String::new(),
            server: String::new(),
            distances: String::new(),
            unit: BenchChoice::default(),
            plotted: ["speed", "train_speed", "limit", "eb"]
                .map(str::to_owned)
                .to_vec(),
            live_plot: false,
            lanes: Vec::new(),
            layouts: Vec::new(),
            statistics: Vec::new(),
            faults: Vec::new(),
        }
    }
}

impl Settings {
    /// Settings in `file`; defaults if there is no file or it cannot be read, so that the window always opens.
    pub fn load(file: &Path) -> Self {
        Self::of(&read_regular_file(file, LONGEST_FILE).unwrap_or_default())
    }

    fn of(text: &[u8]) -> Self {
        let mut settings: Self = match text.is_empty() {
            // The first start of the window has the layout that leads through a case.
            true => Self {
                density: Density::Operator,
                ..Self::default()
            },
            false => serde_json::from_slice(text).unwrap_or_default(),
        };
        settings.forget_operator(clock::now_us());
        settings
    }

    /// Takes the name away when it was written in another shift, so that a person cannot sign for another by mistake.
    pub fn forget_operator(&mut self, now_us: i64) {
        let since_us = now_us.saturating_sub(self.shift.operator_at_us);
        if !(0..SHIFT_US).contains(&since_us) {
            self.operator.clear();
        }
    }

    /// Notes when the name was written, if it differs from `before`.
    pub fn note_operator(&mut self, before: &str, now_us: i64) {
        if self.operator != before || self.shift.operator_at_us == 0 {
            self.shift.operator_at_us = now_us;
        }
    }

    /// Locks the window after its user has gone: the next user gives a name.
    pub fn lock(&mut self) {
        self.operator.clear();
        self.shift.locked = true;
    }

    /// Unlocks the window, once there is a name.
    pub fn unlock(&mut self) {
        self.shift.locked &= self.operator.trim().is_empty();
    }

    pub fn is_locked(&self) -> bool {
        self.shift.locked
    }

    /// Saves the settings in `file`, as a whole or not at all.
    ///
    /// # Errors
    /// The file or its folder cannot be written.
    pub fn save(&self, file: &Path) -> Result<(), Failure> {
        ptu_runs::whole_file::keep(file, self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saved_settings_are_read_back_and_a_damaged_file_gives_the_defaults() {
        let folder = tempfile::tempdir().expect("folder");
        let file = folder.path().join("config/window.json");
        assert_eq!(
            Settings::load(&file).density,
            Density::Operator,
            "first start"
        );
        let at = |operator_at_us| Shift {
            operator_at_us,
            locked: false,
        };
        let kept = Settings {
            language: Language::Korean,
            zoom: 1.25.into(),
            operator: "김".into(),
            depot: "군자차량기지".into(),
            shift: at(clock::now_us()),
            ..Settings::default()
        };
        kept.save(&file).expect("saved");
        assert_eq!(Settings::load(&file), kept);
        let yesterday = Settings {
            shift: at(clock::now_us() - 2 * SHIFT_US),
            ..kept
        };
        yesterday.save(&file).expect("saved");
        assert_eq!(Settings::load(&file).operator, "", "asked for again");
        std::fs::write(&file, "{\"zoom\":").expect("damaged");
        assert_eq!(Settings::load(&file), Settings::default());
    }

    #[test]
    fn damaged_settings_are_read_or_left() {
        let kept = serde_json::to_vec_pretty(&Settings::default()).expect("JSON");
        fuzzing::Fuzz::new("window-settings", env!("CARGO_MANIFEST_DIR"), [kept])
            .run(20_000, |bytes| {
                assert!(Settings::of(bytes).zoom.0.is_finite())
            });
    }
}
