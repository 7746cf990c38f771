//! The distinct names in a history (units, lines, codes …), for choices in filters.

use crate::error::StoreError;
use crate::store::Store;
use crate::values::record::part_name;

/// SQL: each value of an indexed column once, in order, from the rows `x` of a table that meet a condition. The index
/// leads from one value to the next, without reading all rows.
pub(super) fn each_value(column: &str, table: &str, condition: &str) -> String {
    format!(
        "WITH RECURSIVE each_value(value) AS (
            SELECT min(x.{column}) FROM {table} x WHERE {condition}
            UNION ALL SELECT (SELECT min(x.{column}) FROM {table} x WHERE x.{column} > each_value.value AND {condition})
            FROM each_value WHERE each_value.value IS NOT NULL)
        SELECT value FROM each_value WHERE value IS NOT NULL ORDER BY value"
    )
}

impl Store {
    /// Every code of a fault, with the code's latest name.
    pub fn known_codes(&self) -> Result<Vec<(i64, String)>, StoreError> {
        let codes = each_value("code", "fault", "true");
        let sql = format!(
            "WITH c(code) AS ({codes}) SELECT code, (SELECT f.code_name FROM fault f WHERE f.code = c.code
                ORDER BY f.last_at_us DESC LIMIT 1) FROM c ORDER BY code"
        );
        self.select("listing codes", &sql, &[], |row| {
            Ok((row.get(0)?, row.get(1)?))
        })
    }

    /// Every part a fault pointed at.
    pub fn known_lrus(&self) -> Result<Vec<String>, StoreError> {
        let sql = each_value("lru", "fault", "true");
        self.select("listing parts", &sql, &[], |row| row.get(0))
    }

    /// Every part a fault came from: the attributed one, or else the one it points at. Reads all faults.
    pub fn known_causes(&self) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT DISTINCT cause FROM faults ORDER BY cause";
        self.select("listing parts", sql, &[], |row| row.get(0))
    }

    /// Every part that a fault pointed at or that was repaired, in one of its spellings.
    pub fn known_parts(&self) -> Result<Vec<String>, StoreError> {
        let mut known = self.known_lrus()?;
        let sql = "SELECT DISTINCT part FROM repairs ORDER BY part";
        let repaired: Vec<String> = self.select("listing parts", sql, &[], |row| row.get(0))?;
        for part in repaired {
            if !known.iter().any(|known| part_name(known) == part) {
                known.push(part);
            }
        }
        Ok(known)
    }

    /// The serial number of every unit.
    pub fn known_units(&self) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT serial FROM unit ORDER BY serial";
        self.select("listing units", sql, &[], |row| row.get(0))
    }

    /// Every train with the time of the first run in it, µs since 1970.
    pub fn first_runs_of_trains(&self) -> Result<Vec<(String, i64)>, StoreError> {
        let sql = "SELECT train, min(started_at_us) FROM run WHERE train <> ''
            GROUP BY train ORDER BY train";
        self.select("listing trains", sql, &[], |row| {
            Ok((row.get(0)?, row.get(1)?))
        })
    }

    /// Every train a unit was in when it was tested.
    pub fn known_trains(&self) -> Result<Vec<String>, StoreError> {
        let sql = each_value("train", "run", "x.train <> ''");
        self.select("listing trains", &sql, &[], |row| row.get(0))
    }

    /// Every line a fault was seen on. Reads all occurrences.
    pub fn known_lines(&self) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT DISTINCT line FROM fault_occurrence WHERE line <> '' ORDER BY line";
        self.select("listing lines", sql, &[], |row| row.get(0))
    }

    /// Every procedure a fault was seen in. Reads all occurrences.
    pub fn known_procedures(&self) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT DISTINCT s.procedure FROM fault_occurrence o
            JOIN step s ON s.run = o.run AND s.step_index = o.step_index ORDER BY s.procedure";
        self.select("listing procedures", sql, &[], |row| row.get(0))
    }

    /// The serial number of every part that a repair took out or put in. Reads all repairs.
    pub fn known_part_serials(&self) -> Result<Vec<String>, StoreError> {
        let sql = "SELECT serial FROM (SELECT serial_old AS serial FROM repairs
                UNION SELECT serial_new FROM repairs) AS changed
            WHERE serial IS NOT NULL ORDER BY serial";
        self.select("listing parts", sql, &[], |row| row.get(0))
    }
}
