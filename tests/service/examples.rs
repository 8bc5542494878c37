//! The examples of the description are answers of the service, and follow its schemas.
//!
//! `ARCSLIP_EXAMPLES=write` writes `src/service/http/document/examples.json` anew from the answers of this build.

use crate::common::server::{EventStream, TestServer};
use crate::common::service::request;
use crate::common::solver::{MadeUp, PANICS};
use arcslip::service::jobs::PathSolver;
use reqwest::{Method, StatusCode};
use serde_json::{Map, Value, json};
use std::path::Path;

const FILE: &str = "src/service/http/document/examples.json";
/// Calls that are answered without a body, and media types that are no text.
const WITHOUT_BODY: [&str; 4] = ["delete_job", "delete_study", "delete_sweep", "delete_curve"];
const NO_TEXT: [&str; 2] = ["application/zip", "image/png"];

/// Answers by operation, status and media type.
#[derive(Default)]
struct Recorded(Map<String, Value>);

impl Recorded {
    fn put(&mut self, operation: &str, status: u16, media_type: &str, body: Value) {
        let place = self.0.entry(operation).or_insert_with(|| json!({}));
        place[status.to_string()][media_type] = body;
    }

    /// A call without a body, or with one.
    async fn call(
        &mut self,
        server: &TestServer,
        operation: &str,
        method: Method,
        path: &str,
        body: Option<&Value>,
    ) -> Value {
        let mut asked = server.ask(method, path);
        if let Some(body) = body {
            asked = asked.json(body);
        }
        let answer = asked.send().await.expect("an answer");
        let status = answer.status().as_u16();
        let media_type =
            answer.headers()["content-type"].to_str().expect("text").split(';').next().expect("a type").to_owned();
        let text = answer.text().await.expect("a body");
        assert!((200..300).contains(&status), "{operation}: {text}");
        let body = match media_type.as_str() {
            "application/json" => serde_json::from_str(&text).expect("JSON"),
            "image/svg+xml" => Value::from(without_content(&text)),
            // Of many lines the first ones show what they are.
            _ => Value::from(text.lines().take(6).map(|line| format!("{line}\n")).collect::<String>()),
        };
        self.put(operation, status, &media_type, body.clone());
        body
    }

    async fn get(&mut self, server: &TestServer, operation: &str, path: &str) -> Value {
        self.call(server, operation, Method::GET, path, None).await
    }

    /// The first event of a stream, and its first line where it has lines.
    async fn stream(&mut self, server: &TestServer, operation: &str, path: &str, after: Option<&str>) {
        let mut asked = server.ask(Method::GET, path);
        if let Some(after) = after {
            asked = asked.header("last-event-id", after);
        }
        let first = EventStream::of(asked.send().await.expect("an answer")).next().await.expect("an event");
        let event = json!({"event": first.event, "id": first.id, "data": first.data});
        self.put(operation, 200, "text/event-stream", event);
        if after.is_some() {
            return;
        }
        let lines =
            server.ask(Method::GET, path).header("accept", "application/x-ndjson").send().await.expect("an answer");
        let lines = lines.text().await.expect("a whole body");
        let first = serde_json::from_str(lines.lines().next().expect("a line")).expect("JSON");
        self.put(operation, 200, "application/x-ndjson", first);
    }
}

/// An SVG without what it draws.
fn without_content(svg: &str) -> String {
    let end = svg.find("<svg").and_then(|start| svg[start..].find('>').map(|length| start + length + 1));
    format!("{}</svg>\n", &svg[..end.expect("an element svg")])
}

fn document() -> Value {
    serde_json::from_str(&arcslip::service::http::router::openapi_json().expect("a document")).expect("JSON")
}

/// The request in the description of a call.
fn documented(operation: &str) -> Value {
    let document = document();
    let calls = document["paths"]
        .as_object()
        .expect("paths")
        .values()
        .flat_map(|item| item.as_object().expect("calls").values());
    let found = calls.into_iter().find(|call| call["operationId"] == operation).expect("a call");
    found.pointer("/requestBody/content/application~1json/example").expect("an example").clone()
}

