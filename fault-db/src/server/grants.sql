-- Who may do what: all that is here belongs to who asks, and the account named in ptu.laptops adds rows, reads
-- and calls the functions that keep what follows. Said again by each `ptu db server init`.
DO $$
DECLARE
  laptops constant text := current_setting('ptu.laptops');
  home constant text := current_schema();
  thing record;
BEGIN
  FOR thing IN
    SELECT CASE c.relkind WHEN 'v' THEN 'VIEW' ELSE 'TABLE' END AS kind, c.oid::regclass AS name FROM pg_class c
    WHERE c.relnamespace = to_regnamespace(quote_ident(home)) AND c.relkind IN ('r', 'p', 'v')
      AND pg_get_userbyid(c.relowner) <> current_user
  LOOP
    EXECUTE format('ALTER %s %s OWNER TO CURRENT_USER', thing.kind, thing.name);
  END LOOP;
  FOR thing IN
    SELECT p.oid::regprocedure AS name FROM pg_proc p
    WHERE p.pronamespace = to_regnamespace(quote_ident(home))
      AND pg_get_userbyid(p.proowner) <> current_user
  LOOP
    EXECUTE format('ALTER FUNCTION %s OWNER TO CURRENT_USER', thing.name);
  END LOOP;

  IF EXISTS (SELECT 1 FROM pg_database WHERE datname = current_database()
      AND pg_get_userbyid(datdba) = laptops) THEN
    EXECUTE format('ALTER DATABASE %I OWNER TO CURRENT_USER', current_database());
  END IF;
  EXECUTE format('REVOKE CREATE, TEMPORARY ON DATABASE %I FROM PUBLIC, %I', current_database(), laptops);
  EXECUTE format('GRANT CONNECT ON DATABASE %I TO %I', current_database(), laptops);
  EXECUTE format('REVOKE CREATE ON SCHEMA %I FROM PUBLIC, %I', home, laptops);
  EXECUTE format('GRANT USAGE ON SCHEMA %I TO %I', home, laptops);
  EXECUTE format('REVOKE ALL ON ALL TABLES IN SCHEMA %I FROM PUBLIC, %I', home, laptops);
  EXECUTE format('REVOKE ALL ON ALL SEQUENCES IN SCHEMA %I FROM PUBLIC, %I', home, laptops);
  EXECUTE format('GRANT SELECT ON ALL TABLES IN SCHEMA %I TO %I', home, laptops);
  -- Neither the numbers of rows nor what follows from other rows is for a laptop to say.
  FOR thing IN
    SELECT c.oid::regclass AS name, string_agg(quote_ident(a.attname), ', ') AS columns
    FROM pg_class c JOIN pg_attribute a ON a.attrelid = c.oid AND a.attnum > 0 AND NOT a.attisdropped
    WHERE c.relnamespace = to_regnamespace(quote_ident(home)) AND c.relkind = 'r'
      AND c.relname IN ('unit', 'run', 'run_script', 'step', 'measurement', 'fault', 'fault_alias',
        'laptop_fault', 'channel_set', 'recording', 'trace', 'fault_occurrence', 'fault_event', 'run_note',
        'seal')
      AND (c.relname, a.attname) NOT IN (('unit', 'seq'), ('run', 'seq'), ('fault', 'seq'),
        ('fault', 'occurrences'), ('fault', 'closed_at_us'), ('fault', 'repairs'), ('fault', 'disputed'),
        ('fault', 'cause'), ('channel_set', 'seq'), ('trace', 'seq'), ('fault_occurrence', 'seq'), ('fault_occurrence', 'trace'),
        ('fault_event', 'seq'), ('run_note', 'seq'))
    GROUP BY c.oid
  LOOP
    EXECUTE format('GRANT INSERT (%s) ON %s TO %I', thing.columns, thing.name, laptops);
  END LOOP;
  FOR thing IN
    SELECT p.oid::regprocedure AS name FROM pg_proc p
    WHERE p.pronamespace = to_regnamespace(quote_ident(home)) AND p.prosecdef
  LOOP
    EXECUTE format('REVOKE ALL ON FUNCTION %s FROM PUBLIC', thing.name);
    EXECUTE format('GRANT EXECUTE ON FUNCTION %s TO %I', thing.name, laptops);
  END LOOP;
END $$;
