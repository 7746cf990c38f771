//! A sheet, verified by the certificate in it alone.

use fault_db::Statement;
use ptu_report::read_certificate;
use ptu_runs::keys::KeyList;

use super::findings::Findings;
use ptu_report::words::{Words, fill};

/// Findings on a sheet, by the certificate in it.
pub(super) fn sheet(page: &str, keys: &KeyList, words: &'static Words) -> Findings {
    let verify = &words.verify;
    let mut found = Findings::of("sheet", words);
    let certificate = match read_certificate(page) {
        Ok(certificate) => certificate,
        Err(why) => {
            found.changes.push(why);
            return found;
        }
    };
    let mut digest = None;
    for signed in certificate.run {
        match signed
            .and_then(|signed| Statement::of(&signed).ok_or_else(|| verify.no_statement.to_owned()))
        {
            Err(why) => {
                let said = fill(verify.in_certificate, &[("why", &why)]);
                found.changes.push(said);
            }
            Ok(statement) => {
                match (&statement.what[..], &digest) {
                    ("run", None) => {
                        found.id.clone_from(&statement.id);
                        digest = Some(statement.digest.clone());
                    }
                    ("note", _) => {}
                    (what, _) => {
                        let said = fill(verify.foreign, &[("what", &words.signed_thing(what))]);
                        found.changes.push(said);
                    }
                }
                found.take(&statement, keys);
            }
        }
    }
    match certificate.sheet {
        None => found.doubts.push(verify.text_unsigned.to_owned()),
        Some(Err(why)) => found
            .changes
            .push(fill(verify.wrong_sheet, &[("why", &why)])),
        Some(Ok(sheet)) => {
            found.is_covered = true;
            if found.id.is_empty() {
                found.id.clone_from(&sheet.id);
                found.doubts.push(verify.only_sheet.to_owned());
            }
            if sheet.id != found.id || digest.is_some_and(|digest| digest != sheet.digest) {
                found.changes.push(verify.two_runs.to_owned());
            }
            found.departure = sheet.departure;
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
