-- Times are milliseconds since 1970-01-01 UTC, so that leases compare as numbers.
CREATE TABLE jobs (
    id               BLOB    PRIMARY KEY NOT NULL, -- UUID version 7: in the order of submission
    name             TEXT,                         -- the model's own name
    status           TEXT    NOT NULL CHECK (status IN ('queued', 'running', 'completed', 'stopped', 'cancelled', 'failed')),
    priority         INTEGER NOT NULL DEFAULT 0,   -- higher goes first
    request          TEXT    NOT NULL,             -- as posted, byte for byte
    idempotency_key  TEXT    UNIQUE,
    plan             TEXT    NOT NULL,
    report           TEXT,
    stop_reason      TEXT,
    error            TEXT,                         -- why a job failed
    max_increments   INTEGER NOT NULL,
    last_index       INTEGER,                      -- of the last increment stored; null before the first
    attempt          INTEGER NOT NULL DEFAULT 0,
    max_attempts     INTEGER NOT NULL CHECK (max_attempts >= 1),
    worker           TEXT,                         -- whoever holds the lease
    lease_until      INTEGER,
    cancel_requested INTEGER NOT NULL DEFAULT 0,
    created_at       INTEGER NOT NULL,
    started_at       INTEGER,
    ended_at         INTEGER,
    updated_at       INTEGER NOT NULL,
    CHECK ((status = 'running') = (worker IS NOT NULL)),
    CHECK ((status = 'running') = (lease_until IS NOT NULL))
) STRICT;

CREATE INDEX jobs_waiting ON jobs (priority DESC, id) WHERE status = 'queued';
CREATE INDEX jobs_leased ON jobs (lease_until) WHERE status = 'running';
CREATE INDEX jobs_by_status ON jobs (status, id);

-- Append only: a row is written once and never changed.
CREATE TABLE increments (
    job             BLOB    NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    increment_index INTEGER NOT NULL,
    body            TEXT    NOT NULL,              -- the JSON line, streamed as it stands
    PRIMARY KEY (job, increment_index)
) STRICT;

-- One row that the readiness probe rewrites: proof that the disk still takes writes.
CREATE TABLE heartbeat (
    id         INTEGER PRIMARY KEY CHECK (id = 1),
    beat_at    INTEGER NOT NULL
) STRICT;