/// The answers of real calls.
async fn recorded(folder: &Path) -> Map<String, Value> {
    let mut all = Recorded::default();
    let failing = TestServer::start(&folder.join("failing.db"), MadeUp::default()).await;
    let failed = failing.submit(&request(PANICS, 9)).await;
    failing.ended(&failed).await;
    all.call(&failing, "retry_job", Method::POST, &format!("/v1/jobs/{failed}/retry"), None).await;

    let server = TestServer::start(&folder.join("jobs.db"), PathSolver).await;
    for (operation, path) in [
        ("health", "/healthz"),
        ("readiness", "/readyz"),
        ("list_scenes", "/v1/scenes"),
        ("get_scene", "/v1/scenes/klarbring"),
    ] {
        all.get(&server, operation, path).await;
    }
    let model = documented("submit_job");
    all.call(&server, "submit_job", Method::POST, "/v1/jobs?validate=true", Some(&model)).await;
    let job = all.call(&server, "submit_job", Method::POST, "/v1/jobs", Some(&model)).await;
    let job = job["id"].as_str().expect("an id").to_owned();
    server.ended(&job).await;
    let of_job = format!("/v1/jobs/{job}");
    for (operation, rest) in [
        ("get_job", ""),
        ("get_request", "/request"),
        ("list_increments", "/increments?limit=1"),
        ("get_columns", "/columns?of=load_factor,/point/kind&limit=3"),
        ("get_exact_path", "/exact"),
        ("get_path_csv", "/path.csv"),
        ("get_path_picture", "/picture.svg"),
    ] {
        all.get(&server, operation, &format!("{of_job}{rest}")).await;
    }
    all.get(&server, "list_jobs", "/v1/jobs?limit=1").await;
    all.stream(&server, "stream_increments", &format!("{of_job}/stream"), None).await;
    let beginning = format!("0-{}", uuid::Uuid::nil().simple());
    all.stream(&server, "stream_changes", "/v1/changes", Some(&beginning)).await;
    let follow = documented("follow_direction");
    all.call(&server, "follow_direction", Method::POST, &format!("{of_job}/follow"), Some(&follow)).await;
    let curve = documented("continue_job");
    all.call(&server, "continue_job", Method::POST, &format!("{of_job}/continue"), Some(&curve)).await;
    all.call(&server, "cancel_job", Method::POST, &format!("{of_job}/cancel"), None).await;

    for (kind, plural) in [("study", "studies"), ("sweep", "sweeps"), ("curve", "curves")] {
        let submit = format!("submit_{kind}");
        let body = documented(&submit);
        all.call(&server, &submit, Method::POST, &format!("/v1/{plural}?validate=true"), Some(&body)).await;
        let whole = all.call(&server, &submit, Method::POST, &format!("/v1/{plural}"), Some(&body)).await;
        let place = format!("/v1/{plural}/{}", whole["id"].as_str().expect("an id"));
        all.stream(&server, &format!("stream_{kind}"), &format!("{place}/stream"), None).await;
        all.get(&server, &format!("get_{kind}"), &place).await;
        all.get(&server, &format!("list_{plural}"), &format!("/v1/{plural}?limit=1")).await;
        for (name, rest) in [("table_csv", "table.csv"), ("table_txt", "table.txt"), ("picture", "picture.svg")] {
            all.get(&server, &format!("get_{kind}_{name}"), &format!("{place}/{rest}")).await;
        }
        if kind != "study" {
            all.get(&server, &format!("list_{kind}_rows"), &format!("{place}/rows?limit=1")).await;
        }
        all.call(&server, &format!("cancel_{kind}"), Method::POST, &format!("{place}/cancel"), None).await;
    }
    all.get(&server, "metrics", "/metrics").await;
    let missing = server.get("/v1/jobs/00000000-0000-0000-0000-000000000000").await;
    assert_eq!(missing.status(), StatusCode::NOT_FOUND);
    all.0.insert("problem".to_owned(), missing.json().await.expect("JSON"));
    all.0
}

/// What the description's schemas use of JSON Schema; a word beyond that fails the test.
struct Schemas<'d>(&'d Value);

const ANNOTATIONS: [&str; 8] =
    ["description", "title", "default", "example", "examples", "deprecated", "discriminator", "readOnly"];

