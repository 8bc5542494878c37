-- What the limits of a job are held against, over all of its attempts.
ALTER TABLE jobs ADD COLUMN ran_ms       INTEGER NOT NULL DEFAULT 0; -- up to updated_at, where it runs
ALTER TABLE jobs ADD COLUMN stored_bytes INTEGER NOT NULL DEFAULT 0; -- increments and branches

-- For what is kept of ended jobs.
CREATE INDEX jobs_ended ON jobs (ended_at) WHERE ended_at IS NOT NULL;
