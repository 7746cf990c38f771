//! Rows of a unit's run record, cut into runs, each as a trace on the grid of cycles.

use std::collections::BTreeMap;

use fault_db::{Channel, Id, TraceData};
use protocol::message::{Message, StoredRow};
use protocol::signal::Signal;
use protocol::{CYCLE, Speed};

use crate::run::channel;
use crate::unit_log::StoredRead;

/// Most rows of a trace, 30 min: later rows, as after a long stand, are left out.
const MOST_ROWS: usize = 36_000;

/// The signals that a row tells of.
const SIGNALS: [Signal; 7] = [
    Signal::Speed,
    Signal::Target,
    Signal::Position,
    Signal::Effort,
    Signal::Marker,
    Signal::MarkerCount,
    Signal::AtoState,
];

/// One run of one power-up.
#[derive(Clone, Debug)]
pub struct RecordedRun {
    /// Id of the run, equal on every laptop: made from the unit and all rows of the run.
    pub id: Id,
    /// Power-up in which the run was made.
    pub power_up: u32,
    /// Number of the run since that power-up.
    pub run: u16,
    /// Time since that power-up at its first row, ms.
    pub at_ms: u32,
    /// When it began, µs UTC, and by how much that may be wrong; none where the unit was not given the time.
    pub date: Option<(i64, Option<i64>)>,
    pub trace: TraceData,
    /// Rows before the first that is kept were overwritten or damaged: it does not begin where the run did.
    pub is_cut: bool,
}

/// Rest of the last run of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rest {
    /// The rest is complete: the record was read to its end, and the run is over.
    Nothing,
    /// The unit may still add to a run of its present power-up.
    OfUnit,
    /// The record was not read to its end.
    Unread,
}

/// The runs of a unit, in order, without the last one if more of it may come.
pub fn recorded_runs(serial: &str, read: &StoredRead, rest: Rest) -> Vec<RecordedRun> {
    let mut runs: BTreeMap<(usize, u32, u16), Vec<StoredRow>> = BTreeMap::new();
    // A run number that comes again in a power-up has wrapped, or another flash counts from the start.
    let mut turn = 0;
    let mut last: Option<&StoredRow> = None;
    for row in &read.rows {
        if last.is_some_and(|last| (last.power_up, last.run) > (row.power_up, row.run)) {
            turn += 1;
        }
        last = Some(row);
        let rows = runs.entry((turn, row.power_up, row.run)).or_default();
        rows.push(*row);
    }
    let newest = runs.keys().next_back().copied();
    let is_open = |key: &(usize, u32, u16)| {
        let may = match rest {
            Rest::Nothing => false,
            Rest::OfUnit => key.1 == read.power_up,
            Rest::Unread => true,
        };
        may && Some(*key) == newest
    };
    let complete = runs.iter().filter(|(key, _)| !is_open(key));
    complete
        .map(|(_, rows)| run_of(serial, read, rows))
        .collect()
}

fn run_of(serial: &str, read: &StoredRead, rows: &[StoredRow]) -> RecordedRun {
    let first = rows[0];
    let (grid, partial) = on_grid(rows);
    let date = read.clocks.date(first.power_up, first.at_ms);
    let column = |signal: &Signal| {
        let values = grid
            .iter()
            .map(|row| row.map_or(f64::NAN, |row| value(*signal, row)));
        values.collect::<Vec<_>>()
    };
    let moves = |row: &Option<Shown>| row.is_some_and(|row| row.row.speed_cms > 0);
    let trace = TraceData {
        t0_bench_us: i64::from(first.at_ms) * 1000,
        t0_us: date.map_or(0, |date| date.at_us),
        period_us: CYCLE.as_us() as i64,
        trigger_row: Some(grid.iter().position(moves).unwrap_or(0) as u32),
        partial,
        gaps: grid.iter().any(Option::is_none),
        channels: SIGNALS
            .iter()
            .map(|signal| channel(*signal))
            .collect::<Vec<Channel>>(),
        columns: SIGNALS.iter().map(column).collect(),
    };
    RecordedRun {
        id: id_of(serial, rows),
        power_up: first.power_up,
        run: first.run,
        at_ms: first.at_ms,
        date: date.map(|date| (date.at_us, date.uncertainty_us)),
        trace,
        is_cut: first.speed_cms > 0,
    }
}

/// Made from the unit and all of each row: with a new memory every run of a unit begins with the same first row.
fn id_of(serial: &str, rows: &[StoredRow]) -> Id {
    let mut all = Vec::new();
    for row in rows {
        Message::from(*row).encode(&mut all);
    }
    Id::of_content("unit run record", &[serial.as_bytes(), &all])
}

/// A row with the marker passed last and the number of markers until then.
#[derive(Clone, Copy)]
struct Shown {
    row: StoredRow,
    marker: u8,
    markers: u8,
}

