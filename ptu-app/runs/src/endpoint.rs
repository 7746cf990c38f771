//! Where a unit is.

/// Where a unit is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Endpoint {
    /// The embedded unit.
    Sim,
    /// A serial port.
    Serial {
        path: String,
        /// Baud rate.
        baud: u32,
    },
    /// A TCP socket, `HOST:PORT`.
    Tcp(String),
    /// A pseudo-terminal whose unit scans once for each scan of the bench, however fast that is.
    LockStep(String),
}

impl std::fmt::Display for Endpoint {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Sim => f.write_str("sim"),
            Self::Serial { path, baud } => write!(f, "serial:{path}@{baud}"),
            Self::Tcp(address) => write!(f, "tcp:{address}"),
            Self::LockStep(path) => write!(f, "lockstep:{path}"),
        }
    }
}
