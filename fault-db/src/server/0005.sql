-- The earlier run that a run continues, how its unit was reached, what was wrong with it, and where limits come from, as in a file: fault-db/src/schema/0008.sql.
ALTER TABLE run ADD COLUMN continues bytea;
ALTER TABLE run ADD COLUMN connection text COLLATE "C";
ALTER TABLE run ADD COLUMN symptom text COLLATE "C";
ALTER TABLE step ADD COLUMN limit_source text COLLATE "C";
ALTER TABLE measurement ADD COLUMN limit_source text COLLATE "C";

CREATE TRIGGER in_domain_of_continues BEFORE INSERT ON run FOR EACH ROW
  WHEN (NOT is_id(NEW.continues)) EXECUTE FUNCTION refuse_row();
CREATE TRIGGER in_domain_of_connection BEFORE INSERT ON run FOR EACH ROW
  WHEN (NOT is_name(NEW.connection)) EXECUTE FUNCTION refuse_row();
CREATE TRIGGER in_domain_of_symptom BEFORE INSERT ON run FOR EACH ROW
  WHEN (NOT is_name(NEW.symptom)) EXECUTE FUNCTION refuse_row();
CREATE TRIGGER in_domain_of_limit_source BEFORE INSERT ON step FOR EACH ROW
  WHEN (NOT is_text(NEW.limit_source)) EXECUTE FUNCTION refuse_row();
CREATE TRIGGER in_domain_of_limit_source BEFORE INSERT ON measurement FOR EACH ROW
  WHEN (NOT is_text(NEW.limit_source)) EXECUTE FUNCTION refuse_row();

DROP VIEW runs;
CREATE VIEW runs AS
  SELECT id_text(r.id) AS id, u.serial AS unit, u.kind, r.line, r.train, r.operator, r.source, r.connection, r.symptom,
    time_text(r.started_at_us) AS started_at, time_text(r.finished_at_us) AS finished_at, r.verdict,
    CAST(r.bench_time_us AS DOUBLE PRECISION) / 1e6 AS bench_time_s, r.injected, r.app_version,
    id_text(r.continues) AS continues, r.started_at_us
  FROM run r JOIN unit u ON u.seq = r.unit;

DROP VIEW steps;
DROP VIEW measurements;
CREATE VIEW steps AS
  SELECT id_text(r.id) AS run_id, u.serial AS unit, s.step_index, s.procedure, s.name, s.verdict,
    s.message, CAST(s.bench_time_us AS DOUBLE PRECISION) / 1e6 AS bench_time_s, s.script_line, s.limit_source,
    time_text(r.started_at_us) AS started_at,
    r.started_at_us
  FROM step s JOIN run r ON r.seq = s.run JOIN unit u ON u.seq = r.unit;

CREATE VIEW measurements AS
  SELECT id_text(r.id) AS run_id, u.serial AS unit, s.procedure, s.name AS step, m.step_index, m.name,
    m.value, m.unit AS measured_in, m.low, m.high, m.verdict, m.limit_source, time_text(r.started_at_us) AS started_at,
    r.started_at_us
  FROM measurement m JOIN step s ON s.run = m.run AND s.step_index = m.step_index
  JOIN run r ON r.seq = m.run JOIN unit u ON u.seq = r.unit;

-- What a person has withdrawn, as in a file.
CREATE INDEX fault_event_withdrawn ON fault_event(follows) WHERE kind = 'withdrawn';
CREATE TRIGGER in_domain_of_withdrawal BEFORE INSERT ON fault_event FOR EACH ROW
  WHEN (NEW.kind = 'withdrawn' AND NOT (is_id(NEW.follows) AND NEW.state IS NULL))
  EXECUTE FUNCTION refuse_row();

CREATE OR REPLACE VIEW repair AS
  SELECT e.seq AS event, f.seq AS fault, f.unit, f.code, f.lru, f.line, e.part, e.at_us,
    least(e.at_us, coalesce((SELECT max(b.at_us) FROM fault_event b WHERE b.fault = f.seq
      AND b.kind IN ('opened', 'recurred', 'reopened') AND b.at_us <= e.at_us
      AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = b.id)),
      f.first_at_us)) AS opened_at_us,
    (SELECT min(o.at_us) FROM fault_occurrence o WHERE o.unit = f.unit AND o.code = f.code
      AND o.lru = f.lru AND o.at_us > e.at_us) AS back_at_us
  FROM fault_event e JOIN fault f ON f.seq = e.fault WHERE e.kind = 'repair'
    AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = e.id);

DROP VIEW events;
CREATE VIEW events AS
  SELECT id_text(e.id) AS id, id_text(f.id) AS fault_id, e.kind, e.who,
    CASE WHEN e.kind = 'repair' THEN CAST(e.body AS json) ->> 'note'
      WHEN e.kind IN ('cause', 'diagnosed')
        THEN trim((CAST(e.body AS json) ->> 'part') || ' ' || (CAST(e.body AS json) ->> 'note'))
      ELSE e.body END AS text,
    e.state,
    CAST(EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = e.id) AS integer) AS withdrawn,
    e.turn, time_text(e.at_us) AS happened_at, e.at_us
  FROM fault_event e JOIN fault f ON f.seq = e.fault;

-- A search for a fault that found none.
ALTER TABLE run DROP CONSTRAINT run_verdict_check, ADD CONSTRAINT run_verdict_check
  CHECK(verdict IN ('passed','failed','error','skipped','inconclusive','aborted'));
ALTER TABLE step DROP CONSTRAINT step_verdict_check, ADD CONSTRAINT step_verdict_check
  CHECK(verdict IN ('passed','failed','error','skipped','inconclusive','aborted'));
