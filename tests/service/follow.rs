//! Jobs that follow a direction of another: exact values, histories, generations, explorations, restarts, refusals.

use crate::common::server::{TestServer, settings};
use crate::common::service::{scene, without_elapsed};
use arcslip::service::jobs::{PathSolver, Settings};
use arcslip::service::store::{self, LeaseAnswer, Line, Page};
use reqwest::{Method, StatusCode};
use serde_json::{Value, json};
use std::path::Path;
use std::time::Duration;

/// The one-bar truss with a path short enough to be traced often.
fn one_bar() -> Value {
    let mut request = scene("one-bar-truss");
    request["model"]["stages"][0]["until"] = json!({"displacement": {"node": "tip", "component": "x", "above": 2.0}});
    request
}

fn waiting() -> Settings {
    Settings { workers: 0, ..settings() }
}

async fn increments(server: &TestServer, id: &str) -> Vec<Value> {
    server.lines(id).await.iter().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn other_direction(increment: &Value) -> usize {
    let directions = increment["directions"].as_array().expect("directions");
    let is_other = |direction: &Value| direction["taken"] == false && direction["retrace"] != true;
    directions.iter().position(is_other).expect("an alternative")
}

async fn follow(server: &TestServer, id: &str, body: &Value) -> Value {
    let answer = server.post(&format!("/v1/jobs/{id}/follow"), body).await;
    let status = answer.status();
    let location = answer.headers().get("location").map(|place| place.to_str().expect("text").to_owned());
    let job: Value = answer.json().await.expect("JSON");
    assert_eq!(status, StatusCode::ACCEPTED, "{job}");
    assert_eq!(location, Some(format!("/v1/jobs/{}", name(&job))));
    job
}

fn name(job: &Value) -> &str {
    job["id"].as_str().expect("an id")
}

/// `s = P (μ - x)/L` with `P = 1 - L/L0`: the load at which the tip at `x` slips against friction `μ`.
fn slipping_load(increment: &Value, friction: f64) -> f64 {
    let x = number(&increment["displacements"]["tip"][0]) - 1.5;
    let (length, rest) = (x.hypot(1.0), 1.5_f64.hypot(1.0));
    (1.0 - length / rest) * (friction - x) / length
}

fn first_event(path: &[Value]) -> &Value {
    path[1..].iter().find(|increment| !increment["point"]["event"].is_null()).expect("an event")
}

#[tokio::test]
async fn a_direction_is_followed_with_its_history_and_once_more_from_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let root = server.submit(&one_bar()).await;
    let job = server.ended(&root).await;
    assert!(job["parent"].is_null() && job["explore"].is_null());
    let path = increments(&server, &root).await;
    let falling = |increment: &&Value| {
        increment["point"]["bifurcation"] == true && number(&increment["displacements"]["tip"][0]) > 1.2
    };
    let from = path.iter().find(falling).expect("a bifurcation point");
    let (index, direction) = (from["index"].clone(), other_direction(from));
    let queued = follow(&server, &root, &json!({"increment": index, "direction": direction})).await;
    let parent = json!({"job": root, "increment": index, "direction": direction});
    assert_eq!(queued["parent"], parent);
    assert_eq!((&queued["name"], &queued["plan"]), (&job["name"], &job["plan"]));
    let stuck = server.ended(name(&queued)).await;
    assert_eq!(stuck["parent"], parent);

    let path = increments(&server, name(&queued)).await;
    let start = &path[0];
    assert_eq!(start["point"]["kind"], "start");
    let event = format!("follows direction {direction} of increment {index} of job {root}");
    assert_eq!(start["point"]["event"], event);
    for carried in ["load_factor", "arc_length", "displacements", "energy", "stage"] {
        assert_eq!(start[carried], from[carried], "{carried}");
    }
    assert_eq!(start["contacts"][0]["normal_reaction"], from["contacts"][0]["normal_reaction"]);
    assert_eq!(start["directions"][direction]["taken"], true);
    // Stuck, the tip stays and the load falls, to exactly where the other side of the cone is reached.
    let corner = first_event(&path);
    assert_eq!(corner["point"]["kind"], "nonsmooth_limit");
    assert!((number(&corner["displacements"]["tip"][0]) - number(&from["displacements"]["tip"][0])).abs() < 1e-13);
    assert!((number(&corner["load_factor"]) - slipping_load(from, -0.3)).abs() < 1e-12);
    assert!((number(&corner["energy"]["dissipated"]) - number(&from["energy"]["dissipated"])).abs() < 1e-13);

    // From where the tip slips back it sticks once more, and the load rises to the first side of the cone.
    let back = path
        .iter()
        .find(|increment| {
            increment["contacts"][0]["status"] == "slip" && number(&increment["contacts"][0]["slip"][0]) < 0.0
        })
        .expect("the tip slips back");
    let asked = json!({"increment": back["index"], "direction": other_direction(back), "max_increments": 12});
    let grandchild = follow(&server, name(&queued), &asked).await;
    let ended = server.ended(name(&grandchild)).await;
    assert_eq!((&ended["status"], &ended["progress"]["max_increments"]), (&json!("completed"), &json!(12)));
    let path = increments(&server, name(&grandchild)).await;
    assert_eq!((path[0]["energy"].clone(), path.len()), (back["energy"].clone(), 13));
    assert!((number(&first_event(&path)["load_factor"]) - slipping_load(back, 0.3)).abs() < 1e-12);

    assert_eq!(server.get_json(&format!("/v1/jobs/{root}")).await["children"], 1);
    let children = server.get_json(&format!("/v1/jobs?parent={root}")).await;
    assert_eq!(children["jobs"].as_array().map(Vec::len), Some(1));
    assert_eq!(children["jobs"][0]["id"], queued["id"]);
    assert_eq!(server.get_json(&format!("/v1/jobs?parent={root}&status=queued")).await["jobs"], json!([]));
}

