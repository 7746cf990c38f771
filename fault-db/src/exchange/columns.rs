//! The columns of a change set: their types, or the parents that they name.

/// A column of a change set.
pub(super) struct Column {
    pub name: &'static str,
    pub kind: Kind,
    /// SQL: value of a derived column, from the row `t`.
    pub value: &'static str,
}

/// The type of a column, or the parent that it names.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Integer,
    Real,
    Text,
    Bytes,
    Unit,
    Run,
    Fault,
    ChannelSet,
    Trace,
}

impl Kind {
    /// The table of the parent, and the column that identifies the parent.
    pub fn parent(self) -> Option<(&'static str, &'static str)> {
        Some(match self {
            Self::Unit => ("unit", "serial"),
            Self::Run => ("run", "id"),
            Self::Fault => ("fault", "id"),
            Self::ChannelSet => ("channel_set", "sha256"),
            Self::Trace => ("trace", "id"),
            Self::Integer | Self::Real | Self::Text | Self::Bytes => return None,
        })
    }

    /// Name of the column's type on the server.
    pub fn server_type(self) -> &'static str {
        match self {
            Self::Integer => "bigint",
            Self::Real => "float8",
            Self::Text | Self::Unit => "text",
            Self::Bytes | Self::Run | Self::Fault | Self::ChannelSet | Self::Trace => "bytea",
        }
    }
}

/// `columns![id Bytes, line Text]`: the columns of a table.
macro_rules! columns {
    ($($name:ident $kind:ident),* $(,)?) => {
        &[$(Column { name: stringify!($name), kind: Kind::$kind, value: "" }),*]
    };
}

pub(super) use columns;
