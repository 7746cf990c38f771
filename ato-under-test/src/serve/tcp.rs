//! Serves one TCP client at a time. A second one gets a message that says who has the unit and is disconnected: nothing that
//! it sent while it waited may act later as if it were fresh.

extern crate std;

use std::io::{self, ErrorKind, Read, Write};
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream, ToSocketAddrs as _};
use std::string::String;
use std::vec;
use std::vec::Vec;

use protocol::link::{End, Link, MAX_DELAY};
use protocol::message::Taken;
use protocol::{Duration, Instant};
use socket2::{SockRef, TcpKeepalive};

/// A client of which no frame was accepted for so long is disconnected.
const SILENT: Duration = Duration::from_ms(10_000);
/// A connection on which nothing comes is probed after this time, and again each time that it passes.
const PROBED_AFTER: std::time::Duration = std::time::Duration::from_secs(5);
/// A second client waits this long before it is accepted: its predecessor's last bytes may still have to be read.
const HANDS_OVER: Duration = Duration::from_ms(100);
/// A client that is turned away has so long to close, so that the message is not lost by a reset.
const LEAVES_WITHIN: Duration = Duration::from_ms(1000);
/// Newcomers attended to at once; others wait for them in the system's queue.
const MOST_COMING: usize = 16;

/// Warning about every unit at a TCP address.
pub const NO_AUTHENTICATION: &str =
    "there is no authentication: whoever reaches this address has the unit";

/// Refuses an address that other computers can reach, unless that is asked for. What cannot be resolved is left to whoever
/// listens there.
///
/// # Errors
/// Other computers reach the address; the text says what to do instead.
pub fn check_exposed(address: &str, expose: bool) -> Result<(), String> {
    let mut found = address.to_socket_addrs().into_iter().flatten();
    match !expose && found.any(|at| !at.ip().is_loopback()) {
        true => Err(std::format!(
            "other computers reach {address}, and {NO_AUTHENTICATION}; serve at 127.0.0.1, or say --expose on a network \
             of your own"
        )),
        false => Ok(()),
    }
}

/// The listener and its clients.
pub struct Server {
    listener: TcpListener,
    client: Option<Client>,
    coming: Vec<SecondClient>,
    /// Buffer for bytes that are read and thrown away.
    unheard: Vec<u8>,
}

/// The client that has the unit.
struct Client {
    stream: TcpStream,
    address: SocketAddr,
    since: Instant,
    /// Count of accepted frames when it last grew, and the time of that.
    accepted: u64,
    heard_at: Instant,
}

/// A client that connected while another has the unit.
struct SecondClient {
    stream: TcpStream,
    address: SocketAddr,
    since: Instant,
    /// The client was sent `Taken`, which says who has the unit.
    answered: bool,
}

