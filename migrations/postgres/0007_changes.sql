-- The order in which jobs, studies and sweeps have changed, for a feed of the changes: each change has the number of its
-- transaction. Readers look at changes of transactions before which none is still open, so that they miss none.
ALTER TABLE jobs ADD COLUMN change BIGINT NOT NULL DEFAULT 0; -- 0: none since there are numbers
CREATE INDEX jobs_by_change ON jobs (change, id);

-- Those that were deleted within the last day.
CREATE TABLE deletions (
    job        UUID   PRIMARY KEY,
    task       TEXT   NOT NULL,
    owner      TEXT,
    change     BIGINT NOT NULL,
    deleted_at BIGINT NOT NULL
);
CREATE INDEX deletions_by_change ON deletions (change, job);
CREATE INDEX deletions_by_age ON deletions (deleted_at);

CREATE FUNCTION number_change() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    NEW.change := txid_current();
    RETURN NEW;
END
$$;

CREATE TRIGGER change_of_a_new_job BEFORE INSERT ON jobs
FOR EACH ROW EXECUTE FUNCTION number_change();
CREATE TRIGGER change_of_a_changed_job BEFORE UPDATE OF status, last_index, cancel_requested ON jobs
FOR EACH ROW WHEN (NEW.status <> OLD.status OR NEW.last_index IS DISTINCT FROM OLD.last_index
                   OR NEW.cancel_requested <> OLD.cancel_requested)
EXECUTE FUNCTION number_change();

CREATE FUNCTION keep_deletion() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    INSERT INTO deletions (job, task, owner, change, deleted_at)
    VALUES (OLD.id, OLD.task, OLD.owner, txid_current(), CAST(extract(epoch FROM clock_timestamp()) * 1000 AS BIGINT));
    RETURN NULL;
END
$$;

CREATE TRIGGER change_of_a_dropped_job AFTER DELETE ON jobs
FOR EACH ROW EXECUTE FUNCTION keep_deletion();
