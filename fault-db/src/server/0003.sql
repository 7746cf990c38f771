-- All that is said is sealed, not only runs: fault-db/SEALS.md. A file's entries here are what this server has
-- seen of its chain; like all rows they are only ever added.
ALTER TABLE run ADD COLUMN unit_kind text COLLATE "C", ADD COLUMN unit_config_name text COLLATE "C",
  ADD COLUMN sw_versions text COLLATE "C";
ALTER TABLE fault_occurrence ADD COLUMN code_name text COLLATE "C", ADD COLUMN severity text COLLATE "C";
ALTER TABLE seal DISABLE TRIGGER only_added;
ALTER TABLE seal ADD COLUMN what text COLLATE "C", ADD COLUMN id bytea, ADD COLUMN covers bigint,
  ADD COLUMN says text COLLATE "C";
UPDATE seal s SET what = 'run', id = r.id, covers = 1, says = '' FROM run r WHERE r.seq = s.run;
ALTER TABLE seal ENABLE TRIGGER only_added;
ALTER TABLE seal ALTER COLUMN what SET NOT NULL, ALTER COLUMN id SET NOT NULL, ALTER COLUMN covers SET NOT NULL,
  ALTER COLUMN says SET NOT NULL, DROP COLUMN run;
CREATE INDEX seal_by_id ON seal(id, what);

DROP TRIGGER in_domain ON seal;
CREATE TRIGGER in_domain BEFORE INSERT ON seal FOR EACH ROW
  WHEN (NOT (is_id(NEW.origin) AND is_count(NEW.ordinal) AND is_name(NEW.what) AND is_id(NEW.id)
    AND is_count(NEW.covers) AND octet_length(NEW.says) <= 16777216 AND is_digest(NEW.digest)
    AND is_digest(NEW.hash)))
  EXECUTE FUNCTION refuse_row();
CREATE TRIGGER in_domain_of_unit BEFORE INSERT ON run FOR EACH ROW
  WHEN (NOT (is_name(NEW.unit_kind) AND is_name(NEW.unit_config_name) AND is_json(NEW.sw_versions)))
  EXECUTE FUNCTION refuse_row();
CREATE TRIGGER in_domain_of_fault BEFORE INSERT ON fault_occurrence FOR EACH ROW
  WHEN (NOT (is_name(NEW.code_name) AND is_name(NEW.severity)))
  EXECUTE FUNCTION refuse_row();
