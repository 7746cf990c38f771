//! Merges units, runs, notes on runs, and traces.

use rusqlite::params;

use super::Merge;
use super::rows::{Numbers, renumber, values};

impl Merge<'_> {
    pub(super) fn units(&mut self) -> rusqlite::Result<Numbers> {
        let mut numbers = Numbers::new();
        let mut select = self
            .theirs
            .prepare("SELECT seq, serial, kind, config_name, sw_versions FROM unit")?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let known = "SELECT seq FROM unit WHERE serial = ?1";
            let insert = "INSERT INTO unit(serial, kind, config_name, sw_versions)
                VALUES (?1, ?2, ?3, ?4)";
            let (seq, is_new) = self.find_or_insert(known, insert, &values(row, 1..5)?)?;
            self.counts.units += usize::from(is_new);
            numbers.insert(row.get(0)?, seq);
        }
        Ok(numbers)
    }

    pub(super) fn runs(&mut self, units: &Numbers) -> rusqlite::Result<Numbers> {
        let mut numbers = Numbers::new();
        let mut select = self.theirs.prepare(
            "SELECT seq, id, unit, line, seed, operator, source, started_at_us, finished_at_us,
                verdict, bench_time_us, wall_time_us, app_version, scripts_sha256,
                unit_config_sha256, injected, owner, train, unit_kind, unit_config_name, sw_versions
             FROM run",
        )?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let mut run = values(row, 1..21)?;
            run[1] = renumber(units, row.get(2)?);
            let known = "SELECT seq FROM run WHERE id = ?1";
            let insert = "INSERT INTO run(id, unit, line, seed, operator, source, started_at_us,
                    finished_at_us, verdict, bench_time_us, wall_time_us, app_version,
                    scripts_sha256, unit_config_sha256, injected, owner, train, unit_kind,
                    unit_config_name, sw_versions)
                VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16,
                    ?17, ?18, ?19, ?20)";
            let (seq, is_new) = self.find_or_insert(known, insert, &run)?;
            self.counts.runs += usize::from(is_new);
            // It may have been copied earlier while it was still running.
            let ended = self
                .ours
                .prepare_cached(
                    "UPDATE run SET finished_at_us = ?2, verdict = ?3, bench_time_us = ?4,
                        wall_time_us = ?5 WHERE seq = ?1 AND verdict IS NULL AND ?3 IS NOT NULL",
                )?
                .execute(params![seq, run[7], run[8], run[9], run[10]])?;
            if is_new || ended > 0 {
                self.fresh_runs.insert(seq);
            } else if self.is_over(seq)? {
                self.sealed_runs.insert(seq);
            }
            numbers.insert(row.get(0)?, seq);
        }
        Ok(numbers)
    }

    /// Whether a run of ours is finished, and so sealed.
    fn is_over(&self, run: i64) -> rusqlite::Result<bool> {
        self.ours
            .prepare_cached("SELECT verdict IS NOT NULL FROM run WHERE seq = ?1")?
            .query_row([run], |row| row.get(0))
    }

    pub(super) fn notes(&mut self, runs: &Numbers) -> rusqlite::Result<()> {
        let mut select = self
            .theirs
            .prepare("SELECT id, run, at_us, who, text FROM run_note")?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let mut note = values(row, 0..5)?;
            note[1] = renumber(runs, row.get(1)?);
            let known = "SELECT seq FROM run_note WHERE id = ?1";
            let insert =
                "INSERT INTO run_note(id, run, at_us, who, text) VALUES (?1, ?2, ?3, ?4, ?5)";
            let (_, is_new) = self.find_or_insert(known, insert, &note)?;
            self.counts.notes += usize::from(is_new);
        }
        Ok(())
    }

    pub(super) fn channel_sets(&self) -> rusqlite::Result<Numbers> {
        let mut numbers = Numbers::new();
        let mut select = self
            .theirs
            .prepare("SELECT seq, sha256, json FROM channel_set")?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let known = "SELECT seq FROM channel_set WHERE sha256 = ?1";
            let insert = "INSERT INTO channel_set(sha256, json) VALUES (?1, ?2)";
            let (seq, _) = self.find_or_insert(known, insert, &values(row, 1..3)?)?;
            numbers.insert(row.get(0)?, seq);
        }
        Ok(numbers)
    }

    pub(super) fn traces(
        &mut self,
        runs: &Numbers,
        channel_sets: &Numbers,
    ) -> rusqlite::Result<Numbers> {
        let mut numbers = Numbers::new();
        let mut select = self.theirs.prepare(
            "SELECT seq, id, run, t0_bench_us, t0_us, period_us, row_count, trigger_row, flags,
                channel_set, encoding, sha256, data, recording FROM trace",
        )?;
        let mut rows = select.query([])?;
        while let Some(row) = rows.next()? {
            let mut trace = values(row, 1..14)?;
            trace[1] = renumber(runs, row.get(2)?);
            trace[8] = renumber(channel_sets, row.get(9)?);
            let known = "SELECT seq FROM trace WHERE id = ?1";
            let insert = "INSERT INTO trace(id, run, t0_bench_us, t0_us, period_us, row_count,
                    trigger_row, flags, channel_set, encoding, sha256, data, recording)
                VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13)";
            let (seq, is_new) = self.find_or_insert(known, insert, &trace)?;
            self.counts.traces += usize::from(is_new);
            // It may have been copied earlier while its procedure was still running.
            self.ours
                .prepare_cached(
                    "UPDATE trace SET recording = ?2 WHERE seq = ?1 AND recording IS NULL",
                )?
                .execute(params![seq, trace[12]])?;
            numbers.insert(row.get(0)?, seq);
        }
        Ok(numbers)
    }
}
