//! Who may call: tokens, scopes, owners, rates, origins, connections.

use crate::common::server::{EventStream, TestServer, settings};
use crate::common::service::request;
use crate::common::solver::MadeUp;
use arcslip::service::http::access::origins::Origins;
use arcslip::service::http::access::rates::Rates;
use arcslip::service::http::access::tokens::{self, Tokens};
use arcslip::service::http::access::{Access, AccessPolicy};
use arcslip::service::store;
use reqwest::{Method, Response};
use serde_json::{Value, json};
use std::num::NonZeroU32;
use std::path::Path;

/// Tokens and the lines that make a service take them.
struct People {
    ann: String,
    bob: String,
    reader: String,
    ops: String,
    lines: String,
}

impl People {
    fn new() -> Self {
        let mut lines = String::new();
        let mut person = |name: &str, scopes: &str| {
            let (token, hash) = tokens::make().expect("randomness");
            lines.push_str(&format!("{name} {scopes} {hash}\n"));
            token
        };
        let (ann, bob) = (person("ann", "read,submit"), person("bob", "read,submit"));
        let (reader, ops) = (person("ann", "read"), person("ops", "admin"));
        Self { ann, bob, reader, ops, lines }
    }

    fn tokens(&self) -> Tokens {
        Tokens::of_text("tokens", &self.lines).expect("tokens")
    }

    fn access(&self) -> Access {
        Access::new(AccessPolicy::with(self.tokens()), Rates::default(), Origins::default())
    }
}

async fn start(folder: &Path, access: Access) -> TestServer {
    let store = store::open(&folder.join("jobs.db")).await.expect("a store");
    TestServer::start_for(store, MadeUp::default(), settings(), access).await
}

async fn ask(server: &TestServer, token: &str, method: Method, path: &str) -> Response {
    server.ask(method, path).bearer_auth(token).send().await.expect("an answer")
}

async fn submit(server: &TestServer, token: &str, key: &str, body: &Value) -> Response {
    let ask = server.ask(Method::POST, "/v1/jobs").bearer_auth(token).header("idempotency-key", key);
    ask.json(body).send().await.expect("an answer")
}

async fn id_of(answer: Response) -> String {
    assert_eq!(answer.status(), 202);
    answer.json::<Value>().await.expect("a job")["id"].as_str().expect("an id").to_owned()
}

async fn problem(answer: Response, status: u16, kind: &str) -> Value {
    assert_eq!(answer.status(), status, "{kind}");
    assert_eq!(answer.headers()["content-type"], "application/problem+json");
    let problem: Value = answer.json().await.expect("a problem");
    assert_eq!(problem["type"], format!("/problems/{kind}"), "{problem}");
    problem
}

/// Every call that the service describes.
fn calls() -> Vec<(Method, String)> {
    let document: Value =
        serde_json::from_str(&arcslip::service::http::router::openapi_json().expect("a document")).expect("JSON");
    let paths = document["paths"].as_object().expect("paths");
    let calls = paths.iter().flat_map(|(path, item)| {
        let path = path.replace("{id}", "01890000-0000-7000-8000-000000000000").replace("{name}", "klarbring");
        let methods = item.as_object().expect("an item").keys().filter_map(|method| method.to_uppercase().parse().ok());
        methods.map(move |method| (method, path.clone())).collect::<Vec<_>>()
    });
    calls.collect()
}

