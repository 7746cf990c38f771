//! A proxy between `ptu` and a served unit, which changes what passes.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};

use protocol::frame::{self, Decoder, Header};
use protocol::message::{Channel, Message};

use super::served::Unit;

/// Takes one client and does this with it on a thread of its own.
pub fn peer(act: impl FnOnce(TcpStream) + Send + 'static) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = listener.local_addr().expect("its address");
    std::thread::spawn(move || {
        let (stream, _) = listener.accept().expect("a client");
        act(stream);
    });
    address
}

/// Change of the bytes in one direction of a proxy.
pub type Change = Box<dyn FnMut(&[u8]) -> Vec<u8> + Send>;

/// Stands between `ptu` and a served unit for one client; gives what `--unit` takes.
pub fn proxy(unit: &Unit, mut to_unit: Change, mut from_unit: Change) -> String {
    let port = unit.port.clone();
    let address = peer(move |client| {
        let unit = TcpStream::connect(port).expect("the unit");
        let pass = |mut from: TcpStream, mut to: TcpStream, change: &mut Change| {
            let mut chunk = [0; 4096];
            while let Ok(count @ 1..) = from.read(&mut chunk) {
                if to.write_all(&change(&chunk[..count])).is_err() {
                    break;
                }
            }
            let _ = to.shutdown(std::net::Shutdown::Both);
        };
        let ends = |stream: &TcpStream| stream.try_clone().expect("a clone");
        std::thread::scope(|scope| {
            let (client_in, unit_out) = (ends(&client), ends(&unit));
            scope.spawn(|| pass(client_in, unit_out, &mut to_unit));
            pass(ends(&unit), ends(&client), &mut from_unit);
        });
    });
    format!("tcp:{address}")
}

pub fn unchanged() -> Change {
    Box::new(<[u8]>::to_vec)
}

/// Changes whole frames of a channel: what is pushed goes on in the place of each, with sequence numbers that leave no
/// gap.
pub fn frames(
    channel: Channel,
    mut change: impl FnMut(Message, &mut Vec<Message>) + Send + 'static,
) -> Change {
    let (mut decoder, mut next_seq) = (Decoder::new(), 0_u16);
    let mut payload_out = Vec::new();
    Box::new(move |bytes| {
        let mut out = Vec::new();
        decoder.push(bytes);
        while let Some(frame) = decoder.next_frame() {
            let Ok((header, payload)) = frame else {
                continue;
            };
            let message = Message::decode(header.channel, payload).expect("a message");
            if header.channel != channel {
                frame::encode(&header, payload, &mut out);
                continue;
            }
            let mut messages = Vec::new();
            change(message, &mut messages);
            for message in messages {
                payload_out.clear();
                message.encode(&mut payload_out);
                let header = Header {
                    seq: next_seq,
                    ..header
                };
                next_seq = next_seq.wrapping_add(1);
                frame::encode(&header, &payload_out, &mut out);
            }
        }
        out
    })
}
