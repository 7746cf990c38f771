//! Traces to and from other programs' files.
//!
//! * [`export`]: a stored trace, or a part of it, as CSV, Parquet or MCAP, a piece at a time, so that an
//!   hour of all signals takes no more memory than a second of one;
//! * [`RunMcap`]: a whole run while it goes on, every row of every signal and every event;
//! * [`TraceInfo`]: the description of a trace in every format: unit, times, and each signal's unit, kind and words;
//! * [`import`]: signals of a CSV, Parquet or MCAP file, ours or another program's;
//! * [`align()`]: the signals of a file at the times of a stored trace's rows, to be compared with the trace.

mod about;
mod align;
mod beside;
mod column;
pub mod csv;
mod csv_read;
mod export;
mod known;
mod mcap_read;
mod mcap_write;
mod parquet;
mod parquet_pages;
mod parquet_read;
mod parquet_values;
mod part;
mod run_mcap;
mod series;
mod times;
mod utf16;

pub use about::TraceInfo;
pub use align::{Aligned, align};
pub use beside::beside;
pub use column::column_name;
pub use export::{Format, export};
pub(crate) use parquet::schema_column;
pub use part::{Seconds, TracePart};
pub use run_mcap::RunMcap;
pub use series::{Import, import, is_importable};
pub use times::{Columns, TimeUnit};
