//! Holds a recorded service run against its own target and against the run of a sound unit through the same section:
//! same line, same unit configuration, an empty train on a dry day unless something else is asked for.
//!
//! Both are laid side by side by place, because a late departure is no fault. The record says what the unit believed:
//! its position is corrected at markers, its speed is ATO's.

use std::fmt;

use btu_rig::drive::Ending;
use fault_db::TraceData;
use protocol::CYCLE;
use protocol::line::Section;
use protocol::signal::Signal;

use crate::drive::{Case, drive};
use crate::failure::{Failure, RecordTrouble};

/// Difference of a speed, km/h, that may last; a greater one may last less than [`FOR_ROWS`] rows.
const SPEED_KMH: f64 = 3.0;
/// Number of rows from which on a greater difference is a failure [default: 1 s].
const FOR_ROWS: usize = 20;
/// A brake is late if it begins more than this behind the sound unit's, m [default].
const LATE_M: f64 = 10.0;
/// Efforts below this are braking.
const BRAKES: f64 = -20.0;
/// Below this speed nothing is compared, km/h: the last metre is judged as the stop.
const SLOW_KMH: f64 = 3.0;
/// Up to this speed a record that ends counts as one that ends at rest, km/h: the train goes 8 cm more at most. ATP
/// takes the train out of Automatic Run, and the record ends, when ATO has arrived.
pub(super) const RESTS_KMH: f64 = 1.0;

/// Where two curves part for the first time.
#[derive(Clone, Debug, PartialEq)]
pub struct Parting {
    /// The signal: `speed`, which differs from the run's own `target`, or a signal that differs
    /// from the sound unit's.
    pub signal: &'static str,
    /// Reference of the comparison: `target` or `twin`.
    pub against: &'static str,
    /// Seconds since departure.
    pub at_s: f64,
    /// Place in the section, m.
    pub at_m: f64,
    /// What came and what was expected, km/h.
    pub came_kmh: f64,
    pub expected_kmh: f64,
    /// Greatest difference anywhere, km/h.
    pub most_kmh: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopComparison {
    /// Place at rest less stop point, m, as the unit believed; above 0 = past it. None if the record does not end at
    /// rest.
    pub error_m: Option<f64>,
    /// Error of the sound unit's stop, as that unit believed.
    pub twin_error_m: Option<f64>,
    /// Stops within this count as aligned, m.
    pub aligned_m: f64,
}

/// A recorded run beside what it should have been.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordComparison {
    pub section: u16,
    /// Where curves part, the first one first.
    pub partings: Vec<Parting>,
    pub stop: StopComparison,
    /// Place where the run's brake for the stop begins, m.
    pub brake_m: Option<f64>,
    /// The sound unit's.
    pub twin_brake_m: Option<f64>,
    /// Time of the run from departure to rest, s.
    pub run_time_s: Option<f64>,
    /// The sound unit's.
    pub twin_run_time_s: Option<f64>,
    /// Markers that the sound unit passed and the run did not.
    pub markers_missed: Vec<u8>,
    pub notes: Vec<String>,
}

/// A run as rows from its departure on.
#[derive(Default)]
struct Curve {
    /// Rows whose place and speed are known.
    rows: Vec<Point>,
    /// Markers in the order in which they were passed.
    markers: Vec<u8>,
}

/// Signals that a curve is made of, in the order of [`Curve::of`].
const SIGNALS: [Signal; 6] = [
    Signal::Speed,
    Signal::Target,
    Signal::Position,
    Signal::Effort,
    Signal::Marker,
    Signal::MarkerCount,
];

#[derive(Clone, Copy)]
struct Point {
    /// Seconds since departure.
    t_s: f64,
    /// Place in the section, m.
    x_m: f64,
    speed_kmh: f64,
    target_kmh: f64,
    effort: f64,
}

