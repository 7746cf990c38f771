//! Declared field layouts: one table gives the struct, its codec and its description.

use alloc::vec::Vec;

use thiserror::Error;

/// What is wrong with a payload, said so that a person with a hex dump finds the place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{message}: {kind} at offset {offset} (field {field})")]
pub struct DecodeError {
    /// Message or channel the payload was taken for.
    pub message: &'static str,
    /// Field being read.
    pub field: &'static str,
    /// Byte offset into the payload.
    pub offset: usize,
    /// What went wrong there.
    pub kind: DecodeErrorKind,
}

/// Kinds of [`DecodeError`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum DecodeErrorKind {
    /// The payload ends inside a field.
    #[error("payload ends too early")]
    Truncated,
    /// Bytes are left after the last field.
    #[error("{0} bytes too many")]
    Trailing(usize),
    /// No message of this channel has this code.
    #[error("unknown message code 0x{0:02X}")]
    UnknownMessage(u8),
    /// No channel has this number.
    #[error("unknown channel {0}")]
    UnknownChannel(u8),
}

/// One field of a layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldSpec {
    /// Name, ending in its unit where it has one.
    pub name: &'static str,
    /// Type on the wire.
    pub ty: &'static str,
    /// Bytes it takes.
    pub size: usize,
    /// What it means.
    pub doc: &'static str,
}

/// A message with a declared layout.
pub trait Layout: Sized {
    /// Name as written in `WIRE.md`.
    const NAME: &'static str;
    /// Channel it travels on.
    const CHANNEL: super::Channel;
    /// First payload byte.
    const CODE: u8;
    /// Fields after the code, in order.
    const FIELDS: &'static [FieldSpec];
    /// Appends code and fields.
    fn write(&self, out: &mut Vec<u8>);
    /// Reads a whole payload, code included.
    fn read(payload: &[u8]) -> Result<Self, DecodeError>;
}

/// A reader over a payload that knows where it is.
pub struct Cursor<'a> {
    pub(super) payload: &'a [u8],
    pub(super) offset: usize,
    pub(super) message: &'static str,
}

impl Cursor<'_> {
    /// The next `N` bytes, or an error that names `field`.
    pub fn take<const N: usize>(&mut self, field: &'static str) -> Result<[u8; N], DecodeError> {
        let bytes = self
            .payload
            .get(self.offset..)
            .and_then(|rest| rest.first_chunk::<N>())
            .ok_or_else(|| self.error(field, DecodeErrorKind::Truncated))?;
        self.offset += N;
        Ok(*bytes)
    }

    /// Checks that nothing is left.
    pub fn finish(&self) -> Result<(), DecodeError> {
        match self.payload.len() - self.offset {
            0 => Ok(()),
            extra => Err(self.error("end", DecodeErrorKind::Trailing(extra))),
        }
    }

    fn error(&self, field: &'static str, kind: DecodeErrorKind) -> DecodeError {
        DecodeError {
            message: self.message,
            field,
            offset: self.offset,
            kind,
        }
    }
}

/// A type that can be a field: fixed size, big-endian.
pub trait Field: Sized {
    /// Bytes on the wire.
    const SIZE: usize;
    /// Appends the field.
    fn put(&self, out: &mut Vec<u8>);
    /// Reads the field called `name`.
    fn get(cursor: &mut Cursor<'_>, name: &'static str) -> Result<Self, DecodeError>;
}

macro_rules! integer_fields {
    ($($t:ty),*) => {$(
        impl Field for $t {
            const SIZE: usize = size_of::<$t>();
            fn put(&self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_be_bytes());
            }
            fn get(cursor: &mut Cursor<'_>, name: &'static str) -> Result<Self, DecodeError> {
                Ok(Self::from_be_bytes(cursor.take(name)?))
            }
        }
    )*};
}
integer_fields!(u8, i8, u16, i16, u32, i32);

impl<const N: usize> Field for [u8; N] {
    const SIZE: usize = N;
    fn put(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(self);
    }
    fn get(cursor: &mut Cursor<'_>, name: &'static str) -> Result<Self, DecodeError> {
        cursor.take(name)
    }
}

