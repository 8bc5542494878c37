//! The real program, killed with SIGKILL at chosen and at random moments: every job ends once, with every increment once,
//! bit for bit those of an undisturbed run, and a client that comes back sees each of them once.

use crate::common::kills::{Random, assert_undisturbed, strip};
use crate::common::process::{Process, client, get, has_ended, lines, solved, submit, until};
use crate::common::server::{Event, EventStream};
use crate::common::service::{in_short_steps, scene};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Duration;

const ARGUMENTS: [&str; 6] = ["--workers", "2", "--lease", "400ms", "--max-attempts", "50"];

/// Reads a job's events through every restart until its `end`.
async fn read_on(url: Arc<Mutex<String>>, id: String) -> Vec<Event> {
    let client = client();
    let mut events: Vec<Event> = Vec::new();
    loop {
        let address = format!("{}/v1/jobs/{id}/stream", url.lock().expect("a lock"));
        let mut ask = client.get(address);
        if let Some(last) = events.last() {
            ask = ask.header("last-event-id", last.id.as_str());
        }
        if let Ok(answer) = ask.send().await {
            let mut stream = EventStream::of(answer);
            while let Some(Some(event)) = stream.try_next().await {
                match event.event.as_str() {
                    "increment" => events.push(event),
                    "end" => return events,
                    "" => {}
                    other => panic!("{other}"),
                }
            }
        }
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
}

/// Kinds of jobs that go through the kills: in few unknowns and in more, plain and with directions, of several stages, in
/// space, by the method that cannot be put down, and with few of their increments recorded.
fn kinds() -> Vec<Value> {
    let mut plain = in_short_steps("one-bar-truss", 6000, 6000);
    plain["analysis"]["record"] = json!({"directions": false});
    let mut sparse = in_short_steps("two-snapping-bars", 3000, 1000);
    sparse["analysis"]["record"] = json!({"every": 7});
    let mut rival = scene("klarbring");
    rival["analysis"]["method"] = json!("regularised");
    vec![
        plain,
        in_short_steps("one-bar-truss", 1500, 600),
        in_short_steps("klarbring", 2000, 300),
        in_short_steps("curving-slip", 600, 300),
        sparse,
        rival,
        in_short_steps("arch-type-truss", 800, 300),
        in_short_steps("turning-drag", 800, 200),
    ]
}

#[tokio::test(flavor = "multi_thread")]
async fn forty_kills_at_random_moments() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let kinds = kinds();
    let expected: Vec<Vec<String>> = kinds.iter().map(|request| strip(&solved(request))).collect();
    let mut random = Random::fixed();
    let client = client();
    let mut process = Process::serve(&database, &ARGUMENTS);
    let url = Arc::new(Mutex::new(process.url.clone()));
    let mut jobs: HashMap<String, usize> = HashMap::new();
    let mut readers = Vec::new();
    let mut submitted = 0;
    let mut interrupted = 0;
    for _ in 0..40 {
        // Always some at work and some that wait.
        let now = url.lock().expect("a lock").clone();
        let listed = until(&client, &now, "/v1/jobs?limit=200", |list| list["jobs"].is_array()).await;
        let open = listed["jobs"].as_array().expect("jobs").iter().filter(|job| !has_ended(job)).count();
        for _ in open..4 {
            let kind = submitted % kinds.len();
            submitted += 1;
            let id = submit(&client, &now, "/v1/jobs", &kinds[kind]).await;
            readers.push((kind, tokio::spawn(read_on(Arc::clone(&url), id.clone()))));
            jobs.insert(id, kind);
        }
        tokio::time::sleep(Duration::from_millis(random.next(700))).await;
        if let Some(running) = get(&client, &now, "/v1/jobs?status=running").await {
            interrupted += running["jobs"].as_array().map_or(0, Vec::len);
        }
        process.kill();
        process = Process::serve(&database, &ARGUMENTS);
        process.url.clone_into(&mut url.lock().expect("a lock"));
    }
    for (id, kind) in &jobs {
        assert_undisturbed(&client, &process.url, id, &expected[*kind]).await;
    }
    for (kind, reader) in readers {
        let read: Vec<String> = reader.await.expect("read").into_iter().map(|event| event.data).collect();
        assert_eq!(strip(&read), expected[kind], "a client that comes back sees each once");
    }
    println!("{} jobs, {interrupted} of them running when killed", jobs.len());
    assert!(interrupted >= 20, "the kills hit nothing");
    nothing_is_left_over(&database).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn ten_kills_at_chosen_moments() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let request = in_short_steps("one-bar-truss", 1500, 600);
    let expected = strip(&solved(&request));
    let client = client();
    let mut process = Process::serve(&database, &ARGUMENTS);
    let id = submit(&client, &process.url, "/v1/jobs", &request).await;
    let place = format!("/v1/jobs/{id}");
    // What has been answered is there, whatever comes next.
    process.kill();
    process = Process::serve(&database, &ARGUMENTS);
    for reached in [1, 2, 100, 400, 700, 1000] {
        until(&client, &process.url, &place, |job| job["progress"]["increments"].as_u64() >= Some(reached)).await;
        process.kill();
        process = Process::serve(&database, &ARGUMENTS);
    }
    until(&client, &process.url, &place, has_ended).await;
    process.kill();
    process = Process::serve(&database, &ARGUMENTS);
    let job = get(&client, &process.url, &place).await.expect("the job");
    assert!(has_ended(&job) && job["losses"] == 0, "{job}");
    assert_undisturbed(&client, &process.url, &id, &expected).await;

    // A job that follows another, and a study.
    let listing = expected.iter().map(|line| serde_json::from_str::<Value>(&line.replace(":?", ":0")).expect("JSON"));
    let from = listing.into_iter().find(|one| one["point"]["bifurcation"] == true).expect("a bifurcation point");
    let directions = from["directions"].as_array().expect("directions");
    let other = directions.iter().position(|one| one["taken"] == false && one["retrace"] != true).expect("another");
    let body = json!({"increment": from["index"], "direction": other});
    let followed = |url: &str| format!("{url}/v1/jobs/{id}/follow");
    let follow = async |url: &str| -> String {
        let answer = client.post(followed(url)).json(&body).send().await.expect("an answer");
        answer.json::<Value>().await.expect("a job")["id"].as_str().expect("an id").to_owned()
    };
    let undisturbed = follow(&process.url).await;
    until(&client, &process.url, &format!("/v1/jobs/{undisturbed}"), has_ended).await;
    let expected = strip(&lines(&client, &process.url, &undisturbed).await);
    let id = follow(&process.url).await;
    let place = format!("/v1/jobs/{id}");
    until(&client, &process.url, &place, |job| job["progress"]["increments"].as_u64() >= Some(50)).await;
    process.kill();
    process = Process::serve(&database, &ARGUMENTS);
    assert_undisturbed(&client, &process.url, &id, &expected).await;

    let mut study = scene("klarbring");
    study["study"] = json!({"arc_lengths": [0.02, 0.01, 0.005, 0.002], "methods": ["auto"], "repeats": 5});
    let id = submit(&client, &process.url, "/v1/studies", &study).await;
    let place = format!("/v1/studies/{id}");
    until(&client, &process.url, &place, |study| study["progress"]["runs"].as_u64() >= Some(2)).await;
    process.kill();
    process = Process::serve(&database, &ARGUMENTS);
    let study = until(&client, &process.url, &place, has_ended).await;
    assert_eq!(
        (&study["status"], &study["progress"]["runs"]),
        (&json!("completed"), &study["progress"]["of"]),
        "{study}"
    );
    nothing_is_left_over(&database).await;
}

/// Checkpoints are dropped at the end of their jobs, and the database is whole.
async fn nothing_is_left_over(database: &Path) {
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(database);
    let pool = sqlx::SqlitePool::connect_with(options).await.expect("a pool");
    for table in ["checkpoints", "checkpoint_trails"] {
        let count = sqlx::AssertSqlSafe(format!("SELECT count(*) FROM {table}"));
        let rows: i64 = sqlx::query_scalar(count).fetch_one(&pool).await.expect("a count");
        assert_eq!(rows, 0, "{table}");
    }
    let whole: String = sqlx::query_scalar("PRAGMA integrity_check").fetch_one(&pool).await.expect("an answer");
    assert_eq!(whole, "ok");
}
