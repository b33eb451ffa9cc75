-- Runs in the order of one measure of their last frame, the best first.
--   :measure  its name (default broken_fraction)
--   :most     1: the largest is the best; else the smallest (default)
--   :scene    only runs whose title contains this (default: all)
--   :limit    how many (default 10)
SELECT runs.id AS run, runs.status, runs.scene_title AS scene, runs.variant, final_measures.value, runs.output
FROM final_measures
JOIN runs USING (run)
WHERE final_measures.name = coalesce(:measure, 'broken_fraction')
  AND final_measures.value IS NOT NULL
  AND runs.status <> 'failed'
  AND instr(lower(runs.scene_title), lower(coalesce(:scene, ''))) > 0
ORDER BY iif(coalesce(:most, 0), -final_measures.value, final_measures.value), runs.started
LIMIT coalesce(:limit, 10);
