//! Declared field layouts: one table gives the struct, its codec and its description.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;

use thiserror::Error;

/// Error in a payload, with its place for a person with a hex dump.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{message}: {kind} at offset {offset} (field {field})")]
pub struct DecodeError {
    /// Message or channel the payload was taken for.
    pub message: &'static str,
    /// Field being read.
    pub field: &'static str,
    /// Byte offset into the payload.
    pub offset: usize,
    /// Kind of error.
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
    /// Meaning of the field.
    pub doc: &'static str,
}

/// Description of a message, as in `WIRE.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MessageSpec {
    /// Name.
    pub name: &'static str,
    /// Channel it travels on.
    pub channel: super::Channel,
    /// First payload byte; from 0x80 on the unit is the sender, below it the receiver.
    pub code: u8,
    /// Purpose of the message.
    pub doc: &'static str,
    /// Fields after the code, in order.
    pub fields: &'static [FieldSpec],
}

impl MessageSpec {
    /// Bytes of the payload, code included.
    pub const fn payload_len(&self) -> usize {
        // `const`, so that the compiler checks that every message fits a frame.
        let (mut len, mut i) = (1, 0);
        while i < self.fields.len() {
            len += self.fields[i].size;
            i += 1;
        }
        len
    }

    /// Whether the unit sends the message.
    pub const fn sent_by_unit(&self) -> bool {
        self.code >= 0x80
    }
}

/// Description of an enumeration, as in `WIRE.md`: code, label and meaning of each value; or of a
/// set of bits: number, name and meaning of each bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WordSpec {
    /// Name of the type.
    pub name: &'static str,
    /// Meaning of the type.
    pub doc: &'static str,
    /// Values or bits of the type.
    pub entries: &'static [(u8, &'static str, &'static str)],
}

/// A message with a declared layout.
pub trait Layout: Sized {
    /// Name, channel, code and fields.
    const SPEC: MessageSpec;
    /// Appends code and fields.
    fn write(&self, out: &mut Vec<u8>);
    /// Reads a whole payload, code included.
    fn read(payload: &[u8]) -> Result<Self, DecodeError>;
    /// Each field's value as text, in order.
    fn show(&self) -> Vec<String>;
}

/// A reader of a payload, with its position.
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
    /// The value as people read it: a decimal number, a label, names of bits, text.
    fn show(&self) -> String;
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
            fn show(&self) -> String {
                self.to_string()
            }
        }
    )*};
}
integer_fields!(u8, i8, u16, i16, u32, i32, u64);

impl<const N: usize> Field for [u8; N] {
    const SIZE: usize = N;
    fn put(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(self);
    }
    fn get(cursor: &mut Cursor<'_>, name: &'static str) -> Result<Self, DecodeError> {
        cursor.take(name)
    }
    /// Text if it is ASCII filled up with 0, else hexadecimal digits; never empty.
    fn show(&self) -> String {
        let text_len = self.iter().position(|&byte| byte == 0).unwrap_or(N);
        let (text, fill) = self.split_at(text_len);
        let is_text = !text.is_empty() && text.iter().all(u8::is_ascii_graphic);
        if is_text && fill.iter().all(|&byte| byte == 0) {
            return text.iter().map(|&byte| char::from(byte)).collect();
        }
        self.iter().map(|byte| format!("{byte:02x}")).collect()
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
            const SPEC: $crate::message::MessageSpec = $crate::message::MessageSpec {
                name: stringify!($name),
                channel: $crate::message::Channel::$channel,
                code: $code,
                doc: concat!($($doc),+).trim_ascii(),
                fields: &[ $( $crate::message::FieldSpec {
                    name: stringify!($field),
                    ty: stringify!($ty),
                    size: <$ty as $crate::message::Field>::SIZE,
                    doc: concat!($($fdoc),+).trim_ascii(),
                } ),* ],
            };
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
            fn show(&self) -> alloc::vec::Vec<alloc::string::String> {
                alloc::vec![ $( $crate::message::Field::show(&self.$field) ),* ]
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
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
        #[serde(from = "u8", into = "u8")]
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
            /// Name, meaning, and number, label and meaning of each known value.
            pub const SPEC: $crate::message::WordSpec = $crate::message::WordSpec {
                name: stringify!($name),
                doc: concat!($($doc),+).trim_ascii(),
                entries: &[$( ($value, $label, concat!($($vdoc),+).trim_ascii()) ),*],
            };

            /// The value for a wire byte.
            pub const fn from_code(code: u8) -> Self {
                match code { $( $value => Self::$variant, )* other => Self::Unknown(other) }
            }
            /// The wire byte.
            pub const fn code(self) -> u8 {
                match self { $( Self::$variant => $value, )* Self::Unknown(other) => other }
            }
            /// Whether this version knows the value.
            pub const fn is_known(self) -> bool { !matches!(self, Self::Unknown(_)) }
            /// Label of the value.
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

        impl From<u8> for $name {
            fn from(code: u8) -> Self { Self::from_code(code) }
        }

        impl From<$name> for u8 {
            fn from(value: $name) -> Self { value.code() }
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
            fn show(&self) -> alloc::string::String {
                match self {
                    Self::Unknown(code) => alloc::format!("unknown_{code}"),
                    known => known.label().into(),
                }
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
            /// Number, name and meaning of each bit.
            pub const BITS: &'static [(u8, &'static str, &'static str)] = Self::SPEC.entries;
            /// Name, meaning and bits.
            pub const SPEC: $crate::message::WordSpec = $crate::message::WordSpec {
                name: stringify!($name),
                doc: concat!($($doc),+).trim_ascii(),
                entries: &[$( ($shift, stringify!($bit), concat!($($bdoc),+).trim_ascii()) ),*],
            };
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
            fn show(&self) -> alloc::string::String {
                $crate::message::layout::show_bits(self.bits(), Self::SPEC.entries)
            }
        }
    };
}
pub(super) use wire_bits;

/// Names of the bits set, joined by `|`; a bit without a name as `bit_N`; `0` for none.
pub(super) fn show_bits(bits: u16, entries: &[(u8, &str, &str)]) -> String {
    if bits == 0 {
        return "0".into();
    }
    let name = |bit: u8| {
        let known = entries.iter().find(|entry| entry.0 == bit);
        known.map_or_else(|| format!("bit_{bit}"), |entry| entry.1.to_string())
    };
    let set: Vec<String> = (0..16)
        .filter(|bit| bits & 1 << bit != 0)
        .map(name)
        .collect();
    set.join("|")
}
