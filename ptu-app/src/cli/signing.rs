//! `--key`: signs what a command records.

use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use fault_db::{Signer, Store};

use ptu_report::words::{Words, fill};
use ptu_runs::failure::{Asked, Failure, FileTrouble, KeyTrouble};
use ptu_runs::{keys, owner_only};

/// Longest file with a PIN, bytes.
const LONGEST_PIN: u64 = 4096;
/// Environment variable that holds the PIN, for benches without a terminal.
const PIN: &str = "PTU_PIN";

/// Option that names the key to sign with.
#[derive(Debug, Default, Args)]
pub struct SigningOption {
    /// Sign with this key file of `ptu key new`; its PIN is asked for, or read from --pin-file or PTU_PIN
    #[arg(long, value_name = "FILE", env = "PTU_KEY")]
    key: Option<PathBuf>,
    #[command(flatten)]
    pin: PinOption,
}

/// Arguments of a command that records something, with the key to sign it.
#[derive(Debug, Args)]
pub struct Signed<T: Args> {
    #[command(flatten)]
    what: T,
    #[command(flatten)]
    signing: SigningOption,
}

impl<T: Args> Signed<T> {
    /// The command's own arguments; from now on the history signs what is recorded, if a key is named.
    ///
    /// # Errors
    /// As [`SigningOption::sign`].
    pub fn by_its_key(self, store: &Store) -> Result<T, Failure> {
        self.signing.sign(store)?;
        Ok(self.what)
    }
}

/// Option that says where the PIN of a key comes from.
#[derive(Debug, Default, Args)]
pub struct PinOption {
    /// File with the PIN of the key, for commands that run without a terminal
    #[arg(long, value_name = "FILE", env = "PTU_PIN_FILE")]
    pin_file: Option<PathBuf>,
}

impl SigningOption {
    /// From now on what is recorded in this history is signed, if there is a key.
    ///
    /// # Errors
    /// The key is not there, holds no longer, or its PIN is wrong.
    pub fn sign(&self, store: &Store) -> Result<(), Failure> {
        if let Some(signer) = self.signer()? {
            store.sign_with(Some(signer));
        }
        Ok(())
    }

    fn named(&self) -> Option<&Path> {
        (self.key.as_deref()).filter(|path| !path.as_os_str().is_empty())
    }

    /// Whether a key is named.
    pub fn is_named(&self) -> bool {
        self.named().is_some()
    }

    /// Opens the key, if one is named.
    ///
    /// # Errors
    /// The key is not there, holds no longer, or its PIN is wrong.
    pub fn signer(&self) -> Result<Option<Arc<Signer>>, Failure> {
        let Some(path) = self.named() else {
            return Ok(None);
        };
        let file = keys::usable(path)?;
        let pin = self.pin.ask(&fill(
            Words::shown().terminal.pin_of,
            &[("who", &file.entry().who)],
        ))?;
        Ok(Some(Arc::new(file.open(&pin)?)))
    }
}

impl PinOption {
    /// The PIN, from the file, the environment or the terminal.
    ///
    /// # Errors
    /// There is no file, variable or terminal to take a PIN from, or the file cannot be read.
    pub fn ask(&self, prompt: &str) -> Result<String, Failure> {
        if let Some(path) = &self.pin_file {
            let bytes = fault_db::read_regular_file(path, LONGEST_PIN)
                .map_err(|error| Failure::usage(FileTrouble::unread(path, error)))?;
            owner_only::refuse_shared(path)?;
            let text = String::from_utf8_lossy(&bytes);
            return Ok(text.trim_end_matches(['\n', '\r']).to_owned());
        }
        if let Ok(pin) = std::env::var(PIN) {
            return Ok(pin);
        }
        if !std::io::stdin().is_terminal() {
            return Err(Failure::usage(KeyTrouble::NoPin));
        }
        let terminal = console::Term::stderr();
        let cannot = |error: std::io::Error| Failure::usage(Asked::PinUnread(error.to_string()));
        terminal.write_str(prompt).map_err(cannot)?;
        terminal.read_secure_line().map_err(cannot)
    }

    /// The PIN for a new key: typed twice at a terminal.
    ///
    /// # Errors
    /// As [`Self::ask`], or the two differ.
    pub fn choose(&self) -> Result<String, Failure> {
        let first = self.ask(Words::shown().terminal.new_pin)?;
        let typed = self.pin_file.is_none() && std::env::var_os(PIN).is_none();
        if typed && self.ask(Words::shown().terminal.same_again)? != first {
            return Err(Failure::usage(KeyTrouble::PinsDiffer));
        }
        Ok(first)
    }
}
