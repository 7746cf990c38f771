-- Eighth schema: a run that runs what an earlier one left open names it, and says how its unit was reached and what was
-- wrong with it; limits say where they come from.
ALTER TABLE run ADD COLUMN continues BLOB; -- id of that run, which may be in another file; NULL: none
ALTER TABLE run ADD COLUMN connection TEXT; -- harness, or ptu for the maintenance port alone; NULL: nobody said
ALTER TABLE run ADD COLUMN symptom TEXT; -- what was wrong with the unit, as who brought it said; NULL: nobody said
ALTER TABLE step ADD COLUMN limit_source TEXT; -- of the numbers in what it expected; NULL: none is known
ALTER TABLE measurement ADD COLUMN limit_source TEXT; -- of its limits; NULL: none is known

DROP VIEW runs;
CREATE VIEW runs AS
  SELECT
    lower(hex(substr(r.id, 1, 4)) || '-' || hex(substr(r.id, 5, 2)) || '-' || hex(substr(r.id, 7, 2)) || '-'
      || hex(substr(r.id, 9, 2)) || '-' || hex(substr(r.id, 11))) AS id,
    u.serial AS unit, u.kind, r.line, r.train, r.operator, r.source, r.connection, r.symptom,
    strftime('%Y-%m-%dT%H:%M:%fZ', r.started_at_us / 1000 / 1000.0, 'unixepoch') AS started_at,
    strftime('%Y-%m-%dT%H:%M:%fZ', r.finished_at_us / 1000 / 1000.0, 'unixepoch') AS finished_at, r.verdict,
    CAST(r.bench_time_us AS DOUBLE PRECISION) / 1e6 AS bench_time_s, r.injected, r.app_version,
    CASE WHEN r.continues IS NOT NULL THEN
      lower(hex(substr(r.continues, 1, 4)) || '-' || hex(substr(r.continues, 5, 2)) || '-' || hex(substr(r.continues, 7, 2)) || '-'
      || hex(substr(r.continues, 9, 2)) || '-' || hex(substr(r.continues, 11))) END AS continues, r.started_at_us
  FROM run r JOIN unit u ON u.seq = r.unit;

DROP VIEW steps;
DROP VIEW measurements;
CREATE VIEW steps AS
  SELECT
    lower(hex(substr(r.id, 1, 4)) || '-' || hex(substr(r.id, 5, 2)) || '-' || hex(substr(r.id, 7, 2)) || '-'
      || hex(substr(r.id, 9, 2)) || '-' || hex(substr(r.id, 11))) AS run_id,
    u.serial AS unit, s.step_index, s.procedure, s.name, s.verdict,
    s.message, CAST(s.bench_time_us AS DOUBLE PRECISION) / 1e6 AS bench_time_s, s.script_line, s.limit_source,
    strftime('%Y-%m-%dT%H:%M:%fZ', r.started_at_us / 1000 / 1000.0, 'unixepoch') AS started_at,
    r.started_at_us
  FROM step s JOIN run r ON r.seq = s.run JOIN unit u ON u.seq = r.unit;

CREATE VIEW measurements AS
  SELECT
    lower(hex(substr(r.id, 1, 4)) || '-' || hex(substr(r.id, 5, 2)) || '-' || hex(substr(r.id, 7, 2)) || '-'
      || hex(substr(r.id, 9, 2)) || '-' || hex(substr(r.id, 11))) AS run_id,
    u.serial AS unit, s.procedure, s.name AS step, m.step_index, m.name,
    m.value, m.unit AS measured_in, m.low, m.high, m.verdict, m.limit_source,
    strftime('%Y-%m-%dT%H:%M:%fZ', r.started_at_us / 1000 / 1000.0, 'unixepoch') AS started_at,
    r.started_at_us
  FROM measurement m JOIN step s ON s.run = m.run AND s.step_index = m.step_index
  JOIN run r ON r.seq = m.run JOIN unit u ON u.seq = r.unit;

-- An event of the kind `withdrawn` follows the one that a person takes back. Both stay; what is derived leaves the one
-- that is taken back out, in whatever order they come.
CREATE INDEX fault_event_withdrawn ON fault_event(follows) WHERE kind = 'withdrawn';

DROP TRIGGER fault_opened_earlier;
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
        AND e.kind IN ('opened', 'recurred', 'reopened') AND e.at_us <= repair.at_us
        AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = e.id)), NEW.first_at_us))
    WHERE unit = NEW.unit AND code = NEW.code AND lru = NEW.lru AND fault = NEW.seq;
