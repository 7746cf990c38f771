//! The byte stream of a connection: TLS as the address demands, and a limit on the length of each message
//! from the server. Without the limit the client would buffer as much as a server announces.

use std::error::Error;
use std::future::Future;
use std::io;
use std::pin::Pin;
use std::task::{Context, Poll, ready};

use postgres::Socket;
use postgres::tls::{ChannelBinding, MakeTlsConnect, TlsConnect, TlsStream};
use tokio::io::{AsyncRead, AsyncReadExt as _, AsyncWrite, AsyncWriteExt as _, ReadBuf};
use tokio_postgres_rustls::MakeRustlsConnect;

use super::address::Guard;
use crate::error::NO_TLS;

/// Most bytes of all messages that the client keeps while it is connected: what comes before authentication is complete,
/// and later the server's settings and notifications.
const MOST_KEPT: u32 = 1 << 20;
/// Longest other message, bytes: a row may hold all samples of a trace.
const MOST: u32 = 64 << 20;

/// PostgreSQL's SSLRequest message.
const TLS_REQUEST: [u8; 8] = [0, 0, 0, 8, 0x04, 0xd2, 0x16, 0x2f];
/// The server's answer that it speaks TLS.
const TLS_YES: u8 = b'S';

type Failed = Box<dyn Error + Sync + Send>;
type Tls = <MakeRustlsConnect as MakeTlsConnect<Socket>>::Stream;

/// Opens streams. It negotiates TLS itself, so that plain streams are bounded, too; the client takes every
/// stream for one with TLS.
#[derive(Clone)]
pub(super) struct BoundedConnector {
    pub tls: MakeRustlsConnect,
    pub guard: Guard,
    pub host: String,
}

impl MakeTlsConnect<Socket> for BoundedConnector {
    type Stream = BoundedStream;
    type TlsConnect = Self;
    type Error = Failed;

    fn make_tls_connect(&mut self, _: &str) -> Result<Self, Failed> {
        Ok(self.clone())
    }
}

impl TlsConnect<Socket> for BoundedConnector {
    type Stream = BoundedStream;
    type Error = Failed;
    type Future = Pin<Box<dyn Future<Output = Result<BoundedStream, Failed>> + Send>>;

    fn connect(mut self, mut socket: Socket) -> Self::Future {
        Box::pin(async move {
            let mut answer = [0];
            if self.guard != Guard::Disable {
                socket.write_all(&TLS_REQUEST).await?;
                socket.read_exact(&mut answer).await?;
            }
            let way = match self.guard {
                _ if answer == [TLS_YES] => {
                    let tls =
                        MakeTlsConnect::<Socket>::make_tls_connect(&mut self.tls, &self.host)?;
                    Way::Tls(Box::new(tls.connect(socket).await?))
                }
                Guard::Disable | Guard::Prefer => Way::Clear(socket),
                Guard::Verify => return Err(NO_TLS.into()),
            };
            let lengths = Lengths::default();
            Ok(BoundedStream { way, lengths })
        })
    }
}

/// With or without TLS.
enum Way {
    Clear(Socket),
    Tls(Box<Tls>),
}

/// A stream that checks the length of incoming messages.
pub(super) struct BoundedStream {
    way: Way,
    lengths: Lengths,
}

impl BoundedStream {
    fn writer(self: Pin<&mut Self>) -> Pin<&mut (dyn AsyncWrite + Unpin)> {
        Pin::new(match &mut self.get_mut().way {
            Way::Clear(stream) => stream,
            Way::Tls(stream) => stream,
        })
    }
}

impl TlsStream for BoundedStream {
    fn channel_binding(&self) -> ChannelBinding {
        match &self.way {
            Way::Clear(_) => ChannelBinding::none(),
            Way::Tls(stream) => stream.channel_binding(),
        }
    }
}

impl AsyncRead for BoundedStream {
    fn poll_read(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let Self { way, lengths } = self.get_mut();
        let before = into.filled().len();
        ready!(match way {
            Way::Clear(stream) => Pin::new(stream).poll_read(context, into),
            Way::Tls(stream) => Pin::new(stream).poll_read(context, into),
        })?;
        Poll::Ready(lengths.take(&into.filled()[before..]))
    }
}

impl AsyncWrite for BoundedStream {
    fn poll_write(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        self.writer().poll_write(context, bytes)
    }

    fn poll_flush(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.writer().poll_flush(context)
    }

    fn poll_shutdown(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.writer().poll_shutdown(context)
    }
}

/// Follows the messages of the stream: a type byte, four bytes of length (including themselves), the content.
#[derive(Default)]
struct Lengths {
    head: [u8; 5],
    /// Bytes of the header read so far.
    known: usize,
    /// Bytes of the message still to come.
    rest: usize,
    /// Whether the server has reported ReadyForQuery.
    is_in: bool,
    /// Bytes of the messages that the client keeps.
    kept: u32,
}

/// The type of ReadyForQuery, sent after authentication and after each result.
const READY: u8 = b'Z';
/// The type of ParameterStatus, a setting of the server.
const SETTING: u8 = b'S';
/// The type of NotificationResponse.
const NOTIFICATION: u8 = b'A';

impl Lengths {
    fn take(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        while !bytes.is_empty() {
            if self.rest > 0 {
                let skipped = self.rest.min(bytes.len());
                self.rest -= skipped;
                bytes = &bytes[skipped..];
                continue;
            }
            self.head[self.known] = bytes[0];
            bytes = &bytes[1..];
            self.known += 1;
            if self.known == self.head.len() {
                self.known = 0;
                self.begin()?;
            }
        }
        Ok(())
    }

    fn begin(&mut self) -> io::Result<()> {
        let [letter, length @ ..] = self.head;
        let length = u32::from_be_bytes(length);
        self.is_in |= letter == READY;
        let is_kept = !self.is_in || matches!(letter, SETTING | NOTIFICATION);
        let most = if is_kept { MOST_KEPT - self.kept } else { MOST };
        if !(4..=most).contains(&length) {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                format!(
                    "it announces a message of {length} bytes where at most {most} are expected; it is no server of ours"
                ),
            ));
        }
        if is_kept {
            self.kept += length;
        }
        self.rest = length as usize - 4;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(letter: u8, length: u32) -> Vec<u8> {
        let mut bytes = vec![letter];
        bytes.extend(length.to_be_bytes());
        bytes.resize(1 + length.clamp(4, 1000) as usize, 0);
        bytes
    }

    /// Goal: every message passes, byte by byte and in uneven pieces.
    #[test]
    fn messages_are_bounded_wherever_they_are_cut() {
        let greeting = [message(b'R', 8), message(b'S', 30), message(READY, 5)].concat();
        let good = [greeting.clone(), message(b'D', 900), message(READY, 5)].concat();
        let long = [greeting.clone(), message(b'D', MOST + 1)].concat();
        let early = message(b'R', MOST_KEPT + 1);
        let settings = [greeting.clone(), message(SETTING, 1000).repeat(1100)].concat();
        let short = [greeting, message(b'D', 3)].concat();
        for piece in [1, 2, 3, 7, 4096] {
            let taken = |bytes: &[u8]| {
                let mut lengths = Lengths::default();
                bytes.chunks(piece).try_for_each(|some| lengths.take(some))
            };
            assert!(taken(&good).is_ok(), "{piece}");
            for bad in [&long, &early, &settings, &short, &message(b'R', u32::MAX)] {
                let refused = taken(bad).expect_err("bounded").to_string();
                assert!(refused.contains("it announces a message of"), "{refused}");
            }
        }
    }
}
