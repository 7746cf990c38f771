-- Keep the derived tables, in whatever order rows come and whoever adds them.

-- Repairs: when the fault was opened before, and when it was seen again after.
CREATE TRIGGER event_repair AFTER INSERT ON fault_event WHEN NEW.kind = 'repair' BEGIN
  INSERT INTO repair(event, fault, unit, code, lru, line, part, at_us, opened_at_us, back_at_us)
    SELECT NEW.seq, f.seq, f.unit, f.code, f.lru, f.line,
      part_of(NEW.body), NEW.at_us,
      min(NEW.at_us, coalesce((SELECT max(e.at_us) FROM fault_event e WHERE e.fault = f.seq
        AND e.kind IN ('opened', 'recurred', 'reopened') AND e.at_us <= NEW.at_us
        AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = e.id)), f.first_at_us)),
      (SELECT min(o.at_us) FROM fault_occurrence o WHERE o.unit = f.unit AND o.code = f.code
        AND o.lru = f.lru AND o.at_us > NEW.at_us)
    FROM fault f WHERE f.seq = NEW.fault
      AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = NEW.id);
  UPDATE fault SET repairs = (SELECT count(*) FROM fault_event e WHERE e.fault = NEW.fault AND e.kind = 'repair'
      AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = e.id))
    WHERE seq = NEW.fault;
END;
CREATE TRIGGER event_opened AFTER INSERT ON fault_event
WHEN NEW.kind IN ('opened', 'recurred', 'reopened', 'withdrawn') BEGIN
  UPDATE repair SET opened_at_us = min(repair.at_us, coalesce((SELECT max(e.at_us) FROM fault_event e
      WHERE e.fault = NEW.fault AND e.kind IN ('opened', 'recurred', 'reopened') AND e.at_us <= repair.at_us
        AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = e.id)),
      (SELECT first_at_us FROM fault WHERE seq = NEW.fault)))
    WHERE (unit, code, lru) = (SELECT unit, code, lru FROM fault WHERE seq = NEW.fault)
      AND (NEW.kind = 'withdrawn' OR at_us >= NEW.at_us) AND fault = NEW.fault;
END;
CREATE TRIGGER event_withdrawn AFTER INSERT ON fault_event WHEN NEW.kind = 'withdrawn' BEGIN
  DELETE FROM repair WHERE event = (SELECT seq FROM fault_event WHERE id = NEW.follows);
END;
CREATE TRIGGER occurrence_seen AFTER INSERT ON fault_occurrence BEGIN
  UPDATE repair SET back_at_us = NEW.at_us
    WHERE unit = NEW.unit AND code = NEW.code AND lru = NEW.lru AND at_us < NEW.at_us
      AND (back_at_us IS NULL OR back_at_us > NEW.at_us);
END;
CREATE TRIGGER fault_opened_earlier AFTER UPDATE OF first_at_us, line ON fault
WHEN NEW.first_at_us <> OLD.first_at_us OR NEW.line <> OLD.line BEGIN
  UPDATE repair SET line = NEW.line, opened_at_us = min(repair.at_us, coalesce(
      (SELECT max(e.at_us) FROM fault_event e WHERE e.fault = NEW.seq
        AND e.kind IN ('opened', 'recurred', 'reopened') AND e.at_us <= repair.at_us
        AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = e.id)), NEW.first_at_us))
    WHERE unit = NEW.unit AND code = NEW.code AND lru = NEW.lru AND fault = NEW.seq;
END;

-- Packed faults are emptied when a row that they follow from changes, whoever changes it.
CREATE TRIGGER fault_unpacked_new AFTER INSERT ON fault BEGIN
  INSERT INTO packed(block) VALUES (NEW.seq >> 5)
    ON CONFLICT DO UPDATE SET faults = NULL, occurrences = NULL, repairs = NULL WHERE faults IS NOT NULL;
END;
CREATE TRIGGER fault_unpacked AFTER UPDATE ON fault BEGIN
  UPDATE packed SET faults = NULL, occurrences = NULL, repairs = NULL WHERE block = NEW.seq >> 5 AND faults IS NOT NULL;
END;
CREATE TRIGGER fault_unpacked_gone AFTER DELETE ON fault BEGIN
  UPDATE packed SET faults = NULL, occurrences = NULL, repairs = NULL WHERE block = OLD.seq >> 5 AND faults IS NOT NULL;
END;
CREATE TRIGGER occurrence_unpacked_new AFTER INSERT ON fault_occurrence BEGIN
  UPDATE packed SET faults = NULL, occurrences = NULL, repairs = NULL WHERE block = NEW.fault >> 5 AND faults IS NOT NULL;
