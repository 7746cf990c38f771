//! The window on a real display: a private X server, keys as a keyboard sends them, and a picture of
//! every page in both languages, kept in the target directory to be looked at.

#![allow(
    clippy::print_stdout,
    reason = "figures, for whoever asks with --nocapture"
)]

use std::cell::Cell;
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{Place, list};
use ptu_app::gui::{Page, Settings};
use ptu_bench::run::BenchChoice;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ClientMessageEvent, ConnectionExt, EventMask};

/// Patience with a busy machine that paints in software.
const PATIENCE: Duration = Duration::from_secs(300);
/// Pages, in the order of their keys F1 to F6.
const PAGES: [&str; 6] = [
    "bench",
    "procedures",
    "traces",
    "faults",
    "diagnosis",
    "report",
];

/// Where the button that begins a run is on the page of procedures.
const RUN: [&str; 2] = ["333", "89"];

/// It is clicked again after this time.
const AGAIN: Duration = Duration::from_secs(3);

/// A private X server; ends with the value.
struct Display {
    server: Child,
    name: String,
    frame_buffer: PathBuf,
}

/// `ptu gui` on it; ends with the value.
struct Shown<'a> {
    child: Child,
    display: &'a Display,
    /// From the start of the program to its first picture.
    first_picture: Duration,
}

/// What is on the screen.
#[derive(PartialEq)]
struct Picture {
    width: u32,
    height: u32,
    rgb: Vec<u8>,
}

impl Display {
    fn new(place: &Place) -> Self {
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1280x800x24"])
            .args(["-nolisten", "tcp", "-fbdir"])
            .arg(place.path(""))
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb starts; scripts/test installs it");
        let mut number = String::new();
        BufReader::new(server.stdout.take().expect("its stdout"))
            .read_line(&mut number)
            .expect("its number");
        Self {
            server,
            name: format!(":{}", number.trim()),
            frame_buffer: place.path("Xvfb_screen0"),
        }
    }

    /// The server's frame buffer file is an X window dump, 32 bits a pixel.
    fn picture(&self) -> Picture {
        let dump = std::fs::read(&self.frame_buffer).expect("the frame buffer");
        let word = |place: usize| {
            let bytes = dump[4 * place..4 * place + 4].try_into().expect("a word");
            u32::from_be_bytes(bytes)
        };
        let (header, width, height, line, colours) =
            (word(0), word(4), word(5), word(12), word(19));
        let pixels = &dump[(header + 12 * colours) as usize..];
        let rows = pixels.chunks_exact(line as usize).take(height as usize);
        let rgb = rows
            .flat_map(|row| row[..4 * width as usize].chunks_exact(4))
            .flat_map(|pixel| [pixel[2], pixel[1], pixel[0]])
            .collect();
        Picture { width, height, rgb }
    }

    /// There is no window manager here, so the test sends what one would send.
    fn ask_to_close(&self) {
        let (connection, screen) = x11rb::connect(Some(&self.name)).expect("the server");
        let atom = |name: &str| {
            let asked = connection.intern_atom(false, name.as_bytes());
            asked.expect("asked").reply().expect("an atom").atom
        };
        let (protocols, delete) = (atom("WM_PROTOCOLS"), atom("WM_DELETE_WINDOW"));
        let root = connection.setup().roots[screen].root;
        let tree = connection.query_tree(root).expect("asked").reply();
        let takes_part = |window: &u32| {
            let asked = connection.list_properties(*window).expect("asked").reply();
            asked.is_ok_and(|properties| properties.atoms.contains(&protocols))
        };
        let windows = tree.expect("windows").children;
        let window = windows.into_iter().find(takes_part).expect("its window");
        let event = ClientMessageEvent::new(32, window, protocols, [delete, 0, 0, 0, 0]);
        let sent = connection.send_event(false, window, EventMask::NO_EVENT, event);
        sent.expect("sent").check().expect("taken");
    }

