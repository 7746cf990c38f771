//! The technician's window: one frame with a connection bar, and pages below it.
//!
//! Widgets show what other rooms compute: a [`crate::station`] drives the unit on its own thread, the
//! [`library`] asks the database on another, and no page waits for either.

mod app;
mod desk;
mod display;
mod fonts;
pub mod frame;
pub mod library;
mod pages;
mod parts;
mod settings;
mod theme;
mod units;

pub use app::{App, Options};
pub use desk::{Desk, Go, Messages};
pub use display::open;
pub use pages::Page;
pub use settings::Settings;
pub use theme::Palette;
pub use units::{Unit, UnitChoice, Units};
