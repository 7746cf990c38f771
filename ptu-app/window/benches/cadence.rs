//! Does the window hold the bench up? Lateness of a live bench's 50 ms cycles, with no window and with
//! one that is laid out, painted into triangles and read without a pause. Prints percentiles.
//!
//! ```text
//! cargo bench -p ptu-window --bench cadence
//! ```

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "what a benchmark or an example is for"
)]

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use btu_rig::stimulus::Stimulus;
use eframe::egui::{Context, RawInput, Rect, pos2, vec2};
use protocol::{CYCLE, Speed};
use ptu_options::Page;
use ptu_runs::bench_worker::Phase;
use ptu_runs::data::ScriptsDirectory;
use ptu_runs::link::{Pace, keep_time};
use ptu_window::DataPaths;
use ptu_window::{App, Options, Settings};

/// Duration of each measurement.
const LASTS: Duration = Duration::from_secs(20);

fn main() {
    println!("lateness of 50 ms cycles         p50       p99       max    cycles");
    row("no window", &lateness(false).0);
    let (late_us, frames) = lateness(true);
    row("a window without a pause", &late_us);
    println!("frames laid out meanwhile: {frames}");
    println!("\nlateness of 10 ms scans          p50     p99.9       max     scans");
    for (name, busy) in [("quiet", 0), ("beside six busy loops", 6)] {
        for (priority, raised) in [("", false), (", raised", true)] {
            scans(&format!("{name}{priority}"), busy, raised);
        }
    }
}

/// Lateness of scans in a thread that does nothing else, `busy` loops beside it.
fn scans(name: &str, busy: usize, raised: bool) {
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for _ in 0..busy {
            scope.spawn(|| {
                while !over.load(Ordering::Relaxed) {
                    std::hint::spin_loop();
                }
            });
        }
        let timed = scope.spawn(|| {
            let raised = raised && keep_time();
            let mut pace = Pace::real();
            let mut late_us = Vec::new();
            let began = Instant::now();
            while began.elapsed() < LASTS {
                pace.wait();
                late_us.push(pace.behind().as_us());
            }
            (late_us, raised)
        });
        let (mut late_us, was_raised) = timed.join().expect("a thread");
        over.store(true, Ordering::Relaxed);
        late_us.sort_unstable();
        match raised && !was_raised {
            true => println!("{name:<30} the system does not let it"),
            false => percentiles(name, &late_us, 0.999),
        }
    });
}

fn row(name: &str, late_us: &[u64]) {
    percentiles(name, late_us, 0.99);
}

fn percentiles(name: &str, late_us: &[u64], high: f64) {
    let last = late_us.len().saturating_sub(1);
    let at = |share: f64| {
        late_us
            .get((last as f64 * share) as usize)
            .copied()
            .unwrap_or(0)
    };
    println!(
        "{name:<26} {:>6} µs {:>6} µs {:>6} µs  {:>8}",
        at(0.5),
        at(high),
        at(1.0),
        late_us.len()
    );
}

/// Sorted lateness of cycles, µs after the earliest, and the frames laid out meanwhile.
fn lateness(look_on: bool) -> (Vec<u64>, usize) {
    let shown: Arc<Mutex<Vec<Instant>>> = Arc::default();
    let noted = shown.clone();
    let folder = tempfile::tempdir().expect("a folder");
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts");
    let options = Options {
        paths: DataPaths::new(
            folder.path().join("history.db"),
            ScriptsDirectory::find(Some(&scripts)).expect("scripts"),
        ),
        settings: Settings {
            page: Page::Bench,
            ..Settings::default()
        },
        settings_file: None,
        connect: true,
        interrupted: ptu_runs::stop::Stop::default(),
    };
    let context = Context::default();
    let wake = Arc::new(move || noted.lock().expect("times").push(Instant::now()));
    let mut app = App::new(&context, options, wake).expect("a window");
    while app.units.chosen().phase() != Phase::Idle {
        frame(&context, &mut app);
        std::thread::sleep(Duration::from_millis(20));
    }
    // Something changes in every cycle from now on, so that every cycle is shown.
    let speed = Stimulus::Speed {
        to: Speed::from_kmh(20.0),
        accel_mps2: 0.5,
    };
    app.units.chosen().bench.apply(speed).expect("permitted");
    std::thread::sleep(Duration::from_secs(1));
    shown.lock().expect("times").clear();
    let began = Instant::now();
    let mut frames = 0;
    while began.elapsed() < LASTS {
        if look_on {
            frame(&context, &mut app);
            frames += 1;
        } else {
            std::thread::sleep(Duration::from_millis(100));
        }
    }
    let shown = shown.lock().expect("times").clone();
    (late(&shown), frames)
}

fn frame(context: &Context, app: &mut App) {
    let input = RawInput {
        screen_rect: Some(Rect::from_min_size(pos2(0.0, 0.0), vec2(1280.0, 800.0))),
        ..RawInput::default()
    };
    let output = context.run_ui(input, |ui| app.show(ui));
    divan::black_box(context.tessellate(output.shapes, output.pixels_per_point));
}

/// How much later than the earliest of them cycles came, sorted, µs.
fn late(shown: &[Instant]) -> Vec<u64> {
    let Some(first) = shown.first() else {
        return Vec::new();
    };
    let cycle = CYCLE.as_us();
    let offsets = shown
        .iter()
        .map(|at| (at.duration_since(*first).as_micros() as u64 + cycle / 2) % cycle);
    let offsets: Vec<u64> = offsets.collect();
    let earliest = offsets.iter().min().copied().unwrap_or(0);
    let mut late: Vec<u64> = offsets.iter().map(|offset| offset - earliest).collect();
    late.sort_unstable();
    late
}
