//! The domain of each column, by its name: ranges, lengths and formats. Rows from outside are checked against it: those
//! of a file to merge, and those that a sync sends or receives. The server enforces the same in `server/rules.sql`.

use serde::Serialize;

use crate::backend::Field;
use crate::seal::hex;
use crate::values::fault_state::FaultState;
use crate::values::record::Verdict;

/// Times from 1970, where a clock without a battery starts, to the end of 2199, µs since 1970.
const TIME_US: std::ops::RangeInclusive<i64> = 0..=7_258_118_400_000_000;
/// Durations and bench times: up to 50 years either way, µs.
const SPAN_US: std::ops::RangeInclusive<i64> = -1_577_880_000_000_000..=1_577_880_000_000_000;
/// A day, µs.
const DAY_US: i64 = 86_400_000_000;
const ID_BYTES: usize = 16;
const DIGEST_BYTES: usize = 32;
/// Greatest length of a name, path or place.
const NAME_BYTES: usize = 64 << 10;
/// Greatest length of a note or message.
const TEXT_BYTES: usize = 1 << 20;
const JSON_BYTES: usize = 16 << 20;
/// Greatest length of a trace's samples or a recording's stimuli.
pub(crate) const PACKED_BYTES: usize = 48 << 20;

/// Greatest number of refused rows that are listed.
const MOST_NAMED: usize = 100;

/// Rows outside their columns' domain. They stay where they are; all other rows were processed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Refusals {
    /// Number of refusals.
    pub count: u64,
    /// The first hundred refused rows.
    pub named: Vec<Refused>,
}

/// A row that was refused.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Refused {
    /// Name of the row, as "run 0197…".
    pub what: String,
    /// Reason of the refusal.
    pub reason: String,
}

impl Refusals {
    pub(crate) fn add(&mut self, what: String, reason: String) {
        // A sync may meet the same event twice.
        if self.named.iter().any(|one| one.what == what) {
            return;
        }
        self.count += 1;
        if self.named.len() < MOST_NAMED {
            self.named.push(Refused { what, reason });
        }
    }

    pub(crate) fn extend(&mut self, more: Self) {
        self.count += more.count - more.named.len() as u64;
        for Refused { what, reason } in more.named {
            self.add(what, reason);
        }
    }

    /// Whether nothing was refused.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }
}

/// An id in its usual form; of other bytes a description.
pub(crate) fn shown_id(bytes: &[u8]) -> String {
    match bytes.try_into() {
        Ok(id) => crate::id::Id::from_bytes(id).to_string(),
        Err(_) => {
            let shown = hex(&bytes[..bytes.len().min(ID_BYTES + 1)]);
            format!("of {} bytes ({shown}…)", bytes.len())
        }
    }
}

/// Checks a value against the domain of the column; the error names the column. NULL passes: the table's constraint
/// decides whether NULL is allowed.
pub(crate) fn check(column: &str, field: Field<'_>) -> Result<(), String> {
    let is_in = match field {
        Field::Null => return Ok(()),
        Field::Integer(value) => integer(column, value),
        Field::Real(value) if value.is_finite() => return Ok(()),
        Field::Real(value) => return Err(format!("{column} is {value}")),
        Field::Text(text) => return self::text(column, text),
        Field::Bytes(bytes) => return self::bytes(column, bytes.len()),
    };
    is_in.map_err(|expected| match field {
        Field::Integer(value) => format!("{column} is {value}, not {expected}"),
        _ => format!("{column} is not {expected}"),
    })
}

fn integer(column: &str, value: i64) -> Result<(), &'static str> {
    let (range, expected) = match column {
        "period_us" => (0..=DAY_US, "up to a day"),
        "t0_us" => (TIME_US, "a time from 1970 to 2199"),
        "bench_us" | "t0_bench_us" | "started_bench_us" | "bench_time_us" | "wall_time_us"
        | "place_us" => (SPAN_US, "a length of up to 50 years"),
        "step_index" | "place" | "ordinal" | "script_line" | "row_count" | "trigger_row"
        | "flags" | "encoding" | "recording" | "turn" | "turns" | "seen" | "occurrences"
        | "repairs" | "disputed" => (0..=u32::MAX.into(), "a number of 32 bits"),
        column if column.ends_with("at_us") => (TIME_US, "a time from 1970 to 2199"),
        _ => return Ok(()),
    };
    match range.contains(&value) {
        true => Ok(()),
        false => Err(expected),
    }
}

