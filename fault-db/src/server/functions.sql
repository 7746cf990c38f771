-- Keep what follows from other rows, for laptops, which may only add rows. A laptop reports how far it has read, and
-- the present names of units and faults. Each `ptu db server init` replaces these functions; how a fault is settled is fault-db/src/history/graph_sql.rs.

-- A file comes: what is here of it.
CREATE OR REPLACE FUNCTION meet_laptop(file bytea, called text, ahead_us bigint)
  RETURNS TABLE(number bigint, through bigint, traces_through bigint, told bigint)
  LANGUAGE sql SECURITY DEFINER SET search_path FROM CURRENT AS $$
  INSERT INTO laptop(file_id, name, first_at_us, last_at_us, clock_offset_us, sent, sent_traces, received)
  SELECT $1, $2, clock.us, clock.us, $3, 0, 0, 0
  FROM (SELECT CAST(extract(epoch FROM clock_timestamp()) * 1000000 AS bigint) AS us) AS clock
  ON CONFLICT (file_id) DO UPDATE SET name = excluded.name, last_at_us = excluded.last_at_us,
    clock_offset_us = excluded.clock_offset_us
  RETURNING laptop.seq, laptop.sent, laptop.sent_traces, laptop.received
$$;

CREATE OR REPLACE FUNCTION note_sent(of_laptop bigint, sent bigint, sent_traces bigint) RETURNS void
  LANGUAGE sql SECURITY DEFINER SET search_path FROM CURRENT AS $$
  UPDATE laptop SET sent = $2, sent_traces = $3 WHERE seq = $1
$$;

-- What changed again meanwhile stays fresh.
CREATE OR REPLACE FUNCTION note_told(of_laptop bigint, received bigint, faults bigint[], times bigint[])
  RETURNS void LANGUAGE sql SECURITY DEFINER SET search_path FROM CURRENT AS $$
  UPDATE laptop SET received = $2 WHERE seq = $1;
  UPDATE laptop_fault k SET fresh = 0 FROM unnest($3, $4) AS x(fault, times)
  WHERE k.laptop = $1 AND k.fault = x.fault AND k.fresh = x.times
$$;

-- Who has seen a unit last knows it best.
CREATE OR REPLACE FUNCTION know_units(serials text[], kinds text[], configs text[], versions text[],
    seen_at_us bigint[])
  RETURNS void LANGUAGE sql SECURITY DEFINER SET search_path FROM CURRENT AS $$
  UPDATE unit u SET kind = x.kind, config_name = x.config_name, sw_versions = x.sw_versions
  FROM unnest($1, $2, $3, $4, $5) AS x(serial, kind, config_name, sw_versions, seen_at_us)
  WHERE u.serial = x.serial
    AND (u.kind, u.config_name, u.sw_versions) <> (x.kind, x.config_name, x.sw_versions)
    AND x.seen_at_us >= coalesce((SELECT max(r.started_at_us) FROM run r
      WHERE r.unit = u.seq AND is_time(r.started_at_us)), 0)
    AND is_name(x.kind) AND is_name(x.config_name) AND is_json(x.sw_versions)
$$;

-- Runs that were thought dead, and were not.
CREATE OR REPLACE FUNCTION end_runs(ids bytea[], verdicts text[], finished_at_us bigint[], bench_us bigint[],
    wall_us bigint[])
  RETURNS void LANGUAGE sql SECURITY DEFINER SET search_path FROM CURRENT AS $$
  UPDATE run r SET verdict = x.verdict, finished_at_us = x.finished_at_us, bench_time_us = x.bench_us,
    wall_time_us = x.wall_us
  FROM unnest($1, $2, $3, $4, $5) AS x(id, verdict, finished_at_us, bench_us, wall_us)
  WHERE r.id = x.id AND r.verdict IS NULL AND x.verdict IS NOT NULL AND is_time(x.finished_at_us)
    AND is_span(x.bench_us) AND is_span(x.wall_us)
$$;

-- As a fault was called when it was seen last.
CREATE OR REPLACE FUNCTION name_faults(of_laptop bigint, ids bytea[], names text[], severities text[],
    last_at_us bigint[])
  RETURNS void LANGUAGE sql SECURITY DEFINER SET search_path FROM CURRENT AS $$
  UPDATE fault f SET code_name = x.code_name, severity = x.severity
  FROM unnest($2, $3, $4, $5) AS x(id, code_name, severity, last_at_us)
    JOIN laptop_fault k ON k.laptop = $1 AND k.id = x.id
  WHERE f.seq = k.fault AND (f.code_name, f.severity) <> (x.code_name, x.severity)
    AND x.last_at_us >= f.last_at_us AND is_name(x.code_name) AND is_name(x.severity)
$$;

CREATE OR REPLACE FUNCTION show_traces(occurrences bytea[], traces bytea[]) RETURNS void
  LANGUAGE sql SECURITY DEFINER SET search_path FROM CURRENT AS $$
  UPDATE fault_occurrence o SET trace = t.seq
  FROM unnest($1, $2) AS x(occurrence, trace) JOIN trace t ON t.id = x.trace
  WHERE o.id = x.occurrence AND o.trace IS NULL
$$;

CREATE OR REPLACE FUNCTION settle_faults(faults bigint[]) RETURNS void
  LANGUAGE sql SECURITY DEFINER SET search_path FROM CURRENT AS $$
  {settle} WHERE seq = ANY($1)
$$;

-- Of these faults, those that are not closed become one with the oldest of the same unit, code and part that is
-- not closed either, and their ids other names of it. Each laptop that has either of them reads again what
-- was written about both. How rows move is fault-db/src/history/graph_sql.rs.
CREATE OR REPLACE FUNCTION join_faults(faults bigint[]) RETURNS void
  LANGUAGE plpgsql SECURITY DEFINER SET search_path FROM CURRENT AS $$
DECLARE
  stays bigint;
  goes bigint;
  joined bigint[] := ARRAY[]::bigint[];
BEGIN
  FOR stays, goes IN
    SELECT DISTINCT oldest.seq, other.seq FROM fault f
      CROSS JOIN LATERAL (SELECT min(d.seq) AS seq FROM fault d WHERE d.unit = f.unit
        AND d.code = f.code AND d.lru = f.lru AND d.state <> 'closed') AS oldest
      JOIN fault other ON other.unit = f.unit AND other.code = f.code AND other.lru = f.lru
        AND other.state <> 'closed' AND other.seq > oldest.seq
    WHERE f.seq = ANY($1) AND f.state <> 'closed'
  LOOP
    {move};
    UPDATE laptop_fault SET fault = stays, fresh = fresh + 1 WHERE fault IN (stays, goes);
    DELETE FROM fault WHERE seq = goes;
    joined := joined || stays;
  END LOOP;
  PERFORM settle_faults(joined);
END $$;
