//! What the crate promises.

mod iscas;
mod iscas_errors;
mod matrix;
mod matrix_reading;
mod published;
