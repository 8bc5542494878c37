//! A copy made while the service works: whole, and a service that is started on it goes on where the copy was made.

use crate::common::process::{Process, client, get, has_ended, lines, solved, submit, until};
use crate::common::service::{in_short_steps, indices, without_elapsed};
use sqlx::SqlitePool;
use sqlx::sqlite::SqliteConnectOptions;
use std::fs::Permissions;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Duration;

fn backup(database: &Path, copy: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_arcslip"));
    command.arg("backup").arg("--database").arg(database).arg(copy);
    command.output().expect("the program runs")
}

#[tokio::test]
async fn a_copy_made_while_a_job_runs_can_be_served_and_the_job_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let (database, copy) = (folder.path().join("jobs.db"), folder.path().join("copy.db"));
    let request = in_short_steps("one-bar-truss", 6000, 6000);
    let undisturbed: Vec<String> = solved(&request).iter().map(|line| without_elapsed(line)).collect();
    let client = client();
    let path = async |server: &Process, id: &str| -> Vec<String> {
        lines(&client, &server.url, id).await.iter().map(|line| without_elapsed(line)).collect()
    };
    let (ended, under_way);
    {
        let server = Process::serve(&database, &["--workers", "1"]);
        ended = submit(&client, &server.url, "/v1/jobs", &in_short_steps("klarbring", 50, 20)).await;
        until(&client, &server.url, &format!("/v1/jobs/{ended}"), has_ended).await;
        under_way = submit(&client, &server.url, "/v1/jobs", &request).await;
        let place = format!("/v1/jobs/{under_way}");
        until(&client, &server.url, &place, |job| job["progress"]["increments"].as_u64() > Some(200)).await;
        let made = backup(&database, &copy);
        assert!(made.status.success(), "{made:?}");
        // The service goes on as if nothing had been.
        until(&client, &server.url, &place, has_ended).await;
        assert!(path(&server, &under_way).await == undisturbed);
    }
    let server = Process::serve(&copy, &["--workers", "1"]);
    let whole: Vec<u64> = (0..=50).collect();
    assert_eq!(indices(lines(&client, &server.url, &ended).await.iter().map(String::as_str)), whole);
    let place = format!("/v1/jobs/{under_way}");
    let job = until(&client, &server.url, &place, has_ended).await;
    assert!(job["attempt"].as_u64() >= Some(2), "it was under way when the copy was made: {job}");
    assert!(path(&server, &under_way).await == undisturbed);
    assert_eq!(get(&client, &server.url, "/readyz").await.expect("an answer")["status"], "ready");
}

#[test]
fn a_copy_takes_nothing_s_place_and_is_of_something() {
    let folder = tempfile::tempdir().expect("a folder");
    let (nothing, copy) = (folder.path().join("nothing.db"), folder.path().join("copy.db"));
    let refused = backup(&nothing, &copy);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    assert!(String::from_utf8_lossy(&refused.stderr).contains("there is no such database"));
    assert!(!nothing.exists() && !copy.exists());
    std::fs::write(&copy, "precious").expect("written");
    std::fs::write(&nothing, "").expect("written");
    assert_eq!(backup(&nothing, &copy).status.code(), Some(2));
    assert_eq!(std::fs::read_to_string(&copy).expect("text"), "precious");
    std::fs::write(&nothing, "no database at all, but long enough to be read as one".repeat(100)).expect("written");
    let copy = folder.path().join("other.db");
    let refused = backup(&nothing, &copy);
    assert_eq!(refused.status.code(), Some(1), "{refused:?}");
    // An empty file is a database to SQLite, and none of jobs.
    std::fs::write(&nothing, "").expect("written");
    let refused = backup(&nothing, &copy);
    assert_eq!(refused.status.code(), Some(1), "{refused:?}");
    assert!(String::from_utf8_lossy(&refused.stderr).contains("no jobs of this program"), "{refused:?}");
    let mut left: Vec<_> =
        std::fs::read_dir(folder.path()).expect("a folder").flatten().map(|file| file.file_name()).collect();
    left.sort();
    assert_eq!(left, ["copy.db", "nothing.db"], "nothing is left of what failed");
}

/// What is broken off has never the copy's name, stands in nobody's way, and is for the same readers as the original.
#[tokio::test]
async fn a_copy_that_is_broken_off_is_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let (database, copy) = (folder.path().join("jobs.db"), folder.path().join("copy.db"));
    let client = client();
    let server = Process::serve(&database, &[]);
    let id = submit(&client, &server.url, "/v1/jobs", &in_short_steps("one-bar-truss", 5000, 5000)).await;
    until(&client, &server.url, &format!("/v1/jobs/{id}"), has_ended).await;
    std::fs::set_permissions(&database, Permissions::from_mode(0o600)).expect("set");
    for milliseconds in [1, 3, 6, 10, 15, 20, 30] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_arcslip"));
        let mut child = command.arg("backup").arg("--database").arg(&database).arg(&copy).spawn().expect("it runs");
        tokio::time::sleep(Duration::from_millis(milliseconds)).await;
        child.kill().expect("killed");
        child.wait().expect("its end");
        if copy.exists() {
            assert!(whole(&copy).await, "{milliseconds} ms");
            std::fs::remove_file(&copy).expect("removed");
        }
    }
    let made = backup(&database, &copy);
    assert!(made.status.success(), "{made:?}");
    assert!(whole(&copy).await);
    assert_eq!(std::fs::metadata(&copy).expect("a file").permissions().mode() & 0o777, 0o600);
}

/// Of two that are made at a time under one name one is the copy, and whole, and the other one is told so.
#[tokio::test]
async fn copies_that_are_made_at_a_time_do_not_disturb_each_other() {
    let folder = tempfile::tempdir().expect("a folder");
    // A name that an unfinished copy could have.
    let (database, copy) = (folder.path().join("copy.db.partial"), folder.path().join("copy.db"));
    let client = client();
    let server = Process::serve(&database, &[]);
    let id = submit(&client, &server.url, "/v1/jobs", &in_short_steps("one-bar-truss", 5000, 5000)).await;
    until(&client, &server.url, &format!("/v1/jobs/{id}"), has_ended).await;
    for milliseconds in [0, 2, 5, 9, 14, 20] {
        let begin = || {
            let mut command = Command::new(env!("CARGO_BIN_EXE_arcslip"));
            command.arg("backup").arg("--database").arg(&database).arg(&copy).spawn().expect("it runs")
        };
        let mut first = begin();
        tokio::time::sleep(Duration::from_millis(milliseconds)).await;
        let mut second = begin();
        let ends = [first.wait().expect("its end").success(), second.wait().expect("its end").success()];
        assert_eq!(ends.iter().filter(|end| **end).count(), 1, "{milliseconds} ms: {ends:?}");
        assert!(whole(&copy).await, "{milliseconds} ms");
        std::fs::remove_file(&copy).expect("removed");
    }
    assert!(database.exists());
    assert_eq!(server.terminated().await.0, Some(0));
}

async fn whole(copy: &Path) -> bool {
    let pool = SqlitePool::connect_with(SqliteConnectOptions::new().filename(copy)).await.expect("a pool");
    let count: i64 = sqlx::query_scalar("SELECT count(*) FROM increments").fetch_one(&pool).await.expect("a number");
    pool.close().await;
    count == 5001
}
