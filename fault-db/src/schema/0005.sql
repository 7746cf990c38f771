-- Fifth schema: what a run was told of its unit and its faults stays with the run.

-- The unit as the run found it; NULL of runs of earlier versions.
ALTER TABLE run ADD COLUMN unit_kind TEXT;
ALTER TABLE run ADD COLUMN unit_config_name TEXT;
ALTER TABLE run ADD COLUMN sw_versions TEXT;

-- The fault's name and severity as it was seen then; NULL of occurrences of earlier versions.
ALTER TABLE fault_occurrence ADD COLUMN code_name TEXT;
ALTER TABLE fault_occurrence ADD COLUMN severity TEXT;
