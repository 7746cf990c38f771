-- Ninth schema: a run says how its unit was reached, which decides what a sound unit measures.
ALTER TABLE run ADD COLUMN connection TEXT; -- harness, or ptu for the maintenance port alone; NULL: nobody said

DROP VIEW runs;
CREATE VIEW runs AS
  SELECT
    lower(hex(substr(r.id, 1, 4)) || '-' || hex(substr(r.id, 5, 2)) || '-' || hex(substr(r.id, 7, 2)) || '-'
      || hex(substr(r.id, 9, 2)) || '-' || hex(substr(r.id, 11))) AS id,
    u.serial AS unit, u.kind, r.line, r.train, r.operator, r.source, r.connection,
    strftime('%Y-%m-%dT%H:%M:%fZ', r.started_at_us / 1000 / 1000.0, 'unixepoch') AS started_at,
    strftime('%Y-%m-%dT%H:%M:%fZ', r.finished_at_us / 1000 / 1000.0, 'unixepoch') AS finished_at, r.verdict,
    CAST(r.bench_time_us AS DOUBLE PRECISION) / 1e6 AS bench_time_s, r.injected, r.app_version,
    CASE WHEN r.continues IS NOT NULL THEN
      lower(hex(substr(r.continues, 1, 4)) || '-' || hex(substr(r.continues, 5, 2)) || '-' || hex(substr(r.continues, 7, 2)) || '-'
      || hex(substr(r.continues, 9, 2)) || '-' || hex(substr(r.continues, 11))) END AS continues, r.started_at_us
  FROM run r JOIN unit u ON u.seq = r.unit;
