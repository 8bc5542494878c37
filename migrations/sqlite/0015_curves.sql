-- A curve of limit points is a job of another kind: queued, leased, listed, cancelled and deleted alike. Its lines are its
-- points. The check of a column cannot be changed: the kind moves to a new column, without what reads it meanwhile.
DROP INDEX jobs_by_task;
DROP INDEX jobs_by_task_and_status;
DROP TRIGGER tally_of_a_new_job;
DROP TRIGGER tally_of_a_changed_job;
DROP TRIGGER tally_of_a_dropped_job;
DROP TRIGGER change_of_a_dropped_job;

ALTER TABLE jobs ADD COLUMN kind TEXT NOT NULL DEFAULT 'path' CHECK (kind IN ('path', 'study', 'sweep', 'curve'));
UPDATE jobs SET kind = task;
ALTER TABLE jobs DROP COLUMN task;
ALTER TABLE jobs RENAME COLUMN kind TO task;
CREATE INDEX jobs_by_task ON jobs (task, id);
CREATE INDEX jobs_by_task_and_status ON jobs (task, status, id);

-- What is counted are jobs that are worked on.
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

CREATE TRIGGER change_of_a_dropped_job AFTER DELETE ON jobs
BEGIN
    UPDATE change_count SET latest = latest + 1;
    INSERT INTO deletions (job, task, owner, change, deleted_at)
    SELECT OLD.id, OLD.task, OLD.owner, latest, CAST(round(unixepoch('now', 'subsec') * 1000) AS INTEGER) FROM change_count;
END;
