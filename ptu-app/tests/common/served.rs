//! A unit served on a port in real time, `ptu` working on it, and a client that looks at the wire.
//!
//! Real time on a busy machine: unit and tester ask for a higher priority. Where that is refused
//! they run as they are.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::time::{Duration, Instant};

use protocol::link::{End, Link};
use protocol::message::{KeepAlive, Message, StatusBits};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use serialport::SerialPort;

use super::{Place, Said, scripts};

/// Arguments of `nice` for a program that must keep time.
const URGENT: [&str; 2] = ["-n", "-15"];
/// Longest time anything here takes to come about, also on a machine that is held up.
const PATIENCE: Duration = Duration::from_secs(300);

/// A served unit; ends with the value.
pub struct Unit {
    child: Child,
    /// Where a train's cab is spoken to.
    cab: Option<ChildStdin>,
    /// Address for `--unit`.
    pub address: String,
    /// Port or socket address alone.
    pub port: String,
}

impl Unit {
    /// A unit on a new pseudo-terminal.
    pub fn on_pty(arguments: &[&str]) -> Self {
        Self::serve(&[&["--pty"], arguments].concat(), "serial:")
    }

    /// A unit on a new pseudo-terminal, in lock step with its tester.
    pub fn in_lock_step(arguments: &[&str]) -> Self {
        Self::serve(
            &[&["--pty", "--lock-step"], arguments].concat(),
            "lockstep:",
        )
    }

    /// A unit on a free TCP port.
    pub fn on_tcp(arguments: &[&str]) -> Self {
        Self::serve(&[&["--tcp", "127.0.0.1:0"], arguments].concat(), "tcp:")
    }

    /// A unit on a free TCP port, with these programs before those of the system.
    pub fn with_programs(programs: &str, arguments: &[&str]) -> Self {
        let path = format!("PATH={programs}:/usr/bin:/bin");
        let unit = super::program("ato-under-test").display().to_string();
        let serve = [&path, unit.as_str(), "--tcp", "127.0.0.1:0"];
        Self::start(Path::new("env"), &[&serve, arguments].concat(), "tcp:")
    }

    /// Again where another was.
    pub fn at_port(port: &str) -> Self {
        Self::serve(&["--tcp", port], "tcp:")
    }

    /// Aboard a train, its maintenance port on a new pseudo-terminal.
    pub fn aboard(arguments: &[&str]) -> Self {
        let train = [&["train", "--pty"], arguments].concat();
        Self::start(&super::program("ptu"), &train, "serial:")
    }

    fn serve(arguments: &[&str], scheme: &str) -> Self {
        Self::start(&super::program("ato-under-test"), arguments, scheme)
    }

    fn start(program: &Path, arguments: &[&str], scheme: &str) -> Self {
        let mut child = Command::new("nice")
            .args(URGENT)
            .arg(program)
            .args(arguments)
            .env("PTU_SCRIPTS", scripts())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the unit starts");
        let mut port = String::new();
        BufReader::new(child.stdout.take().expect("its stdout"))
            .read_line(&mut port)
            .expect("its port");
        let port = port.trim().to_owned();
        assert!(!port.is_empty(), "the unit ended without a port");
        let address = format!("{scheme}{port}");
        Self {
            cab: child.stdin.take(),
            child,
            address,
            port,
        }
    }

    /// Says something in the cab of its train.
    pub fn say(&mut self, order: &str) {
        let cab = self.cab.as_mut().expect("a cab");
        writeln!(cab, "{order}").expect("the cab hears");
    }

    /// Nobody is in the cab any more.
    pub fn leave_cab(&mut self) {
        self.cab = None;
    }

    /// Ends it by a signal, as a supervisor does.
    pub fn signal(&self, signal: Signal) {
        kill_process(Pid::from_child(&self.child), signal).expect("a signal");
    }

    /// Waits for its end.
    pub fn exit_code(&mut self) -> Option<i32> {
        self.child.wait().expect("its end").code()
    }

    /// Stops the process for this time, as a busy computer would.
    pub fn stand_still(&self, time: Duration) {
        stand_still(&self.child, time);
    }

    /// Kills it, as a power cut would.
    pub fn kill(&mut self) {
        self.child.kill().expect("the unit is killed");
        self.child.wait().expect("the unit is gone");
    }
}

impl Drop for Unit {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn stand_still(child: &Child, time: Duration) {
    let pid = Pid::from_child(child);
    kill_process(pid, Signal::STOP).expect("a signal");
    std::thread::sleep(time);
    kill_process(pid, Signal::CONT).expect("a signal");
}

/// A `ptu run` under way on a served unit.
pub struct Running<'a> {
    child: Child,
    place: &'a Place,
}

