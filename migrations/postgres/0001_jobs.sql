-- The tables of `migrations/sqlite`, with the same meaning, for many processes on many machines.
--
-- Every change of this schema only adds: processes of before and after it run side by side on one database, and those of
-- before go on when they find it changed. A change that they cannot live with raises `compatibility`; processes of before
-- then refuse to start.
--
-- Numbers and flags are BIGINT and times milliseconds since 1970-01-01 UTC, all of them by this server's clock, so that
-- the statements are those of SQLite.
CREATE TABLE compatibility (
    least_version BIGINT NOT NULL                   -- the newest change that a process has to know
);
INSERT INTO compatibility VALUES (1);

CREATE TABLE jobs (
    id               UUID   PRIMARY KEY,            -- version 7: in the order of submission
    task             TEXT   NOT NULL DEFAULT 'path' CHECK (task IN ('path', 'study')),
    owner            TEXT,                          -- the name of the token that the job was posted with
    name             TEXT,                          -- the model's own name
    status           TEXT   NOT NULL CHECK (status IN ('queued', 'running', 'completed', 'stopped', 'cancelled', 'failed')),
    priority         BIGINT NOT NULL DEFAULT 0,     -- higher goes first
    request          TEXT   NOT NULL,               -- as posted, byte for byte
    idempotency_key  TEXT   UNIQUE,
    plan             TEXT   NOT NULL,
    report           TEXT,
    stop_reason      TEXT,
    error            TEXT,                          -- why a job failed
    max_increments   BIGINT NOT NULL,
    last_index       BIGINT,                        -- of the last increment stored; null before the first
    attempt          BIGINT NOT NULL DEFAULT 0,
    max_attempts     BIGINT NOT NULL CHECK (max_attempts >= 1),
    losses           BIGINT NOT NULL DEFAULT 0,     -- workers lost in a row, nothing stored between
    worker           TEXT,                          -- whoever holds the lease
    lease_until      BIGINT,
    cancel_requested BIGINT NOT NULL DEFAULT 0,
    ran_ms           BIGINT NOT NULL DEFAULT 0,     -- over all attempts, up to updated_at
    stored_bytes     BIGINT NOT NULL DEFAULT 0,     -- increments and branches
    created_at       BIGINT NOT NULL,
    started_at       BIGINT,
    ended_at         BIGINT,
    updated_at       BIGINT NOT NULL,
    parent           UUID,                          -- the job that this one follows; it may be gone
    parent_increment BIGINT CHECK ((parent IS NULL) = (parent_increment IS NULL)),
    parent_direction BIGINT CHECK ((parent IS NULL) = (parent_direction IS NULL)),
    family           UUID,                          -- the job that the exploration began with; null outside of one
    family_number    BIGINT NOT NULL DEFAULT 0,     -- in the order of queueing; the first is 0
    generation       BIGINT NOT NULL DEFAULT 0,
    explored         BIGINT NOT NULL DEFAULT 0,     -- its alternatives have been looked at
    not_queued       BIGINT NOT NULL DEFAULT 0,     -- alternatives for which there was no room
    CHECK ((status = 'running') = (worker IS NOT NULL)),
    CHECK ((status = 'running') = (lease_until IS NOT NULL))
) WITH (fillfactor = 70);                           -- room for the rows that leases and progress rewrite, on their page

CREATE INDEX jobs_waiting ON jobs (priority DESC, id) WHERE status = 'queued';
-- Not by the time of the lease, so that prolonging one changes no index: those at work are few.
CREATE INDEX jobs_at_work ON jobs (id) WHERE status = 'running';
CREATE INDEX jobs_by_task ON jobs (task, id);
CREATE INDEX jobs_by_task_and_status ON jobs (task, status, id);
CREATE INDEX jobs_by_owner ON jobs (owner, id) WHERE owner IS NOT NULL;
CREATE INDEX jobs_by_parent ON jobs (parent, id) WHERE parent IS NOT NULL;
CREATE INDEX jobs_by_family ON jobs (family, family_number) WHERE family IS NOT NULL;
CREATE INDEX jobs_unexplored ON jobs (family, family_number) WHERE family IS NOT NULL AND explored = 0;
CREATE INDEX jobs_ended ON jobs (ended_at) WHERE ended_at IS NOT NULL;
-- Of the jobs that may have ended their process one is worked on at a time, however many claim at the same moment.
CREATE UNIQUE INDEX jobs_one_suspect_at_work ON jobs (status) WHERE status = 'running' AND losses > 0;

