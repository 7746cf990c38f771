-- Fourth schema: counts kept for questions about a whole fleet, search in notes, repairs as rows, the
-- chain of runs, and what a server has been told. Counts and repairs follow from other rows; triggers
-- keep them, whoever adds those rows and in whatever order.

CREATE TABLE about(
  key TEXT PRIMARY KEY,                 -- file_id: names this file for ever, 16 bytes
  value BLOB NOT NULL
) STRICT, WITHOUT ROWID;

-- The train the unit is in, as the tester names it; empty if nobody said.
ALTER TABLE run ADD COLUMN train TEXT NOT NULL DEFAULT '';
CREATE INDEX run_by_train ON run(train, started_at_us) WHERE train <> '';

-- The line of its first occurrence; when it was closed last; repairs recorded for it.
ALTER TABLE fault ADD COLUMN line TEXT NOT NULL DEFAULT '';
ALTER TABLE fault ADD COLUMN closed_at_us INTEGER;
ALTER TABLE fault ADD COLUMN repairs INTEGER NOT NULL DEFAULT 0;

-- An event's turn is one more than the greatest it was made in knowledge of: their order whatever the
-- clocks of different laptops say.
ALTER TABLE fault_event ADD COLUMN turn INTEGER NOT NULL DEFAULT 0;
-- Of an event that changed the state: the ids of the last ones of that kind it was made in knowledge of, 16
-- bytes each, mostly one; and how many occurrences were known.
ALTER TABLE fault_event ADD COLUMN follows BLOB NOT NULL DEFAULT x'';
ALTER TABLE fault_event ADD COLUMN seen INTEGER NOT NULL DEFAULT 0;
-- People who did not know of each other brought it to different states.
ALTER TABLE fault ADD COLUMN disputed INTEGER NOT NULL DEFAULT 0;

-- Of the fault and the run, so that one index answers.
ALTER TABLE fault_occurrence ADD COLUMN unit INTEGER NOT NULL DEFAULT 0;
ALTER TABLE fault_occurrence ADD COLUMN code INTEGER NOT NULL DEFAULT 0;
ALTER TABLE fault_occurrence ADD COLUMN lru TEXT NOT NULL DEFAULT '';
ALTER TABLE fault_occurrence ADD COLUMN line TEXT NOT NULL DEFAULT '';

-- Other ids of a fault: another file or laptop saw it too, and gave it one of its own.
CREATE TABLE fault_alias(
  id BLOB PRIMARY KEY,
  fault INTEGER NOT NULL REFERENCES fault(seq)
) STRICT, WITHOUT ROWID;

-- Each finished run sealed with the one before it, per file that recorded runs. Files that shared runs
-- before there were seals have each sealed them.
CREATE TABLE seal(
  origin BLOB NOT NULL,                 -- file_id of the file that sealed the run
  ordinal INTEGER NOT NULL,             -- 1, 2, 3 …
  run INTEGER NOT NULL REFERENCES run(seq),
  digest BLOB NOT NULL,                 -- SHA-256 of all the run says: fault-db/src/seal.rs
  hash BLOB NOT NULL,                   -- SHA-256 of the hash before and the digest
  PRIMARY KEY(origin, ordinal)
) STRICT, WITHOUT ROWID;
CREATE INDEX seal_by_run ON seal(run);

-- What happened to a part, one row per repair event.
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
CREATE INDEX repair_by_time ON repair(at_us, part, lru, code, unit, line, opened_at_us, back_at_us);
CREATE INDEX repair_by_fault ON repair(unit, code, lru, at_us, opened_at_us, back_at_us, line);
CREATE INDEX repair_by_part ON repair(part, at_us);

-- Counts by day and by month (UTC, counted from 1970) for each code, part, unit and line, and all.
CREATE TABLE tally(
  dim INTEGER NOT NULL,                 -- 0 all, 1 code, 2 part, 3 unit, 4 line
  grain INTEGER NOT NULL,               -- 0 month, 1 day
  at INTEGER NOT NULL,
  key ANY NOT NULL,
  seen INTEGER NOT NULL DEFAULT 0,      -- occurrences
  opened INTEGER NOT NULL DEFAULT 0,    -- faults first seen
  closed INTEGER NOT NULL DEFAULT 0,    -- faults closed
  bare INTEGER NOT NULL DEFAULT 0,      -- of these without a repair
  repairs INTEGER NOT NULL DEFAULT 0,   -- repairs made
  repair_us INTEGER NOT NULL DEFAULT 0, -- time from the opening of their faults to them, together
  back INTEGER NOT NULL DEFAULT 0,      -- of these with the same fault again within 30 days
  units BLOB NOT NULL DEFAULT x'',      -- bit n: seen on unit n
  PRIMARY KEY(dim, grain, at, key)
) STRICT, WITHOUT ROWID;

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

