-- A sweep is a job of another kind: named, owned, listed, followed and cancelled alike. Its lines are its runs as they end,
-- and max_increments their number. Nobody claims it: it runs as long as its runs do.
ALTER TABLE jobs DROP CONSTRAINT jobs_task_check;
ALTER TABLE jobs ADD CONSTRAINT jobs_task_check CHECK (task IN ('path', 'study', 'sweep'));

ALTER TABLE jobs ADD COLUMN sweep        UUID;     -- the sweep that this job is a run of
ALTER TABLE jobs ADD COLUMN sweep_run    BIGINT;   -- from 0
ALTER TABLE jobs ADD COLUMN sweep_values TEXT;     -- a JSON array
ALTER TABLE jobs ADD COLUMN first_limit  TEXT;     -- the first limit load of the path, as JSON
CREATE INDEX jobs_by_sweep ON jobs (sweep, id) WHERE sweep IS NOT NULL;

-- However a run ends, its row is stored with that. The sweep's own row comes after those of its runs wherever both are
-- changed, so that nobody waits for another in a circle.
CREATE FUNCTION row_of_an_ended_run() RETURNS trigger LANGUAGE plpgsql AS $$
DECLARE
    place BIGINT;
BEGIN
    UPDATE jobs SET last_index = coalesce(last_index + 1, 0), updated_at = NEW.updated_at WHERE id = NEW.sweep
    RETURNING last_index INTO place;
    IF FOUND THEN
        INSERT INTO increments (job, increment_index, body)
        SELECT NEW.sweep, place, row_to_json(told)::text FROM (SELECT
            NEW.sweep_run AS run, NEW.id AS job, NEW.sweep_values::json AS "values", NEW.status AS status,
            NEW.stop_reason AS stop_reason, NEW.error AS error, NEW.last_index AS last_index,
            NEW.first_limit::json AS first_limit) AS told;
        -- The last one ends the sweep.
        UPDATE jobs SET
            status = CASE WHEN cancel_requested <> 0 THEN 'cancelled' ELSE 'completed' END,
            stop_reason = CASE WHEN cancel_requested <> 0 THEN 'cancelled' END,
            ended_at = NEW.updated_at, worker = NULL, lease_until = NULL
        WHERE id = NEW.sweep AND last_index + 1 >= max_increments;
    END IF;
    RETURN NULL;
END
$$;
CREATE TRIGGER row_of_an_ended_run AFTER UPDATE OF status ON jobs
FOR EACH ROW WHEN (NEW.sweep IS NOT NULL AND OLD.status IN ('queued', 'running') AND NEW.status NOT IN ('queued', 'running'))
EXECUTE FUNCTION row_of_an_ended_run();

-- What is counted are jobs that are worked on.
CREATE OR REPLACE FUNCTION tally_job() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
    IF TG_OP <> 'INSERT' AND OLD.task <> 'sweep' THEN
        INSERT INTO tallies (status, jobs) VALUES (OLD.status, -1);
    END IF;
    IF TG_OP <> 'DELETE' AND NEW.task <> 'sweep' THEN
        INSERT INTO tallies (status, jobs) VALUES (NEW.status, 1);
    END IF;
    RETURN NULL;
END
$$;
