//! CPU time of the window per frame, layout and paint lists together, without a GPU:
//! `cargo bench -p ptu-window --bench window`.
//!
//! The trace is one hour of 40 signals, a row each 50 ms. `PTU_HOUR_DB=FILE` writes a database with it and
//! benches nothing, so that it can be looked at in the real window.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "what a benchmark or an example is for"
)]

mod hour;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use btu_rig::stimulus::Stimulus;
use divan::Bencher;
use eframe::egui::{Context, Event, Key, Modifiers, RawInput, Rect, pos2, vec2};
use protocol::Speed;
use ptu_options::Page;
use ptu_report::trace_view::TraceView;
use ptu_runs::bench_worker::Phase;
use ptu_runs::data::ScriptsDirectory;
use ptu_window::DataPaths;
use ptu_window::{App, Options, Settings};
use tempfile::TempDir;

/// Size of the window as it opens, and of one in which all 40 lanes are in view at once, points.
const USUAL: [f32; 2] = [1280.0, 800.0];
const TALL: [f32; 2] = [1280.0, 3400.0];
/// Presses of + from the whole hour to about 10 s.
const TO_TEN_SECONDS: usize = 17;

/// Time after which a page has its answers.
const ANSWERED: Duration = Duration::from_secs(2);

fn main() {
    if let Some(file) = std::env::var_os("PTU_HOUR_DB") {
        hour::write(Path::new(&file));
        return;
    }
    report_memory();
    divan::main();
}

struct Window {
    context: Context,
    app: App,
    size: [f32; 2],
    time_s: f64,
    _folder: TempDir,
}

impl Window {
    /// The trace page with the hour in view.
    fn open(size: [f32; 2]) -> Self {
        let folder = TempDir::new().expect("folder");
        let database = folder.path().join("hour.db");
        hour::write(&database);
        let settings = Settings {
            page: Page::Traces,
            lanes: hour::signals().map(|s| s.name().to_owned()).collect(),
            ..Settings::default()
        };
        let mut window = Self::with(folder, database, settings, size);
        // The list is read, then the trace; a window without it is painted from a few hundred shapes.
        window.frames_until(|window| window.frame(&[]) >= 20_000);
        window
    }

    /// A page on the history of one failing run of the whole suite.
    fn with_a_run(page: Page) -> Self {
        let folder = TempDir::new().expect("folder");
        let database = folder.path().join("history.db");
        let ptu = std::process::Command::new(
            Path::new(env!("CARGO_BIN_EXE_ptu-window")).with_file_name("ptu"),
        )
        .args(["run", "--inject", "eb_relay.slow", "--db"])
        .arg(&database)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .output()
        .expect("ptu runs");
        assert_eq!(ptu.status.code(), Some(1), "the fault is found");
        let settings = Settings {
            page,
            ..Settings::default()
        };
        let mut window = Self::with(folder, database, settings, USUAL);
        let began = Instant::now();
        window.frames_until(|window| {
            window.frame(&[]);
            began.elapsed() > ANSWERED
        });
        window
    }

    /// The live page of the simulated unit on a moving train.
    fn live() -> Self {
        let folder = TempDir::new().expect("folder");
        let database = folder.path().join("history.db");
        let settings = Settings {
            page: Page::Bench,
            ..Settings::default()
        };
        let mut window = Self::with(folder, database, settings, USUAL);
        window.frame(&[Key::F9]);
        window.frames_until(|window| {
            window.frame(&[]);
            window.app.units.chosen().phase() == Phase::Idle
        });
        let speed = Stimulus::Speed {
            to: Speed::from_kmh(60.0),
            accel_mps2: 0.5,
        };
        let bench = &window.app.units.chosen().bench;
        bench.apply(speed).expect("permitted");
        let began = Instant::now();
        window.frames_until(|window| {
            window.frame(&[]);
            began.elapsed() > ANSWERED
        });
        window
    }

