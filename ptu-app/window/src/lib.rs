//! The technician's window: one frame with a connection bar, and pages below it.
//!
//! Drawing never waits: each unit is driven by its own bench thread ([`ptu_runs::bench_worker`]), and queries to the
//! database and to files run on the thread of a `QueryWorker`.

mod app;
mod data_paths;
mod data_watch;
mod density;
mod display;
mod fonts;
mod frame;
mod messages;
mod page_context;
mod pages;
mod parts;
#[cfg(test)]
#[path = "../tests/common/picture.rs"]
mod picture;
mod query_worker;
mod request;
mod settings;
mod theme;
mod units;

pub use app::{App, Options};
pub use data_paths::DataPaths;
pub use density::Density;
pub(crate) use density::Sizes;
pub use display::open;
pub(crate) use messages::Messages;
pub(crate) use page_context::{Destination, PageContext, Wanted};
pub use parts::SavedQuestion;
use ptu_options::Page;
pub use settings::Settings;
pub(crate) use theme::Palette;
