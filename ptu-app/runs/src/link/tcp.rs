//! TCP connection to a unit or an instrument.

use std::io;
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

/// A connection to the first of these addresses at which somebody listens: a unit at 127.0.0.1 is at `localhost`, whose
/// first address may be another.
pub(crate) fn connect_to(
    addresses: impl Iterator<Item = SocketAddr>,
    within: Duration,
) -> io::Result<TcpStream> {
    let mut tried = Err(io::Error::other("the name has no address"));
    for address in addresses {
        tried = TcpStream::connect_timeout(&address, within);
        if tried.is_ok() {
            break;
        }
    }
    tried
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;

    use super::*;

    #[test]
    fn a_unit_is_found_at_any_address_of_its_name() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let unit = listener.local_addr().expect("bound");
        // A port that no test is given.
        let closed = SocketAddr::from(([127, 0, 0, 1], 1));
        for addresses in [&[unit][..], &[closed, unit], &[unit, closed]] {
            let stream = connect_to(addresses.iter().copied(), Duration::from_secs(3))
                .expect("there is a unit");
            assert_eq!(stream.peer_addr().expect("connected"), unit);
        }
        for nobody in [&[][..], &[closed]] {
            connect_to(nobody.iter().copied(), Duration::from_secs(3)).expect_err("nobody listens");
        }
    }
}
