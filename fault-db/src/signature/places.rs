//! Locates a change in a run: the signature holds a mark of each row, and of each field of the run's own row. A mark is
//! the beginning of a digest.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::backend::{Backend, SqlResult, values};
use crate::seal::canonical::{CanonicalHash, columns};
use crate::seal::hex;
use crate::seal::run::{OCCURRENCES, PARTS, RUN};

/// Number of hex digits of a mark.
const DIGITS: usize = 8;

/// Marks by kind of row, in the order in which the run's digest takes the rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Places(BTreeMap<String, String>);

/// Mark of a row or field as it is now, and the name for a person.
struct RowMark {
    mark: String,
    name: String,
}

/// The kinds of rows, as they are named to a person.
const KINDS: [&str; 5] = ["fields", "scripts", "steps", "measurements", "occurrences"];

impl Places {
    pub(crate) fn of(backend: &Backend, run: i64) -> SqlResult<Self> {
        let mut marks = BTreeMap::new();
        for kind in KINDS {
            let rows = rows(backend, run, kind)?;
            marks.insert(
                kind.to_owned(),
                rows.into_iter().map(|row| row.mark).collect(),
            );
        }
        Ok(Self(marks))
    }
}

/// Parts of a run that differ from the signed ones.
pub(crate) fn changed_places(
    backend: &Backend,
    run: i64,
    signed: &Places,
) -> SqlResult<Vec<String>> {
    let mut changed = Vec::new();
    for kind in KINDS {
        let marks = signed.0.get(kind).map(String::as_str).unwrap_or_default();
        let marks: Vec<&str> = (0..marks.len() / DIGITS)
            .filter_map(|row| marks.get(row * DIGITS..(row + 1) * DIGITS))
            .collect();
        compare(kind, &marks, &rows(backend, run, kind)?, &mut changed);
    }
    Ok(changed)
}

fn compare(kind: &str, signed: &[&str], found: &[RowMark], changed: &mut Vec<String>) {
    let same = |(signed, found): &(&&str, &RowMark)| **signed == found.mark;
    let start = signed.iter().zip(found).take_while(same).count();
    let (signed, found) = (&signed[start..], &found[start..]);
    let end = (signed.iter().rev().zip(found.iter().rev()))
        .take_while(same)
        .count();
    let (signed, found) = (&signed[..signed.len() - end], &found[..found.len() - end]);
    if signed.len() == found.len() {
        let differ = signed.iter().zip(found).filter(|pair| !same(pair));
        changed.extend(differ.map(|(_, found)| found.name.clone()));
        return;
    }
    let place = start + 1;
    if let Some(fewer) = signed.len().checked_sub(found.len()) {
        changed.push(format!(
            "{fewer} of its {kind} taken out, from number {place}"
        ));
    } else {
        let more = found.len() - signed.len();
        changed.push(format!("{more} put into its {kind}, from number {place}"));
    }
    changed.extend(
        found
            .iter()
            .filter(|row| !signed.contains(&&*row.mark))
            .map(|row| row.name.clone()),
    );
}

fn rows(backend: &Backend, run: i64, kind: &str) -> SqlResult<Vec<RowMark>> {
    let sql = match kind {
        "fields" => return fields(backend, run),
        "scripts" => PARTS[0],
        "steps" => PARTS[1],
        "measurements" => PARTS[2],
        _ => OCCURRENCES,
    };
    let width = columns(sql);
    backend.select(sql, &values![run], |row| {
        let mut hash = CanonicalHash::new();
        for column in 0..width {
            hash.take(row.field(column)?);
        }
        let name = match kind {
            "scripts" => format!("script {}", row.get::<String>(0)?),
            "steps" => {
                let (index, procedure, name) = (
                    row.get::<i64>(0)?,
                    row.get::<String>(1)?,
                    row.get::<String>(4)?,
                );
                format!("step {index} ({procedure}: {name})")
            }
            "measurements" => {
                let (step, ordinal, name) = (
                    row.get::<i64>(0)?,
                    row.get::<i64>(1)?,
                    row.get::<String>(2)?,
                );
                format!("measurement {} of step {step} ({name})", ordinal + 1)
            }
            _ => format!("occurrence {}", row.get::<crate::id::Id>(0)?),
        };
        Ok(RowMark {
            mark: mark(hash),
            name,
        })
    })
}

/// Marks of the run's own row, field by field.
fn fields(backend: &Backend, run: i64) -> SqlResult<Vec<RowMark>> {
    let list = RUN.split("FROM").next().unwrap_or_default();
    let names = list.trim_start_matches("SELECT").split(',');
    let names: Vec<&str> = names.map(|name| name.trim()).collect();
    let read = backend.first(RUN, &values![run], |row| {
        let mut fields = Vec::with_capacity(names.len());
        for (column, name) in names.iter().enumerate() {
            let mut hash = CanonicalHash::new();
            hash.take(row.field(column)?);
            let name = match *name {
                "u.serial" => "serial number of the unit",
                name => name.trim_start_matches("r."),
            };
            fields.push(RowMark {
                mark: mark(hash),
                name: format!("its {}", name.replace('_', " ")),
            });
        }
        Ok(fields)
    })?;
    Ok(read.unwrap_or_default())
}

fn mark(hash: CanonicalHash) -> String {
    hex(&hash.finish()[..DIGITS / 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(signed: &[&str], found: &[&str]) -> Vec<String> {
        let found: Vec<RowMark> = (found.iter().enumerate())
            .map(|(n, mark)| RowMark {
                mark: (*mark).to_owned(),
                name: format!("step {n}"),
            })
            .collect();
        let mut changed = Vec::new();
        compare("steps", signed, &found, &mut changed);
        changed
    }

    #[test]
    fn changed_missing_and_added_rows_are_named() {
        assert_eq!(said(&["a", "b", "c"], &["a", "b", "c"]), [""; 0]);
        assert_eq!(said(&["a", "b", "c"], &["a", "x", "c"]), ["step 1"]);
        assert_eq!(
            said(&["a", "b", "c", "d"], &["x", "b", "c", "y"]),
            ["step 0", "step 3"]
        );
        assert_eq!(
            said(&["a", "b", "c"], &["a", "c"]),
            ["1 of its steps taken out, from number 2"]
        );
        assert_eq!(
            said(&["a", "c"], &["a", "b", "c"]),
            ["1 put into its steps, from number 2", "step 1"]
        );
    }
}
