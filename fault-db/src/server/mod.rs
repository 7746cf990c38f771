//! A PostgreSQL server that holds the history of many laptops: address, connection, schema, setup.

mod address;
mod bounded;
mod connect;
pub(crate) mod derived_columns;
mod password;
pub(crate) mod query;
pub(crate) mod schema;
pub(crate) mod server_error;
mod setup;
mod tls;

pub use address::Address;
pub use schema::SERVER_SCHEMA_VERSION;
pub use setup::ServerSetup;