/// Holds a recorded run against its target and a sound unit's run, which is driven for it.
///
/// # Errors
/// The trace is no run record, or the train never moves in it.
pub fn compare(
    trace: &TraceData,
    section: &Section,
    case: &Case,
) -> Result<RecordComparison, Failure> {
    let came = Curve::of_trace(trace)?;
    let mut plan = case.plan.clone();
    plan.tester = true;
    let outcome = drive(&case.bench, plan, case.seed);
    let rows = outcome.rows.iter();
    let rows = rows.map(|row| SIGNALS.map(|signal| row.value(signal)));
    let twin = Curve::of(rows.collect(), CYCLE.as_secs()).unwrap_or_default();
    // No controller is at its target at once: a run that is as far from its target as the sound unit follows the
    // target.
    let follows = |row: &Point| {
        let behind = twin
            .at(row.x_m)
            .map_or(0.0, |twin| twin.speed_kmh - twin.target_kmh);
        Some(row.target_kmh + behind)
    };
    let mut partings: Vec<_> = [
        parting(&came, ("speed", "target"), &follows, &|row| row.speed_kmh),
        parting(
            &came,
            ("target", "twin"),
            &|row| twin.at(row.x_m).map(|twin| twin.target_kmh),
            &|row| row.target_kmh,
        ),
        parting(
            &came,
            ("speed", "twin"),
            &|row| twin.at(row.x_m).map(|twin| twin.speed_kmh),
            &|row| row.speed_kmh,
        ),
    ]
    .into_iter()
    .flatten()
    .collect();
    partings.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    let missed = twin
        .markers
        .iter()
        .filter(|marker| !came.markers.contains(marker));
    let mut notes = vec![
        "the sound unit drove an empty train on a dry rail unless asked otherwise; a loaded train and a slippery rail \
         part from it, too"
            .to_owned(),
    ];
    if trace.gaps {
        notes.push("rows of the record are missing: nothing is said of them".to_owned());
    }
    if !matches!(outcome.ending, Ending::Stopped) {
        notes.push(format!(
            "the sound unit's own run ended otherwise: {}",
            outcome.ending
        ));
    }
    Ok(RecordComparison {
        section: section.section,
        stop: StopComparison {
            error_m: came.rest_m().map(|x_m| x_m - section.stop_m),
            twin_error_m: twin.rest_m().map(|x_m| x_m - section.stop_m),
            aligned_m: case.bench.config.content.doors.aligned_m,
        },
        brake_m: came.brake_m(),
        twin_brake_m: twin.brake_m(),
        run_time_s: came.run_time_s(),
        twin_run_time_s: twin.run_time_s(),
        markers_missed: missed.copied().collect(),
        partings,
        notes,
    })
}

impl RecordComparison {
    /// Distance by which the brake began later than the sound unit's, m, if it is late.
    pub fn late_m(&self) -> Option<f64> {
        let later_m = self.brake_m? - self.twin_brake_m?;
        (later_m > LATE_M).then_some(later_m)
    }

    /// The train stopped outside of where doors may be opened.
    pub fn is_misaligned(&self) -> bool {
        self.stop
            .error_m
            .is_some_and(|error_m| error_m.abs() > self.stop.aligned_m)
    }

    /// Whether no curve parts, the stop is right, no brake is late and no marker is missed.
    pub fn is_as_expected(&self) -> bool {
        self.partings.is_empty()
            && !self.is_misaligned()
            && self.late_m().is_none()
            && self.markers_missed.is_empty()
    }
}

impl Curve {
    fn of_trace(trace: &TraceData) -> Result<Self, Failure> {
        let column = |signal: Signal| {
            let name = signal.definition().name;
            trace
                .column(name)
                .ok_or_else(|| Failure::usage(RecordTrouble::NoRunRecord(name.to_owned())))
        };
        let columns: Vec<_> = SIGNALS.into_iter().map(column).collect::<Result<_, _>>()?;
        let rows = (0..trace.rows()).map(|row| std::array::from_fn(|at| columns[at][row]));
        Self::of(rows.collect(), trace.period_us as f64 / 1e6)
            .ok_or_else(|| Failure::usage(RecordTrouble::NeverMoves))
    }

