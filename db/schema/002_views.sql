-- Views for people's own queries (`sqlite3 ledger.db`, `sunder runs sql`, the conditions of `sunder runs list`).

-- Measures of every frame with their names: SELECT frame, value FROM measures_view WHERE id = … AND name = 'kinetic'.
CREATE VIEW measures_view AS
SELECT runs.id, runs.run, frames.frame, frames.time, measures.name, run_measures.value
FROM run_measures
JOIN runs USING (run)
JOIN frames USING (run, frame)
JOIN measures USING (measure);

-- The measures of each run's last frame.
CREATE VIEW final_measures AS
SELECT runs.id, runs.run, run_measures.frame, measures.name, run_measures.value
FROM runs
JOIN run_measures ON run_measures.run = runs.run
    AND run_measures.frame = (SELECT max(frame) FROM frames WHERE frames.run = runs.run)
JOIN measures USING (measure);

-- A row a run. `parameters` and `measures` (of the last frame) are JSON objects:
--     SELECT id, parameters ->> 'eta', measures ->> 'broken_fraction' FROM runs_view WHERE title = 'Tube pull'
CREATE VIEW runs_view AS
SELECT
    id, status,
    scene_title AS title,
    variant,
    scene_path AS scene,
    scene_hash,
    datetime(started, 'unixepoch', 'localtime') AS started,
    datetime(ended, 'unixepoch', 'localtime') AS ended,
    particles, threads, precision, simd, version, effects, seed,
    coalesce(frames, (SELECT max(frame) FROM frames AS f WHERE f.run = runs.run), 0) AS frames,
    frames_wanted,
    coalesce(steps, (SELECT f.steps FROM frames AS f WHERE f.run = runs.run ORDER BY frame DESC LIMIT 1), 0) AS steps,
    coalesce(wall_seconds, (SELECT f.wall_seconds FROM frames AS f WHERE f.run = runs.run ORDER BY frame DESC LIMIT 1), 0)
        AS wall_seconds,
    (SELECT f.time FROM frames AS f WHERE f.run = runs.run ORDER BY frame DESC LIMIT 1) AS time,
    (SELECT json_group_object(name, coalesce(text, number)) FROM run_parameters AS p WHERE p.run = runs.run) AS parameters,
    (SELECT json_group_object(name, value) FROM final_measures AS m WHERE m.run = runs.run) AS measures,
    (SELECT group_concat(tag) FROM tags WHERE tags.run = runs.run) AS tags,
    (SELECT group_concat(text, '; ') FROM notes WHERE notes.run = runs.run) AS notes,
    message, parent, parent_frame, command, output,
    iif(json_valid(summary), summary, NULL) AS summary,
    run
FROM runs;
