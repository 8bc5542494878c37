-- A job that follows a direction of another. The other may have been deleted since: what it gave is kept with the job.
ALTER TABLE jobs ADD COLUMN parent BLOB;
ALTER TABLE jobs ADD COLUMN parent_increment INTEGER CHECK ((parent IS NULL) = (parent_increment IS NULL));
ALTER TABLE jobs ADD COLUMN parent_direction INTEGER CHECK ((parent IS NULL) = (parent_direction IS NULL));

-- Jobs that an exploration queued, and the one that it began with.
ALTER TABLE jobs ADD COLUMN family        BLOB;                        -- the first job's id; null outside a family
ALTER TABLE jobs ADD COLUMN family_number INTEGER NOT NULL DEFAULT 0;  -- in the order of queueing; the first is 0
ALTER TABLE jobs ADD COLUMN generation    INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN explored      INTEGER NOT NULL DEFAULT 0;  -- its alternatives have been looked at
ALTER TABLE jobs ADD COLUMN not_queued    INTEGER NOT NULL DEFAULT 0;  -- alternatives for which there was no room

CREATE INDEX jobs_by_parent ON jobs (parent, id) WHERE parent IS NOT NULL;
CREATE INDEX jobs_by_family ON jobs (family, family_number) WHERE family IS NOT NULL;
CREATE INDEX jobs_unexplored ON jobs (family, family_number) WHERE family IS NOT NULL AND explored = 0;

-- What an exploration may do; outlives its first job, because the jobs that it queued do.
CREATE TABLE families (
    id       BLOB    PRIMARY KEY NOT NULL,         -- the first job
    depth    INTEGER NOT NULL,                     -- generations
    max_jobs INTEGER NOT NULL,                     -- jobs queued in all, the first not counted
    queued   INTEGER NOT NULL DEFAULT 0
) STRICT;

-- Increments from which another direction can be followed.
CREATE TABLE branches (
    job             BLOB    NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    increment_index INTEGER NOT NULL,
    body            TEXT    NOT NULL,              -- the checkpoint there
    trail           TEXT,                          -- states passed since the branch before, a JSON line
    alternatives    TEXT,                          -- a JSON array of the directions that an exploration follows
    PRIMARY KEY (job, increment_index)
) STRICT;

-- Where a job that follows another begins: a copy, so that it stands on its own.
CREATE TABLE origins (
    job   BLOB PRIMARY KEY NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    body  TEXT NOT NULL,
    trail TEXT                                     -- JSON lines
) STRICT;
