//! Occurrences of faults counted by day.

use serde::Serialize;

use crate::backend::values;
use crate::error::StoreError;
use crate::schema::sql_functions::DAY_US;
use crate::store::Store;

/// Occurrences of one fault of one unit on one day.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DailyCount {
    /// Beginning of the day, microseconds since 1970, UTC.
    pub day_us: i64,
    /// Serial number of the unit.
    pub unit_serial: String,
    /// The fault's number.
    pub code: i64,
    /// Its name.
    pub code_name: String,
    /// The part it points at.
    pub lru: String,
    /// Number of occurrences.
    pub count: u64,
}

impl Store {
    /// Counts occurrences since `since_us`, oldest day first. Days begin at midnight of a clock that is
    /// `utc_offset_us` ahead of UTC; the offset is the same for all of them.
    pub fn daily_occurrences(
        &self,
        since_us: i64,
        utc_offset_us: i64,
    ) -> Result<Vec<DailyCount>, StoreError> {
        self.select(
            "counting occurrences",
            "SELECT (o.at_us + ?3) / ?2 * ?2 - ?3, u.serial, f.code, f.code_name, f.lru, count(*)
                 FROM fault_occurrence o JOIN fault f ON f.seq = o.fault
                    JOIN unit u ON u.seq = f.unit
                 WHERE o.at_us >= ?1 GROUP BY 1, 2, 3, 4, 5, f.seq ORDER BY 1, u.serial, f.code",
            &values![since_us, DAY_US, utc_offset_us],
            |row| {
                Ok(DailyCount {
                    day_us: row.get(0)?,
                    unit_serial: row.get(1)?,
                    code: row.get(2)?,
                    code_name: row.get(3)?,
                    lru: row.get(4)?,
                    count: row.get::<i64>(5)?.unsigned_abs(),
                })
            },
        )
    }
}
