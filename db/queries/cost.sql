-- What runs of a scene cost: wall time a step and particle-steps a second, by precision, instruction set and threads.
--   :scene  only runs whose title contains this (default: all)
SELECT title AS scene, variant, precision, simd, threads, count(*) AS runs, max(particles) AS particles,
       round(sum(wall_seconds), 1) AS wall_s,
       1e3 * sum(wall_seconds) / sum(steps) AS ms_per_step,
       sum(1.0 * particles * steps) / sum(wall_seconds) / 1e6 AS million_particle_steps_per_s
FROM runs_view
WHERE steps > 0 AND wall_seconds > 0 AND instr(lower(title), lower(coalesce(:scene, ''))) > 0
GROUP BY title, variant, precision, simd, threads
ORDER BY title, variant, million_particle_steps_per_s DESC;
