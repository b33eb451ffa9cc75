-- The run ledger, version 1: what every run was told and what it measured.
-- Each file of this folder is one migration: it is run once, in the order of the numbers, inside a transaction that also
-- sets PRAGMA user_version and fills the table of migrations.

PRAGMA application_id = 0x736e6472; -- "sndr": tells a ledger from any other SQLite database

CREATE TABLE migrations (
    version INTEGER PRIMARY KEY,
    name    TEXT NOT NULL,
    applied TEXT NOT NULL -- UTC
) STRICT;

CREATE TABLE runs (
    run           INTEGER PRIMARY KEY, -- internal; people and files use `id`
    id            TEXT NOT NULL UNIQUE,
    status        TEXT NOT NULL CHECK (status IN ('running', 'done', 'failed', 'interrupted', 'dead')),
    started       REAL NOT NULL,       -- seconds since 1970, UTC
    ended         REAL,
    scene_path    TEXT NOT NULL,
    scene_title   TEXT NOT NULL,
    scene_hash    TEXT NOT NULL,       -- of all sources, hexadecimal
    variant       TEXT,
    command       TEXT NOT NULL,
    output        TEXT NOT NULL,       -- the run's folder
    precision     TEXT NOT NULL,
    simd          TEXT NOT NULL,
    version       TEXT NOT NULL,       -- of the program
    effects       TEXT NOT NULL,       -- names joined by commas
    threads       INTEGER NOT NULL,
    particles     INTEGER NOT NULL,
    frames_wanted INTEGER NOT NULL,
    seed          INTEGER NOT NULL,
    parent        TEXT,                -- id of the run that it was resumed or branched from; that run may be gone
    parent_frame  INTEGER,
    -- Known at the end; until then the table of frames tells.
    frames        INTEGER,
    steps         INTEGER,
    wall_seconds  REAL,
    message       TEXT,
    summary       TEXT,                -- the object that `run --json` prints
    -- The process that writes the run, so that a run whose process is gone is known to be dead.
    host          TEXT NOT NULL,
    boot          TEXT NOT NULL,       -- the kernel's boot id, '' when unknown
    pid_space     TEXT NOT NULL,       -- the namespace in which `pid` means something, '' when unknown
    pid           INTEGER NOT NULL,
    pid_started   INTEGER NOT NULL     -- clock ticks from boot to the process's start, 0 when unknown
) STRICT;

CREATE INDEX runs_by_start ON runs (started);
CREATE INDEX runs_by_scene ON runs (scene_title, variant);
CREATE INDEX runs_running ON runs (status) WHERE status = 'running';

CREATE TABLE run_parameters (
    run      INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
    name     TEXT NOT NULL,
    unit     TEXT NOT NULL,
    number   REAL,             -- NULL when the parameter is a text
    text     TEXT,             -- NULL when it is a number
    from_set INTEGER NOT NULL, -- 1 when --set gave it
    PRIMARY KEY (run, name)
) STRICT, WITHOUT ROWID;

CREATE INDEX run_parameters_by_name ON run_parameters (name, number, text);

CREATE TABLE frames (
    run          INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
    frame        INTEGER NOT NULL,
    time         REAL NOT NULL,    -- simulated
    steps        INTEGER NOT NULL, -- since the run's start
    wall_seconds REAL NOT NULL,    -- since the run's start
    PRIMARY KEY (run, frame)
) STRICT, WITHOUT ROWID;

-- Names of measures are kept once: a run writes thousands of rows with the same thirty names.
CREATE TABLE measures (
    measure INTEGER PRIMARY KEY,
    name    TEXT NOT NULL UNIQUE
) STRICT;

-- The key begins with (run, frame), so that a frame's rows are appended together: one or two pages a frame.
CREATE TABLE run_measures (
    run     INTEGER NOT NULL,
    frame   INTEGER NOT NULL,
    measure INTEGER NOT NULL REFERENCES measures,
    value   REAL, -- NULL: not a number
    PRIMARY KEY (run, frame, measure),
    FOREIGN KEY (run, frame) REFERENCES frames ON DELETE CASCADE
) STRICT, WITHOUT ROWID;

CREATE TABLE events (
    event    INTEGER PRIMARY KEY,
    run      INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
    frame    INTEGER NOT NULL,
    happened REAL NOT NULL, -- seconds since 1970, UTC
    kind     TEXT NOT NULL, -- first_crack, warning, knob, checkpoint …
    text     TEXT NOT NULL
) STRICT;

CREATE INDEX events_by_run ON events (run, frame);

CREATE TABLE tags (
    run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
    tag TEXT NOT NULL,
    PRIMARY KEY (run, tag)
) STRICT, WITHOUT ROWID;

CREATE INDEX tags_by_tag ON tags (tag);

CREATE TABLE notes (
    note    INTEGER PRIMARY KEY,
    run     INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE,
    written REAL NOT NULL, -- seconds since 1970, UTC
    text    TEXT NOT NULL
) STRICT;

CREATE INDEX notes_by_run ON notes (run);
