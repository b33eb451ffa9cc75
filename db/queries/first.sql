-- When something first happened in each run.
--   :kind   of event (default first_crack)
--   :scene  only runs whose title contains this (default: all)
SELECT runs.id AS run, runs.scene_title AS scene, runs.variant, min(events.frame) AS frame, frames.time, events.text
FROM events
JOIN runs USING (run)
LEFT JOIN frames ON frames.run = events.run AND frames.frame = events.frame
WHERE events.kind = coalesce(:kind, 'first_crack')
  AND instr(lower(runs.scene_title), lower(coalesce(:scene, ''))) > 0
GROUP BY events.run
ORDER BY runs.started DESC;