impl<'a> Running<'a> {
    /// Starts `ptu run` on this unit.
    pub fn start(place: &'a Place, unit: &Unit, arguments: &[&str]) -> Self {
        let ptu = place.command(&[]);
        let child = Command::new("nice")
            .args(URGENT)
            .arg(ptu.get_program())
            .args(["run", "--unit", &unit.address])
            .args(arguments)
            .current_dir(place.path(""))
            .envs(ptu.get_envs().filter_map(|(k, v)| Some((k, v?))))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("ptu starts");
        Self { child, place }
    }

    /// Waits until this many steps are recorded, and gives them; attempts that are repeated do not count.
    pub fn recorded_steps(&mut self, count: usize) -> Vec<Value> {
        let began = Instant::now();
        while began.elapsed() < PATIENCE {
            let ended = self.child.try_wait().expect("ptu's state");
            assert!(ended.is_none(), "ptu ended before {count} steps: {ended:?}");
            let mut steps = self.place.steps_so_far();
            steps.retain(|step| step["verdict"] != "skipped");
            if steps.len() >= count {
                return steps;
            }
            // Each look is a program of its own, and takes as long.
            std::thread::sleep(Duration::from_millis(100));
        }
        panic!("not {count} steps within {PATIENCE:?}");
    }

    /// Ctrl-C.
    pub fn interrupt(&self) {
        kill_process(Pid::from_child(&self.child), Signal::INT).expect("a signal");
    }

    /// Stops the process for this time, as a busy computer would.
    pub fn stand_still(&self, time: Duration) {
        stand_still(&self.child, time);
    }

    /// SIGKILL: no chance to say anything.
    pub fn kill(mut self) {
        self.child.kill().expect("ptu is killed");
        self.child.wait().expect("ptu is gone");
    }

    /// Waits for its end.
    pub fn finish(self) -> Said {
        Said::from(self.child.wait_with_output().expect("ptu's output"))
    }
}

/// A client that looks at what the unit sends. What it sends itself is refused until its
/// predecessor has been silent for a second.
pub struct Observer {
    port: Box<dyn SerialPort>,
    link: Link,
    began: Instant,
    keep_alive_due: Instant,
}

impl Observer {
    pub fn on(unit: &Unit) -> Self {
        let port = serialport::new(&unit.port, 115_200)
            .timeout(Duration::from_millis(5))
            .exclusive(false)
            .open()
            .expect("the unit's port");
        let now = Instant::now();
        Self {
            port,
            link: Link::new(End::Bench),
            began: now,
            keep_alive_due: now,
        }
    }

    /// Sends something else than a keep-alive.
    pub fn send(&mut self, message: impl Into<Message>) {
        let now = protocol::Instant::from_ms(self.began.elapsed().as_millis() as u64);
        let mut frame = Vec::new();
        self.link.send(now, &message.into(), &mut frame);
        self.port.write_all(&frame).expect("the port takes a frame");
    }

    /// Messages that arrive within the next few milliseconds.
    pub fn hear(&mut self) -> Vec<Message> {
        let now = protocol::Instant::from_ms(self.began.elapsed().as_millis() as u64);
        if Instant::now() >= self.keep_alive_due {
            self.keep_alive_due += Duration::from_millis(100);
            let mut frame = Vec::new();
            self.link
                .send(now, &KeepAlive { session: 0 }.into(), &mut frame);
            self.port.write_all(&frame).expect("the port takes a frame");
        }
        let mut chunk = [0; 4096];
        match self.port.read(&mut chunk) {
            Ok(count) => self.link.push(&chunk[..count]),
            Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock) => {}
            Err(error) => panic!("reading the port: {error}"),
        }
        std::iter::from_fn(|| self.link.poll(now))
            .map(|heard| heard.message)
            .collect()
    }

    /// Listens until `seen` is satisfied; gives up after this time.
    pub fn wait(&mut self, within: Duration, what: &str, mut seen: impl FnMut(&Message) -> bool) {
        let began = Instant::now();
        while began.elapsed() < within {
            if self.hear().iter().any(&mut seen) {
                return;
            }
        }
        panic!("{what} was not seen within {within:?}");
    }
}

/// No session holds the unit and no test signal is made.
pub fn released(message: &Message) -> bool {
    matches!(message, Message::Status(status)
        if !status.bits.contains(StatusBits::ARMED) && status.test_signals.is_empty())
}

/// A short run on the unit passes.
#[track_caller]
pub fn passes(place: &Place, unit: &Unit, procedure: &str) {
    Running::start(place, unit, &[procedure]).finish().exits(0);
}
