//! Many clients at once: they queue jobs, look at all that came of them, and read streams.

use super::process::{client, get, lines, submit};
use super::reader::{Format, Reader, Said};
use super::service::without_elapsed;
use reqwest::Client;
use serde_json::{Value, json};
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// So many jobs, queued by so many clients; answers their ids.
pub async fn queue(url: &str, request: &Value, jobs: usize, clients: usize) -> Vec<String> {
    let left = Arc::new(AtomicUsize::new(jobs));
    let work = (0..clients).map(|_| {
        let (url, request, left) = (url.to_owned(), request.clone(), Arc::clone(&left));
        tokio::spawn(async move {
            let (client, mut ids) = (client(), Vec::new());
            while left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_ok() {
                ids.push(submit(&client, &url, "/v1/jobs", &request).await);
            }
            ids
        })
    });
    let mut ids = Vec::new();
    for client in work.collect::<Vec<_>>() {
        ids.extend(client.await.expect("a client"));
    }
    ids
}

/// How many jobs have that status, told by the whole list, page by page; each of them once.
pub async fn listed(url: &str, status: &str) -> HashSet<String> {
    let (client, mut seen, mut cursor) = (client(), HashSet::new(), String::new());
    loop {
        let place = format!("/v1/jobs?limit=200&status={status}{cursor}");
        let page = get(&client, url, &place).await.expect("a page");
        for job in page["jobs"].as_array().expect("jobs") {
            assert!(seen.insert(job["id"].as_str().expect("an id").to_owned()), "listed twice: {job}");
        }
        match page["next_cursor"].as_str() {
            Some(next) => cursor = format!("&cursor={next}"),
            None => return seen,
        }
    }
}

/// Waits until nothing is queued or running any more.
pub async fn worked_off(url: &str, patience: Duration) {
    let (client, began) = (client(), Instant::now());
    for status in ["queued", "running"] {
        let place = format!("/v1/jobs?limit=1&status={status}");
        while get(&client, url, &place).await.expect("a page")["jobs"] != json!([]) {
            assert!(began.elapsed() < patience, "jobs are still {status}");
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }
}

/// Every job holds every increment once, as `arcslip solve` has them but for the times; answers how many there are.
pub async fn are_whole(url: &str, ids: &[String], clients: usize, expected: &[String]) -> usize {
    let expected: Arc<[String]> = expected.iter().map(|line| without_elapsed(line)).collect();
    let parts: Vec<_> = ids
        .chunks(ids.len().div_ceil(clients).max(1))
        .map(|ids| {
            let (url, ids, expected) = (url.to_owned(), ids.to_vec(), Arc::clone(&expected));
            tokio::spawn(async move {
                let client = client();
                for id in &ids {
                    let found = lines(&client, &url, id).await;
                    let found = found.iter().map(|line| without_elapsed(line));
                    assert!(found.eq(expected.iter().cloned()), "job {id} is not whole");
                }
                ids.len() * expected.len()
            })
        })
        .collect();
    let mut increments = 0;
    for part in parts {
        increments += part.await.expect("looked at");
    }
    increments
}

/// What came of streams that were open at once.
#[derive(Debug, Default)]
pub struct Streamed {
    pub increments: usize,
    /// Times that a stream was broken off and resumed.
    pub resumed: usize,
    /// From the first reader of an increment to every other, of streams that were not broken off; sorted.
    pub behind: Vec<Duration>,
}

/// A job that is read by several, and when each of its increments was first seen.
struct Read {
    id: String,
    first_seen: Mutex<Vec<Instant>>,
}

/// So many streams of jobs that wait, half of them events and half lines, every fifth of which breaks off again and again;
/// `opened` is called when all of them are open, and has to let the jobs begin.
pub async fn stream_all(
    url: &str,
    jobs: &[String],
    streams: usize,
    increments: usize,
    opened: impl AsyncFnOnce(),
) -> Streamed {
    // Streams last as long as they last.
    let client = Client::builder().no_proxy().build().expect("a client");
    let jobs: Vec<Arc<Read>> =
        jobs.iter().map(|id| Arc::new(Read { id: id.clone(), first_seen: Mutex::default() })).collect();
    let open = Arc::new(tokio::sync::Barrier::new(streams + 1));
    let readers: Vec<_> = (0..streams)
        .map(|number| {
            let job = Arc::clone(&jobs[number % jobs.len()]);
            let format = if (number / jobs.len()).is_multiple_of(2) { Format::Events } else { Format::Lines };
            let part = if number % 5 == 4 { increments / 4 + 1 } else { usize::MAX };
            let (client, url, open) = (client.clone(), url.to_owned(), Arc::clone(&open));
            tokio::spawn(async move { read(&client, &url, &job, format, part, &open).await })
        })
        .collect();
    open.wait().await;
    opened().await;
    let mut all = Streamed::default();
    let mut stored: HashMap<usize, (usize, u64)> = HashMap::new();
    for (number, reader) in readers.into_iter().enumerate() {
        let (read, resumed, behind) = reader.await.expect("a reader");
        let job = number % jobs.len();
        let id = &jobs[job].id;
        if let Entry::Vacant(place) = stored.entry(job) {
            place.insert(hashed(&lines(&client, url, id).await));
        }
        assert_eq!((read, read.0), (stored[&job], increments), "stream {number} of job {id}");
        all.increments += read.0;
        all.resumed += resumed;
        all.behind.extend(behind);
    }
    all.behind.sort();
    all
}

/// Reads to the end, in parts of so many increments; answers their number and a hash of all of them.
async fn read(
    client: &Client,
    url: &str,
    job: &Read,
    format: Format,
    part: usize,
    open: &tokio::sync::Barrier,
) -> ((usize, u64), usize, Vec<Duration>) {
    let (mut hash, mut count, mut resumed, mut behind) = (DefaultHasher::new(), 0, 0, Vec::new());
    let mut reader = Reader::open(client, url, &job.id, format, None).await;
    open.wait().await;
    let mut until = part;
    loop {
        match reader.next().await {
            Said::Increment(index, body) => {
                assert_eq!(index, count as u64, "job {}: missing or twice", job.id);
                body.hash(&mut hash);
                if part == usize::MAX {
                    behind.push(job.seen(count));
                }
                count += 1;
                if count == until {
                    drop(reader);
                    reader = Reader::open(client, url, &job.id, format, Some(index)).await;
                    (until, resumed) = (until + part, resumed + 1);
                }
            }
            Said::End => return ((count, hash.finish()), resumed, behind),
            Said::BrokenOff => panic!("the stream of job {} broke off after {count} increments", job.id),
        }
    }
}

impl Read {
    /// How long ago the first reader had this increment.
    fn seen(&self, index: usize) -> Duration {
        let now = Instant::now();
        let mut first_seen = self.first_seen.lock().expect("a lock");
        match first_seen.get(index) {
            Some(first) => now.saturating_duration_since(*first),
            None => {
                first_seen.push(now);
                Duration::ZERO
            }
        }
    }
}

fn hashed(lines: &[String]) -> (usize, u64) {
    let mut hash = DefaultHasher::new();
    lines.iter().for_each(|line| line.hash(&mut hash));
    (lines.len(), hash.finish())
}
