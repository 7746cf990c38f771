//! Counts from a file's table `packed`: all faults with their occurrences and repairs are gone through.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

use super::super::fault_filter::{FaultFilter, Resolved};
use super::counts::{Bins, Counted, Counts, Key};
use super::repairs::within_us;
use super::{StatKey, StatQuery};
use crate::backend::{Backend, Row, SqlError, SqlResult};
use crate::packed::{Column, Packed, each_block};
use crate::sql_functions::utc_day;

/// Counts what the filter selects; `None` where rows of the tables are read in less time, and of a server.
pub(super) fn count(
    backend: &Backend,
    resolved: &Resolved<'_>,
    query: &StatQuery,
    bins: &Bins,
) -> SqlResult<Option<Counted>> {
    let filter = resolved.filter();
    let is_few = resolved.unit().is_some() || filter.train.is_some() || filter.run.is_some();
    if is_few || matches!(backend, Backend::Server(_)) {
        return Ok(None);
    }
    let mut counting = Counting {
        filter,
        codes: resolved.codes(),
        lrus: resolved.lrus(),
        faults: resolved.faults_by_text(backend)?,
        by: query.by,
        span: filter.since_us.unwrap_or(i64::MIN)..filter.until_us.unwrap_or(i64::MAX),
        is_open_end: filter.until_us.is_none(),
        within_us: within_us(query),
        young_us: query.now_us - within_us(query) + 1,
        bins,
        days: bins.of_days(),
        places: HashMap::new(),
        counts: Vec::new(),
    };
    each_block(backend, |row| counting.block(row))?;
    let places = counting.places.into_iter();
    let counted = places.map(|(key, place)| (key, std::mem::take(&mut counting.counts[place])));
    let counted = counted.filter(|(_, counts)| !counts.is_nothing() || counts.not_closed > 0);
    Ok(Some(counted.collect()))
}

struct Counting<'a> {
    filter: &'a FaultFilter,
    codes: Option<&'a [i64]>,
    lrus: Option<&'a [String]>,
    /// With the words and the part's serial number asked for.
    faults: Option<BTreeSet<i64>>,
    by: StatKey,
    span: Range<i64>,
    is_open_end: bool,
    within_us: i64,
    young_us: i64,
    bins: &'a Bins,
    days: (i64, Vec<usize>),
    /// The place of each key among the counts.
    places: HashMap<Key, usize>,
    counts: Vec<Counts>,
}

/// What of a block's texts is asked for, and where the keys among them are counted; by code in their column.
struct Texts {
    lru: Vec<bool>,
    severity: Vec<bool>,
    state: Vec<bool>,
    closed: Vec<bool>,
    fault_line: Vec<bool>,
    line: Vec<bool>,
    procedure: Vec<bool>,
    lru_places: Vec<usize>,
    fault_line_places: Vec<usize>,
    line_places: Vec<usize>,
}

type Faults<'a> = Packed<'a, 11>;
type Occurrences<'a> = Packed<'a, 4>;
type Repairs<'a> = Packed<'a, 4>;

