//! COM: the links to bench, TCMS, wayside and tester [S0 §3.2].

mod image;
mod maintenance;
mod pace;
mod ports;
mod reject_watch;
mod tcms;

pub use image::IoImage;
pub use maintenance::{ArmConditions, Maintenance};
pub use ports::{Port, Ports};
pub use reject_watch::RejectWatch;
pub use tcms::TcmsLink;
