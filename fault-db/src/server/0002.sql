-- Second version: the account of the laptops adds rows and reads, and nothing else. What follows from rows is
-- kept by functions of the owner (functions.sql). What comes in is held to the domain that a laptop holds it
-- to (fault-db/src/domain.rs): when it comes in, so that a row from before never stands in the way.

ALTER FUNCTION refuse_change() SET search_path FROM CURRENT;
ALTER FUNCTION run_may_end() SET search_path FROM CURRENT;
ALTER FUNCTION occurrence_may_move() SET search_path FROM CURRENT;
ALTER FUNCTION event_may_move() SET search_path FROM CURRENT;

ALTER TABLE fault ALTER COLUMN occurrences SET DEFAULT 0;
ALTER TABLE fault ALTER COLUMN repairs SET DEFAULT 0;

-- Times of a row from before may be any; what asks for a day, a month or a date goes on.
CREATE FUNCTION near(at_us bigint) RETURNS bigint LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN least(greatest(at_us, -62135596800000000), 253402300799999999);
CREATE OR REPLACE FUNCTION utc_month(at_us bigint) RETURNS bigint
  LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE AS $$
  SELECT CAST((extract(year FROM at) - 1970) * 12 + extract(month FROM at) - 1 AS bigint)
  FROM (SELECT timestamp '1970-01-01'
    + least(greatest(at_us, -62135596800000000), 253402300799999999) * interval '1 microsecond' AS at) AS time
$$;
CREATE OR REPLACE FUNCTION time_text(at_us bigint) RETURNS text LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN to_char(to_timestamp(near(at_us) / 1000 / 1000.0) AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS.MS"Z"');
-- And an id of any length.
CREATE OR REPLACE FUNCTION id_text(id bytea) RETURNS text LANGUAGE sql IMMUTABLE STRICT PARALLEL SAFE
  RETURN CASE octet_length(id) WHEN 16 THEN CAST(CAST(encode(id, 'hex') AS uuid) AS text) ELSE encode(id, 'hex') END;

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
      AND is_name(NEW.owner) AND is_name(NEW.train)'],
    ['run_script', 'INSERT', 'is_name(NEW.path) AND is_name(NEW.sha256)'],
    ['step', 'INSERT', 'is_count(NEW.step_index) AND is_name(NEW.procedure) AND is_name(NEW.name)
      AND is_span(NEW.started_bench_us) AND is_span(NEW.bench_time_us) AND is_text(NEW.message)
      AND is_count(NEW.script_line)'],
    ['measurement', 'INSERT', 'is_count(NEW.step_index) AND is_count(NEW.ordinal) AND is_name(NEW.name)
      AND is_finite(NEW.value) AND is_name(NEW.unit) AND is_finite(NEW.low) AND is_finite(NEW.high)'],
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
      AND is_span(NEW.bench_us) AND is_text(NEW.message) AND is_json(NEW.freeze_json) AND is_name(NEW.lru)
      AND is_name(NEW.line)'],
    ['fault_event', 'INSERT', 'is_id(NEW.id) AND is_name(NEW.kind) AND is_time(NEW.at_us)
      AND is_name(NEW.who) AND is_text(NEW.body) AND (NEW.kind <> ''repair'' OR is_json(NEW.body))
      AND is_count(NEW.turn) AND octet_length(NEW.follows) <= 65536 AND octet_length(NEW.follows) % 16 = 0
      AND is_count(NEW.seen) AND is_name(NEW.part)'],
    ['run_note', 'INSERT', 'is_id(NEW.id) AND is_time(NEW.at_us) AND is_name(NEW.who) AND is_text(NEW.text)'],
    ['seal', 'INSERT', 'is_id(NEW.origin) AND is_count(NEW.ordinal) AND is_digest(NEW.digest)
      AND is_digest(NEW.hash)']
  ]
  LOOP
    EXECUTE format('CREATE TRIGGER in_domain BEFORE %s ON %I FOR EACH ROW WHEN (NOT (%s))
      EXECUTE FUNCTION refuse_row()', rule[2], rule[1], rule[3]);
  END LOOP;
END $$;
