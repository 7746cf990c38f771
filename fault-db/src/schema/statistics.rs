//! Statistics for SQL queries, which SQLite lacks: `median(x)`, `percentile(x, p)` with `p` from 0 to 100, `stddev(x)`
//! of a sample, `sqrt(x)`. NULL is left out; without values the result is NULL.

use rusqlite::functions::{Aggregate, Context, FunctionFlags};
use rusqlite::{Connection, Error, Result};

/// Greatest number of values of a group that are kept in memory: 32 MB.
const MOST_VALUES: usize = 4_000_000;

pub(crate) fn register(conn: &Connection, flags: FunctionFlags) -> Result<()> {
    conn.create_scalar_function("sqrt", 1, flags, |context| {
        let root = context.get::<Option<f64>>(0)?.map(f64::sqrt);
        Ok(root.filter(|root| root.is_finite()))
    })?;
    conn.create_aggregate_function("median", 1, flags, Percentile)?;
    conn.create_aggregate_function("percentile", 2, flags, Percentile)?;
    conn.create_aggregate_function("stddev", 1, flags, StandardDeviation)
}

/// The value below which a share of the values lies, interpolated between two values.
struct Percentile;

/// All values of a group, and the share.
struct Values {
    all: Vec<f64>,
    share: f64,
}

impl Aggregate<Values, Option<f64>> for Percentile {
    fn init(&self, _: &mut Context<'_>) -> Result<Values> {
        Ok(Values {
            all: Vec::new(),
            share: 0.5,
        })
    }

    fn step(&self, context: &mut Context<'_>, values: &mut Values) -> Result<()> {
        if context.len() == 2 {
            values.share = context.get::<f64>(1)? / 100.0;
            if !(0.0..=1.0).contains(&values.share) {
                return Err(wrong(
                    "percentile() takes a value and a number from 0 to 100",
                ));
            }
        }
        if values.all.len() >= MOST_VALUES {
            return Err(wrong(
                "median() and percentile() take 4 million values at most",
            ));
        }
        values.all.extend(context.get::<Option<f64>>(0)?);
        Ok(())
    }

    fn finalize(&self, _: &mut Context<'_>, values: Option<Values>) -> Result<Option<f64>> {
        let Some(Values { mut all, share }) = values else {
            return Ok(None);
        };
        all.sort_by(f64::total_cmp);
        let place = share * all.len().saturating_sub(1) as f64;
        let (before, after) = (place.floor() as usize, place.ceil() as usize);
        let pair = all.get(before).copied().zip(all.get(after).copied());
        Ok(pair.map(|(low, high)| low + (high - low) * place.fract()))
    }
}

/// Standard deviation of a sample (divisor: number of values less one), by Welford's sums, which lose no digits.
struct StandardDeviation;

#[derive(Default)]
struct Sums {
    n: f64,
    mean: f64,
    squares: f64,
}

impl Aggregate<Sums, Option<f64>> for StandardDeviation {
    fn init(&self, _: &mut Context<'_>) -> Result<Sums> {
        Ok(Sums::default())
    }

    fn step(&self, context: &mut Context<'_>, sums: &mut Sums) -> Result<()> {
        if let Some(value) = context.get::<Option<f64>>(0)? {
            sums.n += 1.0;
            let off = value - sums.mean;
            sums.mean += off / sums.n;
            sums.squares += off * (value - sums.mean);
        }
        Ok(())
    }

    fn finalize(&self, _: &mut Context<'_>, sums: Option<Sums>) -> Result<Option<f64>> {
        let known = sums.filter(|sums| sums.n > 1.0);
        Ok(known.map(|sums| (sums.squares / (sums.n - 1.0)).sqrt()))
    }
}

fn wrong(what: &str) -> Error {
    Error::UserFunctionError(what.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::sql_functions;

    /// By hand: of 1, 2, 3, 4, 100 the median is 3, a quarter lies below 2, and 90 % below 4 + 0.6 × 96.
    #[test]
    fn statistics_are_those_of_the_textbook() {
        let conn = Connection::open_in_memory().expect("a database in memory");
        sql_functions::register(&conn).expect("functions");
        let one = |what: &str| -> Option<f64> {
            let sql = format!(
                "SELECT {what} FROM (SELECT 1 AS x UNION ALL SELECT 4 UNION ALL SELECT 3.0
                 UNION ALL SELECT NULL UNION ALL SELECT 100 UNION ALL SELECT 2)"
            );
            conn.query_row(&sql, [], |row| row.get(0)).expect(what)
        };
        assert_eq!(one("median(x)"), Some(3.0));
        assert_eq!(one("percentile(x, 25)"), Some(2.0));
        assert!((one("percentile(x, 90)").expect("one") - 61.6).abs() < 1e-9);
        assert_eq!(one("percentile(x, 0)"), Some(1.0));
        assert_eq!(one("percentile(x, 100)"), Some(100.0));
        assert!((one("stddev(x)").expect("one") - 43.6176).abs() < 1e-4);
        assert_eq!(one("sqrt(sum(x) - 1 - 100 - 0.0)"), Some(3.0));
        assert_eq!(one("sqrt(-1)"), None);
        for nothing in ["median(NULL)", "percentile(NULL, 5)", "stddev(NULL)"] {
            assert_eq!(one(nothing), None, "{nothing}");
        }
        let wrong = conn.query_row("SELECT percentile(1, 101)", [], |row| row.get::<_, f64>(0));
        assert!(
            wrong
                .expect_err("no share")
                .to_string()
                .contains("0 to 100")
        );
    }
}