#[tokio::test]
async fn every_call_but_the_public_ones_asks_for_a_token() {
    let folder = tempfile::tempdir().expect("a folder");
    let people = People::new();
    let server = start(folder.path(), people.access()).await;
    let mut asked = 0;
    for (method, path) in calls() {
        let answer = server.ask(method.clone(), &path).send().await.expect("an answer");
        if ["/healthz", "/readyz"].contains(&path.as_str()) {
            assert_eq!(answer.status(), 200, "{path}");
            continue;
        }
        assert_eq!(answer.headers()["www-authenticate"], "Bearer realm=\"arcslip\"");
        problem(answer, 401, "unauthorized").await;
        for wrong in ["arcslip_00", &people.ann[1..], ""] {
            problem(ask(&server, wrong, method.clone(), &path).await, 401, "unauthorized").await;
        }
        let basic = server.ask(method.clone(), &path).header("authorization", format!("Basic {}", people.ann));
        problem(basic.send().await.expect("an answer"), 401, "unauthorized").await;
        // Who may only look changes nothing.
        let looking = ask(&server, &people.reader, method.clone(), &path).await;
        if method == Method::GET {
            assert!(!matches!(looking.status().as_u16(), 401 | 403), "{method} {path}");
        } else {
            problem(looking, 403, "forbidden").await;
        }
        asked += 1;
    }
    assert!(asked > 15, "{asked}");
    for public in ["/", "/docs/", "/openapi.json"] {
        assert_eq!(server.get(public).await.status(), 200, "{public}");
    }
    // Not even what there is not.
    assert_eq!(server.get("/v2/jobs").await.status(), 401);
    assert_eq!(ask(&server, &people.ann, Method::GET, "/v2/jobs").await.status(), 404);
}

#[tokio::test]
async fn a_job_is_there_for_its_owner_and_for_who_sees_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let people = People::new();
    let server = start(folder.path(), people.access()).await;
    let id = id_of(submit(&server, &people.ann, "first", &request("ann's", 5)).await).await;
    // The same key of another owner is another job, whatever it asks for.
    let other = id_of(submit(&server, &people.bob, "first", &request("bob's", 7)).await).await;
    assert_ne!(id, other);
    assert_eq!(id_of(submit(&server, &people.ann, "first", &request("ann's", 5)).await).await, id);
    problem(submit(&server, &people.ann, "first", &request("ann's", 6)).await, 422, "idempotency-key-reused").await;

    let place = format!("/v1/jobs/{id}");
    for token in [&people.ann, &people.reader, &people.ops] {
        let job: Value = ask(&server, token, Method::GET, &place).await.json().await.expect("a job");
        assert_eq!((&job["owner"], &job["name"]), (&json!("ann"), &json!("ann's")), "{job}");
    }
    for path in ["", "/increments", "/stream", "/path.csv"] {
        problem(ask(&server, &people.bob, Method::GET, &format!("{place}{path}")).await, 404, "not-found").await;
    }
    for path in ["/cancel", "/follow"] {
        let ask = server.ask(Method::POST, &format!("{place}{path}")).bearer_auth(&people.bob);
        let answer = ask.json(&json!({"increment": 0, "direction": 0})).send().await.expect("an answer");
        problem(answer, 404, "not-found").await;
    }
    problem(ask(&server, &people.bob, Method::DELETE, &place).await, 404, "not-found").await;
    let listed = async |token: &str, query: &str| -> Vec<String> {
        let list: Value =
            ask(&server, token, Method::GET, &format!("/v1/jobs{query}")).await.json().await.expect("a list");
        let jobs = list["jobs"].as_array().expect("jobs");
        jobs.iter().map(|job| job["id"].as_str().expect("an id").to_owned()).collect()
    };
    assert_eq!(listed(&people.ann, "").await, [&*id]);
    assert_eq!(listed(&people.bob, "").await, [&*other]);
    assert_eq!(listed(&people.ops, "").await, [&*other, &*id]);
    assert!(listed(&people.bob, &format!("?parent={id}")).await.is_empty());

    // Studies are jobs of another kind, and nothing else.
    let study = json!({"model": request("study", 5)["model"], "analysis": {"max_increments": 5}});
    let ask_study = server.ask(Method::POST, "/v1/studies").bearer_auth(&people.ann).json(&study);
    let study = id_of(ask_study.send().await.expect("an answer")).await;
    for path in ["", "/stream", "/table.csv", "/table.txt", "/picture.svg"] {
        problem(ask(&server, &people.bob, Method::GET, &format!("/v1/studies/{study}{path}")).await, 404, "not-found")
            .await;
    }
    assert_eq!(ask(&server, &people.ops, Method::DELETE, &place).await.status(), 204);
    problem(ask(&server, &people.ann, Method::GET, &place).await, 404, "not-found").await;
}

