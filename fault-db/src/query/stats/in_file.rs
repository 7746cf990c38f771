//! Counts in a file, by reading all packed faults with their occurrences and repairs (table `packed`).

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use super::super::fault_filter::{FaultFilter, Resolved};
use super::cases::{Case, CaseRepair, RepairTimes, cases_of};
use super::counts::{Bins, Counts, CountsByKey, Key};
use super::{CountedSpan, StatKey, StatQuery};
use crate::backend::{Backend, Row, SqlError, SqlResult};
use crate::schema::packed::{Column, Packed, each_block};
use crate::schema::sql_functions::utc_day;

/// Counts what the filter selects in each of several spans, which are in order and do not overlap.
pub(super) fn count(
    backend: &Backend,
    resolved: &Resolved<'_>,
    query: &StatQuery,
    spans: &[CountedSpan],
) -> SqlResult<Vec<CountsByKey>> {
    let filter = resolved.filter();
    let spans: Vec<_> = spans.iter().map(Span::of).collect();
    let mut counting = Counting {
        filter,
        unit: resolved.unit,
        codes: resolved.codes.as_deref(),
        lrus: resolved.lrus.as_deref(),
        faults: resolved.faults_by_text(backend)?,
        runs: resolved.runs(backend)?,
        by: query.by,
        times: RepairTimes::of(query),
        spans,
        places: HashMap::new(),
        counts: Vec::new(),
        attributed: Vec::new(),
    };
    each_block(backend, |row| counting.block(row))?;
    let attributed = std::mem::take(&mut counting.attributed);
    cases_of(attributed)
        .iter()
        .for_each(|case| counting.case(case));
    Ok(counting.counted())
}

struct Counting<'a> {
    filter: &'a FaultFilter,
    unit: Option<i64>,
    codes: Option<&'a [i64]>,
    lrus: Option<&'a [String]>,
    /// Faults with the words, or the part's serial number, that the filter has; `None` if it has neither.
    faults: Option<HashSet<i64>>,
    /// Runs of the train, or the one run, that the filter has; `None` if it has neither.
    runs: Option<HashSet<i64>>,
    by: StatKey,
    times: RepairTimes,
    spans: Vec<Span>,
    /// Index of each key's first entry in `counts`.
    places: HashMap<Key, usize>,
    /// Counts by key and span.
    counts: Vec<Counts>,
    /// Faults that are attributed to a part, if cases are counted.
    attributed: Vec<Case>,
}

struct Span {
    first_us: i64,
    last_us: i64,
    bins: Bins,
    days: (i64, Vec<usize>),
}

impl Span {
    fn of(span: &CountedSpan) -> Self {
        Self {
            first_us: span.since_us.unwrap_or(i64::MIN),
            last_us: span
                .until_us
                .map_or(i64::MAX, |until| until.saturating_sub(1)),
            bins: span.bins,
            days: span.bins.of_days(),
        }
    }

    fn bin(&self, at_us: i64) -> usize {
        let (first, bins) = &self.days;
        let day = usize::try_from(utc_day(at_us) - first).ok();
        let bin = day.and_then(|day| bins.get(day));
        bin.copied().unwrap_or_else(|| self.bins.place_at(at_us))
    }
}

/// Which texts of a block's columns the filter selects, and the indexes in `counts` for those that are keys; by the
/// texts' codes.
struct Texts {
    lru: Vec<bool>,
    /// Texts of causes, and of parts where no cause is known; as in `cause_places`.
    cause: [Vec<bool>; 2],
    severity: Vec<bool>,
    state: Vec<bool>,
    fault_line: Vec<bool>,
    line: Vec<bool>,
    procedure: Vec<bool>,
    lru_places: Vec<usize>,
    /// Indexes by the code of the cause, and by the code of the part where no cause is known.
    cause_places: [Vec<usize>; 2],
    fault_line_places: Vec<usize>,
    line_places: Vec<usize>,
}

type Faults<'a> = Packed<'a, 12>;
type Occurrences<'a> = Packed<'a, 5>;
type Repairs<'a> = Packed<'a, 4>;