-- Append only. No foreign keys here and below: who writes rows of a job holds the job's own row, which costs nothing more,
-- and a trigger drops them with it; a key would look the job up again for every row.
CREATE TABLE increments (
    job             UUID   NOT NULL,
    increment_index BIGINT NOT NULL,
    body            TEXT   NOT NULL,                -- the JSON line, streamed as it stands
    PRIMARY KEY (job, increment_index)
);

CREATE TABLE branches (
    job             UUID   NOT NULL,
    increment_index BIGINT NOT NULL,
    body            TEXT   NOT NULL,                -- the checkpoint there
    trail           TEXT,                           -- states passed since the branch before, a JSON line
    alternatives    TEXT,                           -- a JSON array of the directions that an exploration follows
    PRIMARY KEY (job, increment_index)
);

CREATE TABLE origins (
    job   UUID PRIMARY KEY,
    body  TEXT NOT NULL,
    trail TEXT                                      -- JSON lines
);

CREATE TABLE checkpoints (
    job             UUID   PRIMARY KEY,
    increment_index BIGINT NOT NULL,                -- of the increment at which the path was put down
    body            TEXT   NOT NULL
);

CREATE TABLE checkpoint_trails (
    job             UUID   NOT NULL,
    increment_index BIGINT NOT NULL,
    trail           TEXT   NOT NULL,
    PRIMARY KEY (job, increment_index)
);

CREATE TABLE families (
    id       UUID   PRIMARY KEY,                    -- the first job
    depth    BIGINT NOT NULL,                       -- generations
    max_jobs BIGINT NOT NULL,                       -- jobs queued in all, the first not counted
    queued   BIGINT NOT NULL DEFAULT 0
);

-- One row that the readiness probe rewrites: proof that the database takes writes.
CREATE TABLE heartbeat (
    id      BIGINT PRIMARY KEY CHECK (id = 1),
    beat_at BIGINT NOT NULL
);

-- Jobs by status. Changes are added as rows, so that nobody waits for another's, and folded into one a status from time to
-- time: the number is their sum.
CREATE TABLE tallies (
    status TEXT   NOT NULL,
    jobs   BIGINT NOT NULL
);
CREATE INDEX tallies_by_status ON tallies (status);
INSERT INTO tallies (status, jobs)
VALUES ('queued', 0), ('running', 0), ('completed', 0), ('stopped', 0), ('cancelled', 0), ('failed', 0);

CREATE FUNCTION tally_job() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    IF TG_OP <> 'INSERT' THEN
        INSERT INTO tallies (status, jobs) VALUES (OLD.status, -1);
    END IF;
    IF TG_OP <> 'DELETE' THEN
        INSERT INTO tallies (status, jobs) VALUES (NEW.status, 1);
    END IF;
    RETURN NULL;
END
$$;
CREATE TRIGGER tally_of_a_new_or_dropped_job AFTER INSERT OR DELETE ON jobs
FOR EACH ROW EXECUTE FUNCTION tally_job();
CREATE TRIGGER tally_of_a_changed_job AFTER UPDATE OF status ON jobs
FOR EACH ROW WHEN (NEW.status <> OLD.status) EXECUTE FUNCTION tally_job();

-- However a job ends, it is not taken up any more.
CREATE FUNCTION drop_checkpoints() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    DELETE FROM checkpoints WHERE job = NEW.id;
    DELETE FROM checkpoint_trails WHERE job = NEW.id;
    RETURN NULL;
END
$$;
CREATE TRIGGER checkpoints_of_ended_jobs AFTER UPDATE OF status ON jobs
FOR EACH ROW WHEN (NEW.status NOT IN ('queued', 'running')) EXECUTE FUNCTION drop_checkpoints();

CREATE FUNCTION drop_rows_of_job() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    DELETE FROM increments WHERE job = OLD.id;
    DELETE FROM branches WHERE job = OLD.id;
    DELETE FROM origins WHERE job = OLD.id;
    DELETE FROM checkpoints WHERE job = OLD.id;
    DELETE FROM checkpoint_trails WHERE job = OLD.id;
    RETURN NULL;
END
$$;
CREATE TRIGGER rows_of_a_dropped_job AFTER DELETE ON jobs
FOR EACH ROW EXECUTE FUNCTION drop_rows_of_job();
