#!/usr/bin/env python3
"""The questions of benches/questions.rs asked of DuckDB, on the same rows, in the same run.

    python3 -m venv target/duckdb && target/duckdb/bin/pip install duckdb
    target/duckdb/bin/python fault-db/benches/against_duckdb.py FILE

FILE is a history as examples/history makes it. DuckDB keeps the tables as it likes, in memory, with its indexes
on what single units are looked up by; its answers hold what those of the program hold. Prints a table of
medians and 99th percentiles in milliseconds, and how many times as long DuckDB takes.
"""

import json
import sqlite3
import subprocess
import sys
import time

import duckdb

DAY = 86_400_000_000
YEAR = 365 * DAY
TIMES = 50

TABLES = {
    "unit": "seq, serial",
    "run": "seq, unit, line, train, started_at_us",
    "fault": "seq, unit, code, code_name, lru, line, severity, state, first_at_us, last_at_us, closed_at_us, "
    "occurrences, repairs",
    "fault_occurrence": "seq, fault, run, unit, code, lru, line, at_us, bench_us, step_index, message, freeze_json, trace",
    "fault_event": "seq, fault, kind, at_us, who, body, state",
    "repair": "fault, unit, code, lru, line, part, at_us, opened_at_us, back_at_us",
    "measurement": "run, step_index, ordinal, name, value, unit, low, high, verdict",
}


def stats(key, unit):
    """Everything `ptu faults stats` prints of a year, by a key."""
    only = "AND unit = $unit" if unit else ""
    return f"""
    WITH seen AS (SELECT {key} AS k, count(*) AS seen, count(DISTINCT unit) AS units, max(at_us) AS last_at
            FROM fault_occurrence WHERE at_us >= $since AND at_us < $until {only} GROUP BY 1),
        course AS (SELECT k, list(n ORDER BY month) AS course FROM (
            SELECT {key} AS k, date_trunc('month', make_timestamp(at_us)) AS month, count(*) AS n
            FROM fault_occurrence WHERE at_us >= $since AND at_us < $until {only} GROUP BY 1, 2) GROUP BY 1),
        opened AS (SELECT {key} AS k, count(*) AS opened FROM fault
            WHERE first_at_us >= $since AND first_at_us < $until {only} GROUP BY 1),
        closed AS (SELECT {key} AS k, count(*) AS closed, count(*) FILTER (repairs = 0) AS bare FROM fault
            WHERE closed_at_us >= $since AND closed_at_us < $until {only} GROUP BY 1),
        left_open AS (SELECT {key} AS k, count(*) AS left_open FROM fault
            WHERE last_at_us >= $since AND last_at_us < $until AND state <> 'closed' {only} GROUP BY 1),
        repaired AS (SELECT {key} AS k, count(*) AS repairs, sum(at_us - opened_at_us) AS us,
                count(*) FILTER (back_at_us - at_us < {30 * DAY}) AS back FROM repair
            WHERE at_us >= $since AND at_us < $until {only} GROUP BY 1)
    SELECT * FROM seen LEFT JOIN course USING (k) LEFT JOIN opened USING (k) LEFT JOIN closed USING (k)
        LEFT JOIN left_open USING (k) LEFT JOIN repaired USING (k) ORDER BY seen DESC"""


LIST = """SELECT f.*, u.serial, (SELECT max(o.trace) FROM fault_occurrence o WHERE o.fault = f.seq AND o.trace IS NOT NULL)
    FROM fault f JOIN unit u ON u.seq = f.unit WHERE {} ORDER BY f.last_at_us DESC LIMIT 50"""

