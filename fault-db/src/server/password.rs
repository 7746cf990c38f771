//! Finds the password: in the address, in `PGPASSWORD`, or in a password file in libpq's format.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::address::Address;
use crate::files::platform;
use crate::files::regular_file::read_regular_file;

/// Longest password file that is read, bytes.
const LONGEST_FILE: u64 = 1 << 20;

/// A password, or the reason why a password file was not used.
#[derive(Default, PartialEq, Eq)]
pub(super) struct Password {
    pub secret: Option<String>,
    pub passed_over: Option<String>,
}

impl std::fmt::Debug for Password {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let secret = self.secret.as_ref().map(|_| "…");
        (f.debug_struct("Password").field("secret", &secret))
            .field("passed_over", &self.passed_over)
            .finish()
    }
}

/// Reads environment variables.
pub(super) type Environment<'a> = &'a dyn Fn(&str) -> Option<OsString>;

/// Finds the password of a user for a database at an address.
pub(super) fn find(
    address: &Address,
    user: &str,
    database: &str,
    environment: Environment<'_>,
) -> Password {
    let told = environment("PGPASSWORD").and_then(|word| word.into_string().ok());
    if let Some(secret) = address.password.clone().or(told) {
        return Password {
            secret: Some(secret),
            passed_over: None,
        };
    }
    let Some(file) = file(address, environment) else {
        return Password::default();
    };
    let text = match read(&file) {
        Ok(text) => text,
        Err(reason) => {
            return Password {
                secret: None,
                passed_over: Some(reason),
            };
        }
    };
    let host = if address.is_socket() {
        "localhost"
    } else {
        &address.host
    };
    let port = address.port.to_string();
    let secret = (text.lines()).find_map(|line| matching(line, [host, &port, database, user]));
    let passed_over = (secret.is_none() && !text.is_empty())
        .then(|| format!("no line of the password file {} is for it", file.display()));
    Password {
        secret,
        passed_over,
    }
}

fn file(address: &Address, environment: Environment<'_>) -> Option<PathBuf> {
    let named = address.password_file.clone();
    named
        .or_else(|| environment("PGPASSFILE").map(PathBuf::from))
        .or_else(|| platform::password_file(environment))
        .filter(|file| address.password_file.is_some() || file.exists())
}

/// The text of a password file; as in libpq, a file that others can read is not used.
fn read(file: &Path) -> Result<String, String> {
    let shown = file.display();
    let about = std::fs::metadata(file)
        .map_err(|error| format!("the password file {shown} cannot be read ({error})"))?;
    if !about.is_file() {
        return Err(format!("the password file {shown} is no file"));
    }
    if platform::is_open_to_others(&about) {
        return Err(format!(
            "the password file {shown} was not read, because others can: chmod 600 {shown}"
        ));
    }
    let cannot =
        |why: &dyn std::fmt::Display| format!("the password file {shown} cannot be read ({why})");
    let bytes = read_regular_file(file, LONGEST_FILE).map_err(|error| cannot(&error))?;
    String::from_utf8(bytes).map_err(|error| cannot(&error))
}

/// The password in a line `host:port:database:user:password`, if the other fields match.
fn matching(line: &str, asked: [&str; 4]) -> Option<String> {
    if line.starts_with('#') {
        return None;
    }
    let mut rest = line;
    for asked in asked {
        let (field, after) = field(rest);
        if field != asked && rest[..rest.len() - after.len()] != *"*:" {
            return None;
        }
        rest = after;
    }
    let (password, _) = field(rest);
    (!password.is_empty()).then_some(password)
}

/// Splits a line at the first `:`; in the field before it a backslash escapes the next character.
fn field(text: &str) -> (String, &str) {
    let mut field = String::new();
    let mut letters = text.char_indices();
    while let Some((at, letter)) = letters.next() {
        match letter {
            ':' => return (field, &text[at + 1..]),
            '\\' => field.extend(letters.next().map(|(_, letter)| letter)),
            _ => field.push(letter),
        }
    }
    (field, "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_read_as_libpq_reads_them() {
        let asked = ["::1", "5432", "history", "kim"];
        for (line, password) in [
            (r"\:\:1:5432:history:kim:pa\:ss\\", Some(r"pa:ss\")),
            ("*:*:*:*:any", Some("any")),
            ("*:*:*:kim:any:rest", Some("any")),
            (r"*:*:\*:kim:any", None),
            ("# *:*:*:*:any", None),
            ("*:5433:*:kim:any", None),
            ("*:*:*:kim:", None),
            ("*:*", None),
            ("", None),
        ] {
            assert_eq!(matching(line, asked).as_deref(), password, "{line}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_password_file_that_others_can_read_is_not_used() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("pass");
        std::fs::write(&file, "# ours\n*:*:history:kim:secret\n").expect("a file");
        let allow = |mode| {
            let mode = std::fs::Permissions::from_mode(mode);
            std::fs::set_permissions(&file, mode).expect("permissions");
        };
        let text = format!("postgres://kim@depot/history?passfile={}", file.display());
        let address: Address = text.parse().expect("an address");
        let nothing = |_: &str| None;
        allow(0o600);
        let found = find(&address, "kim", "history", &nothing);
        assert_eq!(found.secret.as_deref(), Some("secret"));
        let other = find(&address, "lee", "history", &nothing);
        assert!(other.passed_over.expect("words").contains("no line"));
        allow(0o640);
        let refused = find(&address, "kim", "history", &nothing);
        assert_eq!(refused.secret, None);
        assert!(refused.passed_over.expect("words").contains("chmod 600"));
        let told = |name: &str| (name == "PGPASSWORD").then(|| OsString::from("told"));
        let found = find(&address, "kim", "history", &told);
        assert_eq!(found.secret.as_deref(), Some("told"));
    }

    #[test]
    fn lines_of_a_password_file_may_be_anything() {
        let lines = [
            "localhost:5432:history:kim:s\\:ecret",
            "*:*:*:*:x",
            "# no",
            "a\\\\:1:b",
        ];
        let fuzz = fuzzing::Fuzz::new("pgpass", env!("CARGO_MANIFEST_DIR"), lines);
        fuzz.run(100_000, |bytes| {
            let line = String::from_utf8_lossy(bytes);
            let _ = matching(&line, ["localhost", "5432", "history", "kim"]);
        });
    }
}
