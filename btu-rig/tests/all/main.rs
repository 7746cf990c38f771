mod procedure_loader;
mod procedure_runner;
mod ride;
mod tcms_exhaustive;
mod tcms_figures;
mod tcms_system;
mod train_figures;

use protocol::config::UnitConfig;
use protocol::line::Line;

/// The unit configuration and the line that tests use.
fn shipped() -> (UnitConfig, Line) {
    let unit = UnitConfig::from_toml(include_str!("../../../scripts/units/sg100.toml"));
    let line = Line::from_toml(include_str!("../../../scripts/lines/line8.toml"));
    (unit.unwrap(), line.unwrap())
}
