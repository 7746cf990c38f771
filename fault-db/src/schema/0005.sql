-- Fifth schema: all that is said is sealed. What a run was told of its unit and its faults stays with the
-- run, and the chain of runs becomes one of everything that happened in a file: fault-db/SEALS.md.

-- The unit as the run found it; NULL of runs of earlier versions.
ALTER TABLE run ADD COLUMN unit_kind TEXT;
ALTER TABLE run ADD COLUMN unit_config_name TEXT;
ALTER TABLE run ADD COLUMN sw_versions TEXT;

-- The fault's name and severity as it was seen then; NULL of occurrences of earlier versions.
ALTER TABLE fault_occurrence ADD COLUMN code_name TEXT;
ALTER TABLE fault_occurrence ADD COLUMN severity TEXT;

-- One chain of entries per file that seals: each entry with the one before it. Entries are only ever added.
CREATE TABLE seals(
  origin BLOB NOT NULL,                 -- file_id of the file that sealed
  ordinal INTEGER NOT NULL,             -- 1, 2, 3 …
  what TEXT NOT NULL,                   -- run, event, note, pruned, begun, recounted, copied
  id BLOB NOT NULL,                     -- of the run, event, note or trace; of the file for what concerns it
  covers INTEGER NOT NULL,              -- how much the digest covers: 1 as before the fifth schema, 2 all
  says TEXT NOT NULL,                   -- json: what no other row says
  digest BLOB NOT NULL,                 -- SHA-256 of all that is sealed
  hash BLOB NOT NULL,                   -- SHA-256 of the hash before and the digest
  PRIMARY KEY(origin, ordinal)
) STRICT, WITHOUT ROWID;
INSERT INTO seals SELECT s.origin, s.ordinal, 'run', r.id, 1, '', s.digest, s.hash
  FROM seal s JOIN run r ON r.seq = s.run;
DROP TABLE seal;
ALTER TABLE seals RENAME TO seal;
CREATE INDEX seal_by_id ON seal(id, what);
