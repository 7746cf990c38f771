-- What may be written. Rows are only ever added, with the exceptions named here, and each is held to the domain that a
-- laptop holds it to (fault-db/src/exchange/domain.rs) when it comes in.
CREATE FUNCTION refuse_change() RETURNS trigger LANGUAGE plpgsql SET search_path FROM CURRENT AS $$
BEGIN
  RAISE EXCEPTION 'rows of % are only ever added', TG_TABLE_NAME USING ERRCODE = 'restrict_violation';
END $$;

-- A run that had no verdict may get one, once: its program was only thought dead.
CREATE FUNCTION run_may_end() RETURNS trigger LANGUAGE plpgsql SET search_path FROM CURRENT AS $$
DECLARE
  ends constant text[] := ARRAY['verdict', 'finished_at_us', 'bench_time_us', 'wall_time_us'];
BEGIN
  IF OLD.verdict IS NULL AND to_jsonb(OLD) - ends = to_jsonb(NEW) - ends THEN
    RETURN NEW;
  END IF;
  RAISE EXCEPTION 'rows of run are only ever added' USING ERRCODE = 'restrict_violation';
END $$;

-- A trace comes after the occurrence it shows, and is hung on it once. Two faults may turn out to be one.
CREATE FUNCTION occurrence_may_move() RETURNS trigger LANGUAGE plpgsql SET search_path FROM CURRENT AS $$
DECLARE
  pointers constant text[] := ARRAY['trace', 'fault'];
BEGIN
  IF to_jsonb(OLD) - pointers = to_jsonb(NEW) - pointers
    AND (OLD.trace IS NULL OR OLD.trace IS NOT DISTINCT FROM NEW.trace) THEN
    RETURN NEW;
  END IF;
  RAISE EXCEPTION 'rows of fault_occurrence are only ever added' USING ERRCODE = 'restrict_violation';
END $$;

CREATE FUNCTION event_may_move() RETURNS trigger LANGUAGE plpgsql SET search_path FROM CURRENT AS $$
BEGIN
  IF to_jsonb(OLD) - 'fault' = to_jsonb(NEW) - 'fault' THEN
    RETURN NEW;
  END IF;
  RAISE EXCEPTION 'rows of fault_event are only ever added' USING ERRCODE = 'restrict_violation';
END $$;

CREATE TRIGGER only_added BEFORE UPDATE ON run FOR EACH ROW EXECUTE FUNCTION run_may_end();
CREATE TRIGGER only_added BEFORE UPDATE ON fault_occurrence
  FOR EACH ROW EXECUTE FUNCTION occurrence_may_move();
CREATE TRIGGER only_added BEFORE UPDATE ON fault_event
  FOR EACH ROW EXECUTE FUNCTION event_may_move();
DO $$
DECLARE
  name text;