#[tokio::test]
async fn a_follower_stands_on_its_own_and_is_taken_up_by_another_process() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let server = TestServer::start(&database, PathSolver).await;
    let root = server.submit(&one_bar()).await;
    server.ended(&root).await;
    let path = increments(&server, &root).await;
    let from = path.iter().find(|increment| increment["point"]["bifurcation"] == true).expect("a bifurcation point");
    let asked = json!({"increment": from["index"], "direction": other_direction(from)});
    let undisturbed = follow(&server, &root, &asked).await;
    server.ended(name(&undisturbed)).await;
    let expected = server.lines(name(&undisturbed)).await;
    assert!(expected.len() > 5);
    assert!(server.stop().await);

    // Queued where nobody works, the one it follows deleted, begun by a worker that is lost after four increments.
    let server = TestServer::start_with(&database, PathSolver, waiting()).await;
    let with_key = async |key: &'static str, asked: &Value| {
        let call = server.ask(Method::POST, &format!("/v1/jobs/{root}/follow")).header("Idempotency-Key", key);
        let answer = call.json(asked).send().await.expect("an answer");
        (answer.status(), answer.json::<Value>().await.expect("JSON"))
    };
    let (status, queued) = with_key("once", &asked).await;
    assert_eq!(status, StatusCode::ACCEPTED);
    let gone = server.ask(Method::DELETE, &format!("/v1/jobs/{root}")).send().await.expect("an answer");
    assert_eq!(gone.status(), StatusCode::NO_CONTENT);
    // A client that did not hear the answer asks again.
    let (status, again) = with_key("once", &asked).await;
    assert_eq!((status, &again["id"]), (StatusCode::ACCEPTED, &queued["id"]));
    let elsewhere = json!({"increment": 0, "direction": 0});
    assert_eq!(with_key("once", &elsewhere).await.0, StatusCode::UNPROCESSABLE_ENTITY);
    assert_eq!(with_key("another", &asked).await.0, StatusCode::NOT_FOUND);
    assert!(server.stop().await);
    let lost = store::open(&database).await.expect("a store");
    let claim = lost.claim("lost", Duration::from_secs(60)).await.expect("a claim").expect("a job");
    assert_eq!(claim.lease.job.to_string(), name(&queued));
    let stored: Vec<Line> =
        (0..4).zip(&expected).map(|(index, body)| Line { index, body: body.clone(), branch: None }).collect();
    let answer = lost.append(&claim.lease, &stored.into(), Duration::from_millis(50)).await.expect("stored");
    assert_eq!(answer, LeaseAnswer::Held { cancel_requested: false });

    let server = TestServer::start(&database, PathSolver).await;
    let job = server.ended(name(&queued)).await;
    assert_eq!(job["attempt"], 2);
    assert_eq!(job["parent"]["job"], root.as_str(), "the parent is named though it is gone");
    let strip = |lines: &[String]| lines.iter().map(|line| without_elapsed(line)).collect::<Vec<_>>();
    assert_eq!(strip(&server.lines(name(&queued)).await), strip(&expected));
}

