//! Parameter values of a query, and the conversion of result fields to Rust types.

use std::borrow::Cow;

use crate::id::Id;

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value<'a> {
    Null,
    Integer(i64),
    Real(f64),
    Text(Cow<'a, str>),
    Bytes(Cow<'a, [u8]>),
}

/// A field of a result, borrowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Field<'a> {
    Null,
    Integer(i64),
    Real(f64),
    Text(&'a str),
    Bytes(&'a [u8]),
}

/// `values![a, b]`: the parameters `?1`, `?2` of a query.
macro_rules! values {
    ($($value:expr),* $(,)?) => { [$($crate::backend::Value::from($value)),*] };
}
pub(crate) use values;

impl Value<'_> {
    /// The value as an id, if it is one.
    pub fn id(&self) -> Option<Id> {
        Id::from_field(self.field()).ok()
    }

    /// The value as a field, for comparison with stored rows.
    pub fn field(&self) -> Field<'_> {
        match self {
            Self::Null => Field::Null,
            Self::Integer(value) => Field::Integer(*value),
            Self::Real(value) => Field::Real(*value),
            Self::Text(text) => Field::Text(text),
            Self::Bytes(bytes) => Field::Bytes(bytes),
        }
    }
}

/// `of! { i64: value => Self::Integer(value); }` makes a [`Value`] from a Rust type.
macro_rules! of {
    ($($type:ty: $value:ident => $made:expr;)*) => {$(
        impl<'a> From<$type> for Value<'a> {
            fn from($value: $type) -> Self { $made }
        }
    )*};
}
of! {
    i64: value => Self::Integer(value);
    u32: value => Self::Integer(value.into());
    bool: value => Self::Integer(value.into());
    f64: value => Self::Real(value);
    &'a str: value => Self::Text(Cow::Borrowed(value));
    &'a String: value => Self::Text(Cow::Borrowed(value));
    String: value => Self::Text(Cow::Owned(value));
    &'a [u8]: value => Self::Bytes(Cow::Borrowed(value));
    Id: value => Self::Bytes(Cow::Owned(value.as_bytes().to_vec()));
}

impl<'a, T: Into<Value<'a>>> From<Option<T>> for Value<'a> {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Null, Into::into)
    }
}

/// Converts a field to a Rust type; the error says what the field is instead.
pub(crate) trait FromField<'a>: Sized {
    fn from_field(field: Field<'a>) -> Result<Self, String>;
}

impl Field<'_> {
    /// The value, owned.
    pub fn to_value(self) -> Value<'static> {
        match self {
            Self::Null => Value::Null,
            Self::Integer(value) => Value::Integer(value),
            Self::Real(value) => Value::Real(value),
            Self::Text(text) => Value::Text(Cow::Owned(text.to_owned())),
            Self::Bytes(bytes) => Value::Bytes(Cow::Owned(bytes.to_vec())),
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Self::Null => "nothing",
            Self::Integer(_) => "a whole number",
            Self::Real(_) => "a number",
            Self::Text(_) => "text",
            Self::Bytes(_) => "bytes",
        }
    }

    fn instead_of<T>(&self, wanted: &str) -> Result<T, String> {
        Err(format!("{} where {wanted} should be", self.kind()))
    }
}

impl FromField<'_> for i64 {
    fn from_field(field: Field<'_>) -> Result<Self, String> {
        match field {
            Field::Integer(value) => Ok(value),
            other => other.instead_of("a whole number"),
        }
    }
}

macro_rules! smaller_integer {
    ($($type:ty),*) => {$(
        impl FromField<'_> for $type {
            fn from_field(field: Field<'_>) -> Result<Self, String> {
                let value = i64::from_field(field)?;
                value.try_into().map_err(|_| format!("{value} is out of range"))
            }
        }
    )*};
}
smaller_integer!(u32, u64, usize, i32);

impl FromField<'_> for bool {
    fn from_field(field: Field<'_>) -> Result<Self, String> {
        Ok(i64::from_field(field)? != 0)
    }
}

impl FromField<'_> for f64 {
    fn from_field(field: Field<'_>) -> Result<Self, String> {
        match field {
            Field::Real(value) => Ok(value),
            Field::Integer(value) => Ok(value as f64),
            other => other.instead_of("a number"),
        }
    }
}

impl<'a> FromField<'a> for &'a str {
    fn from_field(field: Field<'a>) -> Result<Self, String> {
        match field {
            Field::Text(value) => Ok(value),
            other => other.instead_of("text"),
        }
    }
}

impl FromField<'_> for String {
    fn from_field(field: Field<'_>) -> Result<Self, String> {
        <&str>::from_field(field).map(str::to_owned)
    }
}

impl<'a> FromField<'a> for &'a [u8] {
    fn from_field(field: Field<'a>) -> Result<Self, String> {
        match field {
            Field::Bytes(value) => Ok(value),
            other => other.instead_of("bytes"),
        }
    }
}

impl FromField<'_> for Vec<u8> {
    fn from_field(field: Field<'_>) -> Result<Self, String> {
        <&[u8]>::from_field(field).map(<[u8]>::to_vec)
    }
}

impl FromField<'_> for Id {
    fn from_field(field: Field<'_>) -> Result<Self, String> {
        let bytes = <&[u8]>::from_field(field)?;
        let exact = bytes
            .try_into()
            .map_err(|_| format!("{} bytes where an id has 16", bytes.len()))?;
        Ok(Self::from_bytes(exact))
    }
}

impl<'a, T: FromField<'a>> FromField<'a> for Option<T> {
    fn from_field(field: Field<'a>) -> Result<Self, String> {
        match field {
            Field::Null => Ok(None),
            other => T::from_field(other).map(Some),
        }
    }
}
