-- A study is a job of another kind: queued, leased, cancelled and resumed alike. Its lines are the paths that have been
-- traced, and max_increments their number.
ALTER TABLE jobs ADD COLUMN task TEXT NOT NULL DEFAULT 'path' CHECK (task IN ('path', 'study'));

CREATE INDEX jobs_by_task ON jobs (task, id);
