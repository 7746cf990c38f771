-- Faults, occurrences and repairs packed, anew. Unqualified names only, as in counts.sql.
DELETE FROM packed;
INSERT INTO packed(block, faults, occurrences, repairs)
  SELECT seq >> 5, packed_rows(seq, unit, code, lru, line, severity, state, first_at_us, last_at_us, closed_at_us,
    repairs, cause), (SELECT packed_rows(1) WHERE false), (SELECT packed_rows(1) WHERE false)
  FROM fault GROUP BY 1;
UPDATE packed SET occurrences = known.rows FROM
  (SELECT o.fault >> 5 AS of, packed_rows(o.fault, o.at_us, o.line, s.procedure, o.run) AS rows
   FROM fault_occurrence o LEFT JOIN step s ON s.run = o.run AND s.step_index = o.step_index GROUP BY 1) AS known
  WHERE packed.block = known.of;
UPDATE packed SET repairs = known.rows FROM
  (SELECT fault >> 5 AS of, packed_rows(fault, at_us, opened_at_us, back_at_us) AS rows FROM repair GROUP BY 1) AS known
  WHERE packed.block = known.of;
