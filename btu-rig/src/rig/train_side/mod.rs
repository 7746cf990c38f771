//! The train around the unit: wheels and tachometers, cab desk and doors, TCMS's end of its link, and what is
//! broken in it or in the bench.

mod bench_faults;
mod cab_desk;
mod coils;
mod door_gear;
mod motion;
mod tacho;
mod tcms_port;
mod train_faults;
mod true_motion;
mod wheel;

pub use bench_faults::Wires;
pub use cab_desk::CabDesk;
pub use coils::{Coils, InCoils};
pub use door_gear::DoorGear;
pub use motion::Motion;
pub use tacho::{MAX_AGE_US, Tacho};
pub use tcms_port::{TcmsPort, TrainSeen};
pub use train_faults::{Injected, Misplaced, TrainFaults, check_places};
pub use true_motion::{SpeedHistory, TrueMotion};
pub use wheel::Wheel;