BEGIN
  FOREACH name IN ARRAY ARRAY['run_script', 'step', 'measurement', 'recording', 'channel_set', 'trace',
    'run_note', 'seal']
  LOOP
    EXECUTE format('CREATE TRIGGER only_added BEFORE UPDATE ON %I
      FOR EACH ROW EXECUTE FUNCTION refuse_change()', name);
  END LOOP;
  FOREACH name IN ARRAY ARRAY['run', 'fault_occurrence', 'run_script', 'step', 'measurement',
    'recording', 'channel_set', 'trace', 'fault_event', 'run_note', 'seal', 'unit']
  LOOP
    EXECUTE format('CREATE TRIGGER only_added_1 BEFORE DELETE ON %I
      FOR EACH ROW EXECUTE FUNCTION refuse_change()', name);
    EXECUTE format('CREATE TRIGGER only_added_2 BEFORE TRUNCATE ON %I
      FOR EACH STATEMENT EXECUTE FUNCTION refuse_change()', name);
  END LOOP;
END $$;

---- the domain ----

CREATE FUNCTION is_id(id bytea) RETURNS boolean LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN octet_length(id) = 16;
CREATE FUNCTION is_digest(digest bytea) RETURNS boolean LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN octet_length(digest) = 32;
CREATE FUNCTION is_time(at_us bigint) RETURNS boolean LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN at_us BETWEEN 0 AND 7258118400000000;
CREATE FUNCTION is_span(us bigint) RETURNS boolean LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN us BETWEEN -1577880000000000 AND 1577880000000000;
CREATE FUNCTION is_count(n bigint) RETURNS boolean LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN n BETWEEN 0 AND 4294967295;
CREATE FUNCTION is_finite(x double precision) RETURNS boolean LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN abs(x) < 'Infinity';
CREATE FUNCTION is_name(name text) RETURNS boolean LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN octet_length(name) <= 65536;
CREATE FUNCTION is_text(said text) RETURNS boolean LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN octet_length(said) <= 1048576;
CREATE FUNCTION is_json(said text) RETURNS boolean LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN octet_length(said) <= 16777216 AND CAST(said AS json) IS NOT NULL;
CREATE FUNCTION is_packed(data bytea) RETURNS boolean LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN octet_length(data) <= 50331648;

CREATE FUNCTION refuse_row() RETURNS trigger LANGUAGE plpgsql SET search_path FROM CURRENT AS $$
BEGIN
  RAISE EXCEPTION 'a row of % holds what none can hold', TG_TABLE_NAME
    USING ERRCODE = 'check_violation', DETAIL = left(CAST(to_jsonb(NEW) AS text), 300);
END $$;

DO $$
DECLARE
  rule text[];
BEGIN
  FOREACH rule SLICE 1 IN ARRAY ARRAY[
    ['laptop', 'INSERT OR UPDATE', 'is_id(NEW.file_id) AND is_name(NEW.name)
      AND abs(NEW.clock_offset_us) <= 7258118400000000'],
    ['unit', 'INSERT', 'is_name(NEW.serial) AND is_name(NEW.kind) AND is_name(NEW.config_name)
      AND is_json(NEW.sw_versions)'],
    ['run', 'INSERT', 'is_id(NEW.id) AND is_name(NEW.line) AND is_name(NEW.operator)
      AND is_name(NEW.source) AND is_time(NEW.started_at_us) AND is_time(NEW.finished_at_us)
      AND is_span(NEW.bench_time_us) AND is_span(NEW.wall_time_us) AND is_name(NEW.app_version)
      AND is_name(NEW.scripts_sha256) AND is_name(NEW.unit_config_sha256) AND is_text(NEW.injected)
      AND is_name(NEW.owner) AND is_name(NEW.train) AND is_name(NEW.unit_kind) AND is_name(NEW.unit_config_name)
      AND is_json(NEW.sw_versions) AND is_json(NEW.evidence) AND is_id(NEW.continues) AND is_name(NEW.connection) AND is_name(NEW.symptom)'],
    ['run_script', 'INSERT', 'is_name(NEW.path) AND is_name(NEW.sha256)'],
    ['step', 'INSERT', 'is_count(NEW.step_index) AND is_name(NEW.procedure) AND is_count(NEW.place) AND is_name(NEW.name)
      AND is_count(NEW.turn) AND is_count(NEW.turns)
      AND is_span(NEW.started_bench_us) AND is_span(NEW.bench_time_us) AND is_text(NEW.message) AND is_json(NEW.findings)
      AND is_count(NEW.script_line) AND is_text(NEW.limit_source)'],
    ['measurement', 'INSERT', 'is_count(NEW.step_index) AND is_count(NEW.ordinal) AND is_name(NEW.name)
      AND is_finite(NEW.value) AND is_name(NEW.unit) AND is_finite(NEW.low) AND is_finite(NEW.high)
      AND is_text(NEW.limit_source)'],
    ['fault', 'INSERT', 'is_id(NEW.id) AND is_name(NEW.code_name) AND is_name(NEW.lru)
      AND is_name(NEW.severity) AND is_time(NEW.first_at_us) AND is_time(NEW.last_at_us)
      AND is_name(NEW.line)'],
    ['fault_alias', 'INSERT', 'is_id(NEW.id)'],
    ['laptop_fault', 'INSERT', 'is_id(NEW.id)'],
    ['channel_set', 'INSERT', 'is_digest(NEW.sha256) AND is_json(NEW.json)'],
    ['recording', 'INSERT', 'is_count(NEW.ordinal) AND is_name(NEW.procedure) AND is_span(NEW.t0_bench_us)
      AND is_json(NEW.bench_json) AND is_packed(NEW.stimuli)'],
    ['trace', 'INSERT', 'is_id(NEW.id) AND is_span(NEW.t0_bench_us) AND is_time(NEW.t0_us)
      AND NEW.period_us BETWEEN 0 AND 86400000000 AND is_count(NEW.row_count) AND is_count(NEW.trigger_row)
      AND is_count(NEW.flags) AND is_count(NEW.encoding) AND is_digest(NEW.sha256) AND is_packed(NEW.data)
      AND is_count(NEW.recording)'],
    ['fault_occurrence', 'INSERT', 'is_id(NEW.id) AND is_count(NEW.step_index) AND is_time(NEW.at_us)
      AND is_span(NEW.bench_us) AND is_text(NEW.message) AND is_json(NEW.findings) AND is_json(NEW.freeze_json) AND is_name(NEW.lru)
      AND is_name(NEW.line) AND is_name(NEW.code_name) AND is_name(NEW.severity)'],
    ['fault_event', 'INSERT', 'is_id(NEW.id) AND is_name(NEW.kind) AND is_time(NEW.at_us)
      AND is_name(NEW.who) AND is_text(NEW.body) AND (NEW.kind NOT IN (''repair'', ''cause'', ''diagnosed'') OR is_json(NEW.body))
      AND is_count(NEW.turn) AND octet_length(NEW.follows) <= 65536 AND octet_length(NEW.follows) % 16 = 0
      AND is_count(NEW.seen) AND is_name(NEW.part)
      AND (NEW.kind <> ''withdrawn'' OR is_id(NEW.follows) AND NEW.state IS NULL)'],
    ['run_note', 'INSERT', 'is_id(NEW.id) AND is_time(NEW.at_us) AND is_name(NEW.who) AND is_id(NEW.trace)
      AND is_span(NEW.place_us) AND is_text(NEW.text)'],
    ['seal', 'INSERT', 'is_id(NEW.origin) AND is_count(NEW.ordinal) AND is_name(NEW.what) AND is_id(NEW.id)
      AND octet_length(NEW.says) <= 16777216 AND is_digest(NEW.digest) AND is_digest(NEW.hash)']
  ]
  LOOP
    EXECUTE format('CREATE TRIGGER in_domain BEFORE %s ON %I FOR EACH ROW WHEN (NOT (%s))
      EXECUTE FUNCTION refuse_row()', rule[2], rule[1], rule[3]);
  END LOOP;
END $$;