-- What a server has not been told yet, in order of commits.
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

-- The values of a unit are asked run by run; the index alone answers.
DROP INDEX run_by_unit;
CREATE INDEX run_by_unit ON run(unit, started_at_us, id, line, train);
DROP INDEX measurement_by_name;
CREATE INDEX measurement_by_name ON measurement(name, run, value, unit, low, high, verdict);

CREATE INDEX run_by_end ON run(substr(id, 13));
CREATE INDEX fault_by_end ON fault(substr(id, 13));
CREATE INDEX trace_by_end ON trace(substr(id, 13));
CREATE INDEX fault_by_unit_time ON fault(unit, last_at_us);
CREATE INDEX fault_not_closed ON fault(last_at_us, lru, code, unit, line, state) WHERE state <> 'closed';
CREATE INDEX fault_of_unit_not_closed ON fault(unit, last_at_us, code, lru, line, state) WHERE state <> 'closed';
CREATE INDEX fault_by_opening ON fault(first_at_us, code, lru, unit, line);
CREATE INDEX fault_of_unit_by_opening ON fault(unit, first_at_us, code, lru, line);
CREATE INDEX fault_of_unit_by_closing ON fault(unit, closed_at_us, code, lru, line, repairs)
  WHERE closed_at_us IS NOT NULL;
CREATE INDEX fault_by_closing ON fault(closed_at_us, code, lru, unit, line, repairs)
  WHERE closed_at_us IS NOT NULL;
CREATE INDEX occurrence_traced ON fault_occurrence(fault, at_us) WHERE trace IS NOT NULL;
CREATE INDEX occurrence_by_time ON fault_occurrence(at_us, code, lru, unit, line);
CREATE INDEX occurrence_by_code ON fault_occurrence(code, at_us, unit, lru, line);
CREATE INDEX occurrence_by_lru ON fault_occurrence(lru, at_us, unit, code, line);
CREATE INDEX occurrence_by_unit ON fault_occurrence(unit, at_us, code, lru, line);
CREATE INDEX occurrence_by_line ON fault_occurrence(line, at_us, unit, code, lru);
CREATE INDEX fault_event_by_time ON fault_event(at_us);

---- fill from what is there, then keep ----

UPDATE fault SET
  line = coalesce((SELECT r.line FROM fault_occurrence o JOIN run r ON r.seq = o.run
    WHERE o.fault = fault.seq ORDER BY o.at_us, o.id LIMIT 1), ''),
  closed_at_us = (SELECT max(e.at_us) FROM fault_event e
    WHERE e.fault = fault.seq AND e.kind = 'closed' AND fault.state = 'closed'),
  repairs = (SELECT count(*) FROM fault_event e WHERE e.fault = fault.seq AND e.kind = 'repair');
UPDATE fault_occurrence SET (unit, code, lru, line) =
  (SELECT f.unit, f.code, f.lru, r.line FROM fault f, run r
   WHERE f.seq = fault_occurrence.fault AND r.seq = fault_occurrence.run);
UPDATE fault_event SET turn = n FROM
  (SELECT seq AS of, row_number() OVER (PARTITION BY fault ORDER BY at_us, seq) AS n FROM fault_event)
  WHERE seq = of;
UPDATE fault_event SET
  follows = coalesce((SELECT id FROM fault_event before WHERE before.fault = fault_event.fault
    AND before.state IS NOT NULL AND before.turn < fault_event.turn ORDER BY before.turn DESC LIMIT 1), x''),
  seen = (SELECT occurrences FROM fault WHERE fault.seq = fault_event.fault)
  WHERE state IS NOT NULL;

-- In time a fault has few events.
DROP INDEX fault_event_by_fault;
CREATE INDEX fault_event_by_fault ON fault_event(fault, turn, state);
CREATE INDEX fault_disputed ON fault(id) WHERE disputed = 1;