#[tokio::test]
async fn what_cannot_be_followed_is_refused_with_its_place_and_what_would_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let server = TestServer::start(&database, PathSolver).await;
    let root = server.submit(&scene("klarbring")).await;
    server.ended(&root).await;
    let path = increments(&server, &root).await;
    let listing = path.iter().find(|increment| !increment["directions"].is_null()).expect("directions");
    let plain = path.iter().find(|increment| increment["directions"].is_null()).expect("one way on");
    let listed = listing["directions"].as_array().expect("directions").len();
    let place = format!("/v1/jobs/{root}/follow");
    let whole = format!("0 to {} would do", listed - 1);
    for (body, pointer, tells) in [
        (json!({"increment": listing["index"], "direction": listed}), "/direction", whole.as_str()),
        (json!({"increment": listing["index"], "direction": u64::MAX}), "/direction", whole.as_str()),
        (json!({"increment": plain["index"], "direction": 0}), "/increment", "one way on"),
        (json!({"increment": path.len(), "direction": 0}), "/increment", "it is not stored"),
        (json!({"increment": u64::MAX, "direction": 0}), "/increment", "it is not stored"),
        (json!({"increment": -1, "direction": 0}), "/increment", "not negative"),
        (json!({"increment": 1.5, "direction": 0}), "/increment", "whole number"),
        (json!({"increment": 1}), "", "`direction` is missing"),
        (json!({"increment": 1, "direction": 0, "depth": 2}), "/depth", "unknown field"),
        (json!({"increment": 1, "direction": 0, "max_increments": 0}), "/max_increments", "1 to "),
        (json!([]), "", "an object"),
    ] {
        let answer = server.post(&place, &body).await;
        assert_eq!(answer.status(), StatusCode::UNPROCESSABLE_ENTITY, "{body}");
        assert_eq!(answer.headers()["content-type"], "application/problem+json");
        let problem: Value = answer.json().await.expect("a problem");
        let no_direction = ["would do", "one way on", "not stored"].iter().any(|words| tells.contains(words));
        let kind = if no_direction { "not-followable" } else { "invalid-model" };
        assert_eq!(problem["type"], format!("/problems/{kind}"), "{body}");
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{body}: {problem}");
        assert!(problem["errors"][0]["detail"].as_str().expect("text").contains(tells), "{body}: {problem}");
    }
    let unknown = "/v1/jobs/00000000-0000-7000-8000-000000000000/follow";
    let sound = json!({"increment": listing["index"], "direction": 0});
    assert_eq!(server.post(unknown, &sound).await.status(), StatusCode::NOT_FOUND);
    let text = server.ask(Method::POST, &place).header("content-type", "application/json").body("{").send();
    assert_eq!(text.await.expect("an answer").status(), StatusCode::BAD_REQUEST);
    assert_eq!(server.get_json("/v1/jobs").await["jobs"].as_array().map(Vec::len), Some(1), "nothing was queued");

    // A model that this version no longer takes.
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(&database);
    let pool = sqlx::SqlitePool::connect_with(options).await.expect("a pool");
    sqlx::query("UPDATE jobs SET request = '{\"model\": {}}'").execute(&pool).await.expect("changed");
    let problem: Value = server.post(&place, &sound).await.json().await.expect("a problem");
    assert_eq!((&problem["status"], &problem["errors"][0]["pointer"]), (&json!(422), &json!("")));
    assert!(problem["detail"].as_str().expect("text").contains("no longer accepted"), "{problem}");
    // Increments stored before there were branches.
    sqlx::query("DELETE FROM branches").execute(&pool).await.expect("changed");
    let problem: Value = server.post(&place, &sound).await.json().await.expect("a problem");
    assert_eq!(problem["errors"][0]["pointer"], "/increment");
    assert!(problem["detail"].as_str().expect("text").contains("trace the path anew"), "{problem}");
}

