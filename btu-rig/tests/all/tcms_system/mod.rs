//! TCMS as a whole: what it does with cabs, train lines, the unit's frames and the equipment's reports.

mod arbitrary;
mod bench;
mod brakes;
mod cabs;
mod link;
mod power_cuts;
mod put_again;
mod watch;
