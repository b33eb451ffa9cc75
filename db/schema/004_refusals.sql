-- Hard cases (`sunder stress`) that were refused before a run began: there is no run whose event their verdict could be. The newest try of each.

CREATE TABLE refusals (
    name      TEXT NOT NULL, -- the case: 'domain/outside'
    precision TEXT NOT NULL, -- 'f32', 'f64'
    happened  REAL NOT NULL, -- seconds since 1970
    text      TEXT NOT NULL, -- the verdict, as events of kind 'verdict' have it
    PRIMARY KEY (name, precision)
) STRICT, WITHOUT ROWID;
