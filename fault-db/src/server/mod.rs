//! A PostgreSQL server that holds the history of many laptops: address, connection, schema, setup.

mod address;
mod address_in_text;
mod connect;
mod password;
pub(crate) mod schema;
mod setup;
mod tls;

pub use address::Address;
pub use schema::SERVER_SCHEMA_VERSION;
pub use setup::ServerSetup;
