-- Further runs that may be added to a sweep, where its response changes most.
ALTER TABLE jobs ADD COLUMN refine INTEGER NOT NULL DEFAULT 0;
CREATE INDEX jobs_refinable ON jobs (id) WHERE refine > 0 AND status = 'running';

DROP TRIGGER row_of_an_ended_run;
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
        'last_index', NEW.last_index, 'first_limit', json(NEW.first_limit), 'responses', json(NEW.responses))
    FROM jobs WHERE id = NEW.sweep;
    -- The last one ends the sweep, unless further runs may be added.
    UPDATE jobs SET
        status = CASE WHEN cancel_requested THEN 'cancelled' ELSE 'completed' END,
        stop_reason = CASE WHEN cancel_requested THEN 'cancelled' END,
        ended_at = NEW.updated_at, worker = NULL, lease_until = NULL
    WHERE id = NEW.sweep AND last_index + 1 >= max_increments AND (refine = 0 OR cancel_requested <> 0);
END;
