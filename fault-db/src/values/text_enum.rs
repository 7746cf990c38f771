//! Enums whose variants are stored and shown as one fixed word each.

/// Declares an enum whose variants are words in the database, in JSON and on the command line.
macro_rules! text_enum {
    ($(#[$meta:meta])* $name:ident { $($(#[$vmeta:meta])* $variant:ident = $text:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum $name { $($(#[$vmeta])* $variant,)+ }

        impl $name {
            /// Every value, in order.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)+];

            /// Word of the value in the database.
            pub fn as_str(self) -> &'static str {
                match self { $(Self::$variant => $text,)+ }
            }
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.as_str())
            }
        }

        impl std::str::FromStr for $name {
            type Err = crate::values::text_enum::UnknownWord;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                Self::ALL.iter().copied().find(|value| value.as_str() == text).ok_or_else(|| {
                    crate::values::text_enum::UnknownWord {
                        asked: text.to_owned(),
                        known: Self::ALL.iter().map(|value| value.as_str()).collect(),
                    }
                })
            }
        }

        impl serde::Serialize for $name {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.as_str())
            }
        }

        impl crate::backend::FromField<'_> for $name {
            fn from_field(field: crate::backend::Field<'_>) -> Result<Self, String> {
                let word = <&str as crate::backend::FromField>::from_field(field)?;
                word.parse().map_err(|error: crate::values::text_enum::UnknownWord| error.to_string())
            }
        }

        impl From<$name> for crate::backend::Value<'_> {
            fn from(value: $name) -> Self {
                value.as_str().into()
            }
        }
    };
}

pub(crate) use text_enum;

/// A text is none of the words of an enum.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown word {asked:?}; one of {} is expected", .known.join(", "))]
pub struct UnknownWord {
    /// The text.
    pub asked: String,
    /// The words of the enum.
    pub known: Vec<&'static str>,
}
