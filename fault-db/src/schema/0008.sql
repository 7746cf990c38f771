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