impl Counting<'_> {
    fn block(&mut self, row: Row<'_>) -> SqlResult<()> {
        let damaged = |column| SqlError::Value {
            column,
            reason: "not what was packed; `ptu db rebuild` packs it anew".to_owned(),
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
            let procedure = &occurrences.columns[3];
            if !seen.clone().any(|row| texts.procedure[procedure.code(row)])
                && self.filter.procedure.is_some()
            {
                continue;
            }
            let place = self.place(&faults, fault, &texts);
            self.seen(&faults, fault, &occurrences, seen.clone(), &texts, place);
            if texts.fault_line[faults.columns[4].code(fault)] {
                self.life(&faults, fault, &texts, place);
                self.repairs(&repairs, repaired.clone(), place);
            }
        }
        Ok(())
    }

    fn texts(&mut self, faults: &Faults<'_>, occurrences: &Occurrences<'_>) -> Texts {
        let [_, _, _, lru, fault_line, severity, state, ..] = &faults.columns;
        let [_, _, line, procedure] = &occurrences.columns;
        let filter = self.filter;
        let in_line = |text: &str| filter.line.as_ref().is_none_or(|line| line == text);
        Texts {
            lru: of_texts(lru, true, |text| {
                self.lrus
                    .is_none_or(|lrus| lrus.iter().any(|lru| lru == text))
            }),
            severity: of_texts(severity, true, |text| {
                let asked = filter.severity.as_ref();
                asked.is_none_or(|severity| severity.eq_ignore_ascii_case(text))
            }),
            state: of_texts(state, true, |text| {
                filter.states.is_empty() || filter.states.iter().any(|one| one.as_str() == text)
            }),
            closed: of_texts(state, false, |text| text == "closed"),
            fault_line: of_texts(fault_line, filter.line.is_none(), in_line),
            line: of_texts(line, filter.line.is_none(), in_line),
            procedure: of_texts(procedure, filter.procedure.is_none(), |text| {
                filter.procedure.as_ref().is_none_or(|one| one == text)
            }),
            lru_places: self.text_places(StatKey::Lru, lru),
            fault_line_places: self.text_places(StatKey::Line, fault_line),
            line_places: self.text_places(StatKey::Line, line),
        }
    }

    /// Where the texts of a column are counted; empty if they are no keys.
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
            self.counts.push(Counts::default());
        }
        place
    }

    fn is_asked(&self, seq: i64, faults: &Faults<'_>, fault: usize, texts: &Texts) -> bool {
        let [_, _, code, lru, _, severity, state, ..] = &faults.columns;
        let has_code = |codes: &[i64]| {
            let code = code.number(fault);
            code.is_some_and(|code| codes.contains(&code))
        };
        texts.severity[severity.code(fault)]
            && texts.state[state.code(fault)]
            && texts.lru[lru.code(fault)]
            && self.codes.is_none_or(has_code)
            && self
                .faults
                .as_ref()
                .is_none_or(|faults| faults.contains(&seq))
    }

    /// Where a fault is counted.
    fn place(&mut self, faults: &Faults<'_>, fault: usize, texts: &Texts) -> usize {
        let [_, unit, code, lru, line, ..] = &faults.columns;
        let number = |column: &Column<'_>| Key::Number(column.number(fault).unwrap_or_default());
        match self.by {
            StatKey::Code => self.place_of(number(code)),
            StatKey::Unit => self.place_of(number(unit)),
            StatKey::Lru => texts.lru_places[lru.code(fault)],
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
        let [_, at, line, procedure] = &occurrences.columns;
        let unit = faults.columns[1].number(fault).unwrap_or_default();
        let mut last = None;
        for row in rows {
            let at_us = at.number(row).unwrap_or_default();
            let line = line.code(row);
            if !self.is_within(at_us) || !texts.line[line] || !texts.procedure[procedure.code(row)]
            {
                continue;
            }
            let place = match self.by {
                StatKey::Line => texts.line_places[line],
                _ => place,
            };
            let bin = self.bin(at_us);
            let counts = &mut self.counts[place];
            counts.add_occurrences(self.bins, bin, 1);
            counts.seen_at(at_us);
            if last != Some(place) {
                counts.units.add_one(unit);
                last = Some(place);
            }
        }
    }

    /// Counts a fault's opening and closing, and that it is not closed.
    fn life(&mut self, faults: &Faults<'_>, fault: usize, texts: &Texts, place: usize) {
        let [.., state, first, last, closed, repairs] = &faults.columns;
        let is_within = |column: &Column<'_>| {
            let at_us = column.number(fault);
            at_us.is_some_and(|at_us| self.is_within(at_us))
        };
        let (opened, closed) = (is_within(first), is_within(closed));
        let not_closed = is_within(last) && !texts.closed[state.code(fault)];
        let counts = &mut self.counts[place];
        counts.opened += u32::from(opened);
        counts.closed += u32::from(closed);
        counts.closed_without_repair += u32::from(closed && repairs.number(fault) == Some(0));
        counts.not_closed += u32::from(not_closed);
    }

    /// Counts a fault's repairs.
    fn repairs(&mut self, repairs: &Repairs<'_>, rows: Range<usize>, place: usize) {
        let [_, at, opened, back] = &repairs.columns;
        for row in rows {
            let at_us = at.number(row).unwrap_or_default();
            if !self.is_within(at_us) {
                continue;
            }
            let after_us = back.number(row).map(|back_us| back_us - at_us);
            let is_back = after_us.is_some_and(|after_us| after_us < self.within_us);
            let of_key = &mut self.counts[place].repairs;
            of_key.all += 1;
            of_key.us += at_us - opened.number(row).unwrap_or_default();
            of_key.back += u32::from(is_back);
            of_key.young += u32::from(!is_back && at_us >= self.young_us);
        }
    }

    fn is_within(&self, at_us: i64) -> bool {
        at_us >= self.span.start && (at_us < self.span.end || self.is_open_end)
    }

    fn bin(&self, at_us: i64) -> usize {
        let (first, bins) = &self.days;
        let day = usize::try_from(utc_day(at_us) - first).ok();
        let bin = day.and_then(|day| bins.get(day));
        bin.copied().unwrap_or_else(|| self.bins.place_at(at_us))
    }
}

/// The rows of a fault in a column sorted by fault, from `from` on.
fn rows_of(fault: i64, column: &Column<'_>, rows: usize, from: usize) -> Range<usize> {
    let is_of = |row: &usize| column.number(*row) == Some(fault);
    from..from + (from..rows).take_while(is_of).count()
}

/// A property of each text of a column, by its code; `null` that of NULL.
fn of_texts(column: &Column<'_>, null: bool, of: impl Fn(&str) -> bool) -> Vec<bool> {
    let texts = column.texts.iter().map(|text| of(text));
    std::iter::once(null).chain(texts).collect()
}
