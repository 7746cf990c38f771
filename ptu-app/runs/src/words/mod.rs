//! Refusals and failures in both languages: data, and one table of sentences for each area.
//!
//! A row is `Name(what: Type): "English" ["; what helps at a command line" "; the same in a window"], "한국어" […];`. What stands
//! in brackets ends the sentence; without a second text a window says nothing there. `ptu_report::words` chooses the language.

mod asked;
mod damage;
mod link;
mod near;
mod nouns;
mod refused;
mod store;
mod warned;

pub use asked::{Asked, DriveTrouble, KeepTrouble, SoundTrouble};
pub use link::korean as link_korean;
pub use near::{Near, did_you_mean, did_you_mean_number};
pub use nouns::{event_kind, fault_state, noun};
pub use refused::{
    BrokenOff, DiagnosisTrouble, EndpointError, FieldTrouble, FileTrouble, KeyTrouble, NoUnit,
    RecordTrouble, RunTrouble, Sought, Unheard, Unknown, Why, WrongCell,
};
pub use store::{in_place_of, store_message};
pub use warned::{BenchNote, Differs, Warning};

use fault_db::Id;

/// Language and extent of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextStyle {
    /// Korean instead of English.
    pub korean: bool,
    /// The text names commands and options that help.
    pub commands: bool,
}

impl TextStyle {
    /// Style of a text that no window shows.
    pub const COMMAND_LINE: Self = Self {
        korean: false,
        commands: true,
    };

    /// The text of the language.
    pub fn choose<T>(self, [english, korean]: [T; 2]) -> T {
        match self.korean {
            true => korean,
            false => english,
        }
    }
}

/// A value that stands in a sentence: a name, a number, or a sentence of its own.
pub trait Say {
    /// Text of the value in this language, with or without commands.
    fn say(&self, how: TextStyle) -> String;
}

macro_rules! as_it_is {
    ($($kind:ty),*) => { $(
        impl Say for $kind {
            fn say(&self, _: TextStyle) -> String {
                self.to_string()
            }
        }
    )* };
}
as_it_is!(
    String,
    u16,
    u32,
    u64,
    usize,
    i64,
    f64,
    protocol::Duration,
    crate::endpoint::Endpoint
);

/// A word of this program, which has a translation; a `String` comes from elsewhere.
impl Say for &'static str {
    fn say(&self, how: TextStyle) -> String {
        how.choose([self, noun(self)]).to_owned()
    }
}

impl Say for Id {
    fn say(&self, _: TextStyle) -> String {
        self.short().to_string()
    }
}

impl Say for Near {
    fn say(&self, how: TextStyle) -> String {
        how.choose([format!("{self}"), format!("{self:#}")])
    }
}

/// Addition to a sentence: the unit of a thing, if one was named.
#[derive(Clone, Debug, PartialEq)]
pub struct OfUnit(pub Option<String>);

impl Say for OfUnit {
    fn say(&self, how: TextStyle) -> String {
        self.0.as_ref().map_or_else(String::new, |unit| {
            how.choose([format!(" of unit {unit}"), format!(" (장치 {unit})")])
        })
    }
}

impl Say for btu_rig::rig::LinkTrouble {
    fn say(&self, how: TextStyle) -> String {
        how.choose([self.to_string(), link_korean(self)])
    }
}

/// Declares the refusals of an area, with their sentences.
macro_rules! sentences {
    ($($(#[$doc:meta])* $area:ident { $(
        $name:ident $(($($part:ident: $kind:ty),*))?:
        $english:literal $([$tail:literal $($plain:literal)?])?,
        $korean:literal $([$tail_ko:literal $($plain_ko:literal)?])?;
    )* })*) => {
        $(
            $(#[$doc])*
            #[allow(rustdoc::broken_intra_doc_links, reason = "brackets of a sentence are no link")]
            #[derive(Clone, Debug, PartialEq)]
            pub enum $area { $(#[doc = concat!($english $(, $tail)?)] $name $(($($kind),*))?,)* }

            impl $crate::words::Say for $area {
                fn say(&self, how: $crate::words::TextStyle) -> String {
                    match self { $(
                        Self::$name $(($($part),*))? => {
                            $($(let $part = $crate::words::Say::say($part, how);)*)?
                            let _ = ($($(&$part,)*)?);
                            match (how.korean, how.commands) {
                                (false, true) => [format!($english), String::new() $(+ &format!($tail))?].concat(),
                                (false, false) => [format!($english), String::new() $($(+ &format!($plain))?)?].concat(),
                                (true, true) => [format!($korean), String::new() $(+ &format!($tail_ko))?].concat(),
                                (true, false) => [format!($korean), String::new() $($(+ &format!($plain_ko))?)?].concat(),
                            }
                        }
                    )* }
                }
            }

            impl std::fmt::Display for $area {
                fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                    f.write_str(&$crate::words::Say::say(self, $crate::words::TextStyle::COMMAND_LINE))
                }
            }

            impl std::error::Error for $area {}
        )*

        /// All sentences: name, English and Korean, with all that can end them.
        pub(super) const ALL: &[[&str; 3]] = &[$($([
            stringify!($name),
            concat!($english $(, "[", $tail $(, "|", $plain)?, "]")?),
            concat!($korean $(, "[", $tail_ko $(, "|", $plain_ko)?, "]")?),
        ],)*)*];
    };
}
use sentences;

/// Gives all areas of refusals to a macro.
macro_rules! with_areas {
    ($macro:ident) => {
        $macro!(
            Asked,
            DiagnosisTrouble,
            DriveTrouble,
            EndpointError,
            FieldTrouble,
            FileTrouble,
            KeepTrouble,
            KeyTrouble,
            NoUnit,
            RecordTrouble,
            RunTrouble,
            SoundTrouble,
            Unknown,
            Warning
        );
    };
}
pub(crate) use with_areas;

/// Makes one type of all areas.
macro_rules! areas {
    ($($area:ident),*) => {
        /// Refusals, by area.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Refusal { $(#[doc = stringify!($area)] $area($area),)* }

        impl Say for Refusal {
            fn say(&self, how: TextStyle) -> String {
                match self { $(Self::$area(of) => of.say(how),)* }
            }
        }
    };
}
with_areas!(areas);

/// All sentences, for tests of their wording: name, English and Korean.
pub fn all() -> impl Iterator<Item = [&'static str; 3]> {
    [asked::ALL, refused::ALL, warned::ALL].concat().into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: what helps at a command line is said there in both languages, and a window says nothing of it. Method: each
    /// sentence with a command or an option, by its parts.
    #[test]
    fn commands_stand_where_a_window_does_not_say_them() {
        for [name, english, korean] in all() {
            for text in [english, korean] {
                let (said, end) = text.split_once('[').unwrap_or((text, ""));
                let plain = end.split_once('|').map_or("", |(_, plain)| plain);
                let is_option = |text: &str| text.contains("`ptu ") || text.contains("--");
                // The command line alone refuses them.
                let is_asked = asked::ALL.iter().any(|[other, ..]| *other == name);
                assert!(
                    is_asked || !is_option(said) && !is_option(plain),
                    "{name}: {text}"
                );
            }
            let options = |text: &str| -> Vec<String> {
                let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
                let mut words: Vec<_> = words
                    .filter(|word| word.starts_with("--"))
                    .map(str::to_owned)
                    .collect();
                words.sort_unstable();
                words.dedup();
                words
            };
            assert_eq!(options(english), options(korean), "{name}");
        }
    }
}
