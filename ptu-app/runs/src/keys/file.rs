//! The file of a private key: PKCS#8, encrypted with a PIN by scrypt and AES-256, below the name it signs by.

use std::fmt::Display;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use fault_db::{Signer, read_regular_file};
use pkcs8::der::pem::PemLabel as _;
use pkcs8::der::{Decode as _, Document};
use pkcs8::pkcs5::{pbes2, scrypt};
use pkcs8::{EncryptedPrivateKeyInfoRef, LineEnding, PrivateKeyInfoRef};

use super::list::{KeyEntry, KeyList};
use super::{located, sought};
use crate::failure::{Failure, FileTrouble, KeyTrouble, Why};
use crate::new_file::{NewFile, cannot_write, kind};

/// Fewest letters and digits of a PIN.
const SHORTEST_PIN: usize = 6;
/// Longest file that is read, bytes.
const LONGEST: u64 = 64 << 10;
/// Bytes before the 32 bytes of an Ed25519 key in PKCS#8 (RFC 8410).
const HEAD: [u8; 16] = [
    0x30, 0x2e, 0x02, 0x01, 0x00, 0x30, 0x05, 0x06, 0x03, 0x2b, 0x65, 0x70, 0x04, 0x22, 0x04, 0x20,
];
const BEGIN: &str = "-----BEGIN";

/// A key to be made.
pub struct NewKey<'a> {
    /// The name it signs by.
    pub who: &'a str,
    /// `technician` or `bench`.
    pub kind: &'a str,
    /// The first day on which it holds.
    pub from: String,
    /// The first day on which it holds no more.
    pub until: Option<String>,
}

/// A key file as it was read: the private key is still encrypted.
#[derive(Clone, Debug)]
pub struct KeyFile {
    path: PathBuf,
    entry: KeyEntry,
    pem: String,
}

/// The name of the file with the public key beside that of a private key.
pub fn public_name(private: &Path) -> PathBuf {
    private.with_extension("pub")
}

fn not_made(error: impl Display) -> Failure {
    Failure::bench(KeyTrouble::NotMade(error.to_string()))
}

impl NewKey<'_> {
    /// Makes a key and writes its two files: the private key for its owner alone, and the public one beside it.
    ///
    /// # Errors
    /// The PIN is too short, a file is there already, or the disk does not take it.
    pub fn write(self, path: &Path, pin: &str) -> Result<KeyEntry, Failure> {
        if pin.chars().filter(|c| c.is_alphanumeric()).count() < SHORTEST_PIN {
            return Err(Failure::usage(KeyTrouble::ShortPin(SHORTEST_PIN)));
        }
        let (mut seed, mut salt, mut iv) = ([0; 32], [0; 16], [0; 16]);
        getrandom::fill(&mut seed).map_err(not_made)?;
        getrandom::fill(&mut salt).map_err(not_made)?;
        getrandom::fill(&mut iv).map_err(not_made)?;
        let signer = Signer::new(self.who, self.kind, &seed).map_err(not_made)?;
        let entry = KeyEntry {
            who: self.who.to_owned(),
            kind: self.kind.to_owned(),
            key: signer.public_key(),
            from: self.from,
            until: self.until,
            revoked: None,
            reason: None,
        };
        let encrypted = || -> Result<_, pkcs8::Error> {
            let plain = [&HEAD[..], &seed].concat();
            let by = pbes2::Parameters::generate_scrypt_aes256cbc(
                scrypt::Params::RECOMMENDED,
                &salt,
                iv,
            )?;
            let key = PrivateKeyInfoRef::from_der(&plain)?.encrypt_with_params(by, pin)?;
            Ok(key.to_pem(EncryptedPrivateKeyInfoRef::PEM_LABEL, LineEnding::LF)?)
        };
        let pem = encrypted().map_err(not_made)?;
        let public = KeyList {
            keys: vec![entry.clone()],
        }
        .text();
        let head = public.trim_start_matches("[[key]]\n");
        let mut private = NewFile::begin_new(path, kind::OWN)?;
        private.keep_to_owner()?;
        let mut shared = NewFile::begin_new(&public_name(path), kind::OWN)?;
        (write!(private, "{}\n{}", head.trim_end(), &*pem))
            .map_err(|error| cannot_write(path, &error))?;
        (shared.write_all(public.as_bytes())).map_err(|error| cannot_write(path, &error))?;
        private.finish()?;
        shared.finish()?;
        Ok(entry)
    }
}