impl Server {
    /// Listens at this address; returns with the server the address that the system gave it.
    pub fn listen(address: &str) -> io::Result<(Self, SocketAddr)> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let at = listener.local_addr()?;
        let server = Self {
            listener,
            client: None,
            coming: Vec::new(),
            unheard: vec![0; 4096],
        };
        Ok((server, at))
    }

    /// Takes the first who comes, turns others away and lets a silent one go; true when there is another
    /// client from now on. This program is `behind` its time; `accepted` counts the frames that the unit
    /// accepted.
    pub fn attend(&mut self, now: Instant, behind: Duration, accepted: u64) -> io::Result<bool> {
        self.let_silent_go(now, accepted);
        self.receive_waiting_clients(now, behind)?;
        let taken = self.client.is_none() && self.take_first(now, accepted);
        self.turn_away(now);
        Ok(taken)
    }

    fn let_silent_go(&mut self, now: Instant, accepted: u64) {
        let Some(client) = &mut self.client else {
            return;
        };
        if client.accepted != accepted {
            client.accepted = accepted;
            client.heard_at = now;
        }
        if now.since(client.heard_at) >= SILENT {
            self.client = None;
        }
    }

    fn receive_waiting_clients(&mut self, now: Instant, behind: Duration) -> io::Result<()> {
        while self.coming.len() < MOST_COMING {
            let (mut stream, address) = match self.listener.accept() {
                Ok(came) => came,
                Err(error) if is_of_one_client(&error) => continue,
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(error) => return Err(error),
            };
            stream.set_nonblocking(true)?;
            // Bytes that came while this program stood still may be as old as its delay.
            if behind > MAX_DELAY {
                drain(&mut stream, &mut self.unheard);
            }
            self.coming.push(SecondClient {
                stream,
                address,
                since: now,
                answered: false,
            });
        }
        Ok(())
    }

    fn take_first(&mut self, now: Instant, accepted: u64) -> bool {
        let Some(place) = self.coming.iter().position(|waiting| !waiting.answered) else {
            return false;
        };
        let first = self.coming.remove(place);
        // An option that cannot be set on a broken connection is no error: the next read shows the break.
        let _ = first.stream.set_nodelay(true);
        let keepalive = TcpKeepalive::new()
            .with_time(PROBED_AFTER)
            .with_interval(PROBED_AFTER);
        let _ = SockRef::from(&first.stream).set_tcp_keepalive(&keepalive);
        self.client = Some(Client {
            stream: first.stream,
            address: first.address,
            since: now,
            accepted,
            heard_at: now,
        });
        true
    }

    /// Tells those who came while another has the unit, and lets them go when they close.
    fn turn_away(&mut self, now: Instant) {
        let unheard = &mut self.unheard;
        let client = self.client.as_ref();
        self.coming.retain_mut(|waiting| {
            let waited = now.since(waiting.since);
            if let Some(client) = client.filter(|_| !waiting.answered && waited >= HANDS_OVER) {
                waiting.answered = true;
                let _ = waiting.stream.write(&client.taken(now));
                let _ = waiting.stream.shutdown(std::net::Shutdown::Write);
            }
            !waiting.answered
                || (waited < HANDS_OVER + LEAVES_WITHIN && drain(&mut waiting.stream, unheard))
        });
    }

    /// Reads what is there, 0 when there is nothing.
    pub fn read(&mut self, into: &mut [u8]) -> usize {
        let Some(client) = &mut self.client else {
            return 0;
        };
        match client.stream.read(into) {
            Ok(count @ 1..) => return count,
            Err(error) if is_nothing(&error) => {}
            Ok(_) | Err(_) => self.client = None,
        }
        0
    }

    /// Writes what fits.
    pub fn write(&mut self, bytes: &[u8]) {
        let Some(client) = &mut self.client else {
            return;
        };
        if client.stream.write(bytes).is_err_and(|e| !is_nothing(&e)) {
            self.client = None;
        }
    }
}

impl Client {
    /// Frame that tells another client who has the unit.
    fn taken(&self, now: Instant) -> Vec<u8> {
        let ip = match self.address.ip() {
            IpAddr::V4(ip) => ip.to_ipv6_mapped(),
            IpAddr::V6(ip) => ip,
        };
        let message = Taken {
            address: ip.octets(),
            port: self.address.port(),
            for_ms: now.since(self.since).as_ms() as u32,
            silent_ms: now.since(self.heard_at).as_ms() as u32,
        };
        let mut frame = Vec::new();
        Link::new(End::Unit).send(now, &message.into(), &mut frame);
        frame
    }
}

/// Reads and discards what has come, in a limited number of reads; false when the other end has closed.
fn drain(stream: &mut TcpStream, into: &mut [u8]) -> bool {
    for _ in 0..64 {
        match stream.read(into) {
            Ok(0) => return false,
            Ok(_) => {}
            Err(error) => return is_nothing(&error),
        }
    }
    true
}

fn is_nothing(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

/// A connection that broke before it was taken is no reason to stop serving.
fn is_of_one_client(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::ConnectionAborted | ErrorKind::ConnectionReset | ErrorKind::Interrupted
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes that a server which is `behind` its time hears of a client that spoke before it was
    /// taken.
    fn heard(behind: Duration) -> usize {
        let (mut server, at) = Server::listen("127.0.0.1:0").unwrap();
        let mut client = TcpStream::connect(at).unwrap();
        client.write_all(b"spoken before").unwrap();
        assert!(server.attend(Instant::ZERO, behind, 0).unwrap());
        server.read(&mut [0; 64])
    }

    #[test]
    fn what_was_sent_while_the_program_stood_still_is_not_heard_as_fresh() {
        assert_eq!(heard(Duration::from_ms(1500)), 0);
        assert_eq!(heard(Duration::ZERO), 13);
    }
}