    fn with(folder: TempDir, database: PathBuf, settings: Settings, size: [f32; 2]) -> Self {
        let scripts = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scripts"));
        let context = Context::default();
        let options = Options {
            paths: DataPaths::new(
                database,
                ScriptsDirectory::find(Some(scripts)).expect("scripts"),
            ),
            settings,
            settings_file: None,
            connect: false,
            interrupted: ptu_runs::stop::Stop::default(),
        };
        let app = App::new(&context, options, Arc::new(|| {})).expect("a window");
        Self {
            context,
            app,
            size,
            time_s: 0.0,
            _folder: folder,
        }
    }

    /// Frames, with a moment for the other threads after each, until this holds.
    fn frames_until(&mut self, mut holds: impl FnMut(&mut Self) -> bool) {
        while !holds(self) {
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Vertices painted in one frame.
    fn frame(&mut self, keys: &[Key]) -> usize {
        self.time_s += 1.0 / 60.0;
        let event = |key: &Key| Event::Key {
            key: *key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: Modifiers::NONE,
        };
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(
                pos2(0.0, 0.0),
                vec2(self.size[0], self.size[1]),
            )),
            time: Some(self.time_s),
            events: keys.iter().map(event).collect(),
            ..RawInput::default()
        };
        let app = &mut self.app;
        let mut output = self.context.run_ui(input, |ui| app.show(ui));
        let shapes = std::mem::take(&mut output.shapes);
        let scale = output.pixels_per_point;
        output.drop_without_applying_deltas();
        let painted = self.context.tessellate(shapes, scale);
        let vertices = |primitive: &eframe::egui::ClippedPrimitive| match &primitive.primitive {
            eframe::egui::epaint::Primitive::Mesh(mesh) => mesh.vertices.len(),
            eframe::egui::epaint::Primitive::Callback(_) => 0,
        };
        painted.iter().map(vertices).sum()
    }
}

/// The whole hour in view.
#[divan::bench(args = [USUAL, TALL])]
fn hour(bencher: Bencher<'_, '_>, size: [f32; 2]) {
    let mut window = Window::open(size);
    bencher.bench_local(|| window.frame(&[]));
}

/// Some 10 s of it in view, and the view moves in each frame.
#[divan::bench(args = [USUAL, TALL])]
fn ten_seconds(bencher: Bencher<'_, '_>, size: [f32; 2]) {
    let mut window = Window::open(size);
    for _ in 0..TO_TEN_SECONDS {
        window.frame(&[Key::Plus]);
    }
    bencher.bench_local(|| window.frame(&[Key::ArrowRight]));
}

/// The live page while the train moves.
#[divan::bench]
fn live(bencher: Bencher<'_, '_>) {
    let mut window = Window::live();
    bencher.bench_local(|| window.frame(&[]));
}

/// The other pages, on a run of the whole suite that found a fault.
#[divan::bench(args = [Page::Procedures, Page::Faults, Page::Diagnosis, Page::Report])]
fn page(bencher: Bencher<'_, '_>, page: Page) {
    let mut window = Window::with_a_run(page);
    bencher.bench_local(|| window.frame(&[]));
}

/// Work done once when the trace is opened, on the library's thread.
#[divan::bench(sample_count = 20)]
fn summaries(bencher: Bencher<'_, '_>) {
    bencher
        .with_inputs(hour::trace)
        .bench_values(TraceView::new);
}

/// Memory that the open trace takes, samples and summaries.
fn report_memory() {
    let before = resident_mib();
    let view = TraceView::new(hour::trace());
    let after = resident_mib();
    if let (Some(before), Some(after)) = (before, after) {
        println!(
            "{} rows of {} signals take {:.1} MiB",
            view.data().rows(),
            view.data().channels.len(),
            after - before
        );
    }
}

/// Memory of this process, as Linux tells it.
fn resident_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmRSS"))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib / 1024.0)
}