CREATE TRIGGER fault_opened AFTER INSERT ON fault BEGIN
  INSERT INTO tally(dim, grain, at, key, opened)
    SELECT dim, grain, at, key, 1 FROM
      (SELECT 0 AS dim, '' AS key UNION ALL SELECT 1, NEW.code UNION ALL SELECT 2, NEW.lru
       UNION ALL SELECT 3, NEW.unit UNION ALL SELECT 4, NEW.line),
      (SELECT 0 AS grain, utc_month(NEW.first_at_us) AS at UNION ALL SELECT 1, utc_day(NEW.first_at_us))
    WHERE true
    ON CONFLICT DO UPDATE SET opened = opened + 1;
END;
CREATE TRIGGER fault_opened_earlier AFTER UPDATE OF first_at_us, line ON fault
WHEN NEW.first_at_us <> OLD.first_at_us OR NEW.line <> OLD.line BEGIN
  INSERT INTO tally(dim, grain, at, key, opened)
    SELECT dim, grain, at, CASE dim WHEN 4 THEN line ELSE key END, change FROM
      (SELECT 0 AS dim, '' AS key UNION ALL SELECT 1, NEW.code UNION ALL SELECT 2, NEW.lru
       UNION ALL SELECT 3, NEW.unit UNION ALL SELECT 4, ''),
      (SELECT 0 AS grain, utc_month(OLD.first_at_us) AS at, -1 AS change, OLD.line AS line
       UNION ALL SELECT 1, utc_day(OLD.first_at_us), -1, OLD.line
       UNION ALL SELECT 0, utc_month(NEW.first_at_us), 1, NEW.line
       UNION ALL SELECT 1, utc_day(NEW.first_at_us), 1, NEW.line)
    WHERE true
    ON CONFLICT DO UPDATE SET opened = opened + excluded.opened;
  UPDATE repair SET line = NEW.line, opened_at_us = min(repair.at_us, coalesce(
      (SELECT max(e.at_us) FROM fault_event e WHERE e.fault = NEW.seq
        AND e.kind IN ('opened', 'recurred', 'reopened') AND e.at_us <= repair.at_us), NEW.first_at_us))
    WHERE unit = NEW.unit AND code = NEW.code AND lru = NEW.lru AND fault = NEW.seq;
END;
CREATE TRIGGER fault_closed_new AFTER INSERT ON fault WHEN NEW.closed_at_us IS NOT NULL BEGIN
  INSERT INTO tally(dim, grain, at, key, closed, bare)
    SELECT dim, grain, at, key, 1, NEW.repairs = 0 FROM
      (SELECT 0 AS dim, '' AS key UNION ALL SELECT 1, NEW.code UNION ALL SELECT 2, NEW.lru
       UNION ALL SELECT 3, NEW.unit UNION ALL SELECT 4, NEW.line),
      (SELECT 0 AS grain, utc_month(NEW.closed_at_us) AS at UNION ALL SELECT 1, utc_day(NEW.closed_at_us))
    WHERE true
    ON CONFLICT DO UPDATE SET closed = closed + 1, bare = bare + excluded.bare;
END;
CREATE TRIGGER fault_closed AFTER UPDATE OF closed_at_us, repairs, line ON fault
WHEN NEW.closed_at_us IS NOT OLD.closed_at_us OR NEW.repairs <> OLD.repairs OR NEW.line <> OLD.line BEGIN
  INSERT INTO tally(dim, grain, at, key, closed, bare)
    SELECT dim, grain, at, CASE dim WHEN 4 THEN line ELSE key END, change, change * bare FROM
      (SELECT 0 AS dim, '' AS key UNION ALL SELECT 1, NEW.code UNION ALL SELECT 2, NEW.lru
       UNION ALL SELECT 3, NEW.unit UNION ALL SELECT 4, ''),
      (SELECT 0 AS grain, utc_month(OLD.closed_at_us) AS at, -1 AS change, OLD.repairs = 0 AS bare,
        OLD.line AS line
       UNION ALL SELECT 1, utc_day(OLD.closed_at_us), -1, OLD.repairs = 0, OLD.line
       UNION ALL SELECT 0, utc_month(NEW.closed_at_us), 1, NEW.repairs = 0, NEW.line
       UNION ALL SELECT 1, utc_day(NEW.closed_at_us), 1, NEW.repairs = 0, NEW.line)
    WHERE at IS NOT NULL
    ON CONFLICT DO UPDATE SET closed = closed + excluded.closed, bare = bare + excluded.bare;