END;
DROP TRIGGER event_repair;
CREATE TRIGGER event_repair AFTER INSERT ON fault_event WHEN NEW.kind = 'repair' BEGIN
  INSERT INTO repair(event, fault, unit, code, lru, line, part, at_us, opened_at_us, back_at_us)
    SELECT NEW.seq, f.seq, f.unit, f.code, f.lru, f.line,
      part_of(NEW.body), NEW.at_us,
      min(NEW.at_us, coalesce((SELECT max(e.at_us) FROM fault_event e WHERE e.fault = f.seq
        AND e.kind IN ('opened', 'recurred', 'reopened') AND e.at_us <= NEW.at_us
        AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = e.id)), f.first_at_us)),
      (SELECT min(o.at_us) FROM fault_occurrence o WHERE o.unit = f.unit AND o.code = f.code
        AND o.lru = f.lru AND o.at_us > NEW.at_us)
    FROM fault f WHERE f.seq = NEW.fault
      AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = NEW.id);
  UPDATE fault SET repairs = (SELECT count(*) FROM fault_event e WHERE e.fault = NEW.fault AND e.kind = 'repair'
      AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = e.id))
    WHERE seq = NEW.fault;
END;
DROP TRIGGER event_opened;
CREATE TRIGGER event_opened AFTER INSERT ON fault_event
WHEN NEW.kind IN ('opened', 'recurred', 'reopened', 'withdrawn') BEGIN
  UPDATE repair SET opened_at_us = min(repair.at_us, coalesce((SELECT max(e.at_us) FROM fault_event e
      WHERE e.fault = NEW.fault AND e.kind IN ('opened', 'recurred', 'reopened') AND e.at_us <= repair.at_us
        AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = e.id)),
      (SELECT first_at_us FROM fault WHERE seq = NEW.fault)))
    WHERE (unit, code, lru) = (SELECT unit, code, lru FROM fault WHERE seq = NEW.fault)
      AND (NEW.kind = 'withdrawn' OR at_us >= NEW.at_us) AND fault = NEW.fault;
END;
CREATE TRIGGER event_withdrawn AFTER INSERT ON fault_event WHEN NEW.kind = 'withdrawn' BEGIN
  INSERT INTO tally(dim, grain, at, key, repairs, repair_us, back)
    SELECT dim, grain, CASE grain WHEN 0 THEN utc_month(at_us) ELSE utc_day(at_us) END,
      CASE dim WHEN 0 THEN '' WHEN 1 THEN code WHEN 2 THEN lru WHEN 3 THEN unit ELSE line END,
      -1, opened_at_us - at_us, -coalesce(back_at_us - at_us < 2592000000000, 0)
    FROM repair,
      (SELECT 0 AS dim UNION ALL SELECT 1 UNION ALL SELECT 2 UNION ALL SELECT 3 UNION ALL SELECT 4),
      (SELECT 0 AS grain UNION ALL SELECT 1)
    WHERE event = (SELECT seq FROM fault_event WHERE id = NEW.follows)
    ON CONFLICT DO UPDATE SET repairs = repairs + excluded.repairs,
      repair_us = repair_us + excluded.repair_us, back = back + excluded.back;
  DELETE FROM repair WHERE event = (SELECT seq FROM fault_event WHERE id = NEW.follows);
END;

DROP VIEW events;
CREATE VIEW events AS
  SELECT
    lower(hex(substr(e.id, 1, 4)) || '-' || hex(substr(e.id, 5, 2)) || '-' || hex(substr(e.id, 7, 2)) || '-'
      || hex(substr(e.id, 9, 2)) || '-' || hex(substr(e.id, 11))) AS id,
    lower(hex(substr(f.id, 1, 4)) || '-' || hex(substr(f.id, 5, 2)) || '-' || hex(substr(f.id, 7, 2)) || '-'
      || hex(substr(f.id, 9, 2)) || '-' || hex(substr(f.id, 11))) AS fault_id,
    e.kind, e.who,
    CASE WHEN e.kind = 'repair' THEN json_extract(e.body, '$.note')
      WHEN e.kind IN ('cause', 'diagnosed')
        THEN trim(json_extract(e.body, '$.part') || ' ' || json_extract(e.body, '$.note'))
      ELSE e.body END AS text,
    e.state,
    EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = e.id) AS withdrawn, e.turn,
    strftime('%Y-%m-%dT%H:%M:%fZ', e.at_us / 1000 / 1000.0, 'unixepoch') AS happened_at, e.at_us
  FROM fault_event e JOIN fault f ON f.seq = e.fault;

-- A search for a fault that found none is inconclusive: a word more in the check of two columns, which what is stored meets.
PRAGMA writable_schema = ON;
UPDATE sqlite_schema SET sql = replace(sql, '''skipped'',''aborted''', '''skipped'',''inconclusive'',''aborted''')
  WHERE type = 'table' AND name IN ('run', 'step');
PRAGMA writable_schema = RESET;
