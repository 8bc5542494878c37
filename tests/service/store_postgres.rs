//! What only PostgreSQL asks for: where it is and that its password is not told, schemas of other versions beside this one, and
//! calls that come back when the line does.

use crate::common::cut::Proxy;
use crate::common::engines::{Database, batch, job, line, queued};
use crate::common::postgres::shared;
use arcslip::service::store::{self, Location, StoreError};
use sqlx::postgres::{PgConnectOptions, PgConnection};
use sqlx::{AssertSqlSafe, ConnectOptions, Connection};
use std::process::Command;
use std::str::FromStr;
use std::time::{Duration, Instant};

const MINUTE: Duration = Duration::from_secs(60);

async fn connected(url: &str) -> PgConnection {
    PgConnectOptions::from_str(url).expect("a URL").connect().await.expect("a connection")
}

async fn not_opened(url: &str) -> String {
    match store::open(Location::from(url)).await {
        Err(error @ StoreError::Open(_)) => format!("{error} {error:?}"),
        Err(other) => panic!("{other:?}"),
        Ok(_) => panic!("{url} opens"),
    }
}

#[tokio::test]
async fn what_cannot_be_opened_says_why_and_no_password() {
    for (url, says) in [
        ("postgres://anna:secret@127.0.0.1:1/jobs", "refused"),
        ("postgres://anna:secret@127.0.0.1:nowhere/jobs", "%2F"),
        ("postgres://anna:sec/ret@127.0.0.1/secret", "%2F"),
        ("postgres://127.0.0.1/jobs?password=secret&sslmode=require", "does not encrypt"),
        ("postgres://127.0.0.1/jobs?passwort=secret", "known are application_name"),
    ] {
        let error = not_opened(url).await;
        assert!(error.contains(says), "{error}");
        assert!(!error.contains("secret") && !error.contains("sec/"), "{error}");
    }
}