END;
CREATE TRIGGER occurrence_seen AFTER INSERT ON fault_occurrence BEGIN
  INSERT INTO tally(dim, grain, at, key, seen, units)
    SELECT dim, grain, at, key, 1, with_unit(x'', NEW.unit) FROM
      (SELECT 0 AS dim, '' AS key UNION ALL SELECT 1, NEW.code UNION ALL SELECT 2, NEW.lru
       UNION ALL SELECT 3, NEW.unit UNION ALL SELECT 4, NEW.line),
      (SELECT 0 AS grain, utc_month(NEW.at_us) AS at UNION ALL SELECT 1, utc_day(NEW.at_us))
    WHERE true
    ON CONFLICT DO UPDATE SET seen = seen + 1, units = with_unit(units, NEW.unit);
  UPDATE repair SET back_at_us = NEW.at_us
    WHERE unit = NEW.unit AND code = NEW.code AND lru = NEW.lru AND at_us < NEW.at_us
      AND (back_at_us IS NULL OR back_at_us > NEW.at_us);
END;
CREATE TRIGGER event_repair AFTER INSERT ON fault_event WHEN NEW.kind = 'repair' BEGIN
  INSERT INTO repair(event, fault, unit, code, lru, line, part, at_us, opened_at_us, back_at_us)
    SELECT NEW.seq, f.seq, f.unit, f.code, f.lru, f.line,
      part_of(NEW.body), NEW.at_us,
      min(NEW.at_us, coalesce((SELECT max(e.at_us) FROM fault_event e WHERE e.fault = f.seq
        AND e.kind IN ('opened', 'recurred', 'reopened') AND e.at_us <= NEW.at_us), f.first_at_us)),
      (SELECT min(o.at_us) FROM fault_occurrence o WHERE o.unit = f.unit AND o.code = f.code
        AND o.lru = f.lru AND o.at_us > NEW.at_us)
    FROM fault f WHERE f.seq = NEW.fault;
  UPDATE fault SET repairs = repairs + 1 WHERE seq = NEW.fault;
END;
CREATE TRIGGER event_opened AFTER INSERT ON fault_event WHEN NEW.kind IN ('opened', 'recurred', 'reopened') BEGIN
  UPDATE repair SET opened_at_us = (SELECT max(e.at_us) FROM fault_event e WHERE e.fault = NEW.fault
      AND e.kind IN ('opened', 'recurred', 'reopened') AND e.at_us <= repair.at_us)
    WHERE (unit, code, lru) = (SELECT unit, code, lru FROM fault WHERE seq = NEW.fault)
      AND at_us >= NEW.at_us AND fault = NEW.fault;
END;
CREATE TRIGGER repair_made AFTER INSERT ON repair BEGIN
  INSERT INTO tally(dim, grain, at, key, repairs, repair_us, back)
    SELECT dim, grain, at, key, 1, NEW.at_us - NEW.opened_at_us,
      coalesce(NEW.back_at_us - NEW.at_us < 2592000000000, 0)
    FROM
      (SELECT 0 AS dim, '' AS key UNION ALL SELECT 1, NEW.code UNION ALL SELECT 2, NEW.lru
       UNION ALL SELECT 3, NEW.unit UNION ALL SELECT 4, NEW.line),
      (SELECT 0 AS grain, utc_month(NEW.at_us) AS at UNION ALL SELECT 1, utc_day(NEW.at_us))
    WHERE true
    ON CONFLICT DO UPDATE SET repairs = repairs + 1, repair_us = repair_us + excluded.repair_us,
      back = back + excluded.back;
END;
CREATE TRIGGER repair_known_better AFTER UPDATE OF line, opened_at_us, back_at_us ON repair
WHEN NEW.line <> OLD.line OR NEW.opened_at_us <> OLD.opened_at_us
  OR coalesce(NEW.back_at_us - NEW.at_us < 2592000000000, 0)
    <> coalesce(OLD.back_at_us - OLD.at_us < 2592000000000, 0)