/// Rows at each cycle from the first to the last. The unit leaves out rows that would only repeat that the train
/// stands; any other row that is missing is not known. True if rows after [`MOST_ROWS`] are left out.
fn on_grid(rows: &[StoredRow]) -> (Vec<Option<Shown>>, bool) {
    let cycle_ms = CYCLE.as_ms() as u32;
    let mut grid: Vec<Option<Shown>> = Vec::new();
    let (mut marker, mut markers) = (0, 0u8);
    let mut last: Option<Shown> = None;
    for row in rows {
        let cycles = row
            .at_ms
            .wrapping_sub(rows[0].at_ms)
            .saturating_add(cycle_ms / 2)
            / cycle_ms;
        let place = cycles as usize;
        if place >= MOST_ROWS {
            return (grid, true);
        }
        let stands = last.filter(|last| {
            last.row.speed_cms == 0 && last.row.sequence.wrapping_add(1) == row.sequence
        });
        while grid.len() < place {
            grid.push(stands);
        }
        if row.marker != 0 {
            marker = row.marker;
            markers = markers.wrapping_add(1);
        }
        let shown = Shown {
            row: *row,
            marker,
            markers,
        };
        last = Some(shown);
        // Of two rows in one cycle, by a clock that jitters, the later one counts.
        grid.truncate(place);
        grid.push(last);
    }
    (grid, false)
}

fn value(signal: Signal, shown: Shown) -> f64 {
    let Shown {
        row,
        marker,
        markers,
    } = shown;
    let kmh = |cms: u16| (Speed::from_cms(cms).kmh() * 1000.0).round() / 1000.0;
    match signal {
        Signal::Speed => kmh(row.speed_cms),
        Signal::Target => kmh(row.target_cms),
        Signal::Position => f64::from(row.position_cm) / 100.0,
        Signal::Effort => f64::from(row.effort),
        Signal::Marker => f64::from(marker),
        Signal::MarkerCount => f64::from(markers),
        Signal::AtoState => f64::from(row.ato_state.code()),
        _ => f64::NAN,
    }
}

#[cfg(test)]
pub(super) mod tests {
    use protocol::message::AtoState;

    use super::*;

    pub fn row(sequence: u32, power_up: u32, run: u16, at_ms: u32, speed_cms: u16) -> StoredRow {
        StoredRow {
            sequence,
            power_up,
            index: sequence,
            run,
            at_ms,
            position_cm: i32::try_from(at_ms / 10).expect("small"),
            speed_cms,
            target_cms: speed_cms,
            effort: 100,
            marker: 0,
            ato_state: AtoState::Run,
        }
    }

    fn read(rows: Vec<StoredRow>, power_up: u32) -> StoredRead {
        StoredRead {
            rows,
            power_up,
            ..StoredRead::default()
        }
    }

    #[test]
    fn each_run_of_a_power_up_is_a_trace_with_an_id_of_its_own_and_standing_is_filled_in() {
        let rows = vec![
            row(0, 1, 1, 1_000, 0),
            row(1, 1, 1, 1_200, 10),
            row(2, 1, 1, 1_250, 20),
            row(4, 1, 1, 1_350, 40),
            row(5, 1, 2, 9_000, 0),
            row(6, 2, 1, 1_000, 0),
        ];
        let all = read(rows.clone(), 2);
        let runs = recorded_runs("SG-1", &all, Rest::Nothing);
        let names: Vec<_> = runs.iter().map(|run| (run.power_up, run.run)).collect();
        assert_eq!(names, [(1, 1), (1, 2), (2, 1)]);
        let speed = runs[0].trace.column("speed").expect("recorded");
        assert_eq!(speed[..6], [0.0, 0.0, 0.0, 0.0, 0.36, 0.72]);
        assert!(speed[6].is_nan(), "damaged in the unit");
        assert_eq!((speed.len(), runs[0].trace.gaps), (8, true));
        assert_eq!(runs[0].trace.trigger_row, Some(4));
        assert!(runs[1].id != runs[0].id && runs[2].id != runs[0].id);
        assert_eq!(recorded_runs("SG-1", &all, Rest::Nothing)[0].id, runs[0].id);
        assert_ne!(recorded_runs("SG-2", &all, Rest::Nothing)[0].id, runs[0].id);
        assert_eq!(
            recorded_runs("SG-1", &all, Rest::OfUnit).len(),
            2,
            "one is under way"
        );
        let earlier = read(rows.clone(), 3);
        assert_eq!(recorded_runs("SG-1", &earlier, Rest::OfUnit).len(), 3);
        assert_eq!(recorded_runs("SG-1", &earlier, Rest::Unread).len(), 2);
    }

    /// Goal: a change of any field in any row gives another id, as for another unit with the same name.
    #[test]
    fn each_row_counts_for_the_id() {
        let rows = vec![row(0, 1, 1, 1_000, 0), row(1, 1, 1, 1_050, 10)];
        let id = |rows: Vec<StoredRow>| recorded_runs("SG-1", &read(rows, 1), Rest::Nothing)[0].id;
        let last = |change: fn(&mut StoredRow)| {
            let mut rows = rows.clone();
            change(&mut rows[1]);
            id(rows)
        };
        let ids = [
            id(rows.clone()),
            last(|row| row.at_ms += 1),
            last(|row| row.position_cm += 1),
            last(|row| row.speed_cms += 1),
            last(|row| row.target_cms += 1),
            last(|row| row.effort += 1),
            last(|row| row.marker += 1),
            last(|row| row.ato_state = AtoState::Stop),
            id(rows[..1].to_vec()),
        ];
        let different: std::collections::BTreeSet<_> = ids.iter().collect();
        assert_eq!(different.len(), ids.len());
    }
}
