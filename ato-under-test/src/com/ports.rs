//! The unit's ports: the harness, which carries all channels, the maintenance port, a technician's RS-232 connector on a
//! train, which carries the maintenance channel alone [S2 §2.2], and the loop that the TWC antenna hears.

use alloc::vec::Vec;

use protocol::Instant;
use protocol::link::{End, Link, Received};
use protocol::message::{Channel, Message};

/// A port, in the order of the links in `Ports`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    /// To I/O, TCMS and wayside, and to a tester that plays them.
    Harness,
    /// To a tester alone: frames of any other channel than [`Channel::Ptu`] are rejected here, so that no
    /// laptop can play the train.
    Maintenance,
    /// The loop in the track, of which the TWC antenna hears samples: it carries TWC alone, and nothing is sent there.
    Loop,
}

/// A link on each port.
#[derive(Debug)]
pub struct Ports {
    /// By number of the [`Port`].
    links: [Link; 3],
    /// Port at which a tester was heard last, and at which it is answered.
    pub tester_at: Port,
    /// Bytes to be sent on the maintenance port.
    to_maintenance: Vec<u8>,
}

impl Ports {
    /// Ports on which nothing was received.
    pub fn new() -> Self {
        Self {
            links: [
                Link::new(End::Unit),
                Link::with_channels(End::Unit, &[Channel::Ptu]),
                Link::with_channels(End::Unit, &[Channel::Twc]),
            ],
            tester_at: Port::Harness,
            to_maintenance: Vec::new(),
        }
    }

    pub fn link(&self, port: Port) -> &Link {
        &self.links[port as usize]
    }

    /// The link on a port, to be given bytes.
    pub fn link_mut(&mut self, port: Port) -> &mut Link {
        &mut self.links[port as usize]
    }

    /// The next accepted frame: those of the harness first.
    pub fn poll(&mut self, now: Instant) -> Option<(Port, Received)> {
        [Port::Harness, Port::Loop, Port::Maintenance]
            .into_iter()
            .find_map(|port| Some((port, self.link_mut(port).poll(now)?)))
    }

    /// Sends to the partner of the message's channel; frames for the harness are appended to `out`.
    pub fn send(&mut self, now: Instant, message: &Message, out: &mut Vec<u8>) {
        if message.channel() == Channel::Ptu && self.tester_at == Port::Maintenance {
            let link = &mut self.links[Port::Maintenance as usize];
            link.send(now, message, &mut self.to_maintenance);
        } else {
            self.link_mut(Port::Harness).send(now, message, out);
        }
    }

    /// Begins a scan: frames of the last scan that nobody took are lost, as on a line without a listener.
    pub fn begin_scan(&mut self) {
        self.to_maintenance.clear();
    }

    /// Appends what this scan sent on the maintenance port.
    pub fn take_maintenance(&mut self, out: &mut Vec<u8>) {
        out.append(&mut self.to_maintenance);
    }

    /// Frames rejected on all ports, for any reason.
    pub fn rejected_total(&self) -> u64 {
        let links = self.links.iter();
        links.map(|link| link.counters().rejected_total()).sum()
    }

    /// Frames rejected on a channel, on all ports.
    pub fn rejected_on(&self, channel: Channel) -> u64 {
        let links = self.links.iter();
        links.map(|link| link.counters().rejected_on(channel)).sum()
    }
}
