//! Compares the files of many laptops with their server: rows, faults and states.

use std::collections::{BTreeMap, BTreeSet};

use fault_db::{FaultDetail, FaultFilter, Id, Refusals, Store};
use postgres::Client;

use crate::counts;
use crate::laptop::{Laptop, open_faults, read_only};

/// Content that all files and the server share.
pub struct Same {
    pub rows: usize,
    pub faults: usize,
    /// Faults that several laptops know.
    pub joined: usize,
    /// Faults that people left in different states without knowing of each other.
    pub in_conflict: usize,
}

/// Rows that several files may have: the table, and what they are known by in a file and on a server.
const SHARED: [(&str, &str, &str); 6] = [
    ("unit", "serial", "serial"),
    ("run", HEX_HERE, HEX_THERE),
    ("fault_occurrence", HEX_HERE, HEX_THERE),
    ("fault_event", HEX_HERE, HEX_THERE),
    ("run_note", HEX_HERE, HEX_THERE),
    ("trace", HEX_HERE, HEX_THERE),
];
const HEX_HERE: &str = "lower(hex(id))";
const HEX_THERE: &str = "encode(id, 'hex')";

/// Rows that only the file has that recorded them.
const OWN: [&str; 8] = [
    "run",
    "run_script",
    "step",
    "measurement",
    "fault_occurrence",
    "run_note",
    "trace",
    "seal",
];

/// Lets each laptop sync until nothing waits, and holds its file to the server.
pub fn everything(address: &str, laptops: &[Laptop], client: &mut Client) -> Same {
    sync_twice(address, laptops);
    let server = read_only(address).expect("a server");
    assert_eq!(server.check().expect("a check").problems, []);
    let rows = rows(laptops, client);
    let (faults, joined) = faults(laptops, &server);
    let in_conflict = server.conflicts().expect("conflicts").len();
    Same {
        rows,
        faults,
        joined,
        in_conflict,
    }
}

/// The second time nothing is new to anybody.
fn sync_twice(address: &str, laptops: &[Laptop]) {
    for is_second in [false, true] {
        for laptop in laptops {
            let told = laptop.sync(address);
            let name = laptop.name;
            let sent = (told.runs, told.occurrences, told.notes, told.traces);
            assert_eq!((told.waiting, sent), (0, (0, 0, 0, 0)), "{name}");
            assert_eq!((told.different, told.damaged_traces), (vec![], vec![]));
            assert_eq!(told.refused, Refusals::default(), "{name}");
            if is_second {
                assert_eq!((told.events, told.events_received), (0, 0), "{name}");
            }
        }
    }
    for laptop in laptops {
        laptop.is_whole();
    }
}

/// Holds that each row of each file is on the server once, and nothing else; the number of rows there.
fn rows(laptops: &[Laptop], client: &mut Client) -> usize {
    for (table, key_here, key_there) in SHARED {
        let mut here = BTreeSet::new();
        for laptop in laptops {
            let file = rusqlite::Connection::open(laptop.path()).expect("its file");
            let sql = format!("SELECT {key_here} FROM {table}");
            let mut select = file.prepare(&sql).expect("a question");
            let keys = select.query_map([], |row| row.get::<_, String>(0));
            here.extend(keys.expect("asked").map(|key| key.expect("a text")));
        }
        let sql = format!("SELECT {key_there} FROM {table}");
        let there = client.query(&sql, &[]).expect("an answer");
        let mut there: Vec<String> = there.iter().map(|row| row.get(0)).collect();
        there.sort_unstable();
        assert_eq!(there, Vec::from_iter(here), "{table}");
    }
    let there = counts::of_server(client);
    let files = laptops.iter().map(|laptop| counts::of_file(&laptop.path()));
    let files: Vec<_> = files.collect();
    for table in OWN {
        let here: i64 = files.iter().map(|counts| counts[table]).sum();
        assert_eq!(there[table], here, "{table}");
    }
    usize::try_from(there.values().sum::<i64>()).expect("a number of rows")
}

/// Holds that each fault of each file has the state, cause and events that it has on the server; their number there,
/// and how many of them several laptops know.
fn faults(laptops: &[Laptop], server: &Store) -> (usize, usize) {
    let told = |detail: &FaultDetail| {
        let fault = &detail.fault;
        let events: BTreeSet<Id> = detail.history().iter().map(|event| event.id).collect();
        let place = (fault.unit_serial.clone(), fault.code);
        (place, fault.state, fault.cause.clone(), events)
    };
    let mut there = BTreeMap::new();
    for id in open_faults(server) {
        there.insert(id, told(&server.fault(id).expect("the fault")));
    }
    let mut known: BTreeMap<Id, BTreeSet<&str>> = BTreeMap::new();
    for laptop in laptops {
        let store = laptop.open();
        for fault in store.faults(&FaultFilter::default()).expect("faults") {
            let same = server.resolve_fault(&fault.id.to_string()).expect("known");
            let here = told(&store.fault(fault.id).expect("the fault"));
            assert_eq!(here, there[&same], "{}: fault {}", laptop.name, fault.id);
            known.entry(same).or_default().insert(laptop.name);
        }
    }
    assert!(known.keys().eq(there.keys()), "a fault that no laptop saw");
    let joined = known.values().filter(|laptops| laptops.len() > 1).count();
    (there.len(), joined)
}
