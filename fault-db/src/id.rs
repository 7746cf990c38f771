//! 128-bit UUIDv7 identifiers (RFC 9562), made from a time and random bytes that the caller gives.

use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};
use sha2::{Digest as _, Sha256};
use uuid::{Builder, Uuid};

/// The id of a run, fault, occurrence, event or trace, the same in every file.
///
/// Stored as 16 bytes; shown as hyphenated lower-case text.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Id([u8; 16]);

impl Id {
    /// Mints a UUIDv7 from milliseconds since 1970 (UTC) and ten random bytes.
    pub fn mint(unix_ms: u64, random: [u8; 10]) -> Self {
        Self(
            Builder::from_unix_timestamp_millis(unix_ms, &random)
                .into_uuid()
                .into_bytes(),
        )
    }

    /// A UUIDv8 computed from content: the first 16 bytes of the SHA-256 over `kind` and `parts`, each after its
    /// length. Every store makes the same id for the same content.
    pub fn of_content(kind: &str, parts: &[&[u8]]) -> Self {
        let mut hash = Sha256::new();
        for part in std::iter::once(&kind.as_bytes()).chain(parts) {
            hash.update((part.len() as u64).to_be_bytes());
            hash.update(part);
        }
        let digest: [u8; 32] = hash.finalize().into();
        let mut bytes = [0; 16];
        bytes.copy_from_slice(&digest[..16]);
        Self(Builder::from_custom_bytes(bytes).into_uuid().into_bytes())
    }

    /// An id of these 16 bytes.
    pub fn from_bytes(bytes: [u8; 16]) -> Self {
        Self(bytes)
    }

    /// The 16 bytes, most significant first.
    pub fn as_bytes(&self) -> &[u8; 16] {
        &self.0
    }

    /// The last eight hex digits: random, so usually enough to identify a row in a table.
    pub fn short(&self) -> String {
        self.0[12..]
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect()
    }
}

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Uuid::from_bytes(self.0).as_hyphenated().fmt(f)
    }
}

impl fmt::Debug for Id {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Id({self})")
    }
}

impl FromStr for Id {
    type Err = uuid::Error;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self(Uuid::try_parse(text)?.into_bytes()))
    }
}

impl Serialize for Id {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Source of new ids: the caller reads the clock and the random source.
pub struct IdSource(Box<dyn FnMut() -> (u64, [u8; 10]) + Send>);

impl IdSource {
    /// Wraps a function that gives milliseconds since 1970 (UTC) and ten random bytes.
    pub fn new(next: impl FnMut() -> (u64, [u8; 10]) + Send + 'static) -> Self {
        Self(Box::new(next))
    }

    pub(crate) fn mint(&mut self) -> Id {
        let (unix_ms, random) = (self.0)();
        Id::mint(unix_ms, random)
    }
}

impl fmt::Debug for IdSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("IdSource")
    }
}

/// Ids as text, separated by commas.
pub(crate) fn list(ids: &[Id]) -> String {
    ids.iter().map(Id::to_string).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// RFC 9562 appendix A.6: 2022-02-22 19:22:22.000 UTC, rand_a CC3, rand_b 18C4DC0C0C07398F.
    #[test]
    fn mints_the_rfc_9562_example() {
        let random = [0x0C, 0xC3, 0x18, 0xC4, 0xDC, 0x0C, 0x0C, 0x07, 0x39, 0x8F];
        let id = Id::mint(0x017F_22E2_79B0, random);
        assert_eq!(id.to_string(), "017f22e2-79b0-7cc3-98c4-dc0c0c07398f");
        assert_eq!(id.to_string().parse::<Id>().expect("its own text"), id);
        assert_eq!(id.short(), "0c07398f");
    }

    #[test]
    fn an_id_of_content_is_the_same_everywhere_and_no_other_contents() {
        let id = Id::of_content("entry", &[b"SG-0042", b"7"]);
        assert_eq!(id, Id::of_content("entry", &[b"SG-0042", b"7"]));
        assert_ne!(id, Id::of_content("entry", &[b"SG-0042", b"8"]));
        assert_ne!(id, Id::of_content("entry", &[b"SG-004", b"27"]));
        assert_eq!(id.to_string().as_bytes()[14], b'8', "version 8 of RFC 9562");
    }
}