    fn tool(&self, arguments: &[&str]) -> bool {
        let mut tool = Command::new("xdotool");
        tool.args(arguments).env("DISPLAY", &self.name);
        let output = tool
            .output()
            .expect("xdotool starts; scripts/test installs it");
        output.status.success()
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

impl<'a> Shown<'a> {
    fn open(place: &Place, display: &'a Display, arguments: &[&str]) -> Self {
        let ptu = place.command(&[&["gui"], arguments].concat());
        // A hang-up acts whether or not whoever runs the tests ignores it.
        let mut command = Command::new("env");
        command
            .arg("--default-signal=HUP")
            .arg(ptu.get_program())
            .args(ptu.get_args())
            .current_dir(place.path(""))
            .envs(
                ptu.get_envs()
                    .filter_map(|(key, value)| Some((key, value?))),
            )
            .env("DISPLAY", &display.name)
            .env("XDG_CONFIG_HOME", place.path("config"))
            .env("XDG_RUNTIME_DIR", place.path(""))
            .env_remove("WAYLAND_DISPLAY")
            .stderr(Stdio::piped());
        let dark = display.picture();
        let began = Instant::now();
        let child = command.spawn().expect("ptu starts");
        let mut shown = Self {
            child,
            display,
            first_picture: Duration::ZERO,
        };
        while display.picture() == dark {
            assert!(began.elapsed() < PATIENCE, "waited in vain for a picture");
            std::thread::sleep(Duration::from_millis(2));
        }
        shown.first_picture = began.elapsed();
        shown.until("the window", |display| {
            display.tool(&["search", "--name", "PTU", "windowfocus"])
        });
        // Out of the way, so that no hint covers what is looked at.
        display.tool(&["mousemove", "1279", "799"]);
        shown.until("a picture", |display| display.picture().colours() > 20);
        shown
    }

    fn until(&self, what: &str, holds: impl Fn(&Display) -> bool) {
        let began = Instant::now();
        while !holds(self.display) {
            if began.elapsed() > PATIENCE {
                self.display.picture().keep("in-vain");
                panic!("waited in vain for {what}; the picture is kept as in-vain.png");
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    fn key(&self, key: &str) {
        assert!(self.display.tool(&["key", key]), "key {key}");
    }

    /// A picture that no longer changes but for what lives: the page has its answers.
    fn settled(&self) -> Picture {
        let mut before = self.display.picture();
        let began = Instant::now();
        loop {
            std::thread::sleep(Duration::from_millis(700));
            let now = self.display.picture();
            if now.differs(&before) < 0.01 || began.elapsed() > PATIENCE {
                return now;
            }
            before = now;
        }
    }

    /// Processor time it takes while nothing happens, share of one core.
    fn idle_share(&self) -> f64 {
        let ticks = || {
            let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.child.id()));
            let stat = stat.expect("its statistics");
            let after = stat.rsplit(')').next().expect("fields").split_whitespace();
            let fields: Vec<&str> = after.collect();
            let ticks = |place: usize| fields[place].parse::<f64>().expect("ticks");
            ticks(11) + ticks(12)
        };
        let (before, began) = (ticks(), Instant::now());
        std::thread::sleep(Duration::from_secs(4));
        (ticks() - before) / 100.0 / began.elapsed().as_secs_f64()
    }

    /// Memory it has, MiB.
    fn resident_mib(&self) -> f64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id()));
        let status = status.expect("its status");
        let line = status.lines().find(|line| line.starts_with("VmRSS"));
        let kib = line.and_then(|line| line.split_whitespace().nth(1));
        kib.and_then(|kib| kib.parse::<f64>().ok()).expect("KiB") / 1024.0
    }

    /// Asks it to close, as the cross in its title bar does.
    fn close(self) {
        self.display.ask_to_close();
        self.ends_well();
    }

    /// Tells it to end, as a system that is shut down does, or a terminal that is closed.
    fn tell(self, signal: &str) {
        let id = self.child.id().to_string();
        let told = Command::new("kill").args(["-s", signal, &id]).status();
        assert!(told.expect("kill starts").success());
        self.ends_well();
    }

    fn ends_well(mut self) {
        let began = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("its state") {
                break status;
            }
            assert!(began.elapsed() < PATIENCE, "it does not close");
            std::thread::sleep(Duration::from_millis(50));
        };
        assert_eq!(status.code(), Some(0), "{status}");
    }
}

impl Drop for Shown<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Picture {
    fn colours(&self) -> usize {
        let colours: BTreeSet<&[u8]> = self.rgb.chunks_exact(3).collect();
        colours.len()
    }

    /// Share of the pixels that are not the same.
    fn differs(&self, other: &Self) -> f64 {
        // Most lines are the same, and are found so at once.
        let line = 3 * self.width as usize;
        let lines = self
            .rgb
            .chunks_exact(line)
            .zip(other.rgb.chunks_exact(line));
        let different = lines
            .filter(|(one, other)| one != other)
            .flat_map(|(one, other)| one.chunks_exact(3).zip(other.chunks_exact(3)))
            .filter(|(a, b)| a != b)
            .count();
        different as f64 / f64::from(self.width * self.height)
    }

