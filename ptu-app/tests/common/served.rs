//! A served unit, and a client of its own that looks at the wire.
