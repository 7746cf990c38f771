-- What `ptu db query` is asked about: fault-db/VIEWS.md says what each column means. Ids are text as they are
-- printed, times are UTC text, and beside each the number of microseconds by which an index finds it.

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

CREATE VIEW steps AS
  SELECT
    lower(hex(substr(r.id, 1, 4)) || '-' || hex(substr(r.id, 5, 2)) || '-' || hex(substr(r.id, 7, 2)) || '-'
      || hex(substr(r.id, 9, 2)) || '-' || hex(substr(r.id, 11))) AS run_id,
    u.serial AS unit, s.step_index, s.procedure, s.kind, s.name, s.turn, s.turns, s.verdict,
    s.message, s.findings, CAST(s.bench_time_us AS DOUBLE PRECISION) / 1e6 AS bench_time_s, s.script_line, s.limit_source,
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

CREATE VIEW faults AS
  SELECT
    lower(hex(substr(f.id, 1, 4)) || '-' || hex(substr(f.id, 5, 2)) || '-' || hex(substr(f.id, 7, 2)) || '-'
      || hex(substr(f.id, 9, 2)) || '-' || hex(substr(f.id, 11))) AS id,
    u.serial AS unit, f.code, f.code_name AS name, f.lru, coalesce(f.cause, f.lru) AS cause, f.severity, f.state,
    f.line, f.occurrences, f.repairs,
    strftime('%Y-%m-%dT%H:%M:%fZ', f.first_at_us / 1000 / 1000.0, 'unixepoch') AS first_at,
    strftime('%Y-%m-%dT%H:%M:%fZ', f.last_at_us / 1000 / 1000.0, 'unixepoch') AS last_at,
    strftime('%Y-%m-%dT%H:%M:%fZ', f.closed_at_us / 1000 / 1000.0, 'unixepoch') AS closed_at, f.first_at_us,
    f.last_at_us, f.closed_at_us
  FROM fault f JOIN unit u ON u.seq = f.unit;

CREATE VIEW occurrences AS
  SELECT
    lower(hex(substr(o.id, 1, 4)) || '-' || hex(substr(o.id, 5, 2)) || '-' || hex(substr(o.id, 7, 2)) || '-'
      || hex(substr(o.id, 9, 2)) || '-' || hex(substr(o.id, 11))) AS id,
    lower(hex(substr(f.id, 1, 4)) || '-' || hex(substr(f.id, 5, 2)) || '-' || hex(substr(f.id, 7, 2)) || '-'
      || hex(substr(f.id, 9, 2)) || '-' || hex(substr(f.id, 11))) AS fault_id,
    lower(hex(substr(r.id, 1, 4)) || '-' || hex(substr(r.id, 5, 2)) || '-' || hex(substr(r.id, 7, 2)) || '-'
      || hex(substr(r.id, 9, 2)) || '-' || hex(substr(r.id, 11))) AS run_id,
    u.serial AS unit, o.code,
    f.code_name AS name, o.lru, o.line, r.train, o.step_index, o.message, o.findings,
    strftime('%Y-%m-%dT%H:%M:%fZ', o.at_us / 1000 / 1000.0, 'unixepoch') AS seen_at,
    o.at_us
  FROM fault_occurrence o JOIN fault f ON f.seq = o.fault JOIN run r ON r.seq = o.run
  JOIN unit u ON u.seq = o.unit;

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

