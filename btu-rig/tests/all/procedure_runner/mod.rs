//! Running procedures against a stand-in for bench and unit whose signals the test sets by hand.

mod attempts;
mod expectations;
mod measurements;
mod stand_in;
mod steps;
mod stopping;
mod trust;
