//! Questions asked of a history: by id, by filter, in numbers, and in SQL.

use std::path::Path;

use crate::care::{close_fault, one_run};
use crate::common::{T0_US, open, refused, with};
use fault_db::{
    FaultFilter, FaultState, Id, QueryBounds, QueryLimit, RunFilter, SqlValue, Store, StoreError,
    TrendQuery,
};
use tempfile::tempdir;

fn opened(path: &Path) -> (Store, Vec<Id>) {
    let store = open(path);
    let runs = (0..3)
        .map(|n| one_run(&store, &format!("ATC-{n}"), n).0)
        .collect();
    (store, runs)
}

#[test]
fn ids_are_found_by_beginning_end_and_latest() {
    let dir = tempdir().expect("a directory");
    let (store, runs) = opened(&dir.path().join("a.db"));
    for run in &runs {
        let text = run.to_string();
        assert_eq!(store.resolve_run(&text).ok(), Some(*run));
        assert_eq!(store.resolve_run(&text.to_uppercase()).ok(), Some(*run));
        assert_eq!(store.resolve_run(&run.short()).ok(), Some(*run));
        assert_eq!(store.resolve_run(&text[..25]).ok(), Some(*run));
    }
    assert_eq!(store.resolve_run("latest").ok(), Some(runs[2]));
    let asked = &runs[0].to_string()[..8];
    match store.resolve_run(asked) {
        Err(StoreError::Ambiguous { matches, .. }) => assert_eq!(matches, runs),
        other => panic!("{other:?}: all began in the same minute"),
    }
    assert!(matches!(
        store.resolve_run("ffffffff"),
        Err(StoreError::NotFound { .. })
    ));
    for bad in ["abc", "", "newest", "0123456789-0123456789-0123456789-abc"] {
        assert!(
            matches!(store.resolve_run(bad), Err(StoreError::BadId { .. })),
            "{bad}"
        );
    }
    let empty = open(&dir.path().join("b.db"));
    assert!(matches!(
        empty.resolve_fault("latest"),
        Err(StoreError::NotFound { .. })
    ));
}

#[test]
fn filters_and_trends_answer() {
    let dir = tempdir().expect("a directory");
    let (store, runs) = opened(&dir.path().join("a.db"));
    let count = |narrow: &dyn Fn(&mut FaultFilter)| {
        let mut filter = FaultFilter::default();
        narrow(&mut filter);
        store.faults(&filter).expect("listed").len()
    };
    let some = |text: &str| Some(text.to_owned());
    assert_eq!(count(&|_| ()), 3);
    assert_eq!(count(&|filter| filter.unit = some("ATC-1")), 1);
    assert_eq!(count(&|filter| filter.code = some("0x2")), 1);
    assert_eq!(count(&|filter| filter.code = some("fault_2")), 1);
    assert_eq!(count(&|filter| filter.code = some("nothing")), 0);
    assert_eq!(count(&|filter| filter.lru = some("atp-rx")), 3);
    assert_eq!(count(&|filter| filter.run = Some(runs[1])), 1);
    assert_eq!(count(&|filter| filter.since_us = Some(T0_US + 1)), 0);
    assert_eq!(count(&|filter| filter.until_us = Some(T0_US + 1)), 3);
    assert_eq!(count(&|filter| filter.limit = Some(2)), 2);
    let closed = store.faults(&FaultFilter::default()).expect("listed")[0].id;
    close_fault(&store, closed);
    let is_closed = vec![FaultState::Closed];
    assert_eq!(count(&|filter| filter.states = is_closed.clone()), 1);

    let filter = RunFilter {
        unit: some("ATC-2"),
        ..Default::default()
    };
    assert_eq!(store.runs(&filter).expect("listed")[0].id, runs[2]);

    let of = |measurement: &str, unit: Option<&str>| TrendQuery {
        measurement: measurement.to_owned(),
        unit: unit.map(str::to_owned),
        ..TrendQuery::default()
    };
    let points = store.trend(&of("eb_reaction", None)).expect("known");
    assert_eq!(points.len(), 3);
    let points = store.trend(&of("eb_reaction", Some("ATC-1")));
    let points = points.expect("known");
    assert_eq!(
        (points[0].value, points[0].high, points[0].run_id),
        (Some(0.42), Some(0.5), runs[1])
    );
    let misspelt = store.trend(&of("eb_reacton", None));
    refused!(misspelt, _, "no measurement \"eb_reacton\"");
}

#[test]
fn a_free_query_runs_within_its_limits() {
    let dir = tempdir().expect("a directory");
    let (store, _) = opened(&dir.path().join("a.db"));
    let bounds = with(|it: &mut QueryBounds| it.rows = 10);
    let endless =
        "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT count(*) FROM n";
    let mut looks = 0;
    let goes_on = move || {
        looks += 1;
        looks < 5
    };
    let limit = |error| match error {
        StoreError::QueryExceeds(limit) => limit,
        other => panic!("{other}"),
    };
    let stopped = store
        .query_within(endless, bounds, goes_on)
        .expect_err("stopped");
    assert_eq!(limit(stopped), QueryLimit::Stopped);
    let long = "SELECT zeroblob(10000000)";
    let refused = store.query_read_only(long, 10).expect_err("too long");
    assert_eq!(limit(refused), QueryLimit::Row);
    let answer = store.query_read_only(&format!("SELECT 1 UNION ALL {long}"), 10);
    let answer = answer.expect("the first row");
    assert!(answer.truncated && answer.rows == [[SqlValue::Integer(1)]]);
}

#[test]
fn free_questions_only_read() {
    let dir = tempdir().expect("a directory");
    let (store, runs) = opened(&dir.path().join("a.db"));
    let answer = store
        .query_read_only(
            "SELECT id, verdict, 1.5, NULL, seq FROM run ORDER BY seq; ",
            2,
        )
        .expect("answered");
    assert_eq!(answer.columns, ["id", "verdict", "1.5", "NULL", "seq"]);
    assert!(answer.truncated && answer.rows.len() == 2);
    let text = |text: &str| SqlValue::Text(text.to_owned());
    let first = [
        text(&runs[0].to_string()),
        text("failed"),
        SqlValue::Real(1.5),
        SqlValue::Null,
    ];
    assert_eq!(answer.rows[0][..4], first);
    let attached = dir.path().join("x.db");
    for sql in [
        "DELETE FROM run",
        "SELECT 1; DELETE FROM run",
        "SELECT 1; nonsense",
        "PRAGMA user_version = 9",
        "PRAGMA query_only = OFF",
        &format!("ATTACH '{}' AS x", attached.display()),
        "CREATE TEMP TABLE t(x)",
        "BEGIN IMMEDIATE",
        "VACUUM",
        "WITH x AS (SELECT 1) INSERT INTO unit SELECT 9, 'a', 'b', 'c', 'd'",
        "",
    ] {
        refused!(store.query_read_only(sql, 10), StoreError::QueryRefused(_));
    }
    assert!(!attached.exists());
    let misspelt = store.query_read_only("SELECT verdct FROM run", 10);
    refused!(misspelt, _, "no such column: verdct");
    assert_eq!(store.runs(&RunFilter::default()).expect("listed").len(), 3);
}
