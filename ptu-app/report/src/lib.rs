//! Reports and views: what a run, a drive or a trace says, as files and as texts in two languages. Nothing here
//! moves a bench.
//!
//! * [`Target`]: a report of a run as `.html` or `.pdf` (a test sheet), `.csv`, `.json` or `.junit.xml`;
//!   [`run`]: the test sheet;
//! * [`drive`], [`campaign`], [`diagnosis`]: reports of drives, campaigns and diagnoses;
//! * [`trace_view`]: prepares traces for drawing, independent of the window; [`trace_io`]: trace files;
//! * [`event_lines`]: the stream of a run for other programs; [`history_files`]: the history as Parquet partitions;
//! * [`fault_months`], [`distances`], [`trend`]: the history as counts by month, faults by distance, values over time;
//! * [`words`]: the texts in two languages; [`fonts`]: the font for them; [`limits`]: values and limits.

pub mod campaign;
pub mod care;
mod certificate;
mod coverage;
pub mod csv;
mod departure;
pub mod diagnosis;
pub mod distances;
pub mod drive;
pub mod event_lines;
pub mod event_text;
pub mod fault_months;
pub mod fonts;
pub mod history_files;
mod json;
mod junit;
mod left_out;
pub mod life;
pub mod limits;
pub mod naming;
pub mod plot;
pub mod plot_page;
mod proof;
pub mod record;
pub mod run;
mod shares;
pub mod signal;
mod target;
pub mod ticks;
pub mod trace_io;
pub mod trace_notes;
pub mod trace_view;
pub mod trend;
mod without_korean;
pub mod words;

pub use certificate::{SheetCertificate, SheetStatement, has_certificate, read_certificate};
pub use coverage::{count_short, count_text, coverage_text};
pub use departure::Departure;
pub use json::{
    FAULT_KEYS, fault_json, json_safe, json_text, run_json, run_summary_json, signature_json,
};
pub use proof::proof_text;
use target::page_text;
pub use target::{
    Target, case_content, comparison_content, run_content, write, write_beside, write_case,
    write_comparison,
};
pub use without_korean::without_korean;