impl Counting<'_> {
    fn block(&mut self, row: Row<'_>) -> SqlResult<()> {
        let damaged = |column| SqlError::Value {
            column,
            reason: "not what was packed; `ptu db rebuild` packs it again".to_owned(),
        };
        let faults = Faults::read(row.get(0)?).ok_or_else(|| damaged(0))?;
        let occurrences = Occurrences::read(row.get(1)?).ok_or_else(|| damaged(1))?;
        let repairs = Repairs::read(row.get(2)?).ok_or_else(|| damaged(2))?;
        let texts = self.texts(&faults, &occurrences);
        let (mut seen, mut repaired) = (0..0, 0..0);
        for fault in 0..faults.rows {
            let Some(seq) = faults.columns[0].number(fault) else {
                continue;
            };
            seen = rows_of(seq, &occurrences.columns[0], occurrences.rows, seen.end);
            repaired = rows_of(seq, &repairs.columns[0], repairs.rows, repaired.end);
            if !self.is_asked(seq, &faults, fault, &texts) {
                continue;
            }
            if (self.filter.procedure.is_some() || self.runs.is_some())
                && !seen
                    .clone()
                    .any(|row| self.is_of_run(&occurrences, row, &texts))
            {
                continue;
            }
            let place = self.place(&faults, fault, &texts);
            self.seen(&faults, fault, &occurrences, seen.clone(), &texts, place);
            if texts.fault_line[faults.columns[4].code(fault)] {
                let case = case(&faults, fault, (&repairs, repaired.clone()), place);
                match self.by == StatKey::Cause && faults.columns[11].code(fault) > 0 {
                    true => self.attributed.push(case),
                    false => self.case(&case),
                }
            }
        }
        Ok(())
    }

    fn texts(&mut self, faults: &Faults<'_>, occurrences: &Occurrences<'_>) -> Texts {
        let [_, _, _, lru, fault_line, severity, state, .., cause] = &faults.columns;
        let [_, _, line, procedure, _] = &occurrences.columns;
        let filter = self.filter;
        let in_line = |text: &str| filter.line.as_ref().is_none_or(|line| line == text);
        Texts {
            lru: of_texts(lru, true, |text| {
                self.lrus
                    .is_none_or(|lrus| lrus.iter().any(|lru| lru == text))
            }),
            cause: [cause, lru].map(|column| {
                of_texts(column, true, |text| {
                    let asked = filter.cause.as_ref();
                    asked.is_none_or(|cause| cause.eq_ignore_ascii_case(text))
                })
            }),
            severity: of_texts(severity, true, |text| {
                let asked = filter.severity.as_ref();
                asked.is_none_or(|severity| severity.eq_ignore_ascii_case(text))
            }),
            state: of_texts(state, true, |text| {
                filter.states.is_empty() || filter.states.iter().any(|one| one.as_str() == text)
            }),
            fault_line: of_texts(fault_line, filter.line.is_none(), in_line),
            line: of_texts(line, filter.line.is_none(), in_line),
            procedure: of_texts(procedure, filter.procedure.is_none(), |text| {
                filter.procedure.as_ref().is_none_or(|one| one == text)
            }),
            lru_places: self.text_places(StatKey::Lru, lru),
            cause_places: [cause, lru].map(|column| self.text_places(StatKey::Cause, column)),
            fault_line_places: self.text_places(StatKey::Line, fault_line),
            line_places: self.text_places(StatKey::Line, line),
        }
    }

    /// Indexes in `counts` for the texts of a column; empty if these are not the keys.
    fn text_places(&mut self, by: StatKey, column: &Column<'_>) -> Vec<usize> {
        if self.by != by {
            return Vec::new();
        }
        let texts = std::iter::once(&"").chain(&column.texts);
        let keys = texts.map(|text| Key::Text((*text).to_owned()));
        keys.map(|key| self.place_of(key)).collect()
    }

    fn place_of(&mut self, key: Key) -> usize {
        let next = self.counts.len();
        let place = *self.places.entry(key).or_insert(next);
        if place == next {
            let end = next + self.spans.len();
            self.counts.resize(end, Counts::default());
        }
        place
    }

    fn is_asked(&self, seq: i64, faults: &Faults<'_>, fault: usize, texts: &Texts) -> bool {
        let [_, unit, code, lru, _, severity, state, .., cause] = &faults.columns;
        let has_cause = || match cause.code(fault) {
            0 => texts.cause[1][lru.code(fault)],
            cause => texts.cause[0][cause],
        };
        let has_code = |codes: &[i64]| {
            let code = code.number(fault);
            code.is_some_and(|code| codes.contains(&code))
        };
        texts.severity[severity.code(fault)]
            && texts.state[state.code(fault)]
            && texts.lru[lru.code(fault)]
            && has_cause()
            && self
                .unit
                .is_none_or(|asked| unit.number(fault) == Some(asked))
            && self.codes.is_none_or(has_code)
            && self
                .faults
                .as_ref()
                .is_none_or(|faults| faults.contains(&seq))
    }

    /// Whether an occurrence is of the procedure and the runs that the filter has.
    fn is_of_run(&self, occurrences: &Occurrences<'_>, row: usize, texts: &Texts) -> bool {
        let [.., procedure, run] = &occurrences.columns;
        let is_in = |runs: &HashSet<i64>| run.number(row).is_some_and(|run| runs.contains(&run));
        texts.procedure[procedure.code(row)] && self.runs.as_ref().is_none_or(is_in)
    }

    /// Index in `counts` of a fault's key.
    fn place(&mut self, faults: &Faults<'_>, fault: usize, texts: &Texts) -> usize {
        let [_, unit, code, lru, line, .., cause] = &faults.columns;
        let number = |column: &Column<'_>| Key::Number(column.number(fault).unwrap_or_default());
        match self.by {
            StatKey::Code => self.place_of(number(code)),
            StatKey::Unit => self.place_of(number(unit)),
            StatKey::Lru => texts.lru_places[lru.code(fault)],
            StatKey::Cause => match cause.code(fault) {
                0 => texts.cause_places[1][lru.code(fault)],
                cause => texts.cause_places[0][cause],
            },
            StatKey::Line => texts.fault_line_places[line.code(fault)],
            StatKey::All => self.place_of(Key::Text(String::new())),
        }
    }

    /// Counts a fault's occurrences.
    fn seen(
        &mut self,
        faults: &Faults<'_>,
        fault: usize,
        occurrences: &Occurrences<'_>,
        rows: Range<usize>,
        texts: &Texts,
        place: usize,
    ) {
        let [_, at, line, ..] = &occurrences.columns;
        let unit = faults.columns[1].number(fault).unwrap_or_default();
        let mut last = None;
        for row in rows {
            let at_us = at.number(row).unwrap_or_default();
            let line = line.code(row);
            if !texts.line[line] || !self.is_of_run(occurrences, row, texts) {
                continue;
            }
            let Some(span) = span_of(&self.spans, at_us) else {
                continue;
            };
            let place = span
                + match self.by {
                    StatKey::Line => texts.line_places[line],
                    _ => place,
                };
            let span = &self.spans[span];
            let counts = &mut self.counts[place];
            counts.add_occurrences(&span.bins, span.bin(at_us), 1);
            counts.seen_at(at_us);
            if last != Some(place) {
                counts.units.add_one(unit);
                last = Some(place);
            }
        }
    }

    /// Counts a fault's or case's opening, end and repairs.
    fn case(&mut self, case: &Case) {
        let (spans, all, place) = (&self.spans, &mut self.counts, case.place);
        case.count(self.times, |at_us, change| {
            if let Some(span) = span_of(spans, at_us) {
                change(&mut all[place + span]);
            }
        });
    }

    /// The counts of each span.
    fn counted(mut self) -> Vec<CountsByKey> {
        let spans = 0..self.spans.len();
        let in_span = |span: usize| {
            let counts = self.places.iter().map(|(key, place)| {
                let counts = std::mem::take(&mut self.counts[place + span]);
                (key.clone(), counts)
            });
            let counted =
                counts.filter(|(_, counts)| !counts.is_nothing() || counts.not_closed > 0);
            counted.collect()
        };
        spans.map(in_span).collect()
    }
}

