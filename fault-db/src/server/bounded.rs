//! The byte stream of a connection: TLS as the address demands, and a limit on the length of each message
//! from the server. Without the limit the client would buffer as much as a server announces.

use std::error::Error;
use std::future::Future;
use std::io;
use std::pin::Pin;
use std::task::{Context, Poll, ready};

use postgres::tls::{ChannelBinding, MakeTlsConnect, TlsConnect, TlsStream};
use tokio::io::{AsyncRead, AsyncReadExt as _, AsyncWrite, AsyncWriteExt as _, ReadBuf};
use tokio_postgres_rustls::MakeRustlsConnect;

use crate::error::NO_TLS;

/// Longest message before authentication is complete, bytes.
const MOST_BEFORE: u32 = 64 << 10;
/// Longest message after it, bytes: a row may hold all samples of a trace.
const MOST: u32 = 64 << 20;

/// PostgreSQL's SSLRequest message.
const TLS_REQUEST: [u8; 8] = [0, 0, 0, 8, 0x04, 0xd2, 0x16, 0x2f];
/// The server's answer that it speaks TLS.
const TLS_YES: u8 = b'S';

type Failed = Box<dyn Error + Sync + Send>;

/// Opens streams. It negotiates TLS itself, so that plain streams are bounded, too; the client takes every
/// stream for one with TLS.
pub(super) struct BoundedConnector {
    pub tls: Option<MakeRustlsConnect>,
    /// Whether an unencrypted connection is allowed if the server has no TLS.
    pub or_clear: bool,
}

/// Opens one stream.
pub(super) struct Connecting<S>
where
    MakeRustlsConnect: MakeTlsConnect<S>,
{
    tls: Option<<MakeRustlsConnect as MakeTlsConnect<S>>::TlsConnect>,
    or_clear: bool,
}

impl<S> MakeTlsConnect<S> for BoundedConnector
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
    <MakeRustlsConnect as MakeTlsConnect<S>>::TlsConnect: Send + 'static,
    <<MakeRustlsConnect as MakeTlsConnect<S>>::TlsConnect as TlsConnect<S>>::Future: Send,
{
    type Stream = BoundedStream<S>;
    type TlsConnect = Connecting<S>;
    type Error = Failed;

    fn make_tls_connect(&mut self, domain: &str) -> Result<Self::TlsConnect, Failed> {
        let tls = self
            .tls
            .as_mut()
            .map(|tls| <MakeRustlsConnect as MakeTlsConnect<S>>::make_tls_connect(tls, domain));
        Ok(Connecting {
            tls: tls.transpose().map_err(Into::<Failed>::into)?,
            or_clear: self.or_clear,
        })
    }
}

impl<S> TlsConnect<S> for Connecting<S>
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
    <MakeRustlsConnect as MakeTlsConnect<S>>::TlsConnect: Send + 'static,
    <<MakeRustlsConnect as MakeTlsConnect<S>>::TlsConnect as TlsConnect<S>>::Future: Send,
{
    type Stream = BoundedStream<S>;
    type Error = Failed;
    type Future = Pin<Box<dyn Future<Output = Result<BoundedStream<S>, Failed>> + Send>>;

    fn connect(self, mut stream: S) -> Self::Future {
        Box::pin(async move {
            let Some(tls) = self.tls else {
                return Ok(BoundedStream::new(MaybeTls::Clear(stream)));
            };
            stream.write_all(&TLS_REQUEST).await?;
            let mut answer = [0];
            stream.read_exact(&mut answer).await?;
            if answer == [TLS_YES] {
                let stream = tls.connect(stream).await.map_err(Into::<Failed>::into)?;
                return Ok(BoundedStream::new(MaybeTls::Tls(Box::new(stream))));
            }
            match self.or_clear {
                true => Ok(BoundedStream::new(MaybeTls::Clear(stream))),
                false => Err(NO_TLS.into()),
            }
        })
    }
}

type Tls<S> = <MakeRustlsConnect as MakeTlsConnect<S>>::Stream;

/// With or without TLS.
enum MaybeTls<S>
where
    MakeRustlsConnect: MakeTlsConnect<S>,
{
    Clear(S),
    Tls(Box<Tls<S>>),
}

/// A stream that checks the length of incoming messages.
pub(super) struct BoundedStream<S>
where
    MakeRustlsConnect: MakeTlsConnect<S>,
{
    way: MaybeTls<S>,
    lengths: Lengths,
}

impl<S> BoundedStream<S>
where
    MakeRustlsConnect: MakeTlsConnect<S>,
{
    fn new(way: MaybeTls<S>) -> Self {
        Self {
            way,
            lengths: Lengths::default(),
        }
    }
}

impl<S> TlsStream for BoundedStream<S>
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    fn channel_binding(&self) -> ChannelBinding {
        match &self.way {
            MaybeTls::Clear(_) => ChannelBinding::none(),
            MaybeTls::Tls(stream) => stream.channel_binding(),
        }
    }
}

impl<S> AsyncRead for BoundedStream<S>
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    fn poll_read(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let Self { way, lengths } = self.get_mut();
        let before = into.filled().len();
        ready!(match way {
            MaybeTls::Clear(stream) => Pin::new(stream).poll_read(context, into),
            MaybeTls::Tls(stream) => Pin::new(&mut **stream).poll_read(context, into),
        })?;
        Poll::Ready(lengths.take(&into.filled()[before..]))
    }
}

impl<S> AsyncWrite for BoundedStream<S>
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    fn poll_write(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        match &mut self.get_mut().way {
            MaybeTls::Clear(stream) => Pin::new(stream).poll_write(context, bytes),
            MaybeTls::Tls(stream) => Pin::new(&mut **stream).poll_write(context, bytes),
        }
    }

    fn poll_flush(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        match &mut self.get_mut().way {
            MaybeTls::Clear(stream) => Pin::new(stream).poll_flush(context),
            MaybeTls::Tls(stream) => Pin::new(&mut **stream).poll_flush(context),
        }
    }

    fn poll_shutdown(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        match &mut self.get_mut().way {
            MaybeTls::Clear(stream) => Pin::new(stream).poll_shutdown(context),
            MaybeTls::Tls(stream) => Pin::new(&mut **stream).poll_shutdown(context),
        }
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
}

/// The type of ReadyForQuery, sent after authentication and after each result.
const READY: u8 = b'Z';

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
        let most = if self.is_in { MOST } else { MOST_BEFORE };
        if !(4..=most).contains(&length) {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                format!(
                    "it announces a message of {length} bytes, which no history has; it is no server of ours"
                ),
            ));
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
        let early = message(b'R', MOST_BEFORE + 1);
        let short = [greeting, message(b'D', 3)].concat();
        for piece in [1, 2, 3, 7, 4096] {
            let taken = |bytes: &[u8]| {
                let mut lengths = Lengths::default();
                bytes.chunks(piece).try_for_each(|some| lengths.take(some))
            };
            assert!(taken(&good).is_ok(), "{piece}");
            for bad in [&long, &early, &short, &message(b'R', u32::MAX)] {
                let refused = taken(bad).expect_err("bounded").to_string();
                assert!(refused.contains("it announces a message of"), "{refused}");
            }
        }
    }
}
