-- The name of the token that the job was posted with; null where the service asked for none.
ALTER TABLE jobs ADD COLUMN owner TEXT;

CREATE INDEX jobs_by_owner ON jobs (owner, id) WHERE owner IS NOT NULL;