fn text(column: &str, text: &str) -> Result<(), String> {
    let most = match column {
        "json" | "findings" | "freeze_json" | "bench_json" | "sw_versions" | "says"
        | "evidence" => JSON_BYTES,
        "message" | "body" | "text" | "injected" | "words" => TEXT_BYTES,
        _ => NAME_BYTES,
    };
    if text.len() > most {
        return Err(format!(
            "{column} has {} bytes, more than {most}",
            text.len()
        ));
    }
    match column {
        "json" | "findings" | "freeze_json" | "bench_json" | "sw_versions" | "evidence" => {
            json(column, text)
        }
        "verdict" => text.parse::<Verdict>().map(drop).map_err(|_| word(column)),
        "state" => text
            .parse::<FaultState>()
            .map(drop)
            .map_err(|_| word(column)),
        _ => Ok(()),
    }
}

fn word(column: &str) -> String {
    format!("{column} is no word that is known")
}

/// Checks that a text is JSON, by parsing all of it, which bounds its depth.
fn json(column: &str, text: &str) -> Result<(), String> {
    let parsed = serde_json::from_str::<serde_json::Value>(text);
    parsed
        .map(drop)
        .map_err(|error| format!("{column} is no JSON: {error}"))
}

/// Checks the body of an event of this kind.
pub(crate) fn check_body(kind: &str, body: &str) -> Result<(), String> {
    use crate::values::record::{CAUSE, CauseRecord, DIAGNOSED, REPAIR, RepairRecord};
    let (read, what) = match kind {
        REPAIR => (
            serde_json::from_str::<RepairRecord>(body).map(drop),
            "repair",
        ),
        CAUSE | DIAGNOSED => (serde_json::from_str::<CauseRecord>(body).map(drop), "cause"),
        _ => return Ok(()),
    };
    read.map_err(|error| format!("body is no {what}: {error}"))
}

fn bytes(column: &str, length: usize) -> Result<(), String> {
    let expected = match column {
        "data" | "stimuli" if length <= PACKED_BYTES => return Ok(()),
        "data" | "stimuli" => "at most 48 MiB".to_owned(),
        "follows" if length.is_multiple_of(ID_BYTES) && length <= NAME_BYTES => return Ok(()),
        "follows" => "ids of 16 bytes".to_owned(),
        "sha256" | "digest" | "hash" | "channel_set" => {
            if length == DIGEST_BYTES {
                return Ok(());
            }
            format!("{DIGEST_BYTES}")
        }
        _ if length == ID_BYTES => return Ok(()),
        _ => format!("{ID_BYTES}"),
    };
    Err(format!("{column} has {length} bytes, not {expected}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_column_has_its_bounds() {
        let long = "x".repeat(NAME_BYTES + 1);
        let deep = "[".repeat(100_000);
        for (column, good, bad) in [
            (
                "at_us",
                Field::Integer(1_772_323_200_000_000),
                Field::Integer(i64::MAX),
            ),
            ("started_at_us", Field::Integer(0), Field::Integer(-1)),
            ("t0_us", Field::Integer(1), Field::Integer(i64::MAX)),
            ("bench_us", Field::Integer(-5), Field::Integer(i64::MIN)),
            (
                "period_us",
                Field::Integer(50_000),
                Field::Integer(i64::MAX),
            ),
            ("row_count", Field::Integer(300), Field::Integer(1 << 40)),
            ("id", Field::Bytes(&[1; 16]), Field::Bytes(&[1; 15])),
            ("run", Field::Bytes(&[1; 16]), Field::Bytes(&[])),
            ("sha256", Field::Bytes(&[1; 32]), Field::Bytes(&[1; 16])),
            ("follows", Field::Bytes(&[1; 32]), Field::Bytes(&[1; 31])),
            ("value", Field::Real(0.5), Field::Real(f64::NAN)),
            ("high", Field::Real(-0.5), Field::Real(f64::INFINITY)),
            ("verdict", Field::Text("passed"), Field::Text("good")),
            ("state", Field::Text("open"), Field::Text("opened")),
            ("operator", Field::Text("김"), Field::Text(&long)),
            ("sw_versions", Field::Text("{}"), Field::Text("{")),
            ("freeze_json", Field::Text("[]"), Field::Text(&deep)),
        ] {
            assert_eq!(check(column, good), Ok(()), "{column}");
            let said = check(column, bad).expect_err(column);
            assert!(said.contains(column) && said.len() < 200, "{said}");
        }
        assert_eq!(check("seed", Field::Integer(i64::MIN)), Ok(()));
        assert_eq!(check("line", Field::Null), Ok(()));
        assert!(check_body("repair", "{}").is_err());
        assert!(check_body("diagnosed", "{\"part\":1}").is_err());
        assert!(check_body("note", "{").is_ok());
    }
}