/// Declares a message: struct, codec and field table from one list.
macro_rules! layout {
    ($(#[doc = $doc:literal])+ $name:ident, $channel:ident, $code:literal {
        $( $(#[doc = $fdoc:literal])+ $field:ident : $ty:ty ),* $(,)?
    }) => {
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $name { $( $(#[doc = $fdoc])+ pub $field: $ty ),* }

        impl $crate::message::Layout for $name {
            const NAME: &'static str = stringify!($name);
            const CHANNEL: $crate::message::Channel = $crate::message::Channel::$channel;
            const CODE: u8 = $code;
            const FIELDS: &'static [$crate::message::FieldSpec] = &[
                $( $crate::message::FieldSpec {
                    name: stringify!($field),
                    ty: stringify!($ty),
                    size: <$ty as $crate::message::Field>::SIZE,
                    doc: concat!($($fdoc),+),
                } ),*
            ];
            fn write(&self, out: &mut alloc::vec::Vec<u8>) {
                out.push($code);
                $( $crate::message::Field::put(&self.$field, out); )*
            }
            fn read(payload: &[u8]) -> Result<Self, $crate::message::DecodeError> {
                #[allow(unused_mut)]
                let mut cursor = $crate::message::Cursor { payload, offset: 1, message: stringify!($name) };
                let message = Self {
                    $( $field: $crate::message::Field::get(&mut cursor, stringify!($field))? ),*
                };
                cursor.finish()?;
                Ok(message)
            }
        }
    };
}
pub(super) use layout;

/// Declares a one-byte enumeration that keeps unknown values and has a label for each known one.
macro_rules! wire_enum {
    ($(#[doc = $doc:literal])+ $name:ident {
        $( $(#[doc = $vdoc:literal])+ $variant:ident = $value:literal $label:literal ),* $(,)?
    }) => {
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum $name {
            $( $(#[doc = $vdoc])+ $variant, )*
            /// A value this version does not know: kept and shown, never acted on.
            Unknown(u8),
        }

        impl $name {
            /// Labels of the known values, in the order of their numbers from 0.
            pub const LABELS: &'static [&'static str] = &[$($label),*];
            /// Known values in the order of their numbers.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The value for a wire byte.
            pub const fn from_code(code: u8) -> Self {
                match code { $( $value => Self::$variant, )* other => Self::Unknown(other) }
            }
            /// The wire byte.
            pub const fn code(self) -> u8 {
                match self { $( Self::$variant => $value, )* Self::Unknown(other) => other }
            }
            /// The word for it.
            pub fn label(self) -> &'static str {
                match self { $( Self::$variant => $label, )* Self::Unknown(_) => "unknown" }
            }
            /// The value called `label`.
            pub fn from_label(label: &str) -> Option<Self> {
                match label { $( $label => Some(Self::$variant), )* _ => None }
            }
        }

        impl Default for $name {
            fn default() -> Self { Self::from_code(0) }
        }

        impl $crate::message::Field for $name {
            const SIZE: usize = 1;
            fn put(&self, out: &mut alloc::vec::Vec<u8>) { out.push(self.code()); }
            fn get(
                cursor: &mut $crate::message::Cursor<'_>,
                name: &'static str,
            ) -> Result<Self, $crate::message::DecodeError> {
                Ok(Self::from_code(cursor.take::<1>(name)?[0]))
            }
        }
    };
}
pub(super) use wire_enum;

/// Declares a set of bits in a `u16`; bits this version does not know are kept.
macro_rules! wire_bits {
    ($(#[doc = $doc:literal])+ $name:ident {
        $( $(#[doc = $bdoc:literal])+ $bit:ident = $shift:literal ),* $(,)?
    }) => {
        bitflags::bitflags! {
            $(#[doc = $doc])+
            #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
            pub struct $name: u16 { $( $(#[doc = $bdoc])+ const $bit = 1 << $shift; )* }
        }

        impl $name {
            /// Bit number, name and meaning of each bit.
            pub const BITS: &'static [(u8, &'static str, &'static str)] =
                &[$( ($shift, stringify!($bit), concat!($($bdoc),+)) ),*];
        }

        impl $crate::message::Field for $name {
            const SIZE: usize = 2;
            fn put(&self, out: &mut alloc::vec::Vec<u8>) {
                out.extend_from_slice(&self.bits().to_be_bytes());
            }
            fn get(
                cursor: &mut $crate::message::Cursor<'_>,
                name: &'static str,
            ) -> Result<Self, $crate::message::DecodeError> {
                Ok(Self::from_bits_retain(u16::from_be_bytes(cursor.take(name)?)))
            }
        }
    };
}
pub(super) use wire_bits;
