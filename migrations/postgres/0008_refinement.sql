-- Further runs that may be added to a sweep, where its response changes most.
ALTER TABLE jobs ADD COLUMN refine BIGINT NOT NULL DEFAULT 0;
CREATE INDEX jobs_refinable ON jobs (id) WHERE refine > 0 AND status = 'running';

-- However a run ends, its row is stored with that. The sweep's own row comes after those of its runs wherever both are
-- changed, so that nobody waits for another in a circle.
CREATE OR REPLACE FUNCTION row_of_an_ended_run() RETURNS trigger LANGUAGE plpgsql AS $$
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
            NEW.first_limit::json AS first_limit, NEW.responses::json AS responses) AS told;
        -- The last one ends the sweep, unless further runs may be added.
        UPDATE jobs SET
            status = CASE WHEN cancel_requested <> 0 THEN 'cancelled' ELSE 'completed' END,
            stop_reason = CASE WHEN cancel_requested <> 0 THEN 'cancelled' END,
            ended_at = NEW.updated_at, worker = NULL, lease_until = NULL
        WHERE id = NEW.sweep AND last_index + 1 >= max_increments AND (refine = 0 OR cancel_requested <> 0);
    END IF;
    RETURN NULL;
END
$$;
