-- The order in which jobs, studies and sweeps have changed, for a feed of the changes: each change has the next number.
CREATE TABLE change_count (
    id     INTEGER PRIMARY KEY CHECK (id = 1),
    latest INTEGER NOT NULL
) STRICT;
INSERT INTO change_count (id, latest) VALUES (1, 0);

ALTER TABLE jobs ADD COLUMN change INTEGER NOT NULL DEFAULT 0; -- the number of the last one; 0: none since there are numbers
CREATE INDEX jobs_by_change ON jobs (change, id);

-- Those that were deleted within the last day.
CREATE TABLE deletions (
    job        BLOB    PRIMARY KEY NOT NULL,
    task       TEXT    NOT NULL,
    owner      TEXT,
    change     INTEGER NOT NULL,
    deleted_at INTEGER NOT NULL
) STRICT;
CREATE INDEX deletions_by_change ON deletions (change, job);
CREATE INDEX deletions_by_age ON deletions (deleted_at);

CREATE TRIGGER change_of_a_new_job AFTER INSERT ON jobs
BEGIN
    UPDATE change_count SET latest = latest + 1;
    UPDATE jobs SET change = (SELECT latest FROM change_count) WHERE id = NEW.id;
END;

CREATE TRIGGER change_of_a_changed_job AFTER UPDATE OF status, last_index, cancel_requested ON jobs
WHEN NEW.status <> OLD.status OR NEW.last_index IS NOT OLD.last_index OR NEW.cancel_requested <> OLD.cancel_requested
BEGIN
    UPDATE change_count SET latest = latest + 1;
    UPDATE jobs SET change = (SELECT latest FROM change_count) WHERE id = NEW.id;
END;

CREATE TRIGGER change_of_a_dropped_job AFTER DELETE ON jobs
BEGIN
    UPDATE change_count SET latest = latest + 1;
    INSERT INTO deletions (job, task, owner, change, deleted_at)
    SELECT OLD.id, OLD.task, OLD.owner, latest, CAST(round(unixepoch('now', 'subsec') * 1000) AS INTEGER) FROM change_count;
END;
