//! What the program that serves the unit promises its TCP clients, by the clock, one after the other.

mod tcp;
