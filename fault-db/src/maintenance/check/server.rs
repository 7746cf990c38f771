//! Checks of a server from a client: the seals of its runs, and the triggers that make its tables
//! append-only.

use super::{Advice, CheckReport, Damage, Findings, ProblemKind, chain};
use crate::error::StoreError;
use crate::store::Store;

const DOING: &str = "checking the server";

/// Triggers that are missing or disabled.
const OFF: &str = "
    SELECT t.name, x.trigger FROM (VALUES ('run'), ('run_script'), ('step'), ('measurement'), ('recording'),
        ('channel_set'), ('trace'), ('fault_occurrence'), ('fault_event'), ('run_note'), ('seal')) AS t(name)
    CROSS JOIN (VALUES ('only_added'), ('only_added_1'), ('only_added_2'), ('in_domain')) AS x(trigger)
    WHERE NOT EXISTS (SELECT 1 FROM pg_trigger g WHERE g.tgrelid = to_regclass(t.name)
        AND g.tgname = x.trigger AND g.tgenabled IN ('O', 'A'))
    ORDER BY 1, 2";

pub(super) fn check(store: &Store) -> Result<CheckReport, StoreError> {
    let mut report = CheckReport::default();
    let problems = &mut report.problems;
    let mut found = Findings::new(problems, ProblemKind::Schema, Advice::GuardsOfServer);
    found.add_all(store.select(DOING, OFF, &[], |row| {
        Ok(Damage::NoGuard(row.get(1)?, row.get(0)?))
    })?);
    drop(found);
    let found = Findings::new(problems, ProblemKind::Seal, Advice::SealsOfServer);
    (report.runs, report.signed) = store.ask(DOING, |server| {
        chain::check(server, found, &mut report.remarks)
    })?;
    Ok(report)
}
