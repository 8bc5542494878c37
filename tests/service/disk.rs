//! The disk itself: full, and damaged. What is stored stands, what is wrong is told, and room is all that it takes to go on.

use crate::common::process::{PATIENCE, Process, client, get, has_ended, lines, solved, submit, until};
use crate::common::server::TestServer;
use crate::common::service::{in_short_steps, scene, without_elapsed};
use arcslip::service::jobs::PathSolver;
use reqwest::StatusCode;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The program on a disk of its own of so many MiB, a tmpfs in a mount namespace that ends with it; `None` where the system
/// lets nobody make one.
fn on_a_small_disk(megabytes: u32, arguments: &[&str]) -> Option<(Process, PathBuf, tempfile::TempDir)> {
    let folder = tempfile::tempdir().expect("a folder");
    let mount = format!("mount -t tmpfs -o size={megabytes}m tmpfs {}", folder.path().display());
    let may = Command::new("unshare").args(["-rm", "sh", "-c", &mount]).stderr(Stdio::null()).status();
    if !may.is_ok_and(|status| status.success()) {
        return None;
    }
    let mut command = Command::new("unshare");
    command.args(["-rm", "sh", "-c", &format!("{mount} && exec \"$@\""), "sh", env!("CARGO_BIN_EXE_arcslip"), "serve"]);
    command.args(["--listen", "127.0.0.1:0", "--database"]).arg(folder.path().join("jobs.db")).args(arguments);
    command.env("RUST_LOG", "off");
    let process = Process::start(command);
    // The disk as it is seen from out here.
    let seen = PathBuf::from(format!("/proc/{}/root{}", process.id(), folder.path().display()));
    Some((process, seen, folder))
}

/// What would be written to a file that has no name any more would be lost with the process.
#[tokio::test]
async fn a_database_that_has_been_removed_takes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let server = TestServer::start(&database, PathSolver).await;
    let id = server.submit(&scene("klarbring")).await;
    server.ended(&id).await;
    std::fs::rename(&database, folder.path().join("elsewhere.db")).expect("moved");
    for _ in 0..2 {
        assert_eq!(server.get("/readyz").await.status(), StatusCode::SERVICE_UNAVAILABLE);
        assert_eq!(server.post("/v1/jobs", &scene("klarbring")).await.status(), StatusCode::SERVICE_UNAVAILABLE);
        std::fs::write(&database, "another file").expect("written");
    }
    std::fs::rename(folder.path().join("elsewhere.db"), &database).expect("moved back");
    assert_eq!(server.get("/readyz").await.status(), StatusCode::OK);
    assert_eq!(server.get_json(&format!("/v1/jobs/{id}")).await["status"], "completed");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_full_disk_keeps_what_is_stored_and_takes_up_again_when_there_is_room() {
    let Some((process, disk, _folder)) = on_a_small_disk(96, &["--workers", "2", "--lease", "1s"]) else {
        println!("skipped: nobody may mount a disk here");
        return;
    };
    let (client, url) = (client(), process.url.clone());
    let small = scene("klarbring");
    let kept = submit(&client, &url, "/v1/jobs", &small).await;
    until(&client, &url, &format!("/v1/jobs/{kept}"), has_ended).await;
    let before = lines(&client, &url, &kept).await;
    // All but 4 MiB of the disk is somebody else's.
    let ballast = disk.join("ballast");
    std::fs::write(&ballast, vec![1_u8; 92 << 20]).expect("written");
    let mut large = in_short_steps("one-bar-truss", 12_000, 12_000);
    large["analysis"]["record"] = json!({"directions": false, "elements": "none", "supports": "none"});
    let expected: Vec<String> = solved(&large).iter().map(|line| without_elapsed(line)).collect();
    let id = submit(&client, &url, "/v1/jobs", &large).await;
    let place = format!("/v1/jobs/{id}");
    // Until the disk is full: then nothing is taken, and that is told.
    let began = Instant::now();
    let refused = loop {
        let answer = client.post(format!("{url}/v1/jobs")).json(&small).send().await.expect("an answer");
        if answer.status() == StatusCode::INSUFFICIENT_STORAGE {
            break answer.json::<Value>().await.expect("a problem");
        }
        let job = get(&client, &url, &place).await.expect("the job");
        if job["status"] == "failed" {
            // The end found room where the increments did not.
            break json!({"type": "/problems/storage-full"});
        }
        assert!(began.elapsed() < PATIENCE, "{job}");
        tokio::time::sleep(Duration::from_millis(20)).await;
    };
    assert_eq!(refused["type"], "/problems/storage-full", "{refused}");
    assert_eq!(lines(&client, &url, &kept).await, before, "what is stored can be read");
    assert_eq!(get(&client, &url, "/healthz").await.expect("an answer")["status"], "alive");

    std::fs::remove_file(&ballast).expect("removed");
    // It fails with the reason or, where not even that could be stored, goes on.
    let job = until(&client, &url, &place, has_ended).await;
    let found: Vec<String> = lines(&client, &url, &id).await.iter().map(|line| without_elapsed(line)).collect();
    if job["status"] == "failed" {
        assert!(job["error"].as_str().expect("a text").contains("the disk that holds the database is full"), "{job}");
        assert!(!found.is_empty() && found.len() < expected.len() && found == expected[..found.len()]);
    } else {
        assert!(found == expected, "{job}");
    }
    println!("the job {} with {} of {} increments", job["status"], found.len(), expected.len());
    until(&client, &url, "/readyz", |ready| ready["status"] == "ready").await;
    let again = submit(&client, &url, "/v1/jobs", &large).await;
    let job = until(&client, &url, &format!("/v1/jobs/{again}"), has_ended).await;
    assert!(matches!(job["status"].as_str(), Some("completed" | "stopped")), "{job}");
    let found: Vec<String> = lines(&client, &url, &again).await.iter().map(|line| without_elapsed(line)).collect();
    assert!(found == expected);
}

