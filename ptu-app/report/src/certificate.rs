//! The certificate in a sheet: who signed the run, and who signed the text of the sheet. With it the sheet can be verified
//! without the database.

use fault_db::{RunDetail, Signed, Signer};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use ptu_runs::data::sha256;

/// What stands before the certificate in a page, and after it.
const BEGIN: &str = "<script type=\"application/json\" id=\"ptu-certificate\">";
const END: &str = "</script>";
/// Where it is put.
const PLACE: &str = "</body>";

/// What is signed of a sheet.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SheetStatement {
    /// Version of this list.
    pub version: u32,
    /// `sheet`.
    pub what: String,
    /// The run.
    pub id: String,
    /// SHA-256 of the page without its certificate.
    pub sheet: String,
    /// SHA-256 of the run's content, as its seal has it; empty before its end.
    pub digest: String,
    /// When the sheet was written.
    pub at_us: i64,
    /// Who signed.
    #[serde(default)]
    pub who: String,
    /// Whose key it is.
    #[serde(default)]
    pub kind: String,
    /// The public key.
    #[serde(default)]
    pub key: String,
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

/// A sheet's certificate, read.
#[derive(Debug)]
pub struct SheetCertificate {
    /// The signed documents of the run and its notes; an error says why one does not hold.
    pub run: Vec<Result<Signed, String>>,
    /// The signed document of the sheet, if it was signed.
    pub sheet: Option<Result<SheetStatement, String>>,
    /// SHA-256 of the page without its certificate, as it is now.
    pub sha256: String,
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
    let Some(place) = page.rfind(PLACE) else {
        return page;
    };
    let parsed = |text: &String| serde_json::from_str(text).ok();
    let sheet = signer.map(|signer| {
        let statement = SheetStatement {
            version: 1,
            what: "sheet".to_owned(),
            id: run.run.id.to_string(),
            sheet: sha256(&page),
            digest: run
                .seal
                .as_ref()
                .map_or_else(String::new, |seal| seal.digest.clone()),
            at_us,
            ..SheetStatement::default()
        };
        serde_json::to_value(Signed::new(signer, &statement)).unwrap_or_default()
    });
    let block = Block {
        run: signatures.iter().filter_map(parsed).collect(),
        sheet,
    };
    let json = serde_json::to_string(&block).unwrap_or_default();
    // No sign of JSON's own: nothing in it ends the element.
    let json = json.replace('<', "\\u003c");
    format!("{}{BEGIN}{json}{END}{}", &page[..place], &page[place..])
}

/// Whether a text is a page with a certificate.
pub fn has_certificate(page: &str) -> bool {
    page.contains(BEGIN)
}

/// Reads the certificate of a sheet.
///
/// # Errors
/// There is none, or it cannot be read.
pub fn read_certificate(page: &str) -> Result<SheetCertificate, String> {
    let (before, rest) = page.split_once(BEGIN).ok_or("it has no certificate")?;
    let (json, after) = rest.split_once(END).ok_or("its certificate has no end")?;
    let block: Block = serde_json::from_str(json)
        .map_err(|error| format!("its certificate cannot be read: {error}"))?;
    let signed = |value: Value| Signed::read(&value.to_string()).map_err(|error| error.to_string());
    let sheet = block.sheet.map(|value| {
        let signed = signed(value)?;
        serde_json::from_value(signed.statement().clone())
            .map_err(|_| "it is no statement about a sheet".to_owned())
    });
    Ok(SheetCertificate {
        run: block.run.into_iter().map(signed).collect(),
        sheet,
        sha256: sha256(&format!("{before}{after}")),
    })
}
