//! What the crate promises.

mod diagnosis;
mod matrix;
mod matrix_reading;
