//! Recognises server addresses, and passwords in them, in any text: file names, arguments and saved commands, even if
//! they are misspelt.

use super::address::Address;

impl Address {
    /// Whether a text is meant as a server's address, not as a file name: it begins with a scheme, even a misspelt one.
    pub fn is_meant(text: &str) -> bool {
        let is_postgres = |scheme: &str| scheme.to_ascii_lowercase().starts_with("postgres");
        scheme(text).is_some_and(|(scheme, rest)| rest.starts_with("//") || is_postgres(scheme))
    }

    /// Whether a text contains the password of a server: in an address, even misspelt or within a longer
    /// text, or as libpq's `password=`.
    pub fn holds_password(text: &str) -> bool {
        if let Ok(address) = text.parse::<Self>() {
            return address.password.is_some();
        }
        let lower = text.to_ascii_lowercase();
        let is_place = |word: &str| lower.contains(word);
        let named = lower.contains("password=")
            && (after_schemes(text).next().is_some()
                || ["host=", "dbname=", "user="].into_iter().any(is_place));
        named || after_schemes(text).any(is_login)
    }
}

/// The scheme and the text after its colon.
fn scheme(text: &str) -> Option<(&str, &str)> {
    let (scheme, rest) = text.split_once(':')?;
    let is_letter = |letter: char| letter.is_ascii_alphanumeric() || "+-._".contains(letter);
    let begins = scheme.starts_with(|first: char| first.is_ascii_alphabetic());
    (begins && scheme.chars().all(is_letter)).then_some((scheme, rest))
}

/// The text after each `://`, and after the colon of a scheme similar to PostgreSQL's.
fn after_schemes(text: &str) -> impl Iterator<Item = &str> {
    let marked = (text.match_indices("://")).map(|(at, mark)| &text[at + mark.len()..]);
    let short = (text.match_indices(':')).filter_map(|(at, _)| {
        let word = text[..at].rsplit(|letter: char| !letter.is_ascii_alphanumeric());
        let is_near = (word.take(1)).any(|word| word.to_ascii_lowercase().starts_with("postgre"));
        is_near.then(|| text[at + 1..].trim_start_matches('/'))
    });
    marked.chain(short)
}

/// Whether the text begins with `user:password@`.
fn is_login(rest: &str) -> bool {
    let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
    let rest = &rest[..end];
    let Some((user, rest)) = rest.split_once(':') else {
        return false;
    };
    !user.contains(['/', '@', '?']) && rest.contains('@')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_password_is_recognised_in_misspelt_addresses() {
        for text in [
            "postgres://kim:s3cret@a/h",
            "postgresql://kim:s3cret@a/h?sslmode=disable",
            "postgre://kim:s3cret@a/h",
            "postgresql+ssl://kim:s3cret@a/h",
            "POSTGRES://kim:s3cret@a/h",
            "postgres:/kim:s3cret@a/h",
            "postgresql:kim:s3cret@a/h",
            "mysql://kim:s3cret@a/h",
            "--db=postgres://kim:s3cret@a/h",
            "--db=postgres://kim@a/h?password=s3cret",
            "see postgres://kim:s3cret@a/h there",
            "postgres://kim:s3/cret@a/h",
            "postgres://kim:s3?cret@a/h",
            "postgres://:s3cret@a/h",
            "postgres://kim@a/h?password=s3cret",
            "postgre://kim@a/h?password=s3cret",
            "host=a user=kim password=s3cret",
        ] {
            assert!(Address::holds_password(text), "{text}");
        }
        for text in [
            "postgres://kim@a:5432/h?passfile=/home/kim/@pass",
            "postgres://[::1]:5432/h",
            "postgres://a:5432/h",
            "postgre://kim@a:5432/h",
            "see https://example.com/a:b",
            "12:30 called kim@depot",
            "tcp:127.0.0.1:4000",
            "password=lost",
        ] {
            assert!(!Address::holds_password(text), "{text}");
        }
    }

    #[test]
    fn an_address_is_told_from_a_file_by_its_scheme() {
        for text in [
            "postgres://a/h",
            "postgre://a/h",
            "mysql://a",
            "postgresql:a",
            "s3://x/y",
        ] {
            assert!(Address::is_meant(text), "{text}");
        }
        for text in [
            "history.db",
            "./a:b",
            "C:\\history.db",
            "/tmp/a://b",
            "run:1.db",
        ] {
            assert!(!Address::is_meant(text), "{text}");
        }
    }
}