#[tokio::test]
async fn an_idempotency_key_queues_one_follower() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let root = server.submit(&one_bar()).await;
    server.ended(&root).await;
    let path = increments(&server, &root).await;
    let from = path.iter().find(|increment| increment["point"]["bifurcation"] == true).expect("a bifurcation point");
    let asked = json!({"increment": from["index"], "direction": other_direction(from)});
    let send = |path: String, body: Value| {
        server.ask(Method::POST, &path).header("idempotency-key", "once").json(&body).send()
    };
    let place = format!("/v1/jobs/{root}/follow");
    let first: Value = send(place.clone(), asked.clone()).await.expect("an answer").json().await.expect("a job");
    let again: Value = send(place.clone(), asked.clone()).await.expect("an answer").json().await.expect("a job");
    assert_eq!(first["id"], again["id"]);
    let mut other = asked.clone();
    other["max_increments"] = 3.into();
    for (place, body) in [(place, other), ("/v1/jobs".to_owned(), one_bar())] {
        let reused = send(place, body).await.expect("an answer");
        assert_eq!(reused.status(), StatusCode::UNPROCESSABLE_ENTITY);
        let problem: Value = reused.json().await.expect("a problem");
        assert_eq!(problem["type"], "/problems/idempotency-key-reused");
    }
    assert_eq!(server.get_json(&format!("/v1/jobs?parent={root}")).await["jobs"].as_array().map(Vec::len), Some(1));
}

/// A family as its jobs are: each with its parent's number, increment and direction, and its path, ids left out.
async fn family(database: &Path, request: &Value, workers: usize) -> (Value, Vec<(Value, Value, Vec<String>)>) {
    let settings = Settings { workers, ..settings() };
    let server = TestServer::start_with(database, PathSolver, settings).await;
    let root = server.submit(request).await;
    loop {
        let jobs = server.get_json("/v1/jobs?limit=200").await;
        let jobs = jobs["jobs"].as_array().expect("jobs").clone();
        if jobs.iter().all(|job| job["explore"]["done"] == true) {
            let ids: Vec<String> = jobs.iter().rev().map(|job| name(job).to_owned()).collect();
            let mut members = Vec::new();
            for job in jobs.iter().rev() {
                assert_eq!(job["explore"]["family"], root.as_str());
                assert!(matches!(job["status"].as_str(), Some("completed" | "stopped")), "{job}");
                let parent = job["parent"]["job"].as_str().map(|parent| ids.iter().position(|id| id == parent));
                let place = json!([parent, job["parent"]["increment"], job["parent"]["direction"]]);
                let lines = server.lines(name(job)).await;
                let lines = lines.iter().map(|line| {
                    let line = without_elapsed(line);
                    ids.iter().fold(line, |line, id| line.replace(id, "?"))
                });
                members.push((place, job["explore"].clone(), lines.collect()));
            }
            let root = server.get_json(&format!("/v1/jobs/{root}")).await;
            assert!(server.stop().await);
            for (_, explore, _) in &mut members {
                explore["family"] = Value::Null;
            }
            return (root, members);
        }
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
}

#[tokio::test]
async fn an_exploration_collects_the_whole_family_and_the_same_one_each_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut request = scene("arch-type-truss");
    request["analysis"] = json!({"explore": {"depth": 2, "max_jobs": 100}, "max_increments": 60});
    let (root, jobs) = family(&folder.path().join("one.db"), &request, 1).await;
    let count = jobs.len() as u64 - 1;
    assert_eq!((&root["explore"]["family_queued"], &root["explore"]["depth"]), (&json!(count), &json!(2)));
    let generation = |number: u64| jobs.iter().filter(|(_, explore, _)| explore["generation"] == number).count();
    assert_eq!(generation(0), 1);
    assert!(generation(1) >= 2 && generation(2) >= 1);
    assert_eq!(root["children"], generation(1));
    // Every job but the first begins where its parent's increment is.
    for (place, _, lines) in &jobs[1..] {
        let parent = place[0].as_u64().expect("a parent before it") as usize;
        let index = place[1].as_u64().expect("an increment") as usize;
        let from: Value =
            serde_json::from_str(&jobs[parent].2[index].replace("\"elapsed_s\":?", "\"elapsed_s\":0")).expect("JSON");
        let start: Value = serde_json::from_str(&lines[0].replace("\"elapsed_s\":?", "\"elapsed_s\":0")).expect("JSON");
        assert_eq!((&start["energy"], &start["displacements"]), (&from["energy"], &from["displacements"]));
        let direction = place[2].as_u64().expect("a direction") as usize;
        assert_eq!(from["directions"][direction]["taken"], false);
        assert_eq!(start["directions"][direction]["taken"], true);
    }
    // Not one job an increment: an alternative that goes on existing is followed once.
    let listing = jobs[0].2.iter().filter(|line| line.contains("\"directions\"")).count();
    assert!(generation(1) < listing, "{listing}");
    // However many work at once.
    let (_, again) = family(&folder.path().join("two.db"), &request, 3).await;
    assert!(again == jobs);

    // What there is no room for is counted.
    request["analysis"]["explore"]["max_jobs"] = 1.into();
    let (root, fewer) = family(&folder.path().join("three.db"), &request, 2).await;
    assert_eq!(fewer.len(), 2);
    assert_eq!(root["explore"]["not_queued"], generation(1) - 1);
    assert_eq!((&fewer[1].0, &fewer[1].2), (&jobs[1].0, &jobs[1].2));
}

