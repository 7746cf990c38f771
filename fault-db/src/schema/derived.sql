-- Fills the derived tables from the others. Unqualified names only: a check fills temporary tables of the same names.
DELETE FROM repair;
INSERT INTO repair(event, fault, unit, code, lru, line, part, at_us, opened_at_us, back_at_us)
  SELECT e.seq, f.seq, f.unit, f.code, f.lru, f.line, part_of(e.body), e.at_us,
    min(e.at_us, coalesce((SELECT max(b.at_us) FROM fault_event b WHERE b.fault = f.seq
      AND b.kind IN ('opened', 'recurred', 'reopened') AND b.at_us <= e.at_us
      AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = b.id)), f.first_at_us)),
    (SELECT min(o.at_us) FROM fault_occurrence o WHERE o.unit = f.unit AND o.code = f.code
      AND o.lru = f.lru AND o.at_us > e.at_us)
  FROM fault_event e JOIN fault f ON f.seq = e.fault WHERE e.kind = 'repair'
    AND NOT EXISTS (SELECT 1 FROM fault_event w WHERE w.kind = 'withdrawn' AND w.follows = e.id);

DELETE FROM measured_day;
INSERT INTO measured_day(name, procedure, day, n, x, xx, least, most, not_passed)
  SELECT m.name, s.procedure, utc_day(r.started_at_us), count(*), sum(m.value), sum(m.value * m.value), min(m.value),
    max(m.value), sum(m.verdict <> 'passed')
  FROM measurement m JOIN run r ON r.seq = m.run
    JOIN step s ON s.run = m.run AND s.step_index = m.step_index
  WHERE m.value IS NOT NULL GROUP BY 1, 2, 3;
DELETE FROM measured_month;
INSERT INTO measured_month(name, procedure, month, unit, n, x, xx, t, tt, tx)
  SELECT name, procedure, month, unit, count(*), sum(x), sum(x * x), sum(t), sum(t * t), sum(t * x)
  FROM (SELECT m.name, s.procedure, utc_month(r.started_at_us) AS month, r.unit, m.value AS x,
      (r.started_at_us - 1577836800000000) / 86400e6 AS t
    FROM measurement m JOIN run r ON r.seq = m.run
      JOIN step s ON s.run = m.run AND s.step_index = m.step_index
    WHERE m.value IS NOT NULL)
  GROUP BY 1, 2, 3, 4;

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