#[tokio::test]
async fn tokens_are_exchanged_while_the_service_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    let (before, after) = (People::new(), People::new());
    let access = before.access();
    let server = start(folder.path(), access.clone()).await;
    let id = id_of(submit(&server, &before.ann, "kept", &request("kept", 3)).await).await;
    access.exchange(after.tokens());
    problem(ask(&server, &before.ann, Method::GET, "/v1/jobs").await, 401, "unauthorized").await;
    // Jobs belong to the name, not to the token.
    assert_eq!(ask(&server, &after.ann, Method::GET, &format!("/v1/jobs/{id}")).await.status(), 200);
}

/// Also what has been open since before: it can be resumed by whoever shows a token that holds.
#[tokio::test]
async fn streams_of_tokens_that_hold_no_more_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let people = People::new();
    let access = people.access();
    let store = store::open(&folder.path().join("jobs.db")).await.expect("a store");
    let solver = MadeUp::holding_at(3);
    let server = TestServer::start_for(store, solver.clone(), settings(), access.clone()).await;
    let id = id_of(submit(&server, &people.ann, "held", &request("held", 6)).await).await;
    let place = format!("/v1/jobs/{id}/stream");
    let mut stream = EventStream::of(ask(&server, &people.ann, Method::GET, &place).await);
    for _ in 0..3 {
        assert_eq!(stream.next().await.expect("an event").event, "increment");
    }
    access.exchange(people.tokens());
    let rest = stream.rest().await;
    assert!(rest.len() == 1 && rest[0].event.is_empty() && !rest[0].retry.is_empty(), "{rest:?}");
    solver.let_go();
    let resumed = server.ask(Method::GET, &place).bearer_auth(&people.ann).header("last-event-id", "2");
    let events = EventStream::of(resumed.send().await.expect("an answer")).rest().await;
    assert_eq!(events.iter().map(|event| event.id.as_str()).collect::<Vec<_>>(), ["3", "4", "5", ""]);
}

#[tokio::test]
async fn what_was_posted_without_a_token_is_for_who_sees_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = start(folder.path(), Access::loopback()).await;
    let id = server.submit(&request("open", 3)).await;
    assert!(server.ended(&id).await["owner"].is_null());
    assert!(server.stop().await);
    let people = People::new();
    let server = start(folder.path(), people.access()).await;
    let place = format!("/v1/jobs/{id}");
    assert_eq!(ask(&server, &people.ann, Method::GET, &place).await.status(), 404);
    assert_eq!(ask(&server, &people.ops, Method::GET, &place).await.status(), 200);
}

#[tokio::test]
async fn too_many_requests_of_one_address_or_token_are_told_when_to_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let people = People::new();
    let (few, many) = (NonZeroU32::new(5), NonZeroU32::new(40));
    let access = Access::new(AccessPolicy::with(people.tokens()), Rates::new(many, few), Origins::default());
    let server = start(folder.path(), access).await;
    let answers = async |token: &str, count: usize| {
        let mut answers = Vec::new();
        for _ in 0..count {
            answers.push(ask(&server, token, Method::GET, "/v1/scenes").await);
        }
        answers
    };
    let answered = |answers: &[Response]| answers.iter().filter(|answer| answer.status() == 200).count();
    let of_ann = answers(&people.ann, 12).await;
    assert!((5..12).contains(&answered(&of_ann)), "{}", answered(&of_ann));
    let refused = of_ann.into_iter().find(|answer| answer.status() != 200).expect("one is refused");
    assert_eq!(refused.headers()["retry-after"], "1");
    let told = problem(refused, 429, "rate-limited").await;
    assert!(told["detail"].as_str().expect("a text").contains("this token"), "{told}");
    let of_bob = answers(&people.bob, 4).await;
    assert_eq!(answered(&of_bob), 4, "each token has a rate of its own");
    // Whoever tries tokens is stopped by the address.
    let mut wrong = Vec::new();
    for _ in 0..100 {
        wrong.push(ask(&server, "arcslip_wrong", Method::GET, "/v1/scenes").await.status().as_u16());
    }
    assert!(wrong.contains(&401) && wrong.contains(&429), "{wrong:?}");
}