BEGIN
  INSERT INTO tally(dim, grain, at, key, repairs, repair_us, back)
    SELECT dim, grain, at, CASE dim WHEN 4 THEN line ELSE key END, n, us, back FROM
      (SELECT 0 AS dim, '' AS key UNION ALL SELECT 1, NEW.code UNION ALL SELECT 2, NEW.lru
       UNION ALL SELECT 3, NEW.unit UNION ALL SELECT 4, ''),
      (SELECT 0 AS grain, utc_month(NEW.at_us) AS at UNION ALL SELECT 1, utc_day(NEW.at_us)),
      (SELECT -1 AS n, OLD.line AS line, OLD.opened_at_us - OLD.at_us AS us,
         -coalesce(OLD.back_at_us - OLD.at_us < 2592000000000, 0) AS back
       UNION ALL SELECT 1, NEW.line, NEW.at_us - NEW.opened_at_us,
         coalesce(NEW.back_at_us - NEW.at_us < 2592000000000, 0))
    WHERE true
    ON CONFLICT DO UPDATE SET repairs = repairs + excluded.repairs,
      repair_us = repair_us + excluded.repair_us, back = back + excluded.back;
END;
CREATE TRIGGER event_said AFTER INSERT ON fault_event
WHEN NEW.kind NOT IN ('opened', 'recurred') AND NEW.body <> '' BEGIN
  INSERT INTO event_words(rowid, words) VALUES (NEW.seq, search_words(NEW.body));
END;
CREATE TRIGGER run_noted AFTER INSERT ON run_note BEGIN
  INSERT INTO note_words(rowid, words) VALUES (NEW.seq, search_words(NEW.text));
END;
CREATE TRIGGER value_measured AFTER INSERT ON measurement WHEN NEW.value IS NOT NULL BEGIN
  INSERT INTO measured_day(name, procedure, day, n, x, xx, least, most, not_passed)
    SELECT NEW.name, s.procedure, utc_day(r.started_at_us), 1, NEW.value, NEW.value * NEW.value, NEW.value, NEW.value,
      NEW.verdict <> 'passed'
    FROM run r, step s WHERE r.seq = NEW.run AND s.run = NEW.run AND s.step_index = NEW.step_index
    ON CONFLICT DO UPDATE SET n = n + 1, x = x + excluded.x, xx = xx + excluded.xx,
      least = min(least, excluded.least), most = max(most, excluded.most),
      not_passed = not_passed + excluded.not_passed;
  INSERT INTO measured_month(name, procedure, month, unit, n, x, xx, t, tt, tx)
    SELECT NEW.name, s.procedure, utc_month(r.started_at_us), r.unit, 1, NEW.value, NEW.value * NEW.value,
      t, t * t, t * NEW.value
    FROM (SELECT seq, unit, started_at_us, (started_at_us - 1577836800000000) / 86400e6 AS t FROM run) r,
      step s
    WHERE r.seq = NEW.run AND s.run = NEW.run AND s.step_index = NEW.step_index
    ON CONFLICT DO UPDATE SET n = n + 1, x = x + excluded.x, xx = xx + excluded.xx,
      t = t + excluded.t, tt = tt + excluded.tt, tx = tx + excluded.tx;
END;

CREATE TRIGGER run_ended AFTER UPDATE OF verdict ON run
WHEN OLD.verdict IS NULL AND NEW.verdict IS NOT NULL BEGIN
  INSERT INTO outbox(what, row) VALUES ('run', NEW.seq);
  INSERT INTO outbox(what, row) SELECT 'trace', t.seq FROM trace t WHERE t.run = NEW.seq ORDER BY t.seq;
END;
CREATE TRIGGER run_came AFTER INSERT ON run WHEN NEW.verdict IS NOT NULL BEGIN
  INSERT INTO outbox(what, row) VALUES ('run', NEW.seq);
END;
CREATE TRIGGER trace_came AFTER INSERT ON trace
WHEN (SELECT verdict FROM run WHERE seq = NEW.run) IS NOT NULL BEGIN
  INSERT INTO outbox(what, row) VALUES ('trace', NEW.seq);
END;
CREATE TRIGGER event_came AFTER INSERT ON fault_event BEGIN
  INSERT INTO outbox(what, row) VALUES ('event', NEW.seq);
END;
CREATE TRIGGER note_came AFTER INSERT ON run_note BEGIN
  INSERT INTO outbox(what, row) VALUES ('note', NEW.seq);
END;
