-- How the unit of a run was reached, as in a file: fault-db/src/schema/0009.sql.
ALTER TABLE run ADD COLUMN connection text COLLATE "C";

CREATE TRIGGER in_domain_of_connection BEFORE INSERT ON run FOR EACH ROW
  WHEN (NOT is_name(NEW.connection)) EXECUTE FUNCTION refuse_row();

DROP VIEW runs;
CREATE VIEW runs AS
  SELECT id_text(r.id) AS id, u.serial AS unit, u.kind, r.line, r.train, r.operator, r.source, r.connection,
    time_text(r.started_at_us) AS started_at, time_text(r.finished_at_us) AS finished_at, r.verdict,
    CAST(r.bench_time_us AS DOUBLE PRECISION) / 1e6 AS bench_time_s, r.injected, r.app_version,
    id_text(r.continues) AS continues, r.started_at_us
  FROM run r JOIN unit u ON u.seq = r.unit;