#[test]
fn a_password_stands_in_no_output_of_the_program() {
    let url = "postgres://anna:secret@127.0.0.1:1/jobs";
    for (arguments, status) in [
        (vec!["serve", "--listen", "127.0.0.1:0"], 1),
        (vec!["work"], 1),
        (vec!["backup", "copy"], 2),
        (vec!["serve", "--help"], 0),
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_arcslip"));
        command.args(&arguments).env("RUST_LOG", "debug");
        let by_flag = Command::new(env!("CARGO_BIN_EXE_arcslip")).args(&arguments).args(["--database", url]).output();
        for output in [command.env("ARCSLIP_DATABASE", url).output(), by_flag] {
            let output = output.expect("the program runs");
            assert_eq!(output.status.code(), Some(status), "{arguments:?}: {output:?}");
            let said =
                format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
            assert!(!said.contains("secret"), "{said}");
            assert!(status == 0 || said.contains("anna@127.0.0.1:1/jobs"), "{said}");
            assert!(!arguments.contains(&"backup") || said.contains("pg_dump"), "{said}");
        }
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn processes_that_begin_at_once_make_one_schema() {
    let Some(database) = Database::postgres().await else { return };
    let mut opened = Vec::new();
    for _ in 0..6 {
        let location = database.location.clone();
        let runtime = tokio::runtime::Handle::current();
        opened.push(tokio::task::spawn_blocking(move || runtime.block_on(store::open(location)).map(drop)));
    }
    for one in opened {
        one.await.expect("it ends").expect("a store");
    }
    // One row of the first schema, and one of each that those before cannot live with.
    assert_eq!(database.count("compatibility").await, 2);
}

/// A later version has only added, unless it says so.
#[tokio::test(flavor = "multi_thread")]
async fn a_process_goes_on_with_a_schema_of_a_later_version_unless_that_says_otherwise() {
    let Some(database) = Database::postgres().await else { return };
    let before = database.open().await;
    let mut later = connected(&database.location.to_string()).await;
    for change in [
        "ALTER TABLE jobs ADD COLUMN machine TEXT",
        "ALTER TABLE increments ADD COLUMN colour BIGINT NOT NULL DEFAULT 7",
        "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time) \
         VALUES (99, 'later', true, '', 0)",
    ] {
        sqlx::query(AssertSqlSafe(change.to_owned())).execute(&mut later).await.expect("changed");
    }
    // What ran before it, and what begins after it.
    for store in [before.clone(), database.open().await] {
        queued(store.as_ref(), job(3)).await;
        let lease = store.claim("worker", MINUTE).await.expect("an answer").expect("a job").lease;
        store.append(&lease, &batch(&[line(0, "{}")]), MINUTE).await.expect("stored");
        assert!(store.job(lease.job).await.expect("an answer").is_some());
    }
    sqlx::query("INSERT INTO compatibility VALUES (99)").execute(&mut later).await.expect("changed");
    later.close().await.expect("closed");
    let refused = not_opened(&database.location.to_string()).await;
    assert!(refused.contains("asks for schema 99, and this one knows 9"), "{refused}");
    assert!(before.probe().await.is_ok(), "whoever is at work goes on");
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_no_database_of_utf8_is_refused() {
    let Some(server) = shared() else { return };
    let mut connection = server.connected().await;
    let create = "CREATE DATABASE old_letters ENCODING 'LATIN1' TEMPLATE template0";
    sqlx::query(create).execute(&mut connection).await.expect("created");
    let refused = not_opened(&format!("postgres://arcslip@127.0.0.1:{}/old_letters", server.port())).await;
    assert!(refused.contains("LATIN1") && refused.contains("ENCODING 'UTF8'"), "{refused}");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_line_that_was_cut_is_told_as_passing_and_comes_back() {
    let Some(server) = shared() else { return };
    let proxy = Proxy::to(server.port()).await;
    let url = server.database().await;
    let store = store::open(Location::from(proxy.of(&url, server.port()).as_str())).await.expect("a store");
    queued(store.as_ref(), job(3)).await;
    proxy.cut();
    tokio::time::sleep(Duration::from_millis(100)).await;
    let cut = store.probe().await.expect_err("the line is cut");
    assert!(matches!(cut, StoreError::Unavailable(_)), "{cut:?}");
    let missed = store.claim("worker", MINUTE).await.expect_err("the line is cut");
    assert!(missed.is_passing(), "{missed:?}");
    proxy.whole();
    let began = Instant::now();
    while store.probe().await.is_err() {
        assert!(began.elapsed() < MINUTE, "it does not come back");
    }
    let claim = store.claim("worker", MINUTE).await.expect("an answer").expect("a job");
    // As if the answer to it had been lost: the same worker has it again, at no cost.
    proxy.cut();
    tokio::time::sleep(Duration::from_millis(100)).await;
    store.claim("worker", MINUTE).await.expect_err("the line is cut");
    proxy.whole();
    let began = Instant::now();
    // There may be further connections that were cut.
    let again = loop {
        match store.claim("worker", MINUTE).await {
            Ok(found) => break found.expect("a job"),
            Err(error) => assert!(error.is_passing() && began.elapsed() < MINUTE, "{error:?}"),
        }
    };
    assert_eq!(again.lease, claim.lease);
    assert!(store.claim("worker", MINUTE).await.expect("an answer").is_none(), "once");
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_that_another_transaction_only_keeps_from_deletion_is_claimed_in_its_turn() {
    let Some(postgres) = shared() else { return };
    let url = postgres.database().await;
    let store = store::open(Location::from(url.as_str())).await.expect("a store");
    let first = queued(store.as_ref(), job(3)).await;
    queued(store.as_ref(), job(3)).await;
    let mut other = connected(&url).await;
    let mut transaction = other.begin().await.expect("a transaction");
    sqlx::query("SELECT id FROM jobs FOR KEY SHARE").fetch_all(&mut *transaction).await.expect("the jobs");
    let claim = store.claim("worker", MINUTE).await.expect("an answer").expect("a job");
    assert_eq!(claim.lease.job, first);
}
