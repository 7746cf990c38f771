//! What the crate promises.

mod diagnosis;
mod iscas;
mod iscas_errors;
mod matrix;
mod matrix_reading;
mod proof;
mod published;
