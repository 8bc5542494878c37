-- The order of the queue: of one priority the job of the least turn goes first. Turns are given so that owners take turns, and
-- so that an owner's single jobs come between those of which there are many. Processes of before give none, and theirs go first.
ALTER TABLE jobs ADD COLUMN turn  BIGINT NOT NULL DEFAULT 0;
-- 0: a single job; 1: a study; 2: one of many, a run of a sweep or what an exploration has queued.
ALTER TABLE jobs ADD COLUMN class BIGINT NOT NULL DEFAULT 0;
UPDATE jobs SET class = CASE WHEN task = 'study' THEN 1 WHEN sweep IS NOT NULL OR family_number > 0 THEN 2 ELSE 0 END
WHERE status IN ('queued', 'running');

-- Beside `jobs_waiting`, by which processes of before claim.
CREATE INDEX jobs_waiting_in_turn ON jobs (priority DESC, turn, id) WHERE status = 'queued';
CREATE INDEX jobs_waiting_by_owner ON jobs (priority, coalesce(owner, ''), class, turn, id) WHERE status = 'queued';
