-- Parameters that were given more than one value, over all runs of a scene: what has been studied so far.
--   :scene  only runs whose title contains this (default: all)
SELECT runs.scene_title AS scene, p.name AS parameter, count(DISTINCT coalesce(p.text, p.number)) AS "values",
       min(p.number) AS least, max(p.number) AS most, count(*) AS runs
FROM run_parameters AS p
JOIN runs USING (run)
WHERE instr(lower(runs.scene_title), lower(coalesce(:scene, ''))) > 0
GROUP BY runs.scene_title, p.name
HAVING count(DISTINCT coalesce(p.text, p.number)) > 1
ORDER BY runs.scene_title, "values" DESC, p.name;
