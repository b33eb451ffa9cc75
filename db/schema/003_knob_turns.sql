-- Turns of knobs: with the scene and its parameters they are all that a run was told.

CREATE TABLE knob_turns (
    run   INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
    turn  INTEGER NOT NULL, -- 0, 1, … by frame, and of a frame in the order in which they act
    frame INTEGER NOT NULL, -- acts between this frame and the next
    path  TEXT NOT NULL,    -- 'tube.damage.eta'
    value TEXT NOT NULL,    -- as --set takes it, numbers with all their digits
    PRIMARY KEY (run, turn)
) STRICT, WITHOUT ROWID;
