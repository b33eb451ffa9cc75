-- Runs that did not end well, the newest first, with what they said and where their frames are.
SELECT id AS run, status, title AS scene, variant, frames, message, output
FROM runs_view
WHERE status IN ('failed', 'dead', 'interrupted')
ORDER BY run DESC;
