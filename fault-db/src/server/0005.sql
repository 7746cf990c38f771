-- The earlier run that a run continues, as in a file: fault-db/src/schema/0008.sql.
ALTER TABLE run ADD COLUMN continues bytea;

CREATE TRIGGER in_domain_of_continues BEFORE INSERT ON run FOR EACH ROW
  WHEN (NOT is_id(NEW.continues)) EXECUTE FUNCTION refuse_row();

DROP VIEW runs;
CREATE VIEW runs AS
  SELECT id_text(r.id) AS id, u.serial AS unit, u.kind, r.line, r.train, r.operator, r.source,
    time_text(r.started_at_us) AS started_at, time_text(r.finished_at_us) AS finished_at, r.verdict,
    CAST(r.bench_time_us AS DOUBLE PRECISION) / 1e6 AS bench_time_s, r.injected, r.app_version,
    id_text(r.continues) AS continues, r.started_at_us
  FROM run r JOIN unit u ON u.seq = r.unit;
