//! A JSON document with its signature, as a seal, a certificate file and a test sheet hold it.

use ring::signature::{ED25519, UnparsedPublicKey};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::Signer;
use crate::seal::from_hex;

/// Bytes that are signed before the document, so that a signature made for another purpose never fits.
const PURPOSE: &[u8] = b"ptu signature 1\n";
/// The longest text that is read as a signed document.
const LONGEST: usize = 16 << 20;

/// Reason for which a signature does not hold.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SignatureError {
    /// The document cannot be read.
    #[error("it is no signed document: {0}")]
    Unreadable(String),
    /// The document is not in the form in which it was signed.
    #[error("it is not in the one form in which it was signed: it was changed")]
    Form,
    /// The document or the signature was changed.
    #[error("its signature does not fit its content: one of them was changed")]
    Wrong,
    /// The bytes are no private key.
    #[error("these bytes are no private key")]
    NoKey,
}

/// A JSON object and the signature of the key that its field `key` names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Signed {
    signature: String,
    statement: Value,
}

impl Signed {
    /// Signs an object; fields that name the signer are added.
    pub fn new(signer: &Signer, statement: &impl Serialize) -> Self {
        // The conversion of text and numbers cannot fail.
        let mut statement = serde_json::to_value(statement).unwrap_or_default();
        if let Some(object) = statement.as_object_mut() {
            object.insert("key".into(), signer.public_key().into());
            object.insert("kind".into(), signer.kind().into());
            object.insert("who".into(), signer.who().into());
        }
        Self {
            signature: signer.sign(&message(&statement)),
            statement,
        }
    }

    /// Reads a signed document, which must have its one form byte for byte, and checks its signature.
    ///
    /// # Errors
    /// The text is no signed document, or the signature does not fit.
    pub fn read(text: &str) -> Result<Self, SignatureError> {
        if text.len() > LONGEST {
            let reason = format!("{} bytes are more than {LONGEST}", text.len());
            return Err(SignatureError::Unreadable(reason));
        }
        let signed: Self = serde_json::from_str(text)
            .map_err(|error| SignatureError::Unreadable(error.to_string()))?;
        // JSON readers tolerate different things: the order of keys, blanks, a key that stands twice.
        if signed.text() != text {
            return Err(SignatureError::Form);
        }
        signed.check()?;
        Ok(signed)
    }

    /// Checks the signature.
    ///
    /// # Errors
    /// The signature does not fit.
    pub fn check(&self) -> Result<(), SignatureError> {
        let key = from_hex(self.key()).filter(|key| key.len() == 32);
        let signature = from_hex(&self.signature);
        let (Some(key), Some(signature)) = (key, signature) else {
            return Err(SignatureError::Wrong);
        };
        UnparsedPublicKey::new(&ED25519, key)
            .verify(&message(&self.statement), &signature)
            .map_err(|_| SignatureError::Wrong)
    }

    /// The document in its one form.
    pub fn text(&self) -> String {
        canonical_json(&serde_json::to_value(self).unwrap_or_default())
    }

    /// The signed object.
    pub fn statement(&self) -> &Value {
        &self.statement
    }

    /// The public key, in hex, that the document names as its signer's.
    pub fn key(&self) -> &str {
        self.statement["key"].as_str().unwrap_or_default()
    }

    /// Name of the person who signed, as the signed object says.
    pub fn who(&self) -> &str {
        self.statement["who"].as_str().unwrap_or_default()
    }
}

fn message(statement: &Value) -> Vec<u8> {
    [PURPOSE, canonical_json(statement).as_bytes()].concat()
}

/// JSON in one form: no spaces, keys sorted. For text and whole numbers, and nothing else is signed, this is the
/// form of RFC 8785.
pub fn canonical_json(value: &Value) -> String {
    let mut value = value.clone();
    value.sort_all_objects();
    value.to_string()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn signed() -> Signed {
        let signer = Signer::new("Kim", "technician", &[7; 32]).expect("a key");
        Signed::new(&signer, &json!({"what": "run", "id": "1", "at_us": 5}))
    }

    #[test]
    fn there_is_one_form_whatever_the_order_and_spaces() {
        let a: Value =
            serde_json::from_str(r#"{"b": [1, {"d": "ü\n", "c": null}], "a": 2}"#).unwrap();
        assert_eq!(
            canonical_json(&a),
            r#"{"a":2,"b":[1,{"c":null,"d":"ü\n"}]}"#
        );
        let text = signed().text();
        let spaced = serde_json::to_string_pretty(&signed()).unwrap();
        assert_ne!(text, spaced);
        assert_eq!(Signed::read(&spaced), Err(SignatureError::Form));
    }

    /// Goal: a signed document with a changed byte is refused. Method: each byte is changed in two ways, and cut off.
    #[test]
    fn every_changed_byte_is_found() {
        let text = signed().text();
        assert_eq!(Signed::read(&text), Ok(signed()));
        for place in 0..text.len() {
            for bit in [1, 4] {
                let mut bytes = text.clone().into_bytes();
                bytes[place] ^= bit;
                if let Ok(changed) = String::from_utf8(bytes) {
                    assert!(Signed::read(&changed).is_err(), "{changed}");
                }
            }
            assert!(Signed::read(&text[..place]).is_err());
        }
    }

    #[test]
    fn another_key_of_the_same_name_is_another_signature() {
        let other = Signer::new("Kim", "technician", &[8; 32]).expect("a key");
        let mut forged = signed();
        forged.signature = other.sign(&message(&forged.statement));
        assert_eq!(forged.check(), Err(SignatureError::Wrong));
        assert!(Signer::new("Kim", "technician", &[8; 31]).is_err());
    }

    /// Key, message and signature are those of RFC 8032, test 1, except for the content of the message.
    #[test]
    fn the_public_key_is_that_of_the_standard() {
        let seed =
            from_hex("9d61b19deffd5a60ba844af492ec2cc44449c5697b326919703bac031cae7f60").unwrap();
        let signer = Signer::new("", "", &seed).expect("a key");
        assert_eq!(
            signer.public_key(),
            "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a"
        );
        assert_eq!(
            signer.sign(b""),
            "e5564300c360ac729086e2cc806e828a84877f1eb8e5d974d873e065224901555fb8821590a33bacc61e39701cf9b46bd25bf5f0595bbe24655141438e7a100b"
        );
    }
}
