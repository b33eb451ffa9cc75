-- How one parameter moves one measure: a row for every value that was tried, over all runs that ended well.
--   :parameter  its name, or the end of a dotted one: eta for tube.damage.eta
--   :measure    a measure of the last frame (default broken_fraction)
--   :scene      only runs whose title contains this (default: all)
SELECT coalesce(p.text, p.number) AS value, p.unit, count(*) AS runs, min(m.value) AS least, avg(m.value) AS mean,
       max(m.value) AS most
FROM run_parameters AS p
JOIN runs USING (run)
JOIN final_measures AS m ON m.run = p.run AND m.name = coalesce(:measure, 'broken_fraction')
WHERE (p.name = :parameter OR substr(p.name, -length(:parameter) - 1) = '.' || :parameter) AND runs.status = 'done'
  AND instr(lower(runs.scene_title), lower(coalesce(:scene, ''))) > 0
GROUP BY p.number, p.text
ORDER BY p.number, p.text;
