//! A terminal of its own for a program, which it loses when this is dropped.

use std::cell::RefCell;
use std::fs::File;
use std::io::{Read, Write};
use std::os::fd::OwnedFd;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use rustix::fs::{Mode, OFlags};
use rustix::pty::OpenptFlags;

/// Longest time anything here takes to come about, also on a machine that is held up.
const PATIENCE: Duration = Duration::from_secs(60);

pub struct Terminal {
    /// Whoever looks at it; what is written there is read and passed over.
    screen: OwnedFd,
    line: OwnedFd,
}

impl Terminal {
    pub fn open() -> Self {
        let screen =
            rustix::pty::openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC);
        let screen = screen.expect("a pseudo-terminal");
        rustix::pty::grantpt(&screen).expect("granted");
        rustix::pty::unlockpt(&screen).expect("unlocked");
        let name = rustix::pty::ptsname(&screen, Vec::new()).expect("its name");
        let line = rustix::fs::open(
            &name,
            OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC,
            Mode::empty(),
        );
        rustix::fs::fcntl_setfl(&screen, OFlags::NONBLOCK).expect("a flag");
        Self {
            screen,
            line: line.expect("its other side"),
        }
    }

    /// Starts a program whose terminal this is, as a shell's is that somebody looks at.
    pub fn start(&self, program: &Command) -> Child {
        let line = || self.line.try_clone().expect("a copy");
        // A closed terminal acts whether or not whoever runs the tests ignores signals.
        Command::new("env")
            .args(["--default-signal=HUP,INT", "setsid", "--ctty"])
            .arg(program.get_program())
            .args(program.get_args())
            .current_dir(program.get_current_dir().expect("a folder"))
            .envs(program.get_envs().filter_map(|(k, v)| Some((k, v?))))
            .stdin(line())
            .stdout(line())
            .stderr(line())
            .spawn()
            .expect("it starts")
    }

    /// Passes over what was written, so that the writer goes on.
    pub fn read(&self) {
        let mut screen = File::from(self.screen.try_clone().expect("a copy"));
        let mut chunk = [0; 4096];
        while screen.read(&mut chunk).is_ok_and(|count| count > 0) {}
    }

    /// Reads until this is shown; gives all that was.
    pub fn until_shown(&self, wanted: &str) -> String {
        let mut screen = File::from(self.screen.try_clone().expect("a copy"));
        let (began, mut shown) = (Instant::now(), Vec::new());
        let mut chunk = [0; 4096];
        loop {
            while let Ok(count @ 1..) = screen.read(&mut chunk) {
                shown.extend_from_slice(&chunk[..count]);
            }
            let text = String::from_utf8_lossy(&shown);
            if text.contains(wanted) {
                return text.into_owned();
            }
            assert!(
                began.elapsed() < PATIENCE,
                "\"{wanted}\" is not shown: {text}"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    pub fn resize(&self, [rows, columns]: [u16; 2]) {
        let mut size = rustix::termios::tcgetwinsize(&self.line).expect("a size");
        (size.ws_row, size.ws_col) = (rows, columns);
        rustix::termios::tcsetwinsize(&self.line, size).expect("resized");
    }

    /// Reads until the program ends; gives all that was shown.
    pub fn until_end(&self, program: &mut Child) -> String {
        let shown = RefCell::new(Vec::new());
        let read = || {
            let mut screen = File::from(self.screen.try_clone().expect("a copy"));
            // Nothing more is there for now.
            let _ = screen.read_to_end(&mut shown.borrow_mut());
        };
        ended(program, read);
        read();
        String::from_utf8_lossy(&shown.borrow()).into_owned()
    }

    pub fn type_line(&self, line: &str) {
        let mut keys = File::from(self.screen.try_clone().expect("a copy"));
        writeln!(keys, "{line}").expect("typed");
    }
}

/// Waits for a program's end, and gives its exit code.
pub fn ended(program: &mut Child, meanwhile: impl Fn()) -> Option<i32> {
    let began = Instant::now();
    loop {
        if let Some(status) = program.try_wait().expect("its state") {
            return status.code();
        }
        assert!(began.elapsed() < PATIENCE, "it does not end");
        meanwhile();
        std::thread::sleep(Duration::from_millis(20));
    }
}
