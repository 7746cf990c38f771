//! `ptu db server`: sets up and checks a server that collects the history of many laptops.

use clap::{Args, Subcommand};
use fault_db::{Address, ServerSetup, Store};

use crate::cli::Json;
use ptu_runs::clock;
use ptu_runs::failure::{Exit, Failure};

/// Default name of the laptops' account on the server.
const LAPTOPS: &str = "ptu";

#[derive(Debug, Args)]
pub(super) struct ServerArguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Make the tables, or bring them up to date, and let laptops add rows and read
    ///
    /// Run once by whoever looks after the server, with the account that owns the database or as a superuser; a second
    /// run changes nothing. The laptops' account may add rows and read, but neither change nor remove rows.
    ///
    /// Exit codes: 0 done, 2 wrong address, 3 no server, or the account may not do this.
    Init {
        /// The server, as postgres://OWNER@HOST/DATABASE; write a password into ~/.pgpass
        #[arg(value_name = "ADDRESS")]
        server: String,
        /// The account laptops log in with; made if it is not there
        #[arg(long, value_name = "ACCOUNT", default_value = LAPTOPS)]
        laptops: String,
        #[command(flatten)]
        json: Json,
    },
}

impl ServerArguments {
    pub(super) fn run(self) -> Result<Exit, Failure> {
        let Verb::Init {
            server,
            laptops,
            json,
        } = self.verb;
        let address: Address = server.parse()?;
        let done = Store::set_up_server(&address, clock::ids(), &laptops)?;
        json.answer(|| &done, || told(&done, &address))
    }
}

/// Text that says what was done, and what is left to do by hand.
fn told(done: &ServerSetup, address: &Address) -> String {
    let ServerSetup {
        server,
        database,
        owner,
        laptops,
        schema,
        ..
    } = done;
    let tables = match done.schema_before {
        None => format!("tables made (schema {schema})"),
        Some(before) if before < *schema => {
            format!("tables brought from schema {before} to {schema}")
        }
        Some(_) => format!("tables were there (schema {schema})"),
    };
    let password = match done.made_account {
        true => {
            format!("a password for {laptops}, which has none yet: \\password {laptops} in psql")
        }
        false => format!("a password for {laptops}, if it has none: \\password {laptops} in psql"),
    };
    let place = address.to_string().replacen(&format!("{owner}@"), "", 1);
    let place = place.trim_start_matches("postgres://");
    format!(
        "{server}\n{tables}; they belong to {owner}\n{laptops} may add rows and read, and nothing else\n\n\
         next, on the server:\n  {password}\n  for laptops on the network, in pg_hba.conf: hostssl {database} \
         {laptops} 10.0.0.0/8 scram-sha-256\nand on each laptop:\n  in ~/.pgpass (chmod 600): \
         HOST:PORT:{database}:{laptops}:PASSWORD\n  ptu db sync postgres://{laptops}@{place}"
    )
}
