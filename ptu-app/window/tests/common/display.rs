//! A private X server with the window on it, keys as a keyboard sends them, and pictures of what is shown.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::Place;
use super::picture::Picture;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ClientMessageEvent, ConnectionExt, EventMask};

/// Patience with a busy machine that paints in software.
pub const PATIENCE: Duration = Duration::from_secs(300);

/// Version of the dump in the frame buffer file (XWDFile.h).
const DUMP_VERSION: u32 = 7;

/// A private X server; ends with the value.
pub struct Display {
    server: Child,
    name: String,
    frame_buffer: PathBuf,
}

/// `ptu gui` on it; ends with the value.
pub struct Shown<'a> {
    child: Child,
    display: &'a Display,
    /// From the start of the program to its first picture.
    pub first_picture: Duration,
}

impl Display {
    pub fn new(place: &Place) -> Self {
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
    pub fn picture(&self) -> Picture {
        let word = |dump: &[u8], place: usize| {
            let bytes = dump[4 * place..4 * place + 4].try_into().expect("a word");
            u32::from_be_bytes(bytes)
        };
        let dump = loop {
            let dump = std::fs::read(&self.frame_buffer).expect("the frame buffer");
            // The server turns the bytes of the header round in place when it changes colours.
            if word(&dump, 1) == DUMP_VERSION {
                break dump;
            }
            std::thread::yield_now();
        };
        let word = |place| word(&dump, place);
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

    /// The test sends what a window manager would send; none runs here.
    pub fn ask_to_close(&self) {
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

    /// Some program has something to paste.
    pub fn has_copied(&self) -> bool {
        let (connection, _) = x11rb::connect(Some(&self.name)).expect("the server");
        let atom = connection.intern_atom(false, b"CLIPBOARD").expect("asked");
        let atom = atom.reply().expect("an atom").atom;
        let owner = connection.get_selection_owner(atom).expect("asked");
        owner.reply().expect("an owner").owner != x11rb::NONE
    }

    pub fn tool(&self, arguments: &[&str]) -> bool {
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
    pub fn open(place: &Place, display: &'a Display, arguments: &[&str]) -> Self {
        let ptu = place.command(&[&["gui", "--create"], arguments].concat());
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

    pub fn until(&self, what: &str, holds: impl Fn(&Display) -> bool) {
        let began = Instant::now();
        while !holds(self.display) {
            if began.elapsed() > PATIENCE {
                self.display.picture().keep("in-vain");
                panic!("waited in vain for {what}; the picture is kept as in-vain.png");
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    pub fn key(&self, key: &str) {
        assert!(self.display.tool(&["key", key]), "key {key}");
    }

    /// A picture that no longer changes but for what lives: the page has its answers.
    pub fn settled(&self) -> Picture {
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
    pub fn idle_share(&self) -> f64 {
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
    pub fn resident_mib(&self) -> f64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id()));
        let status = status.expect("its status");
        let line = status.lines().find(|line| line.starts_with("VmRSS"));
        let kib = line.and_then(|line| line.split_whitespace().nth(1));
        kib.and_then(|kib| kib.parse::<f64>().ok()).expect("KiB") / 1024.0
    }

    /// Asks it to close, as the cross in its title bar does.
    pub fn close(self) {
        self.display.ask_to_close();
        self.ends_well();
    }

    /// Tells it to end, as a system that is shut down does, or a terminal that is closed.
    pub fn tell(self, signal: &str) {
        let id = self.child.id().to_string();
        let told = Command::new("kill").args(["-s", signal, &id]).status();
        assert!(told.expect("kill starts").success());
        self.ends_well();
    }

    pub fn ends_well(mut self) {
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
    pub fn colours(&self) -> usize {
        let colours: BTreeSet<&[u8]> = self.rgb.chunks_exact(3).collect();
        colours.len()
    }

    /// Share of the pixels that are not the same.
    pub fn differs(&self, other: &Self) -> f64 {
        self.other_pixels(other, 0) as f64 / f64::from(self.width * self.height)
    }

    pub fn keep(&self, name: &str) {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("window");
        std::fs::create_dir_all(&folder).expect("folder");
        self.write(&folder.join(format!("{name}.png")));
    }
}