CREATE VIEW repairs AS
  SELECT
    lower(hex(substr(f.id, 1, 4)) || '-' || hex(substr(f.id, 5, 2)) || '-' || hex(substr(f.id, 7, 2)) || '-'
      || hex(substr(f.id, 9, 2)) || '-' || hex(substr(f.id, 11))) AS fault_id,
    u.serial AS unit, p.code, p.lru, p.line, p.part,
    CASE WHEN e.kind = 'repair' THEN json_extract(e.body, '$.serial_old') END AS serial_old,
    CASE WHEN e.kind = 'repair' THEN json_extract(e.body, '$.serial_new') END AS serial_new,
    CASE WHEN e.kind = 'repair' THEN json_extract(e.body, '$.note') END AS note,
    e.who, strftime('%Y-%m-%dT%H:%M:%fZ', p.opened_at_us / 1000 / 1000.0, 'unixepoch') AS opened_at,
    strftime('%Y-%m-%dT%H:%M:%fZ', p.at_us / 1000 / 1000.0, 'unixepoch') AS repaired_at,
    strftime('%Y-%m-%dT%H:%M:%fZ', p.back_at_us / 1000 / 1000.0, 'unixepoch') AS back_at,
    CAST(p.at_us - p.opened_at_us AS DOUBLE PRECISION) / 86400e6 AS days_to_repair,
    CAST(p.back_at_us - p.at_us AS DOUBLE PRECISION) / 86400e6 AS days_until_back, p.at_us
  FROM repair p JOIN fault_event e ON e.seq = p.event JOIN fault f ON f.seq = p.fault
  JOIN unit u ON u.seq = p.unit;

CREATE VIEW traces AS
  SELECT
    lower(hex(substr(t.id, 1, 4)) || '-' || hex(substr(t.id, 5, 2)) || '-' || hex(substr(t.id, 7, 2)) || '-'
      || hex(substr(t.id, 9, 2)) || '-' || hex(substr(t.id, 11))) AS id,
    lower(hex(substr(r.id, 1, 4)) || '-' || hex(substr(r.id, 5, 2)) || '-' || hex(substr(r.id, 7, 2)) || '-'
      || hex(substr(r.id, 9, 2)) || '-' || hex(substr(r.id, 11))) AS run_id,
    u.serial AS unit,
    strftime('%Y-%m-%dT%H:%M:%fZ', t.t0_us / 1000 / 1000.0, 'unixepoch') AS began_at,
    t.row_count, CAST(t.period_us AS DOUBLE PRECISION) / 1e3 AS period_ms, length(t.data) AS size_bytes,
    (t.flags / 1) % 2 AS partial, (t.flags / 2) % 2 AS gaps, t.t0_us
  FROM trace t JOIN run r ON r.seq = t.run JOIN unit u ON u.seq = r.unit;

CREATE VIEW units AS
  SELECT u.serial, u.kind, u.config_name, u.sw_versions,
    (SELECT count(*) FROM run r WHERE r.unit = u.seq) AS runs,
    (SELECT count(*) FROM fault f WHERE f.unit = u.seq AND f.state <> 'closed') AS faults_not_closed
  FROM unit u;

CREATE VIEW notes AS
  SELECT
    lower(hex(substr(n.id, 1, 4)) || '-' || hex(substr(n.id, 5, 2)) || '-' || hex(substr(n.id, 7, 2)) || '-'
      || hex(substr(n.id, 9, 2)) || '-' || hex(substr(n.id, 11))) AS id,
    lower(hex(substr(r.id, 1, 4)) || '-' || hex(substr(r.id, 5, 2)) || '-' || hex(substr(r.id, 7, 2)) || '-'
      || hex(substr(r.id, 9, 2)) || '-' || hex(substr(r.id, 11))) AS run_id,
    u.serial AS unit, n.who, n.text,
    CASE WHEN n.trace IS NOT NULL THEN
      lower(hex(substr(n.trace, 1, 4)) || '-' || hex(substr(n.trace, 5, 2)) || '-' || hex(substr(n.trace, 7, 2)) || '-'
      || hex(substr(n.trace, 9, 2)) || '-' || hex(substr(n.trace, 11))) END AS trace_id,
    CAST(n.place_us AS DOUBLE PRECISION) / 1e6 AS place_s,
    strftime('%Y-%m-%dT%H:%M:%fZ', n.at_us / 1000 / 1000.0, 'unixepoch') AS noted_at, n.at_us
  FROM run_note n JOIN run r ON r.seq = n.run JOIN unit u ON u.seq = r.unit;
