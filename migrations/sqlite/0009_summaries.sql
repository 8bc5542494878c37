-- What lists show of a job in the place of its plan, as JSON, where the plan is large; null: the plan itself.
ALTER TABLE jobs ADD COLUMN summary TEXT;