#[tokio::test]
async fn pages_of_other_origins_and_other_names_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = start(folder.path(), Access::loopback()).await;
    let post = |name: &'static str, value: String| {
        server.ask(Method::POST, "/v1/jobs?validate=true").json(&request("one", 3)).header(name, value).send()
    };
    for foreign in ["https://evil.example", "null"] {
        problem(post("origin", foreign.to_owned()).await.expect("an answer"), 403, "forbidden").await;
    }
    let own = format!("http://{}", server.address());
    assert_eq!(post("origin", own).await.expect("an answer").status(), 200);
    let renamed = server.ask(Method::GET, "/v1/jobs").header("host", "evil.example").send().await.expect("an answer");
    problem(renamed, 403, "forbidden").await;
    let local = server.ask(Method::GET, "/v1/jobs").header("host", "localhost:1").send().await.expect("an answer");
    assert_eq!(local.status(), 200);
    let quiet = server.ask(Method::GET, "/v1/jobs").header("origin", "https://evil.example").send().await;
    assert!(!quiet.expect("an answer").headers().contains_key("access-control-allow-origin"));
}

#[tokio::test]
async fn listed_pages_may_call_also_before_they_show_a_token() {
    let folder = tempfile::tempdir().expect("a folder");
    let people = People::new();
    let origins = Origins::read(["https://plots.example"]).expect("an origin");
    let access = Access::new(AccessPolicy::with(people.tokens()), Rates::default(), origins);
    let server = start(folder.path(), access).await;
    let asked = async |origin: &str| {
        let ask = server.ask(Method::OPTIONS, "/v1/jobs").header("origin", origin);
        let ask = ask.header("access-control-request-method", "POST");
        ask.header("access-control-request-headers", "authorization,content-type").send().await.expect("an answer")
    };
    let listed = asked("https://plots.example").await;
    assert_eq!(listed.headers()["access-control-allow-origin"], "https://plots.example");
    assert!(listed.headers()["access-control-allow-headers"].to_str().expect("text").contains("authorization"));
    assert!(!asked("https://evil.example").await.headers().contains_key("access-control-allow-origin"));
    // The page may also read why it was refused.
    let refused = server.ask(Method::GET, "/v1/jobs").header("origin", "https://plots.example").send().await;
    let refused = refused.expect("an answer");
    assert_eq!(refused.headers()["access-control-allow-origin"], "https://plots.example");
    problem(refused, 401, "unauthorized").await;
    let ask = server.ask(Method::POST, "/v1/jobs?validate=true").bearer_auth(&people.ann);
    let answer = ask.header("origin", "https://plots.example").json(&request("one", 3)).send().await;
    assert_eq!(answer.expect("an answer").status(), 200);
}

#[tokio::test]
async fn browsers_are_told_what_they_may_do_with_every_answer() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = start(folder.path(), Access::loopback()).await;
    for path in ["/", "/docs/", "/v1/jobs", "/nothing", "/healthz"] {
        let answer = server.get(path).await;
        let headers = answer.headers();
        assert_eq!(headers["x-content-type-options"], "nosniff", "{path}");
        assert_eq!(headers["x-frame-options"], "DENY", "{path}");
        assert!(headers["content-security-policy"].to_str().expect("text").contains("default-src 'self'"), "{path}");
        assert!(headers.contains_key("cache-control") && headers.contains_key("referrer-policy"), "{path}");
    }
}
