//! fault-db
