//! Many clients at once, on the real program: every job is done once, and every stream has every increment once. The bench
//! `load` does the same with more of them, and takes the times.

use crate::common::load::{are_whole, listed, queue, stream_all, worked_off};
use crate::common::process::{Process, client, solved};
use crate::common::service::{in_short_steps, occupation, scene};
use std::time::Duration;

const PATIENCE: Duration = Duration::from_secs(600);

#[tokio::test(flavor = "multi_thread")]
async fn three_hundred_jobs_by_thirty_two_clients_are_each_done_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Process::serve(&folder.path().join("jobs.db"), &["--workers", "2"]);
    let request = scene("klarbring");
    let ids = queue(&server.url, &request, 300, 32).await;
    worked_off(&server.url, PATIENCE).await;
    let completed = listed(&server.url, "completed").await;
    assert_eq!((ids.len(), completed.len()), (300, 300));
    assert!(ids.iter().all(|id| completed.contains(id)));
    let expected = solved(&request);
    assert_eq!(are_whole(&server.url, &ids, 32, &expected).await, 300 * expected.len());
}

#[tokio::test(flavor = "multi_thread")]
async fn sixty_streams_at_once_miss_nothing_and_have_nothing_twice() {
    let folder = tempfile::tempdir().expect("a folder");
    let workers = 3;
    let server = Process::serve(&folder.path().join("jobs.db"), &["--workers", &workers.to_string()]);
    let busy = queue(&server.url, &occupation(), workers, 1).await;
    let request = in_short_steps("one-bar-truss", 900, 300);
    let jobs = queue(&server.url, &request, 6, 1).await;
    let expected = solved(&request);
    let read = stream_all(&server.url, &jobs, 60, expected.len(), async || {
        assert_eq!(listed(&server.url, "queued").await.len(), jobs.len(), "they wait until all streams are open");
        for id in &busy {
            let cancelled = client().post(format!("{}/v1/jobs/{id}/cancel", server.url)).send().await;
            assert_eq!(cancelled.expect("an answer").status(), 202);
        }
    })
    .await;
    assert_eq!((read.increments, read.resumed), (60 * expected.len(), 12 * 3));
    are_whole(&server.url, &jobs, 3, &expected).await;
}