    /// The curve of rows of [`SIGNALS`] that are `period_s` apart; none if the train never moves.
    fn of(rows: Vec<[f64; SIGNALS.len()]>, period_s: f64) -> Option<Self> {
        let departs = rows.iter().position(|[speed_kmh, ..]| *speed_kmh > 0.0)?;
        let points = (0..).zip(&rows[departs..]).map(|(place, row)| {
            let [speed_kmh, target_kmh, x_m, effort, ..] = *row;
            Point {
                t_s: f64::from(place) * period_s,
                x_m,
                speed_kmh,
                target_kmh,
                effort,
            }
        });
        let markers = rows.windows(2).filter_map(|pair| {
            let ([.., before], [.., marker, count]) = (pair[0], pair[1]);
            (count != before && marker as u8 != 0).then_some(marker as u8)
        });
        Some(Self {
            rows: points
                .filter(|point| !point.speed_kmh.is_nan() && !point.x_m.is_nan())
                .collect(),
            markers: markers.collect(),
        })
    }

    /// The first row at or after a place; `None` beyond the ends.
    fn at(&self, x_m: f64) -> Option<&Point> {
        let after = self.rows.partition_point(|row| row.x_m < x_m);
        self.rows.get(after).filter(|_| after > 0)
    }

    /// Place where the train rests at the end.
    fn rest_m(&self) -> Option<f64> {
        let last = self.rows.last()?;
        (last.speed_kmh <= RESTS_KMH).then_some(last.x_m)
    }

    fn run_time_s(&self) -> Option<f64> {
        self.rest_m()?;
        let last = self
            .rows
            .iter()
            .rposition(|row| row.speed_kmh > RESTS_KMH)?;
        Some(self.rows[last].t_s)
    }

    /// Where the brake for the stop begins: the last time that effort is not braking while the train still goes
    /// faster than half its greatest speed.
    fn brake_m(&self) -> Option<f64> {
        self.rest_m()?;
        let most = self
            .rows
            .iter()
            .map(|row| row.speed_kmh)
            .fold(0.0, f64::max);
        let last = self
            .rows
            .iter()
            .rposition(|row| row.effort > BRAKES && row.speed_kmh > most / 2.0)?;
        self.rows.get(last + 1).map(|row| row.x_m)
    }
}

/// First place where a value differs from the expected one for longer than it may.
fn parting(
    came: &Curve,
    (signal, against): (&'static str, &'static str),
    expected: &dyn Fn(&Point) -> Option<f64>,
    value: &dyn Fn(&Point) -> f64,
) -> Option<Parting> {
    let (mut first, mut rows, mut most_kmh) = (None, 0, 0.0_f64);
    let mut found: Option<(&Point, f64)> = None;
    for row in came.rows.iter().filter(|row| row.speed_kmh > SLOW_KMH) {
        let Some(expected) = expected(row) else {
            continue;
        };
        let apart = value(row) - expected;
        if apart.abs() <= SPEED_KMH {
            (first, rows) = (None, 0);
            continue;
        }
        rows += 1;
        let begin = *first.get_or_insert((row, expected));
        if rows >= FOR_ROWS {
            found.get_or_insert(begin);
            most_kmh = most_kmh.max(apart.abs());
        }
    }
    let (row, expected_kmh) = found?;
    Some(Parting {
        signal,
        against,
        at_s: row.t_s,
        at_m: row.x_m,
        came_kmh: value(row),
        expected_kmh,
        most_kmh,
    })
}

impl fmt::Display for Parting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let against = match self.against {
            "target" => "what its own target asks for",
            _ => "the sound unit's",
        };
        write!(
            f,
            "{} parts from {against} at {:.1} m, {:.1} s after departure: {:.1} km/h for {:.1} km/h, at most {:.1} km/h \
             apart",
            self.signal, self.at_m, self.at_s, self.came_kmh, self.expected_kmh, self.most_kmh
        )
    }
}
