//! A wire between a laptop and the server that does something when a certain commit passes.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::thread::JoinHandle;

/// When the wire does it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// The laptop has asked for the `n`th commit, the server has not heard of it.
    BeforeCommit(u32),
    /// The server has done the `n`th commit, the laptop has not heard of it.
    AfterCommit(u32),
    /// After this number of bytes to the server.
    AfterBytes(u64),
    Never,
}

/// A wire on a port of its own. It serves one connection.
pub struct Wire {
    pub port: u16,
    serving: JoinHandle<u32>,
}

impl Wire {
    /// Leads to a port; does `act` when it is time, and is cut then.
    pub fn to(server_port: u16, when: When, act: impl FnOnce() + Send + 'static) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("its number").port();
        let serving = std::thread::spawn(move || {
            let (laptop, _) = listener.accept().expect("a laptop");
            let server = TcpStream::connect(("127.0.0.1", server_port)).expect("a server");
            serve(&laptop, &server, when, act)
        });
        Self { port, serving }
    }

    /// Waits until it is cut; how many commits it has seen.
    pub fn commits(self) -> u32 {
        self.serving.join().expect("a wire does not panic")
    }
}

fn serve(laptop: &TcpStream, server: &TcpStream, when: When, act: impl FnOnce()) -> u32 {
    let answers = pump_answers(server, laptop);
    let mut act = Some(act);
    let mut do_it = || {
        if let Some(act) = act.take() {
            act();
        }
    };
    let (mut commits, mut bytes) = (0, 0);
    let mut chunk = vec![0; 64 << 10];
    let (mut from, mut to) = (laptop, server);
    while let Ok(read @ 1..) = from.read(&mut chunk) {
        let said = &chunk[..read];
        bytes += read as u64;
        let is_commit = said.starts_with(b"Q") && said.ends_with(b"COMMIT\0");
        commits += u32::from(is_commit);
        if is_commit && when == When::BeforeCommit(commits) {
            do_it();
            break;
        }
        if is_commit && when == When::AfterCommit(commits) {
            answers.hold();
            let _ = to.write_all(said);
            answers.wait_for_one();
            do_it();
            break;
        }
        if to.write_all(said).is_err() {
            break;
        }
        if matches!(when, When::AfterBytes(most) if bytes >= most) {
            do_it();
            break;
        }
    }
    let _ = laptop.shutdown(Shutdown::Both);
    let _ = server.shutdown(Shutdown::Both);
    commits
}

/// Answers from the server.
struct Answers {
    held: std::sync::Arc<std::sync::atomic::AtomicBool>,
    came: std::sync::mpsc::Receiver<()>,
}

impl Answers {
    /// From now on nothing reaches the laptop.
    fn hold(&self) {
        self.held.store(true, std::sync::atomic::Ordering::SeqCst);
        while self.came.try_recv().is_ok() {}
    }

    fn wait_for_one(&self) {
        let patience = std::time::Duration::from_secs(20);
        let _ = self.came.recv_timeout(patience);
    }
}

fn pump_answers(server: &TcpStream, laptop: &TcpStream) -> Answers {
    let (tell, came) = std::sync::mpsc::channel();
    let held = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
    let holding = std::sync::Arc::clone(&held);
    let mut from = server.try_clone().expect("a second end");
    let mut to = laptop.try_clone().expect("a second end");
    std::thread::spawn(move || {
        let mut chunk = vec![0; 64 << 10];
        while let Ok(read @ 1..) = from.read(&mut chunk) {
            if !holding.load(std::sync::atomic::Ordering::SeqCst)
                && to.write_all(&chunk[..read]).is_err()
            {
                break;
            }
            let _ = tell.send(());
        }
        let _ = to.shutdown(Shutdown::Both);
    });
    Answers { held, came }
}
