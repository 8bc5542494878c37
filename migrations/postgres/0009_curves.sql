-- A curve of limit points is a job of another kind: queued, leased, listed, cancelled and deleted alike. Its lines are its
-- points.
ALTER TABLE jobs DROP CONSTRAINT jobs_task_check;
ALTER TABLE jobs ADD CONSTRAINT jobs_task_check CHECK (task IN ('path', 'study', 'sweep', 'curve'));

-- A process of before does not know what a curve is.
INSERT INTO compatibility VALUES (9);
