-- Counts, repairs and sums, anew. Unqualified names only: a check makes them in temporary tables.
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

DELETE FROM tally;
WITH counted(unit, code, lru, line, at_us, seen, opened, closed, bare, repairs, repair_us, back) AS (
  SELECT unit, code, lru, line, at_us, 1, 0, 0, 0, 0, 0, 0 FROM fault_occurrence
  UNION ALL SELECT unit, code, lru, line, first_at_us, 0, 1, 0, 0, 0, 0, 0 FROM fault
  UNION ALL SELECT unit, code, lru, line, closed_at_us, 0, 0, 1, repairs = 0, 0, 0, 0 FROM fault
    WHERE closed_at_us IS NOT NULL
  UNION ALL SELECT unit, code, lru, line, at_us, 0, 0, 0, 0, 1, at_us - opened_at_us,
    coalesce(back_at_us - at_us < 2592000000000, 0) FROM repair
), daily AS (
  SELECT unit, code, lru, line, utc_day(at_us) AS day, utc_month(at_us) AS month, sum(seen) AS seen,
    sum(opened) AS opened, sum(closed) AS closed, sum(bare) AS bare, sum(repairs) AS repairs,
    sum(repair_us) AS repair_us, sum(back) AS back
  FROM counted GROUP BY 1, 2, 3, 4, 5, 6
)
INSERT INTO tally(dim, grain, at, key, seen, opened, closed, bare, repairs, repair_us, back, units)
  SELECT dim, grain,
    CASE grain WHEN 0 THEN month ELSE day END,
    CASE dim WHEN 0 THEN '' WHEN 1 THEN code WHEN 2 THEN lru WHEN 3 THEN unit ELSE line END,
    sum(seen), sum(opened), sum(closed), sum(bare), sum(repairs), sum(repair_us), sum(back),
    unit_set(CASE WHEN seen > 0 THEN unit END)
  FROM daily,
    (SELECT 0 AS dim UNION ALL SELECT 1 UNION ALL SELECT 2 UNION ALL SELECT 3 UNION ALL SELECT 4),
    (SELECT 0 AS grain UNION ALL SELECT 1)
  GROUP BY 1, 2, 3, 4;

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
