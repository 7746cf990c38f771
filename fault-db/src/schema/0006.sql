-- Sixth schema: faults with their occurrences and repairs packed by column, for counts with any filter. A row holds
-- the 32 faults whose seq / 32 it names. It follows from other rows: triggers empty it when one of them changes, whoever
-- changes it. The end of a run and of an import fills what is empty if it is more than a few rows; a reader packs what
-- is empty itself.
CREATE TABLE packed(
  block INTEGER PRIMARY KEY,
  faults BLOB,                          -- NULL: empty, as are the other two
  occurrences BLOB,
  repairs BLOB
) STRICT;
CREATE INDEX packed_empty ON packed(block) WHERE faults IS NULL;

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
