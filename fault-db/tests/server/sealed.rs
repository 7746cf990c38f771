//! A server's runs against their seals.

use crate::laptop::{Laptop, day, read_only};
use crate::private::{name_of, shared};

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
    let problems = || {
        let report = read_only(&address)
            .expect("a server")
            .check()
            .expect("a check");
        assert_eq!(report.runs, 6);
        let found = report.problems.into_iter();
        found
            .map(|problem| (problem.kind.as_str(), problem.detail.to_string()))
            .collect::<Vec<_>>()
    };
    assert_eq!(problems(), []);
    let mut owner = shared().client(name_of(&address));
    owner
        .batch_execute(
            "ALTER TABLE run DISABLE TRIGGER only_added;
             UPDATE run SET verdict = 'failed' WHERE seq = (SELECT min(seq) FROM run WHERE verdict = 'passed')",
        )
        .expect("the owner may");
    let found = problems();
    assert!(
        found.iter().any(|(kind, what)| *kind == "seal" && what.contains("was changed after it was sealed")),
        "{found:?}"
    );
    assert!(
        found
            .iter()
            .any(|(kind, what)| *kind == "schema" && what.contains("only_added")),
        "{found:?}"
    );
}