    fn keep(&self, name: &str) {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("window");
        std::fs::create_dir_all(&folder).expect("folder");
        let file = std::fs::File::create(folder.join(format!("{name}.png"))).expect("file");
        let mut encoder = png::Encoder::new(file, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().expect("header");
        writer.write_image_data(&self.rgb).expect("pixels");
    }
}

#[test]
fn every_page_is_shown_on_a_real_display_in_both_languages() {
    let place = Place::new();
    let failed = place.ptu(&["run", "atp", "--inject", "eb_relay.slow"]);
    assert_eq!(failed.code, Some(1), "{}", failed.err);
    let display = Display::new(&place);
    for language in ["en", "ko"] {
        // Not on the page that it was closed on, of which the first picture could be.
        let from_the_first = ["--unit", "sim", "--lang", language, "--page", "bench"];
        let shown = Shown::open(&place, &display, &from_the_first);
        let mut pictures: Vec<Picture> = Vec::new();
        for (number, page) in (1..).zip(PAGES) {
            shown.key(&format!("F{number}"));
            // The page before has settled, too, and may still be there.
            shown.until(page, |display| {
                let picture = display.picture();
                pictures.iter().all(|other| picture.differs(other) > 0.01)
            });
            let picture = shown.settled();
            picture.keep(&format!("{page}-{language}"));
            assert!(picture.colours() > 20, "{page} shows something");
            pictures.push(picture);
        }
        for (place, one) in pictures.iter().enumerate() {
            for (after, other) in pictures.iter().enumerate().skip(place + 1) {
                assert!(
                    one.differs(other) > 0.01,
                    "{} and {} look alike in {language}",
                    PAGES[place],
                    PAGES[after]
                );
            }
        }
        shown.close();
    }
}

/// Goal: a run is not lost with the window. Method: a run that takes as long as on a real unit, and the
/// window closed, or told to end, in the midst of it.
#[test]
fn a_window_closed_in_mid_run_leaves_a_closed_record() {
    for told_to_end in [None, Some("TERM"), Some("HUP")] {
        let place = Place::new();
        let settings = Settings {
            page: Page::Procedures,
            unit: BenchChoice {
                realtime: true,
                ..BenchChoice::default()
            },
            ..Settings::default()
        };
        let file = place.path("config/ptu/window.json");
        settings.save(&file).expect("settings");
        let display = Display::new(&place);
        let shown = Shown::open(&place, &display, &["--unit", "sim"]);
        shown.settled();
        let [x, y] = RUN;
        let clicked = Cell::new(None::<Instant>);
        shown.until("the run", |display| {
            // The unit may not be there yet, and the button not be enabled. In a run another stands there,
            // which pauses it: it is in its midst all the same.
            if clicked.get().is_none_or(|at| at.elapsed() > AGAIN) {
                display.tool(&["mousemove", x, y, "click", "1"]);
                clicked.set(Some(Instant::now()));
            }
            place.ptu(&["runs", "show", "latest"]).code == Some(0)
        });
        match told_to_end {
            Some(signal) => shown.tell(signal),
            None => shown.close(),
        }
        let runs = place.json(&["runs", "list", "--json"]);
        let [run] = list(&runs) else {
            panic!("one run: {runs}")
        };
        assert_eq!(run["verdict"], "aborted", "{run}");
        assert_eq!(run["state"], "finished", "{run}");
    }
}

/// The figures are measured in release mode; here only that it does not repaint without a pause.
#[test]
fn a_window_nobody_touches_is_idle() {
    let place = Place::new();
    let display = Display::new(&place);
    for (unit, most) in [(&[][..], 0.2), (&["--unit", "sim"], 0.3)] {
        let shown = Shown::open(
            &place,
            &display,
            &[&["--page", "procedures"], unit].concat(),
        );
        shown.settled();
        // One that repaints without a pause never gets there; another may still have something to finish.
        let began = Instant::now();
        let share = loop {
            let share = shown.idle_share();
            if share < most || began.elapsed() > PATIENCE {
                break share;
            }
        };
        // With --nocapture and in release mode these are the figures to quote.
        println!(
            "{unit:?}: first picture after {} ms, idle {:.1} % of a core, {:.0} MiB",
            shown.first_picture.as_millis(),
            100.0 * share,
            shown.resident_mib()
        );
        assert!(share < most, "{unit:?}: {:.1} % of a core", 100.0 * share);
        shown.close();
    }
}

#[test]
fn without_a_display_it_says_so_and_ends() {
    let place = Place::new();
    let say = |arguments: &[&str], display: Option<&str>| {
        let mut ptu = place.command(arguments);
        ptu.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        ptu.envs(display.map(|name| ("DISPLAY", name)));
        let output = ptu.output().expect("ptu starts");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{said}");
        assert!(!said.contains("panicked"), "{said}");
        said
    };
    // Without a verb it is the window, too.
    for arguments in [&["gui"][..], &[]] {
        let said = say(arguments, None);
        assert!(
            said.contains("no display") && said.contains("ptu run"),
            "{said}"
        );
        let said = say(arguments, Some(":4711"));
        assert!(said.contains("cannot open a window"), "{said}");
    }
}