/// A fault with its repairs.
fn case(
    faults: &Faults<'_>,
    fault: usize,
    (repairs, rows): (&Repairs<'_>, Range<usize>),
    place: usize,
) -> Case {
    let [_, unit, .., first, last, closed, repaired, _] = &faults.columns;
    let [_, at, opened, back] = &repairs.columns;
    let repair = |row| CaseRepair {
        at_us: at.number(row).unwrap_or_default(),
        opened_us: opened.number(row).unwrap_or_default(),
        back_us: back.number(row),
    };
    Case {
        place,
        unit: unit.number(fault).unwrap_or_default(),
        first_us: first.number(fault).unwrap_or_default(),
        last_us: last.number(fault).unwrap_or_default(),
        closed_us: closed.number(fault),
        is_repaired: repaired.number(fault) != Some(0),
        repairs: rows.map(repair).collect(),
    }
}

/// The span that a time lies in.
fn span_of(spans: &[Span], at_us: i64) -> Option<usize> {
    let span = spans.partition_point(|span| span.last_us < at_us);
    let first_us = spans.get(span)?.first_us;
    (at_us >= first_us).then_some(span)
}

/// The rows of a fault in a column sorted by fault; the search begins at row `from`.
fn rows_of(fault: i64, column: &Column<'_>, rows: usize, from: usize) -> Range<usize> {
    let is_of = |row: &usize| column.number(*row) == Some(fault);
    from..from + (from..rows).take_while(is_of).count()
}

/// For each code of a column, whether its text has a property; `null` is the answer for NULL.
fn of_texts(column: &Column<'_>, null: bool, of: impl Fn(&str) -> bool) -> Vec<bool> {
    let texts = column.texts.iter().map(|text| of(text));
    std::iter::once(null).chain(texts).collect()
}
