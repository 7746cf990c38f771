-- Second schema: what stimuli a fault's trace came from, and fault dictionaries.

-- What was done to the bench in one procedure of a run, kept when the procedure found a fault: enough
-- to do it again. Only ever added.
CREATE TABLE recording(
  run INTEGER NOT NULL REFERENCES run(seq),
  ordinal INTEGER NOT NULL,             -- place of the procedure in the run
  procedure TEXT NOT NULL,
  t0_bench_us INTEGER NOT NULL,         -- bench time of the run at which the bench's clock was 0
  bench_json TEXT NOT NULL,             -- what the bench was made of
  stimuli BLOB NOT NULL,                -- zstd of json: what was done, each with its time on the bench's clock
  PRIMARY KEY(run, ordinal)
) STRICT, WITHOUT ROWID;

-- The recording a trace was cut from, by its ordinal in the same run; NULL: none was kept.
ALTER TABLE trace ADD COLUMN recording INTEGER;

CREATE TABLE dictionary(
  seq INTEGER PRIMARY KEY,
  id BLOB NOT NULL UNIQUE,
  made_at_us INTEGER NOT NULL,
  app_version TEXT NOT NULL,
  basis_sha256 TEXT NOT NULL,           -- over scripts, unit configuration, line, train and fault catalogue
  modes INTEGER NOT NULL,               -- fault modes it knows
  data BLOB NOT NULL                    -- zstd of json
) STRICT;
CREATE INDEX dictionary_by_time ON dictionary(made_at_us);
