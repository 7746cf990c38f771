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