impl KeyFile {
    /// Reads a key file, in the current folder or among one's own keys; its PIN is not needed for that.
    ///
    /// # Errors
    /// There is none, or it is no key file.
    pub fn read(named: &Path) -> Result<Self, Failure> {
        let path = &located(named);
        let shown = path.display().to_string();
        if !path.exists() {
            return Err(Failure::usage(KeyTrouble::Missing(sought(named))));
        }
        let bytes = read_regular_file(path, LONGEST)
            .map_err(|error| Failure::usage(FileTrouble::unread(path, error)))?;
        let text = String::from_utf8_lossy(&bytes);
        let no_key = |why| Failure::usage(KeyTrouble::NoKeyFile(shown.clone(), why));
        let place = text.find(BEGIN).ok_or_else(|| no_key(Why::NoPrivateKey))?;
        let entry: KeyEntry =
            toml::from_str(&text[..place]).map_err(|error| no_key(Why::of(error.message())))?;
        entry.check().map_err(|why| no_key(Why::Said(why)))?;
        Ok(Self {
            path: path.to_path_buf(),
            entry,
            pem: text[place..].to_owned(),
        })
    }

    pub fn entry(&self) -> &KeyEntry {
        &self.entry
    }

    /// Opens the key with its PIN.
    ///
    /// # Errors
    /// The PIN is wrong, or the file was changed.
    pub fn open(&self, pin: &str) -> Result<Signer, Failure> {
        let shown = self.path.display().to_string();
        let damaged = |why| Failure::usage(KeyTrouble::Damaged(shown.clone(), why));
        let (_, document) =
            Document::from_pem(&self.pem).map_err(|error| damaged(Why::of(error)))?;
        let encrypted = EncryptedPrivateKeyInfoRef::try_from(document.as_bytes())
            .map_err(|error| damaged(Why::of(error)))?;
        let wrong = || Failure::usage(KeyTrouble::WrongPin(shown.clone()));
        let plain = encrypted.decrypt(pin).map_err(|_| wrong())?;
        let seed = plain.as_bytes().strip_prefix(&HEAD[..]).ok_or_else(wrong)?;
        let signer = Signer::new(&self.entry.who, &self.entry.kind, seed).map_err(|_| wrong())?;
        if signer.public_key() != self.entry.key {
            return Err(damaged(Why::OtherPublicKey));
        }
        Ok(signer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: a key file opens with its PIN and with no other, and a changed one not at all.
    #[test]
    fn a_key_file_opens_with_its_pin_alone() {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("kim.key");
        let new = |pin| {
            NewKey {
                who: "Kim",
                kind: "technician",
                from: "2026-03-01".to_owned(),
                until: None,
            }
            .write(&path, pin)
        };
        assert!(
            new("12345")
                .expect_err("too short")
                .to_string()
                .contains("at least 6")
        );
        let made = new("123456").expect("made");
        assert!(
            new("123456")
                .expect_err("there")
                .to_string()
                .contains("there already")
        );
        let key = KeyFile::read(&path).expect("read");
        assert_eq!(*key.entry(), made);
        assert_eq!(key.open("123456").expect("opens").public_key(), made.key);
        let wrong = key.open("123457").expect_err("wrong");
        assert!(
            wrong.to_string().contains("the PIN of") && wrong.exit == crate::failure::Exit::Usage
        );
        assert_eq!(
            KeyList::read(dir.path()).expect("read").keys,
            std::slice::from_ref(&made)
        );
        // Another name above the same private key is not noticed here: the depot's list says whose the key is.
        let text = std::fs::read_to_string(&path).expect("read");
        let other = text.replace(&made.key, &"0".repeat(64));
        std::fs::write(&path, other).expect("written");
        let told = KeyFile::read(&path)
            .expect("read")
            .open("123456")
            .expect_err("changed");
        assert!(told.to_string().contains("damaged"), "{told}");
        for text in ["", "who = 'x'", &text[..text.len() / 2]] {
            std::fs::write(&path, text).expect("written");
            assert!(
                KeyFile::read(&path)
                    .and_then(|key| key.open("123456"))
                    .is_err()
            );
        }
        assert!(
            KeyFile::read(&dir.path().join("no.key"))
                .expect_err("none")
                .to_string()
                .contains("ptu key new")
        );
    }
}
