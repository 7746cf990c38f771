//! Promises of the crate: codecs, vectors, hostile bytes, and the document of the wire.

mod common;
mod hostile;
mod properties;
mod vectors;
mod wire_document;
