-- First schema. Inside the file rows are joined by small integers (seq); between files, and to a
-- person, a row is its 16-byte UUIDv7 (id). Times end in _us: at_us is UTC, bench_us is the bench's
-- own clock. Rows of step, measurement, fault_occurrence and fault_event are only ever added.
PRAGMA application_id = 1179927618; -- 'FTDB'

CREATE TABLE unit(
  seq INTEGER PRIMARY KEY,
  serial TEXT NOT NULL UNIQUE,
  kind TEXT NOT NULL,
  config_name TEXT NOT NULL,
  sw_versions TEXT NOT NULL             -- json object, part -> version, as last seen
) STRICT;

CREATE TABLE run(
  seq INTEGER PRIMARY KEY,
  id BLOB NOT NULL UNIQUE,
  unit INTEGER NOT NULL REFERENCES unit(seq),
  line TEXT NOT NULL,
  seed INTEGER NOT NULL,                -- the 64 bits of an unsigned seed
  operator TEXT NOT NULL,
  source TEXT NOT NULL,                 -- sim, serial:..., tcp:...
  started_at_us INTEGER NOT NULL,
  finished_at_us INTEGER,
  verdict TEXT CHECK(verdict IN ('passed','failed','error','skipped','aborted')),
  bench_time_us INTEGER,
  wall_time_us INTEGER,
  app_version TEXT NOT NULL,
  scripts_sha256 TEXT NOT NULL,
  unit_config_sha256 TEXT NOT NULL,
  injected TEXT,
  owner TEXT NOT NULL                   -- who is writing; tells a running run from a dead one
) STRICT;
CREATE INDEX run_by_start ON run(started_at_us);
CREATE INDEX run_by_unit ON run(unit, started_at_us);

CREATE TABLE run_script(
  run INTEGER NOT NULL REFERENCES run(seq),
  path TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  PRIMARY KEY(run, path)
) STRICT, WITHOUT ROWID;

CREATE TABLE step(
  run INTEGER NOT NULL REFERENCES run(seq),
  step_index INTEGER NOT NULL,
  procedure TEXT NOT NULL,
  name TEXT NOT NULL,
  verdict TEXT NOT NULL CHECK(verdict IN ('passed','failed','error','skipped','aborted')),
  started_bench_us INTEGER NOT NULL,
  bench_time_us INTEGER NOT NULL,
  message TEXT NOT NULL,
  script_line INTEGER,
  PRIMARY KEY(run, step_index)
) STRICT, WITHOUT ROWID;

CREATE TABLE measurement(
  run INTEGER NOT NULL,
  step_index INTEGER NOT NULL,
  ordinal INTEGER NOT NULL,             -- place within its step
  name TEXT NOT NULL,
  value REAL,                           -- NULL: nothing could be measured
  unit TEXT NOT NULL,
  low REAL,
  high REAL,
  verdict TEXT NOT NULL CHECK(verdict IN ('passed','failed','error','skipped','aborted')),
  PRIMARY KEY(run, step_index, ordinal),
  FOREIGN KEY(run, step_index) REFERENCES step(run, step_index)
) STRICT, WITHOUT ROWID;
CREATE INDEX measurement_by_name ON measurement(name, run);

-- One row per (unit, code, lru) that is not closed; the writer holds the rule, because two files
-- that disagree must still merge.
CREATE TABLE fault(
  seq INTEGER PRIMARY KEY,
  id BLOB NOT NULL UNIQUE,
  unit INTEGER NOT NULL REFERENCES unit(seq),
  code INTEGER NOT NULL,
  code_name TEXT NOT NULL,
  lru TEXT NOT NULL,
  severity TEXT NOT NULL,
  state TEXT NOT NULL CHECK(state IN ('open','acknowledged','repaired','verified','closed')),
  first_at_us INTEGER NOT NULL,
  last_at_us INTEGER NOT NULL,
  occurrences INTEGER NOT NULL
) STRICT;
CREATE INDEX fault_by_unit ON fault(unit, code, lru);
CREATE INDEX fault_by_code ON fault(code, last_at_us);
CREATE INDEX fault_by_lru ON fault(lru, last_at_us);
CREATE INDEX fault_by_time ON fault(last_at_us);

CREATE TABLE channel_set(
  seq INTEGER PRIMARY KEY,
  sha256 BLOB NOT NULL UNIQUE,          -- of json
  json TEXT NOT NULL                    -- name, unit, kind, lsb, labels; never changed
) STRICT;

CREATE TABLE trace(
  seq INTEGER PRIMARY KEY,
  id BLOB NOT NULL UNIQUE,
  run INTEGER NOT NULL REFERENCES run(seq),
  t0_bench_us INTEGER NOT NULL,
  t0_us INTEGER NOT NULL,
  period_us INTEGER NOT NULL,
  row_count INTEGER NOT NULL,
  trigger_row INTEGER,
  flags INTEGER NOT NULL,               -- 1 partial, 2 gaps
  channel_set INTEGER NOT NULL REFERENCES channel_set(seq),
  encoding INTEGER NOT NULL,            -- fault-db/src/trace/layout.rs
  sha256 BLOB NOT NULL,                 -- of data
  data BLOB NOT NULL
) STRICT;
CREATE INDEX trace_by_run ON trace(run);
CREATE INDEX trace_by_time ON trace(t0_us);

CREATE TABLE fault_occurrence(
  seq INTEGER PRIMARY KEY,
  id BLOB NOT NULL UNIQUE,
  fault INTEGER NOT NULL REFERENCES fault(seq),
  run INTEGER NOT NULL REFERENCES run(seq),
  step_index INTEGER,                   -- may name a step that is still under way
  at_us INTEGER NOT NULL,
  bench_us INTEGER NOT NULL,
  message TEXT NOT NULL,
  freeze_json TEXT NOT NULL,
  trace INTEGER REFERENCES trace(seq) ON DELETE SET NULL
) STRICT;
CREATE INDEX fault_occurrence_by_fault ON fault_occurrence(fault, at_us);
CREATE INDEX fault_occurrence_by_run ON fault_occurrence(run);
CREATE INDEX fault_occurrence_by_trace ON fault_occurrence(trace) WHERE trace IS NOT NULL;

CREATE TABLE fault_event(
  seq INTEGER PRIMARY KEY,
  id BLOB NOT NULL UNIQUE,
  fault INTEGER NOT NULL REFERENCES fault(seq),
  kind TEXT NOT NULL,
  at_us INTEGER NOT NULL,
  who TEXT NOT NULL,
  body TEXT NOT NULL,                   -- a note, or json for kind 'repair'
  state TEXT                            -- the fault's state after it; NULL: unchanged
    CHECK(state IN ('open','acknowledged','repaired','verified','closed'))
) STRICT;
CREATE INDEX fault_event_by_fault ON fault_event(fault, at_us);
