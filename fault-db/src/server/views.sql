-- The views of schema/views.sql in PostgreSQL's words: the same columns, the same answers.

-- A time is shown as near to it as a date can be.
CREATE FUNCTION near(at_us bigint) RETURNS bigint LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN least(greatest(at_us, -62135596800000000), 253402300799999999);
CREATE FUNCTION time_text(at_us bigint) RETURNS text LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN to_char(to_timestamp(near(at_us) / 1000 / 1000.0) AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS.MS"Z"');
CREATE FUNCTION id_text(id bytea) RETURNS text LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN CASE octet_length(id) WHEN 16 THEN CAST(CAST(encode(id, 'hex') AS uuid) AS text) ELSE encode(id, 'hex') END;

CREATE VIEW runs AS
  SELECT id_text(r.id) AS id, u.serial AS unit, u.kind, r.line, r.train, r.operator, r.source, r.connection, r.symptom,
    time_text(r.started_at_us) AS started_at, time_text(r.finished_at_us) AS finished_at, r.verdict,
    CAST(r.bench_time_us AS DOUBLE PRECISION) / 1e6 AS bench_time_s, r.injected, r.app_version,
    id_text(r.continues) AS continues, r.started_at_us
  FROM run r JOIN unit u ON u.seq = r.unit;

CREATE VIEW steps AS
  SELECT id_text(r.id) AS run_id, u.serial AS unit, s.step_index, s.procedure, s.kind, s.name, s.turn, s.turns, s.verdict,
    s.message, s.findings, CAST(s.bench_time_us AS DOUBLE PRECISION) / 1e6 AS bench_time_s, s.script_line, s.limit_source,
    time_text(r.started_at_us) AS started_at,
    r.started_at_us
  FROM step s JOIN run r ON r.seq = s.run JOIN unit u ON u.seq = r.unit;

CREATE VIEW measurements AS
  SELECT id_text(r.id) AS run_id, u.serial AS unit, s.procedure, s.name AS step, m.step_index, m.name,
    m.value, m.unit AS measured_in, m.low, m.high, m.verdict, m.limit_source, time_text(r.started_at_us) AS started_at,
    r.started_at_us
  FROM measurement m JOIN step s ON s.run = m.run AND s.step_index = m.step_index
  JOIN run r ON r.seq = m.run JOIN unit u ON u.seq = r.unit;

CREATE VIEW faults AS
  SELECT id_text(f.id) AS id, u.serial AS unit, f.code, f.code_name AS name, f.lru,
    coalesce(f.cause, f.lru) AS cause, f.severity, f.state,
    f.line, f.occurrences, f.repairs, time_text(f.first_at_us) AS first_at, time_text(f.last_at_us) AS last_at,
    time_text(f.closed_at_us) AS closed_at, f.first_at_us, f.last_at_us, f.closed_at_us
  FROM fault f JOIN unit u ON u.seq = f.unit;

CREATE VIEW occurrences AS
  SELECT id_text(o.id) AS id, id_text(f.id) AS fault_id, id_text(r.id) AS run_id, u.serial AS unit, o.code,
    f.code_name AS name, o.lru, o.line, r.train, o.step_index, o.message, o.findings, time_text(o.at_us) AS seen_at,
    o.at_us
  FROM fault_occurrence o JOIN fault f ON f.seq = o.fault JOIN run r ON r.seq = o.run
  JOIN unit u ON u.seq = o.unit;

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

CREATE VIEW repairs AS
  SELECT id_text(f.id) AS fault_id, u.serial AS unit, p.code, p.lru, p.line, p.part,
    CASE WHEN e.kind = 'repair' THEN CAST(e.body AS json) ->> 'serial_old' END AS serial_old,
    CASE WHEN e.kind = 'repair' THEN CAST(e.body AS json) ->> 'serial_new' END AS serial_new,
    CASE WHEN e.kind = 'repair' THEN CAST(e.body AS json) ->> 'note' END AS note,
    e.who, time_text(p.opened_at_us) AS opened_at, time_text(p.at_us) AS repaired_at,
    time_text(p.back_at_us) AS back_at,
    CAST(p.at_us - p.opened_at_us AS DOUBLE PRECISION) / 86400e6 AS days_to_repair,
    CAST(p.back_at_us - p.at_us AS DOUBLE PRECISION) / 86400e6 AS days_until_back, p.at_us
  FROM repair p JOIN fault_event e ON e.seq = p.event JOIN fault f ON f.seq = p.fault
  JOIN unit u ON u.seq = p.unit;

CREATE VIEW traces AS
  SELECT id_text(t.id) AS id, id_text(r.id) AS run_id, u.serial AS unit, time_text(t.t0_us) AS began_at,
    t.row_count, CAST(t.period_us AS DOUBLE PRECISION) / 1e3 AS period_ms, length(t.data) AS size_bytes,
    (t.flags / 1) % 2 AS partial, (t.flags / 2) % 2 AS gaps, t.t0_us
  FROM trace t JOIN run r ON r.seq = t.run JOIN unit u ON u.seq = r.unit;

CREATE VIEW units AS
  SELECT u.serial, u.kind, u.config_name, u.sw_versions,
    (SELECT count(*) FROM run r WHERE r.unit = u.seq) AS runs,
    (SELECT count(*) FROM fault f WHERE f.unit = u.seq AND f.state <> 'closed') AS faults_not_closed
  FROM unit u;

CREATE VIEW notes AS
  SELECT id_text(n.id) AS id, id_text(r.id) AS run_id, u.serial AS unit, n.who, n.text,
    id_text(n.trace) AS trace_id, CAST(n.place_us AS DOUBLE PRECISION) / 1e6 AS place_s,
    time_text(n.at_us) AS noted_at, n.at_us
  FROM run_note n JOIN run r ON r.seq = n.run JOIN unit u ON u.seq = r.unit;
