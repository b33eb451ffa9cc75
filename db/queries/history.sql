-- One measure over the frames of one run: what a plot is drawn from.
--   :run      its id
--   :measure  its name (default broken_fraction)
SELECT frame, time, value
FROM measures_view
WHERE id = :run AND name = coalesce(:measure, 'broken_fraction')
ORDER BY frame;
