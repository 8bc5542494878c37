-- Where a job that has not ended can be taken up: the newest checkpoint, stored with the increments that lead to it.
CREATE TABLE checkpoints (
    job             BLOB    PRIMARY KEY NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    increment_index INTEGER NOT NULL,              -- of the increment at which the path was put down
    body            TEXT    NOT NULL
) STRICT;

-- States passed since the checkpoint before, a JSON line each: every state is written once.
CREATE TABLE checkpoint_trails (
    job             BLOB    NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
    increment_index INTEGER NOT NULL,
    trail           TEXT    NOT NULL,
    PRIMARY KEY (job, increment_index)
) STRICT;

-- However a job ends, it is not taken up any more.
CREATE TRIGGER checkpoints_of_ended_jobs AFTER UPDATE OF status ON jobs
WHEN NEW.status NOT IN ('queued', 'running')
BEGIN
    DELETE FROM checkpoints WHERE job = NEW.id;
    DELETE FROM checkpoint_trails WHERE job = NEW.id;
END;

-- Workers that the job has lost in a row, nothing stored between.
ALTER TABLE jobs ADD COLUMN losses INTEGER NOT NULL DEFAULT 0;

CREATE INDEX jobs_suspected ON jobs (id) WHERE status = 'running' AND losses > 0;
