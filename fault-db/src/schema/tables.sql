-- Tables and indexes of a file. Inside the file rows are joined by small integers (seq); between files, and to a
-- person, a row is its 16-byte UUIDv7 (id). Times end in _us: at_us is UTC, bench_us is the bench's own clock.
-- Rows of runs, steps, measurements, occurrences, events, notes and seals are only ever added.
PRAGMA application_id = 1179927618; -- 'FTDB'

CREATE TABLE about(
  key TEXT PRIMARY KEY,                 -- file_id: the name of this file, 16 bytes, given once
  value BLOB NOT NULL
) STRICT, WITHOUT ROWID;

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
  unit_kind TEXT NOT NULL,              -- the unit as this run found it
  unit_config_name TEXT NOT NULL,
  sw_versions TEXT NOT NULL,
  line TEXT NOT NULL,
  train TEXT NOT NULL,                  -- the train the unit is in, as the tester names it; empty: not stated
  seed INTEGER NOT NULL,                -- the 64 bits of an unsigned seed
  operator TEXT NOT NULL,
  source TEXT NOT NULL,                 -- sim, serial:..., tcp:...
  connection TEXT,                      -- harness, or ptu for the maintenance port alone; NULL: not stated
  symptom TEXT,                         -- what was wrong with the unit, as reported; NULL: not stated
  continues BLOB,                       -- id of the run whose open steps this one runs, maybe of another file; NULL: none
  started_at_us INTEGER NOT NULL,
  finished_at_us INTEGER,
  verdict TEXT CHECK(verdict IN ('passed','failed','error','skipped','inconclusive','aborted')),
  bench_time_us INTEGER,
  wall_time_us INTEGER,
  app_version TEXT NOT NULL,
  scripts_sha256 TEXT NOT NULL,
  unit_config_sha256 TEXT NOT NULL,
  injected TEXT,
  evidence TEXT,                        -- json: what the bench was made of, its clock and instruments; NULL: not stated
  owner TEXT NOT NULL                   -- the program that writes it; tells a running run from an interrupted one
) STRICT;
CREATE INDEX run_by_start ON run(started_at_us);
-- The values of a unit are asked run by run; the index alone answers.
CREATE INDEX run_by_unit ON run(unit, started_at_us, id, line, train);
CREATE INDEX run_by_train ON run(train, started_at_us) WHERE train <> '';
CREATE INDEX run_by_end ON run(substr(id, 13));

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
  -- what the record is, and the step's place in its procedure; NULL: outside steps
  kind TEXT NOT NULL CHECK(kind IN ('step','attempt','again','outside')),
  place INTEGER,
  name TEXT NOT NULL,
  turn INTEGER NOT NULL,                -- which of so many repetitions, from 1
  turns INTEGER NOT NULL,
  verdict TEXT NOT NULL CHECK(verdict IN ('passed','failed','error','skipped','inconclusive','aborted')),
  started_bench_us INTEGER NOT NULL,
  bench_time_us INTEGER NOT NULL,
  message TEXT NOT NULL,
  findings TEXT,                        -- the same as data, JSON of the program; NULL: nothing
  script_line INTEGER,
  limit_source TEXT,                    -- where the numbers it expected come from; NULL: not stated
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
  limit_source TEXT,                    -- where its limits come from; NULL: not stated
  PRIMARY KEY(run, step_index, ordinal),
  FOREIGN KEY(run, step_index) REFERENCES step(run, step_index)
) STRICT, WITHOUT ROWID;
CREATE INDEX measurement_by_name ON measurement(name, run, value, unit, low, high, verdict);

-- One row per unit, code and part (lru) that is not closed; the writer keeps that rule, because two files that
-- disagree can still be merged. Columns from `state` on follow from occurrences and events (fault-db/src/history/graph_sql.rs).
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
  occurrences INTEGER NOT NULL,
  line TEXT NOT NULL DEFAULT '',        -- of its first occurrence
  closed_at_us INTEGER,                 -- when it was closed last
  repairs INTEGER NOT NULL DEFAULT 0,   -- repairs recorded for it
  disputed INTEGER NOT NULL DEFAULT 0,  -- people who did not know of each other brought it to different states
  cause TEXT                            -- the part it comes from; NULL: not attributed, it counts for its own part
) STRICT;
CREATE INDEX fault_by_unit ON fault(unit, code, lru);
CREATE INDEX fault_by_unit_time ON fault(unit, last_at_us);
CREATE INDEX fault_by_code ON fault(code, last_at_us);
CREATE INDEX fault_by_lru ON fault(lru, last_at_us);
CREATE INDEX fault_by_time ON fault(last_at_us);
CREATE INDEX fault_by_end ON fault(substr(id, 13));
CREATE INDEX fault_not_closed ON fault(last_at_us, lru, code, unit, line, state) WHERE state <> 'closed';
CREATE INDEX fault_disputed ON fault(id) WHERE disputed = 1;

-- Other ids of a fault: another file or laptop saw it, too, and gave it an id of its own.
CREATE TABLE fault_alias(
  id BLOB PRIMARY KEY,
  fault INTEGER NOT NULL REFERENCES fault(seq)
) STRICT, WITHOUT ROWID;