QUESTIONS = {
    "unit: last 50 faults": LIST.format("f.unit = $unit"),
    "unit: one fault whole": """SELECT o.*, (SELECT list(e.body) FROM fault_event e WHERE e.fault = o.fault)
        FROM fault_occurrence o WHERE o.fault = (SELECT seq FROM fault WHERE unit = $unit
        ORDER BY last_at_us DESC LIMIT 1) ORDER BY o.at_us DESC LIMIT 1000""",
    "unit: a year by code": stats("code", True),
    "unit: a year by part": stats("lru", True),
    "unit: eb_reaction": """SELECT r.started_at_us, m.* FROM run r JOIN measurement m ON m.run = r.seq
        WHERE r.unit = $unit AND m.name = 'eb_reaction' ORDER BY 1""",
    "fleet: a year by code": stats("code", False),
    "fleet: a year by part": stats("lru", False),
    "fleet: a year by unit": stats("unit", False),
    "fleet: a year by line": stats("line", False),
    "fleet: a month by code": stats("code", False),
    "fleet: eb_reaction in a year by day": f"""SELECT r.started_at_us // {DAY}, count(*), sum(value), sum(value * value),
        min(value), max(value), count(*) FILTER (m.verdict <> 'passed') FROM run r JOIN measurement m ON m.run = r.seq
        WHERE m.name = 'eb_reaction' AND value IS NOT NULL AND r.started_at_us >= $since AND r.started_at_us < $until
        GROUP BY 1 ORDER BY 1""",
    "fleet: eb_reaction in a year by unit": """SELECT r.unit, count(*), avg(value), regr_slope(value, r.started_at_us)
        FROM run r JOIN measurement m ON m.run = r.seq WHERE m.name = 'eb_reaction' AND value IS NOT NULL
        AND r.started_at_us >= $since AND r.started_at_us < $until GROUP BY 1""",
    "fleet: last 50 open faults": LIST.format("f.state = 'open'"),
    "fleet: last 50 with 교체 in a note": LIST.format(
        "f.seq IN (SELECT fault FROM fault_event WHERE contains(body, '교체') AND kind NOT IN ('opened', 'recurred'))"
    ),
}


def load(path):
    """The tables of the file in DuckDB, in memory."""
    theirs = duckdb.connect()
    ours = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
    for table, columns in TABLES.items():
        types = {row[1]: row[2] for row in ours.execute(f"PRAGMA table_info({table})")}
        named = [column.strip() for column in columns.split(",")]
        kinds = {"INTEGER": "BIGINT", "REAL": "DOUBLE", "TEXT": "VARCHAR"}
        theirs.execute(f"CREATE TABLE {table} ({', '.join(f'{n} {kinds[types[n]]}' for n in named)})")
        rows = ours.execute(f"SELECT {columns} FROM {table} ORDER BY rowid" if table not in ("measurement",) else
                            f"SELECT {columns} FROM {table} ORDER BY run, step_index, ordinal")
        import csv
        import os
        import tempfile

        with tempfile.NamedTemporaryFile("w", suffix=".csv", newline="", delete=False) as out:
            writer = csv.writer(out)
            while chunk := rows.fetchmany(20_000):
                writer.writerows(["\\N" if cell is None else cell for cell in row] for row in chunk)
        theirs.execute(f"COPY {table} FROM '{out.name}' (FORMAT csv, HEADER false, NULLSTR '\\N')")
        os.unlink(out.name)
    for index, on in {"a": "fault(unit)", "b": "fault_occurrence(fault)", "c": "fault_occurrence(unit)", "d": "run(unit)",
                      "e": "measurement(run)", "f": "repair(unit)", "g": "fault_event(fault)"}.items():
        theirs.execute(f"CREATE INDEX {index} ON {on}")
    return theirs


def main():
    path = sys.argv[1]
    asked = subprocess.run(
        ["cargo", "bench", "-q", "-p", "fault-db", "--bench", "questions", "--", path, "--json"],
        check=True, capture_output=True, text=True,
    )
    ours = {row["question"]: row for row in json.loads(asked.stdout)}
    theirs = load(path)
    first, last = theirs.execute("SELECT min(at_us), max(at_us) FROM fault_occurrence").fetchone()
    units = [row[0] for row in theirs.execute("SELECT seq FROM unit ORDER BY serial").fetchall()]
    print(f"{'question':38} {'p50 ms':>9} {'p99 ms':>9} {'DuckDB p50':>11} {'p99':>9} {'times':>7}")
    for question, sql in QUESTIONS.items():
        span = 30 * DAY if "month" in question else YEAR
        times = []
        for n in range(TIMES):
            since = first + (last - YEAR - first) // TIMES * n
            given = {"unit": units[n * 7 % len(units)], "since": since, "until": min(since + span, last)}
            given = {name: value for name, value in given.items() if f"${name}" in sql}
            began = time.perf_counter()
            theirs.execute(sql, given).fetchall()
            times.append((time.perf_counter() - began) * 1e3)
        times.sort()
        p50, p99 = times[TIMES // 2], times[TIMES * 99 // 100]
        own = ours[question]
        print(f"{question:38} {own['p50_ms']:9.3f} {own['p99_ms']:9.3f} {p50:11.3f} {p99:9.3f} {p50 / own['p50_ms']:7.1f}")


if __name__ == "__main__":
    main()