#[tokio::test]
async fn a_damaged_page_is_found_and_told_and_nothing_is_written_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let server = TestServer::start(&database, PathSolver).await;
    let id = server.submit(&in_short_steps("one-bar-truss", 600, 600)).await;
    server.ended(&id).await;
    let whole = server.lines(&id).await;
    assert!(server.stop().await);
    // Every third page from the middle on.
    let mut bytes = std::fs::read(&database).expect("the database");
    let page = 4096;
    assert!(bytes.len() > 100 * page);
    for start in (bytes.len() / page / 2..bytes.len() / page).step_by(3) {
        bytes[start * page..(start + 1) * page].fill(0xA5);
    }
    std::fs::write(&database, &bytes).expect("written");

    let server = TestServer::start(&database, PathSolver).await;
    let began = Instant::now();
    loop {
        let answer = server.get("/readyz").await;
        if answer.status() == 503 {
            let problem: Value = answer.json().await.expect("a problem");
            // A busy machine may say first that the database does not answer.
            if problem["detail"].as_str().expect("a text").contains("the database is damaged") {
                break;
            }
        }
        assert!(began.elapsed() < PATIENCE, "it is not found");
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
    let answer = server.post("/v1/jobs", &scene("klarbring")).await;
    assert_eq!(answer.status(), 500);
    let problem: Value = answer.json().await.expect("a problem");
    assert_eq!(problem["type"], "/problems/storage-damaged", "{problem}");
    assert_eq!(server.get_json("/healthz").await["status"], "alive");
    // Increments come as they were stored, or not at all.
    let answer = server.get(&format!("/v1/jobs/{id}/increments?limit=10000")).await;
    if answer.status() == 200 {
        let page: Value = answer.json().await.expect("JSON");
        for (place, increment) in page["increments"].as_array().expect("increments").iter().enumerate() {
            assert_eq!(increment, &serde_json::from_str::<Value>(&whole[place]).expect("JSON"));
        }
    } else {
        assert_eq!(answer.json::<Value>().await.expect("a problem")["type"], "/problems/storage-damaged");
    }
    assert!(server.stop().await);
}