CREATE TABLE channel_set(
  seq INTEGER PRIMARY KEY,
  sha256 BLOB NOT NULL UNIQUE,          -- of json
  json TEXT NOT NULL                    -- name, unit, kind, lsb, labels; never changed
) STRICT;

-- What was done to the bench in one procedure of a run, kept when the procedure found a fault: enough to do it again.
CREATE TABLE recording(
  run INTEGER NOT NULL REFERENCES run(seq),
  ordinal INTEGER NOT NULL,             -- place of the procedure in the run
  procedure TEXT NOT NULL,
  t0_bench_us INTEGER NOT NULL,         -- bench time of the run at which the bench's clock was 0
  bench_json TEXT NOT NULL,             -- what the bench was made of
  stimuli BLOB NOT NULL,                -- zstd of json: what was done, each with its time on the bench's clock
  PRIMARY KEY(run, ordinal)
) STRICT, WITHOUT ROWID;

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
  data BLOB NOT NULL,
  recording INTEGER                     -- that it was cut from, by its ordinal in the same run; NULL: none was kept
) STRICT;
CREATE INDEX trace_by_run ON trace(run);
CREATE INDEX trace_by_time ON trace(t0_us);
CREATE INDEX trace_by_end ON trace(substr(id, 13));

CREATE TABLE fault_occurrence(
  seq INTEGER PRIMARY KEY,
  id BLOB NOT NULL UNIQUE,
  fault INTEGER NOT NULL REFERENCES fault(seq),
  run INTEGER NOT NULL REFERENCES run(seq),
  step_index INTEGER,                   -- may name a step that is still running
  at_us INTEGER NOT NULL,
  bench_us INTEGER NOT NULL,
  message TEXT NOT NULL,
  findings TEXT,                        -- the same as data, JSON of the program; NULL: nothing
  freeze_json TEXT NOT NULL,
  trace INTEGER REFERENCES trace(seq) ON DELETE SET NULL,
  unit INTEGER NOT NULL,                -- of the fault, as are code and lru
  code INTEGER NOT NULL,
  lru TEXT NOT NULL,
  line TEXT NOT NULL,                   -- of the run
  code_name TEXT NOT NULL,              -- the fault's name and severity as this run knew them
  severity TEXT NOT NULL
) STRICT;
CREATE INDEX fault_occurrence_by_fault ON fault_occurrence(fault, at_us);
CREATE INDEX fault_occurrence_by_run ON fault_occurrence(run);
CREATE INDEX fault_occurrence_by_trace ON fault_occurrence(trace) WHERE trace IS NOT NULL;
CREATE INDEX occurrence_traced ON fault_occurrence(fault, at_us) WHERE trace IS NOT NULL;
CREATE INDEX occurrence_by_time ON fault_occurrence(at_us);
CREATE INDEX occurrence_by_key ON fault_occurrence(unit, code, lru, at_us);
CREATE INDEX occurrence_by_line ON fault_occurrence(line);

CREATE TABLE fault_event(
  seq INTEGER PRIMARY KEY,
  id BLOB NOT NULL UNIQUE,
  fault INTEGER NOT NULL REFERENCES fault(seq),
  kind TEXT NOT NULL,
  at_us INTEGER NOT NULL,
  who TEXT NOT NULL,
  body TEXT NOT NULL,                   -- a note, or json for a repair or a cause
  state TEXT                            -- the fault's state after it; NULL: unchanged
    CHECK(state IN ('open','acknowledged','repaired','verified','closed')),
  -- One more than the greatest of the events its author knew: their order, whatever the clocks of laptops say.
  turn INTEGER NOT NULL,
  -- Of an event that changes the state: the ids, 16 bytes each, of the last such events its author knew, mostly one; of
  -- one of the kind 'withdrawn': the event that a person takes back.
  follows BLOB NOT NULL,
  seen INTEGER NOT NULL                 -- occurrences that its author knew
) STRICT;
CREATE INDEX fault_event_by_fault ON fault_event(fault, turn, state);
CREATE INDEX fault_event_by_time ON fault_event(at_us);
CREATE INDEX fault_event_withdrawn ON fault_event(follows) WHERE kind = 'withdrawn';

-- What the tester has to say about a run, or about a place in one of its traces.
CREATE TABLE run_note(
  seq INTEGER PRIMARY KEY,
  id BLOB NOT NULL UNIQUE,
  run INTEGER NOT NULL REFERENCES run(seq),
  at_us INTEGER NOT NULL,
  who TEXT NOT NULL,
  trace BLOB,                           -- id of the trace that it is about, which may be deleted since; NULL: of the run
  place_us INTEGER,                  -- the place: time from its trigger, or from its first row
  text TEXT NOT NULL,
  CHECK((trace IS NULL) = (place_us IS NULL))
) STRICT;
CREATE INDEX run_note_by_run ON run_note(run, at_us);

