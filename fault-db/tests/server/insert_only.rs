//! Rows on the server can only be added, for any account.

use crate::common::{Deeds, refused};
use crate::laptop::{Laptop, day};
use crate::private::{name_of, shared};

#[test]
fn recorded_rows_on_a_server_can_be_neither_changed_nor_deleted() {
    let address = shared().database();
    let laptop = Laptop::new("careful");
    let run = laptop.run("U-1", day(0), &[101], true);
    laptop.open().put_run_note(run, "kim", "noted", day(0));
    laptop.sync(&address);
    let mut client = shared().client(name_of(&address));
    for sql in [
        "UPDATE run SET verdict = 'passed'",
        "UPDATE run SET verdict = NULL",
        "UPDATE run SET operator = 'x'",
        "DELETE FROM run",
        "UPDATE run_script SET sha256 = ''",
        "UPDATE step SET message = 'x'",
        "DELETE FROM step",
        "UPDATE measurement SET value = 0.1",
        "DELETE FROM measurement",
        "UPDATE fault_occurrence SET at_us = 0",
        "UPDATE fault_occurrence SET trace = NULL",
        "DELETE FROM fault_occurrence",
        "UPDATE fault_event SET who = 'x'",
        "UPDATE fault_event SET state = 'closed', fault = fault + 1",
        "DELETE FROM fault_event",
        "UPDATE run_note SET text = 'x'",
        "UPDATE trace SET flags = 0",
        "DELETE FROM trace",
        "DELETE FROM channel_set",
        "UPDATE seal SET hash = digest",
        "DELETE FROM seal",
        "DELETE FROM unit",
        "TRUNCATE measurement",
        "TRUNCATE run CASCADE",
    ] {
        let refused = client.batch_execute(sql).expect_err(sql);
        let said = refused.as_db_error().expect(sql).message().to_owned();
        assert!(said.contains("only ever added"), "{sql}: {said}");
    }
    let in_use = client.batch_execute("DELETE FROM fault");
    assert!(in_use.is_err(), "a fault with a history stays");
    // A trace that did not arrive as it was sent is no trace.
    let flipped = client.batch_execute(
        "INSERT INTO trace(id, run, t0_bench_us, t0_us, period_us, row_count, flags, channel_set,
            encoding, sha256, data)
         SELECT '\\x00', run, 0, 0, 1, 1, 0, channel_set, 1, sha256, data || '\\x00' FROM trace LIMIT 1",
    );
    refused!(flipped, _, "db error");
}
