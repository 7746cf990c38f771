//! A PostgreSQL server that holds the history of many laptops: where it is, who it is, its tables.

mod address;
mod bounded;
mod connect;
mod password;
pub(crate) mod query;
pub(crate) mod said;
pub(crate) mod schema;
mod setup;
mod tls;
pub(crate) mod trouble;

pub use address::Address;
pub use schema::SERVER_SCHEMA_VERSION;
pub use setup::ServerSetup;
