//! A server's runs against their seals.

use fault_db::Problem;

use crate::common::tells;
use crate::laptop::{Laptop, as_owner, day, read_only};
use crate::private::shared;

/// Goal: what was changed on the server, by who owns it, is found there.
#[test]
fn a_run_that_was_changed_on_the_server_is_found_by_its_seal() {
    let address = shared().database();
    let (one, two) = (Laptop::new("one"), Laptop::new("two"));
    for n in 0..3 {
        one.run("U-1", day(n), &[101], true);
        two.run("U-2", day(n), &[], false);
    }
    one.sync(&address);
    two.sync(&address);
    let check = || {
        let report = read_only(&address).expect("a server").check();
        let report = report.expect("a check");
        assert_eq!(report.runs, 6);
        report.problems
    };
    assert_eq!(check(), []);
    as_owner(
        &address,
        "ALTER TABLE run DISABLE TRIGGER only_added;
         UPDATE run SET verdict = 'failed' WHERE seq = (SELECT min(seq) FROM run WHERE verdict = 'passed')",
    );
    let found = check();
    for (kind, words) in [
        ("seal", "was changed after it was sealed"),
        ("schema", "only_added"),
    ] {
        let is_told = |it: &Problem| it.kind.as_str() == kind && tells(it, words);
        assert!(found.iter().any(is_told), "{found:?}");
    }
}