END;
CREATE TRIGGER occurrence_unpacked AFTER UPDATE OF fault, run, step_index, at_us, line ON fault_occurrence BEGIN
  UPDATE packed SET faults = NULL, occurrences = NULL, repairs = NULL
    WHERE block IN (OLD.fault >> 5, NEW.fault >> 5) AND faults IS NOT NULL;
END;
CREATE TRIGGER step_unpacked AFTER INSERT ON step BEGIN
  UPDATE packed SET faults = NULL, occurrences = NULL, repairs = NULL
    WHERE block IN (SELECT o.fault >> 5 FROM fault_occurrence o WHERE o.run = NEW.run AND o.step_index = NEW.step_index)
      AND faults IS NOT NULL;
END;
CREATE TRIGGER repair_unpacked_new AFTER INSERT ON repair BEGIN
  UPDATE packed SET faults = NULL, occurrences = NULL, repairs = NULL WHERE block = NEW.fault >> 5 AND faults IS NOT NULL;
END;
CREATE TRIGGER repair_unpacked AFTER UPDATE ON repair BEGIN
  UPDATE packed SET faults = NULL, occurrences = NULL, repairs = NULL
    WHERE block IN (OLD.fault >> 5, NEW.fault >> 5) AND faults IS NOT NULL;
END;

-- Sums of measured values.
CREATE TRIGGER value_measured AFTER INSERT ON measurement WHEN NEW.value IS NOT NULL BEGIN
  INSERT INTO measured_day(name, procedure, day, n, x, xx, least, most, not_passed)
    SELECT NEW.name, s.procedure, utc_day(r.started_at_us), 1, NEW.value, NEW.value * NEW.value, NEW.value, NEW.value,
      NEW.verdict <> 'passed'
    FROM run r, step s WHERE r.seq = NEW.run AND s.run = NEW.run AND s.step_index = NEW.step_index
    ON CONFLICT DO UPDATE SET n = n + 1, x = x + excluded.x, xx = xx + excluded.xx,
      least = min(least, excluded.least), most = max(most, excluded.most),
      not_passed = not_passed + excluded.not_passed;
  INSERT INTO measured_month(name, procedure, month, unit, n, x, xx, t, tt, tx)
    SELECT NEW.name, s.procedure, utc_month(r.started_at_us), r.unit, 1, NEW.value, NEW.value * NEW.value,
      t, t * t, t * NEW.value
    FROM (SELECT seq, unit, started_at_us, (started_at_us - 1577836800000000) / 86400e6 AS t FROM run) r,
      step s
    WHERE r.seq = NEW.run AND s.run = NEW.run AND s.step_index = NEW.step_index
    ON CONFLICT DO UPDATE SET n = n + 1, x = x + excluded.x, xx = xx + excluded.xx,
      t = t + excluded.t, tt = tt + excluded.tt, tx = tx + excluded.tx;
END;

-- Words of notes.
CREATE TRIGGER event_said AFTER INSERT ON fault_event
WHEN NEW.kind NOT IN ('opened', 'recurred') AND NEW.body <> '' BEGIN
  INSERT INTO event_words(rowid, words) VALUES (NEW.seq, search_words(NEW.body));
END;
CREATE TRIGGER run_noted AFTER INSERT ON run_note BEGIN
  INSERT INTO note_words(rowid, words) VALUES (NEW.seq, search_words(NEW.text));
END;

-- What a server does not have yet.
CREATE TRIGGER run_ended AFTER UPDATE OF verdict ON run
WHEN OLD.verdict IS NULL AND NEW.verdict IS NOT NULL BEGIN
  INSERT INTO outbox(what, row) VALUES ('run', NEW.seq);
  INSERT INTO outbox(what, row) SELECT 'trace', t.seq FROM trace t WHERE t.run = NEW.seq ORDER BY t.seq;
END;
CREATE TRIGGER run_came AFTER INSERT ON run WHEN NEW.verdict IS NOT NULL BEGIN
  INSERT INTO outbox(what, row) VALUES ('run', NEW.seq);
END;
CREATE TRIGGER trace_came AFTER INSERT ON trace
WHEN (SELECT verdict FROM run WHERE seq = NEW.run) IS NOT NULL BEGIN
  INSERT INTO outbox(what, row) VALUES ('trace', NEW.seq);
END;
CREATE TRIGGER event_came AFTER INSERT ON fault_event BEGIN
  INSERT INTO outbox(what, row) VALUES ('event', NEW.seq);
END;
CREATE TRIGGER note_came AFTER INSERT ON run_note BEGIN
  INSERT INTO outbox(what, row) VALUES ('note', NEW.seq);
END;