-- One chain of entries per file that seals: each entry with the one before it (fault-db/SEALS.md).
CREATE TABLE seal(
  origin BLOB NOT NULL,                 -- file_id of the file that sealed
  ordinal INTEGER NOT NULL,             -- 1, 2, 3 …
  what TEXT NOT NULL,                   -- run, event, note, signature, instrument, pruned, begun, recounted, copied
  id BLOB NOT NULL,                     -- of the run, event, note or trace; of the file for what concerns it
  says TEXT NOT NULL,                   -- json: what no other row says
  digest BLOB NOT NULL,                 -- SHA-256 of all that is sealed
  hash BLOB NOT NULL,                   -- SHA-256 of the hash before and the digest
  PRIMARY KEY(origin, ordinal)
) STRICT, WITHOUT ROWID;
CREATE INDEX seal_by_id ON seal(id, what);
CREATE INDEX seal_instrument ON seal(origin, ordinal) WHERE what = 'instrument';

-- Ends of chains that were seen, of this file and of others; of each the longest.
CREATE TABLE chain_head(
  origin BLOB PRIMARY KEY,
  ordinal INTEGER NOT NULL,
  hash BLOB NOT NULL,
  seen_at_us INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE dictionary(
  seq INTEGER PRIMARY KEY,
  id BLOB NOT NULL UNIQUE,
  made_at_us INTEGER NOT NULL,
  app_version TEXT NOT NULL,
  basis_sha256 TEXT NOT NULL,           -- over scripts, unit configuration, line, train and fault catalogue
  modes INTEGER NOT NULL,               -- fault modes it knows
  data BLOB NOT NULL                    -- zstd of json
) STRICT;
CREATE INDEX dictionary_by_time ON dictionary(made_at_us);

-- What a server does not have yet, in order of commits.
CREATE TABLE outbox(
  seq INTEGER PRIMARY KEY AUTOINCREMENT,
  what TEXT NOT NULL CHECK(what IN ('run','event','note','trace')),
  row INTEGER NOT NULL
) STRICT;
CREATE TABLE sync_server(
  id BLOB PRIMARY KEY,                  -- the server's own
  address TEXT NOT NULL,                -- as last reached, without a password
  sent INTEGER NOT NULL,                -- outbox.seq up to which all but traces are there
  sent_traces INTEGER NOT NULL,         -- the same of traces
  received INTEGER NOT NULL,            -- the server's event number up to which events are here
  last_at_us INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

---- derived: these tables follow from the others; triggers keep them (triggers.sql) ----

-- What happened to a part, one row per repair event that was not withdrawn.
CREATE TABLE repair(
  event INTEGER PRIMARY KEY REFERENCES fault_event(seq),
  fault INTEGER NOT NULL REFERENCES fault(seq),
  unit INTEGER NOT NULL,
  code INTEGER NOT NULL,
  lru TEXT NOT NULL,                    -- that the fault names
  line TEXT NOT NULL,
  part TEXT NOT NULL,                   -- that was repaired, lower case
  at_us INTEGER NOT NULL,
  opened_at_us INTEGER NOT NULL,        -- when the fault was opened or opened again before it
  back_at_us INTEGER                    -- when the unit had the same fault next
) STRICT;
CREATE INDEX repair_by_fault ON repair(unit, code, lru, at_us, opened_at_us, back_at_us, line);
CREATE INDEX repair_by_part ON repair(part, at_us);

-- Faults with their occurrences and repairs, packed by column for counts with any filter (fault-db/src/schema/packed.rs). A row
-- holds the 32 faults whose seq / 32 it names. Triggers empty it when one of them changes; the end of a run and of an
-- import fills empty rows if they are more than a few; a reader packs the others itself.
CREATE TABLE packed(
  block INTEGER PRIMARY KEY,
  faults BLOB,                          -- NULL: empty, as are the other two
  occurrences BLOB,
  repairs BLOB
) STRICT;
CREATE INDEX packed_empty ON packed(block) WHERE faults IS NULL;

-- Measured values of each procedure by day, and by month and unit; t is days since the beginning of 2020.
CREATE TABLE measured_day(
  name TEXT NOT NULL,
  procedure TEXT NOT NULL,
  day INTEGER NOT NULL,
  n INTEGER NOT NULL,
  x REAL NOT NULL, xx REAL NOT NULL, least REAL NOT NULL, most REAL NOT NULL,
  not_passed INTEGER NOT NULL,
  PRIMARY KEY(name, procedure, day)
) STRICT, WITHOUT ROWID;
CREATE TABLE measured_month(
  name TEXT NOT NULL,
  procedure TEXT NOT NULL,
  month INTEGER NOT NULL,
  unit INTEGER NOT NULL,
  n INTEGER NOT NULL,
  x REAL NOT NULL, xx REAL NOT NULL, t REAL NOT NULL, tt REAL NOT NULL, tx REAL NOT NULL,
  PRIMARY KEY(name, procedure, month, unit)
) STRICT, WITHOUT ROWID;

-- Words of notes, by the number of the event or of the note on a run.
CREATE VIRTUAL TABLE event_words USING fts5(words, content='', tokenize='unicode61 remove_diacritics 0');
CREATE VIRTUAL TABLE note_words USING fts5(words, content='', tokenize='unicode61 remove_diacritics 0');
