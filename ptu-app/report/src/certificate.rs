//! The certificate in a sheet: who signed the run, and who signed the text of the sheet. With it the sheet can be verified
//! without the database.

use fault_db::{RunDetail, Signed, Signer, canonical_json};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::departure::Departure;
use ptu_runs::data::sha256;

/// Text in a page before the certificate.
const BEGIN: &str = "<script type=\"application/json\" id=\"ptu-certificate\">";
const END: &str = "</script>";
/// End of a page, behind its certificate.
const PAGE_END: &str = "</body></html>";
/// Version of a sheet's statement; in version 1 the statement did not cover the certificate.
const VERSION: u32 = 2;

/// The statement about a sheet that is signed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SheetStatement {
    /// Version of this set of fields.
    pub version: u32,
    /// Kind of statement: `sheet`.
    pub what: String,
    pub id: String,
    /// SHA-256 of the page with its certificate, but without this document.
    pub sheet: String,
    /// SHA-256 of the run's content, as the run's seal has it; empty before the end of the run.
    pub digest: String,
    /// Time at which the sheet was written, µs UTC.
    pub at_us: i64,
    /// Name of the person who signed.
    #[serde(default)]
    pub who: String,
    #[serde(default)]
    pub kind: String,
    #[serde(default)]
    pub key: String,
    /// Value of the run as a departure test, if it is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub departure: Option<Departure>,
}

/// The certificate of a sheet as it stands in the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Block {
    /// The signed documents of the run and of the notes on it.
    run: Vec<Value>,
    /// The signed document of the sheet itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sheet: Option<Value>,
}

impl Block {
    /// The page: the text `begins`, then this certificate, which always has the same form.
    fn page(&self, begins: &str) -> String {
        let json = canonical_json(&serde_json::to_value(self).unwrap_or_default());
        // JSON needs no `<` of its own: nothing in the text ends the element.
        let json = json.replace('<', "\\u003c");
        format!("{begins}{BEGIN}{json}{END}{PAGE_END}")
    }

    /// Digest that the signature of a sheet covers: each byte of the page but the signature's own.
    fn covered(&self, begins: &str) -> String {
        let run = self.run.clone();
        sha256(&Self { run, sheet: None }.page(begins))
    }
}

/// A sheet's certificate, read.
#[derive(Debug)]
pub struct SheetCertificate {
    /// The signed documents of the run and its notes; an error says why one does not hold.
    pub run: Vec<Result<Signed, String>>,
    /// The signed document of the sheet, if it was signed; an error says why it does not hold for this page.
    pub sheet: Option<Result<SheetStatement, String>>,
}

/// Puts the certificate into a page: the run's signatures, and that of the sheet where there is a key.
pub(crate) fn attach(
    page: String,
    run: &RunDetail,
    signatures: &[String],
    signer: Option<&Signer>,
    at_us: i64,
) -> String {
    if signatures.is_empty() && signer.is_none() {
        return page;
    }
    let Some(begins) = page.strip_suffix(PAGE_END) else {
        return page;
    };
    let parsed = |text: &String| serde_json::from_str(text).ok();
    let mut block = Block {
        run: signatures.iter().filter_map(parsed).collect(),
        sheet: None,
    };
    block.sheet = signer.map(|signer| {
        let statement = SheetStatement {
            version: VERSION,
            what: "sheet".to_owned(),
            id: run.run.id.to_string(),
            sheet: block.covered(begins),
            digest: run
                .seal
                .as_ref()
                .map_or_else(String::new, |seal| seal.digest.clone()),
            at_us,
            departure: Departure::of(run),
            ..SheetStatement::default()
        };
        serde_json::to_value(Signed::new(signer, &statement)).unwrap_or_default()
    });
    block.page(begins)
}

/// Whether a text is a page with a certificate.
pub fn has_certificate(page: &str) -> bool {
    page.contains(BEGIN)
}

/// Reads the certificate of a sheet, which stands once, in one form, at the end of the page.
///
/// # Errors
/// The page has no certificate, or is not as the program writes it.
pub fn read_certificate(page: &str) -> Result<SheetCertificate, String> {
    let (begins, rest) = page.split_once(BEGIN).ok_or("it has no certificate")?;
    let json = rest.strip_suffix(PAGE_END);
    let json = json.and_then(|rest| rest.strip_suffix(END));
    let json = json.ok_or("the certificate is not what the page ends with")?;
    let block: Block = serde_json::from_str(json)
        .map_err(|error| format!("its certificate cannot be read: {error}"))?;
    let scripts = page.to_ascii_lowercase().matches("<script").count();
    if scripts != 1 || block.page(begins) != page {
        return Err("the certificate is not in the one form in which it was written".to_owned());
    }
    let signed =
        |value: &Value| Signed::read(&canonical_json(value)).map_err(|error| error.to_string());
    let sheet = block.sheet.as_ref().map(|value| {
        let signed = signed(value)?;
        let sheet: SheetStatement = serde_json::from_value(signed.statement().clone())
            .map_err(|_| "it is no statement about a sheet".to_owned())?;
        if sheet.version != VERSION || sheet.what != "sheet" {
            return Err(
                "it is of another version, or of something else; write the sheet again".to_owned(),
            );
        }
        if sheet.sheet != block.covered(begins) {
            return Err("the text of the sheet was changed after it was signed".to_owned());
        }
        Ok(sheet)
    });
    Ok(SheetCertificate {
        run: block.run.iter().map(signed).collect(),
        sheet,
    })
}
