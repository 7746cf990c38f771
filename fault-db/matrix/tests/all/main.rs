//! Tests of decision trees against published problems and results.

mod iscas;
mod iscas_errors;
mod matrix;
mod matrix_reading;
mod published;
