-- Of the workers that a job has lost in a row, nothing stored between, those that speak against it: it was the only one that
-- was lost then, or one that had lost a worker before.
ALTER TABLE jobs ADD COLUMN counted_losses INTEGER NOT NULL DEFAULT 0;
-- Another job of the same process has been lost during this attempt.
ALTER TABLE jobs ADD COLUMN accompanied INTEGER NOT NULL DEFAULT 0;
UPDATE jobs SET counted_losses = losses WHERE losses > 0;