impl Schemas<'_> {
    /// Where the value does not follow the schema.
    fn mistakes(&self, schema: &Value, value: &Value, at: &str) -> Vec<String> {
        let Some(words) = schema.as_object() else { return Vec::new() };
        let mut found = Vec::new();
        for (word, asked) in words {
            let list = || asked.as_array().into_iter().flatten();
            let fits = |one: &Value| self.mistakes(one, value, at).is_empty();
            let holds = match word.as_str() {
                "$ref" => {
                    let target =
                        asked.as_str().and_then(|text| text.strip_prefix('#')).expect("a place in the document");
                    found.extend(self.mistakes(self.0.pointer(target).expect(target), value, at));
                    true
                }
                "allOf" => {
                    list().for_each(|one| found.extend(self.mistakes(one, value, at)));
                    true
                }
                "anyOf" => list().any(fits),
                "oneOf" => list().filter(|one| fits(one)).count() == 1,
                "type" => {
                    asked.as_str().into_iter().chain(list().filter_map(Value::as_str)).any(|name| is_of(value, name))
                }
                "enum" => list().any(|one| one == value),
                "const" => asked == value,
                "required" => value
                    .as_object()
                    .is_none_or(|members| list().all(|name| members.contains_key(name.as_str().expect("a name")))),
                "properties" => {
                    for (name, one) in asked.as_object().expect("members") {
                        let Some(member) = value.get(name) else { continue };
                        found.extend(self.mistakes(one, member, &format!("{at}/{name}")));
                    }
                    true
                }
                "additionalProperties" => {
                    let known = |name: &str| schema["properties"].get(name).is_some();
                    let others = value.as_object().into_iter().flatten().filter(|(name, _)| !known(name));
                    match asked {
                        Value::Bool(allowed) => *allowed || others.count() == 0,
                        one => {
                            others.for_each(|(name, member)| {
                                found.extend(self.mistakes(one, member, &format!("{at}/{name}")))
                            });
                            true
                        }
                    }
                }
                "items" | "prefixItems" => {
                    for (place, item) in value.as_array().into_iter().flatten().enumerate() {
                        let one = if word == "items" { Some(asked) } else { asked.get(place) };
                        found.extend(
                            one.map_or_else(Vec::new, |one| self.mistakes(one, item, &format!("{at}/{place}"))),
                        );
                    }
                    true
                }
                "minimum" => value.as_f64() >= asked.as_f64() || !value.is_number(),
                "maximum" => value.as_f64() <= asked.as_f64() || !value.is_number(),
                "exclusiveMinimum" => value.as_f64() > asked.as_f64() || !value.is_number(),
                "exclusiveMaximum" => value.as_f64() < asked.as_f64() || !value.is_number(),
                "minItems" => {
                    value.as_array().is_none_or(|items| items.len() as u64 >= asked.as_u64().expect("a count"))
                }
                "maxItems" => {
                    value.as_array().is_none_or(|items| items.len() as u64 <= asked.as_u64().expect("a count"))
                }
                "minLength" => value.as_str().is_none_or(|text| text.len() as u64 >= asked.as_u64().expect("a count")),
                "maxLength" => value.as_str().is_none_or(|text| text.len() as u64 <= asked.as_u64().expect("a count")),
                "format" | "propertyNames" | "pattern" | "minProperties" | "maxProperties" | "uniqueItems" => true,
                other => {
                    assert!(ANNOTATIONS.contains(&other), "the test does not know {other:?}");
                    true
                }
            };
            if !holds {
                found.push(format!("{at}: {word} {asked} does not hold of {value}"));
            }
        }
        found
    }
}

fn is_of(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_u64() || value.is_i64(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        other => panic!("the test does not know the type {other:?}"),
    }
}

/// The names of the members, at every depth; of lists those of the first item.
fn shape(value: &Value) -> Value {
    match value {
        Value::Object(members) => members.iter().map(|(name, value)| (name.clone(), shape(value))).collect(),
        Value::Array(items) => items.first().map_or_else(|| json!([]), |first| json!([shape(first)])),
        _ => Value::Null,
    }
}

#[tokio::test]
async fn every_call_is_described_with_examples_that_follow_its_schemas() {
    let folder = tempfile::tempdir().expect("a folder");
    let live = recorded(folder.path()).await;
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE);
    if std::env::var("ARCSLIP_EXAMPLES").is_ok_and(|what| what == "write") {
        let text = serde_json::to_string_pretty(&live).expect("JSON") + "\n";
        return std::fs::write(file, text).expect("written");
    }
    let kept: Map<String, Value> =
        serde_json::from_str(&std::fs::read_to_string(file).expect("the examples")).expect("JSON");
    let document = document();
    let check = |schema: &Value, example: &Value, what: &str| {
        let mistakes = Schemas(&document).mistakes(schema, example, "");
        assert!(mistakes.is_empty(), "{what}: {mistakes:?}");
    };
    for item in document["paths"].as_object().expect("paths").values() {
        for operation in item.as_object().expect("calls").values() {
            let Some(id) = operation["operationId"].as_str() else { continue };
            if let Some(content) = operation.pointer("/requestBody/content/application~1json") {
                check(&content["schema"], content.get("example").expect(id), &format!("request of {id}"));
            }
            let mut examples = 0;
            for (status, response) in operation["responses"].as_object().expect("responses") {
                for (media_type, content) in response["content"].as_object().into_iter().flatten() {
                    examples += 1;
                    if NO_TEXT.contains(&media_type.as_str()) {
                        continue;
                    }
                    let what = format!("{id} {status} {media_type}");
                    let example = content.get("example").unwrap_or_else(|| panic!("{what} has no example"));
                    check(&content["schema"], example, &what);
                    if status == "default" {
                        continue;
                    }
                    let now = &live[id][status][media_type];
                    check(&content["schema"], now, &format!("{what}, answered now"));
                    assert_eq!(
                        shape(&kept[id][status][media_type]),
                        shape(now),
                        "{what}: ARCSLIP_EXAMPLES=write writes them anew"
                    );
                }
            }
            assert!(examples > 1 || WITHOUT_BODY.contains(&id), "{id} is described without an answer");
        }
    }
}
