-- Third schema: what the tester has to say about a run. Only ever added.
CREATE TABLE run_note(
  seq INTEGER PRIMARY KEY,
  id BLOB NOT NULL UNIQUE,
  run INTEGER NOT NULL REFERENCES run(seq),
  at_us INTEGER NOT NULL,
  who TEXT NOT NULL,
  text TEXT NOT NULL
) STRICT;
CREATE INDEX run_note_by_run ON run_note(run, at_us);
