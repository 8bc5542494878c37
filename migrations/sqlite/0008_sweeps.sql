-- A sweep is a job of another kind: named, owned, listed, followed and cancelled alike. Its lines are its runs as they end,
-- and max_increments their number. Nobody claims it: it runs as long as its runs do.
DROP INDEX jobs_by_task;
DROP INDEX jobs_by_task_and_status;
ALTER TABLE jobs ADD COLUMN kind TEXT NOT NULL DEFAULT 'path' CHECK (kind IN ('path', 'study', 'sweep'));
UPDATE jobs SET kind = task;
ALTER TABLE jobs DROP COLUMN task;
ALTER TABLE jobs RENAME COLUMN kind TO task;
CREATE INDEX jobs_by_task ON jobs (task, id);
CREATE INDEX jobs_by_task_and_status ON jobs (task, status, id);

ALTER TABLE jobs ADD COLUMN sweep        BLOB;     -- the sweep that this job is a run of
ALTER TABLE jobs ADD COLUMN sweep_run    INTEGER;  -- from 0
ALTER TABLE jobs ADD COLUMN sweep_values TEXT;     -- a JSON array
ALTER TABLE jobs ADD COLUMN first_limit  TEXT;     -- the first limit load of the path, as JSON
CREATE INDEX jobs_by_sweep ON jobs (sweep, id) WHERE sweep IS NOT NULL;

-- However a run ends, its row is stored with that.
CREATE TRIGGER row_of_an_ended_run AFTER UPDATE OF status ON jobs
WHEN NEW.sweep IS NOT NULL AND OLD.status IN ('queued', 'running') AND NEW.status NOT IN ('queued', 'running')
BEGIN
    UPDATE jobs SET last_index = coalesce(last_index + 1, 0), updated_at = NEW.updated_at WHERE id = NEW.sweep;
    INSERT INTO increments (job, increment_index, body)
    SELECT id, last_index, json_object(
        'run', NEW.sweep_run,
        'job', lower(substr(hex(NEW.id), 1, 8) || '-' || substr(hex(NEW.id), 9, 4) || '-' || substr(hex(NEW.id), 13, 4) || '-'
               || substr(hex(NEW.id), 17, 4) || '-' || substr(hex(NEW.id), 21)),
        'values', json(NEW.sweep_values), 'status', NEW.status, 'stop_reason', NEW.stop_reason, 'error', NEW.error,
        'last_index', NEW.last_index, 'first_limit', json(NEW.first_limit))
    FROM jobs WHERE id = NEW.sweep;
    -- The last one ends the sweep.
    UPDATE jobs SET
        status = CASE WHEN cancel_requested THEN 'cancelled' ELSE 'completed' END,
        stop_reason = CASE WHEN cancel_requested THEN 'cancelled' END,
        ended_at = NEW.updated_at, worker = NULL, lease_until = NULL
    WHERE id = NEW.sweep AND last_index + 1 >= max_increments;
END;

-- What is counted are jobs that are worked on.
DROP TRIGGER tally_of_a_new_job;
DROP TRIGGER tally_of_a_changed_job;
DROP TRIGGER tally_of_a_dropped_job;

CREATE TRIGGER tally_of_a_new_job AFTER INSERT ON jobs
WHEN NEW.task <> 'sweep'
BEGIN
    UPDATE tallies SET jobs = jobs + 1 WHERE status = NEW.status;
END;

CREATE TRIGGER tally_of_a_changed_job AFTER UPDATE OF status ON jobs
WHEN NEW.status <> OLD.status AND NEW.task <> 'sweep'
BEGIN
    UPDATE tallies SET jobs = jobs - 1 WHERE status = OLD.status;
    UPDATE tallies SET jobs = jobs + 1 WHERE status = NEW.status;
END;

CREATE TRIGGER tally_of_a_dropped_job AFTER DELETE ON jobs
WHEN OLD.task <> 'sweep'
BEGIN
    UPDATE tallies SET jobs = jobs - 1 WHERE status = OLD.status;
END;
