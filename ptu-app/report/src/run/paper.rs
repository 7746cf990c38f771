//! Printed document of a run or of a case: blocks, and the frame of every page. The HTML page, the PDF and the
//! window are made from it.

use super::Sheet;
use super::block::Block;
use super::content;
use crate::words::Words;

/// A printed document, in one language.
#[derive(Default)]
pub struct Paper {
    /// Kind of document, for its head and its margin.
    pub(crate) name: &'static str,
    /// Serial number of the unit.
    pub(crate) unit: String,
    /// Short name for the title of a window or a file.
    pub(crate) short: String,
    /// Number of the paper, below each page.
    pub(crate) number: String,
    /// Version of the program that tested.
    pub(crate) program: String,
    /// When the content of the document was complete, µs UTC.
    pub(crate) at_us: i64,
    /// Words across each page of a document that proves nothing of a unit in service.
    pub(crate) across: Option<String>,
    pub(crate) blocks: Vec<Block>,
}

pub trait Printed {
    /// The paper in one language.
    fn paper(&self, words: &Words) -> Paper;
}

/// Text across the pages of practice.
pub(super) fn across(words: &Words) -> String {
    words.report.simulated.to_uppercase()
}

impl Printed for Sheet {
    fn paper(&self, words: &Words) -> Paper {
        let (run, report) = (&self.run.run, &words.report);
        Paper {
            name: report.sheet,
            unit: run.unit_serial.clone(),
            short: run.id.short(),
            number: run.id.to_string(),
            program: format!("ptu {}", run.app_version),
            at_us: run.finished_at_us.unwrap_or(run.started_at_us),
            across: run.is_practice().then(|| across(words)),
            blocks: content::blocks(self, words),
        }
    }
}
