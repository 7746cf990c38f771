//! Signatures of persons and benches over what is sealed. SEALS.md describes them.
//!
//! A signature is itself an entry of the chain of seals, of the kind `signature`: so it is copied, kept and checked
//! like every other entry. While a [`Signer`] is set, each run, event, note and instrument that is sealed is signed in
//! the same transaction.

mod append;
mod places;
mod signed;
mod statement;

pub(crate) use append::sign_new_entries;
pub use places::Places;
pub(crate) use places::changed_places;
pub use signed::{SignatureError, Signed, canonical_json};
pub use statement::{About, Statement};
pub(crate) use statement::{SIGNATURE, read_signature, signatures_of};

use ring::signature::{Ed25519KeyPair, KeyPair as _};

use crate::seal::hex;

/// A private key, with the name and kind of its owner.
pub struct Signer {
    who: String,
    kind: String,
    pair: Ed25519KeyPair,
}

impl std::fmt::Debug for Signer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Signer")
            .field("who", &self.who)
            .finish_non_exhaustive()
    }
}

impl Signer {
    /// A signer with the 32 bytes of a private key; `kind` is the kind of the key's owner, in the caller's words.
    ///
    /// # Errors
    /// The bytes are no key.
    pub fn new(who: &str, kind: &str, seed: &[u8]) -> Result<Self, SignatureError> {
        let pair = Ed25519KeyPair::from_seed_unchecked(seed);
        Ok(Self {
            who: who.to_owned(),
            kind: kind.to_owned(),
            pair: pair.map_err(|_| SignatureError::NoKey)?,
        })
    }

    /// Name of the key's owner.
    pub fn who(&self) -> &str {
        &self.who
    }

    /// Kind of the owner.
    pub fn kind(&self) -> &str {
        &self.kind
    }

    /// The public key, in hex.
    pub fn public_key(&self) -> String {
        hex(self.pair.public_key().as_ref())
    }

    pub(crate) fn sign(&self, message: &[u8]) -> String {
        hex(self.pair.sign(message).as_ref())
    }
}
