//! A sheet, verified by the certificate in it alone.

use fault_db::Statement;
use ptu_report::read_certificate;
use ptu_runs::keys::KeyList;

use super::Findings;

/// A sheet by the certificate in it.
pub(super) fn sheet(page: &str, keys: &KeyList) -> Findings {
    let mut found = Findings {
        what: "sheet",
        ..Findings::default()
    };
    let certificate = match read_certificate(page) {
        Ok(certificate) => certificate,
        Err(why) => {
            found.changes.push(why);
            return found;
        }
    };
    let mut digest = None;
    for signed in certificate.run {
        match signed.and_then(|signed| {
            Statement::of(&signed).ok_or_else(|| "it is no statement about a run".to_owned())
        }) {
            Err(why) => found
                .changes
                .push(format!("a signature in its certificate: {why}")),
            Ok(statement) => {
                match (&statement.what[..], &digest) {
                    ("run", None) => {
                        found.id.clone_from(&statement.id);
                        digest = Some(statement.digest.clone());
                    }
                    ("note", _) => {}
                    (what, _) => found.changes.push(format!(
                        "a {what} is signed in its certificate that is not of the run"
                    )),
                }
                found.take(&statement, keys);
            }
        }
    }
    match certificate.sheet {
        None => found.doubts.push(
            "the text of the sheet is not signed: hold it against the database, or write it again with --key".to_owned(),
        ),
        Some(Err(why)) => found.changes.push(format!("the signature of the sheet: {why}")),
        Some(Ok(sheet)) => {
            found.is_covered = true;
            if found.id.is_empty() {
                found.id.clone_from(&sheet.id);
                found.doubts.push("the run is not signed, only the sheet is".to_owned());
            }
            if sheet.id != found.id || digest.is_some_and(|digest| digest != sheet.digest) {
                found.changes.push("the sheet and the certificate in it are of two runs".to_owned());
            }
            let of = Statement {
                what: "sheet".to_owned(),
                id: sheet.id,
                who: sheet.who,
                kind: sheet.kind,
                key: sheet.key,
                at_us: sheet.at_us,
                ..Statement::default()
            };
            found.take(&of, keys);
        }
    }
    found
}
