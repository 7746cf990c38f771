-- Seventh schema: the part that a fault comes from. It follows from the fault's events of the kinds `cause` (a
-- person's) and `diagnosed` (a run's): fault-db/src/event_graph.rs.
ALTER TABLE fault ADD COLUMN cause TEXT;  -- NULL: nobody has attributed it; then it counts for its own part

DROP VIEW faults;
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
    e.state, e.turn,
    strftime('%Y-%m-%dT%H:%M:%fZ', e.at_us / 1000 / 1000.0, 'unixepoch') AS happened_at, e.at_us
  FROM fault_event e JOIN fault f ON f.seq = e.fault;
