-- The part that a fault comes from, as in a file: fault-db/src/schema/0007.sql.
ALTER TABLE fault ADD COLUMN cause text COLLATE "C";

CREATE TRIGGER in_domain_of_cause BEFORE INSERT ON fault_event FOR EACH ROW
  WHEN (NOT (NEW.kind NOT IN ('cause', 'diagnosed') OR is_json(NEW.body)))
  EXECUTE FUNCTION refuse_row();

DROP VIEW faults;
CREATE VIEW faults AS
  SELECT id_text(f.id) AS id, u.serial AS unit, f.code, f.code_name AS name, f.lru,
    coalesce(f.cause, f.lru) AS cause, f.severity, f.state,
    f.line, f.occurrences, f.repairs, time_text(f.first_at_us) AS first_at, time_text(f.last_at_us) AS last_at,
    time_text(f.closed_at_us) AS closed_at, f.first_at_us, f.last_at_us, f.closed_at_us
  FROM fault f JOIN unit u ON u.seq = f.unit;

DROP VIEW events;
CREATE VIEW events AS
  SELECT id_text(e.id) AS id, id_text(f.id) AS fault_id, e.kind, e.who,
    CASE WHEN e.kind = 'repair' THEN CAST(e.body AS json) ->> 'note'
      WHEN e.kind IN ('cause', 'diagnosed')
        THEN trim((CAST(e.body AS json) ->> 'part') || ' ' || (CAST(e.body AS json) ->> 'note'))
      ELSE e.body END AS text,
    e.state, e.turn, time_text(e.at_us) AS happened_at, e.at_us
  FROM fault_event e JOIN fault f ON f.seq = e.fault;
