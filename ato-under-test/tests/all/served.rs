//! The unit's program as it is served, and a client of one on a TCP socket by the clock.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use protocol::link::{End, Link};
use protocol::message::{Identify, Message};

/// Reading takes no longer, unless the computer stands still, which is no time of the test's.
const MOMENT: Duration = Duration::from_millis(20);

/// The program of a served unit; ends with the value.
pub struct Served(pub Child);

impl Served {
    /// Starts it with these arguments, and gives the port or address that it says.
    pub fn start(arguments: &[&str]) -> (Self, String) {
        let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scripts");
        // A hang-up acts whether or not whoever runs the tests ignores it.
        let mut child = Command::new("env")
            .args(["--default-signal=HUP", env!("CARGO_BIN_EXE_ato-under-test")])
            .args(arguments)
            .arg("--scripts")
            .arg(scripts)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("ato-under-test starts");
        let mut place = String::new();
        let out = child.stdout.take().expect("stdout");
        BufReader::new(out)
            .read_line(&mut place)
            .expect("its port or address");
        (Self(child), place.trim().to_owned())
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A unit served on a TCP socket; ends with the value.
pub struct Unit {
    pub program: Served,
    address: SocketAddr,
}

impl Unit {
    pub fn serve() -> Self {
        let (program, address) = Served::start(&["--tcp", "127.0.0.1:0"]);
        Self {
            program,
            address: address.parse().expect("an address"),
        }
    }

    pub fn signal(&self, name: &str) {
        let pid = self.program.0.id().to_string();
        let sent = Command::new("kill").args(["-s", name, &pid]).status();
        assert!(sent.expect("kill").success());
    }
}

/// A tester whose sequence numbers begin at 0, and its clock with it.
pub struct Client {
    pub stream: TcpStream,
    pub link: Link,
    began: Instant,
    pub closed: bool,
}

impl Client {
    pub fn connect(unit: &Unit) -> Self {
        let stream = TcpStream::connect(unit.address).expect("a connection");
        stream.set_nodelay(true).expect("no delay");
        let patience = Some(Duration::from_millis(10));
        stream.set_read_timeout(patience).expect("a time-out");
        Self {
            stream,
            link: Link::new(End::Bench),
            began: Instant::now(),
            closed: false,
        }
    }

    pub fn now(&self) -> protocol::Instant {
        protocol::Instant::from_ms(self.began.elapsed().as_millis() as u64)
    }

    pub fn send(&mut self, message: impl Into<Message>) {
        let mut frame = Vec::new();
        self.link.send(self.now(), &message.into(), &mut frame);
        self.write(&frame);
    }

    pub fn write(&mut self, bytes: &[u8]) {
        // A client that has been turned away may not be able to write any more.
        let _ = self.stream.write_all(bytes);
    }

    /// Messages that arrive within the next few milliseconds.
    pub fn hear(&mut self) -> Vec<Message> {
        let mut chunk = [0; 4096];
        match self.stream.read(&mut chunk) {
            Ok(0) => self.closed = true,
            Ok(count) => self.link.push(&chunk[..count]),
            Err(error) if is_nothing(&error) => {}
            Err(_) => self.closed = true,
        }
        let now = self.now();
        std::iter::from_fn(|| self.link.poll(now))
            .map(|received| received.message)
            .collect()
    }

    /// All that arrives for a while, in which the computer does not stand still, or until the connection is closed.
    pub fn hear_for(&mut self, time: Duration) -> Vec<Message> {
        let (mut heard, mut passed) = (Vec::new(), Duration::ZERO);
        while passed < time && !self.closed {
            let began = Instant::now();
            heard.extend(self.hear());
            passed += began.elapsed().min(MOMENT);
        }
        heard
    }

    /// Whether the unit answers who it is to one question, within a while.
    pub fn is_answered(&mut self, within: Duration) -> bool {
        self.send(Identify {});
        let mut passed = Duration::ZERO;
        while passed < within && !self.closed {
            let heard = self.hear_for(MOMENT);
            if heard.iter().any(|m| matches!(m, Message::Identity(_))) {
                return true;
            }
            passed += MOMENT;
        }
        false
    }
}

/// A program that was stopped and goes on is interrupted in what it waited for.
fn is_nothing(error: &std::io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
    )
}
