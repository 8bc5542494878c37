//! A model that ends the process which solves it fails, with the reason, and takes no other job along.

use crate::common::process::{PATIENCE, Process, client, get, has_ended};
use crate::common::server::{CONNECTIONS, any_port};
use crate::common::service::{indices, request};
use crate::common::solver::{ABORTS, MadeUp};
use arcslip::service::http::access::Access;
use arcslip::service::http::server::{ListenOptions, Server};
use arcslip::service::jobs::Settings;
use arcslip::service::store::contract::interface::Store;
use arcslip::service::store::{self, NewJob, Submitted, Task};
use reqwest::Client;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Not a test: the process that the test below starts, with a solver that aborts. It reads on its standard input where its
/// database is.
#[test]
#[ignore = "the process that the other test starts"]
fn serve() {
    let mut database = String::new();
    std::io::stdin().read_line(&mut database).expect("a line");
    let database = PathBuf::from(database.trim_end());
    if database.as_os_str().is_empty() {
        return;
    }
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    runtime.block_on(async {
        let store = store::open(&database).await.expect("the database opens");
        let lease = Duration::from_secs(1);
        let settings = Settings { workers: 3, lease, max_attempts: 3, ..Settings::default() };
        let solver = MadeUp::pausing(Duration::from_millis(1));
        let front = ListenOptions { listen: any_port(), connections: CONNECTIONS, access: Access::loopback() };
        let server = Server::start(front, store, Arc::new(solver), settings).await.expect("the server starts");
        println!("the test's server listens on http://{}", server.address());
        std::future::pending::<()>().await;
    });
}

/// `None`: the model ended it before it could say where it listens.
fn start(folder: &Path) -> Option<Process> {
    let place = folder.join("place");
    std::fs::write(&place, folder.join("jobs.db").display().to_string() + "\n").expect("written");
    let mut command = Command::new(std::env::current_exe().expect("this program"));
    command.args(["--exact", "poison::serve", "--ignored", "--nocapture"]);
    command.stdin(std::fs::File::open(place).expect("a file"));
    command.stderr(std::process::Stdio::null());
    Process::try_start(command)
}

async fn queue(store: &dyn Store, request: &Value) -> String {
    let job = NewJob {
        task: Task::Path,
        owner: None,
        name: None,
        request: request.to_string(),
        plan: "{}".to_owned(),
        summary: None,
        max_increments: request["analysis"]["max_increments"].as_u64().expect("a number"),
        max_attempts: 3,
        most_queued: 100,
        priority: 0,
        idempotency_key: None,
        explore: None,
    };
    match store.submit(job).await.expect("queued") {
        Submitted::Created(job) => job.id.to_string(),
        other => panic!("{other:?}"),
    }
}

/// Whether all of so many jobs have ended before the process does.
async fn outlives(client: &Client, process: &Process, jobs: usize) -> bool {
    while let Some(list) = get(client, &process.url, "/v1/jobs?limit=100").await {
        let listed = list["jobs"].as_array().expect("jobs");
        if listed.len() == jobs && listed.iter().all(has_ended) {
            return true;
        }
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    false
}

#[tokio::test(flavor = "multi_thread")]
async fn a_model_that_ends_its_process_takes_no_other_along() {
    let folder = tempfile::tempdir().expect("a folder");
    let client = client();
    let store = store::open(&folder.path().join("jobs.db")).await.expect("a store");
    let poison = queue(store.as_ref(), &request(ABORTS, 10)).await;
    let mut others = Vec::new();
    for number in 0..6 {
        others.push((500, queue(store.as_ref(), &request(&format!("beside {number}"), 500)).await));
    }
    store.close().await;
    let began = Instant::now();
    let mut lives = 0;
    let process = loop {
        assert!(began.elapsed() < PATIENCE, "{lives} lives");
        lives += 1;
        let Some(process) = start(folder.path()) else { continue };
        if outlives(&client, &process, others.len() + 1).await {
            break process;
        }
        process.gone().await;
    };
    let job: Value = get(&client, &process.url, &format!("/v1/jobs/{poison}")).await.expect("the job");
    // The first does not count where others were lost with it: which of them it was could not be told.
    let losses = job["losses"].as_u64().expect("a number");
    assert_eq!((&job["status"], &job["counted_losses"]), (&json!("failed"), &json!(3)), "{job}");
    assert!((3..=4).contains(&losses) && job["attempt"] == losses, "{job}");
    let error = job["error"].as_str().expect("a text");
    assert!(error.contains(&format!("lost {losses} times in a row")) && error.contains("its process ended"), "{error}");
    assert_eq!(lives, losses + 1, "all but the last were ended by the model");
    for (increments, id) in others {
        let job = get(&client, &process.url, &format!("/v1/jobs/{id}")).await.expect("the job");
        assert_eq!((&job["status"], &job["losses"]), (&json!("completed"), &json!(0)), "{job}");
        let lines = crate::common::process::lines(&client, &process.url, &id).await;
        assert_eq!(indices(lines.iter().map(String::as_str)), (0..increments).collect::<Vec<_>>());
    }
}
