-- Jobs by status, kept as they come and go: whether there is room in the queue, and how many run, is told without counting.
CREATE TABLE tallies (
    status TEXT    PRIMARY KEY NOT NULL,
    jobs   INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

INSERT INTO tallies (status, jobs)
VALUES ('queued', 0), ('running', 0), ('completed', 0), ('stopped', 0), ('cancelled', 0), ('failed', 0);
UPDATE tallies SET jobs = (SELECT count(*) FROM jobs WHERE jobs.status = tallies.status);

CREATE TRIGGER tally_of_a_new_job AFTER INSERT ON jobs
BEGIN
    UPDATE tallies SET jobs = jobs + 1 WHERE status = NEW.status;
END;

CREATE TRIGGER tally_of_a_changed_job AFTER UPDATE OF status ON jobs
WHEN NEW.status <> OLD.status
BEGIN
    UPDATE tallies SET jobs = jobs - 1 WHERE status = OLD.status;
    UPDATE tallies SET jobs = jobs + 1 WHERE status = NEW.status;
END;

CREATE TRIGGER tally_of_a_dropped_job AFTER DELETE ON jobs
BEGIN
    UPDATE tallies SET jobs = jobs - 1 WHERE status = OLD.status;
END;

-- A list by status walks this one. The index by status alone, which it replaces, was taken for claims too, and every claim
-- sorted the whole queue.
CREATE INDEX jobs_by_task_and_status ON jobs (task, status, id);
DROP INDEX jobs_by_status;
