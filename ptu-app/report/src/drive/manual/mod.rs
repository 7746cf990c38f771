//! Reports of a manual run: plain text, JSON, CSV, and HTML with the plots of S3's figures 5
//! to 7.

mod csv;
mod figures;
mod html;
mod json;
mod plots;
mod steps;
mod text;

pub use text::text;

use serde_json::Value;

use super::Report;
use ptu_bench::drive::manual::ManualRun;

impl Report for ManualRun {
    fn html(&self) -> String {
        html::html(self)
    }

    fn json(&self) -> Value {
        json::json(self)
    }

    fn csv(&self) -> String {
        csv::csv(self)
    }
}