#[tokio::test]
async fn an_exploration_survives_restarts_and_ends_with_a_cancelled_job() {
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let mut request = one_bar();
    request["analysis"] = json!({"explore": {"depth": 1, "max_jobs": 50}, "max_increments": 60});
    // Traced by a process that goes before it can look at what it has found.
    let server = TestServer::start_with(&database, PathSolver, waiting()).await;
    let root = server.submit(&request).await;
    let cancelled = server.submit(&request).await;
    server.post(&format!("/v1/jobs/{cancelled}/cancel"), &Value::Null).await;
    let job = server.until(&cancelled, |job| job["explore"]["done"] == true).await;
    assert_eq!((&job["status"], &job["children"]), (&json!("cancelled"), &json!(0)));
    assert!(server.stop().await);

    let store = store::open(&database).await.expect("a store");
    let claim = store.claim("lost", Duration::from_secs(60)).await.expect("a claim").expect("a job");
    assert_eq!((claim.lease.job.to_string(), claim.explores), (root.clone(), true));
    assert_eq!(store.explore().await.expect("an answer"), 0, "a job that runs is not looked at");
    store.release(&claim.lease).await.expect("an answer");
    store.close().await;

    let server = TestServer::start(&database, PathSolver).await;
    let job = server.until(&root, |job| job["explore"]["done"] == true).await;
    let queued = job["explore"]["family_queued"].as_u64().expect("a count");
    assert!(queued >= 2, "{job}");
    assert_eq!(job["children"], queued);
    let store = store::open(&database).await.expect("a store");
    assert_eq!(store.explore().await.expect("an answer"), 0, "nothing is queued twice");
    // The first and all that followed it are deleted, and with them the family.
    let children = server.get_json(&format!("/v1/jobs?parent={root}&limit=200")).await;
    for id in children["jobs"].as_array().expect("jobs").iter().map(name).chain([root.as_str(), &cancelled]) {
        let gone = server.ask(Method::DELETE, &format!("/v1/jobs/{id}")).send().await.expect("an answer");
        assert_eq!(gone.status(), StatusCode::NO_CONTENT);
    }
    let pool = sqlx::SqlitePool::connect_with(sqlx::sqlite::SqliteConnectOptions::new().filename(&database));
    let pool = pool.await.expect("a pool");
    for table in ["families", "branches", "origins", "increments", "jobs"] {
        let rows: i64 = sqlx::query_scalar(sqlx::AssertSqlSafe(format!("SELECT count(*) FROM {table}")))
            .fetch_one(&pool)
            .await
            .expect("a count");
        assert_eq!(rows, 0, "{table}");
    }
}

#[tokio::test]
async fn a_database_of_before_is_taken_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let (database, old) = (folder.path().join("jobs.db"), folder.path().join("old"));
    std::fs::create_dir(&old).expect("a folder");
    let first = "0001_jobs_and_increments.sql";
    let migrations = Path::new(env!("CARGO_MANIFEST_DIR")).join("migrations/sqlite");
    std::fs::copy(migrations.join(first), old.join(first)).expect("copied");
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(&database).create_if_missing(true);
    let pool = sqlx::SqlitePool::connect_with(options).await.expect("a pool");
    sqlx::migrate::Migrator::new(old.as_path()).await.expect("read").run(&pool).await.expect("migrated");
    let id = uuid::Uuid::now_v7();
    sqlx::query(
        "INSERT INTO jobs (id, status, request, plan, max_increments, max_attempts, created_at, updated_at) \
         VALUES (?, 'queued', ?, '{}', 7, 3, 0, 0)",
    )
    .bind(id)
    .bind(one_bar().to_string())
    .execute(&pool)
    .await
    .expect("stored");
    pool.close().await;

    let server = TestServer::start(&database, PathSolver).await;
    let mut job = server.ended(&id.to_string()).await;
    assert!(job["parent"].is_null() && job["explore"].is_null());
    assert_eq!((job["children"].take(), job["status"].take()), (json!(0), json!("completed")));
    let store = store::open(&database).await.expect("a store");
    let all = Page { rows: 100, bytes: usize::MAX };
    assert_eq!(store.increments(id, None, all).await.expect("increments").len(), 8);
}
