//! The real application in this process: a port of its own, a database of the test's.

use arcslip::service::http::access::Access;
use arcslip::service::http::listen::Connections;
use arcslip::service::http::server::{ListenOptions, Server};
use arcslip::service::jobs::{Settings, Solver};
use arcslip::service::store;
use arcslip::service::store::contract::interface::Store;
use reqwest::{Client, Method, RequestBuilder, Response, StatusCode};
use serde_json::Value;
use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(600);
pub const CONNECTIONS: Connections = Connections { all: 500, waiting: 500, an_address: None };

pub struct TestServer {
    server: Server,
    url: String,
    client: Client,
}

/// One server-sent event.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Event {
    pub event: String,
    pub id: String,
    pub data: String,
    pub retry: String,
}

/// A lease that no busy machine lets run out.
pub fn settings() -> Settings {
    Settings { workers: 2, lease: Duration::from_secs(60), ..Settings::default() }
}

/// A lease that runs out while a test waits for it. What is asserted must not depend on how often it does.
pub fn short_leases() -> Settings {
    Settings { lease: Duration::from_millis(600), ..settings() }
}

/// Any free port of this machine.
pub fn any_port() -> SocketAddr {
    SocketAddr::from(([127, 0, 0, 1], 0))
}

impl TestServer {
    pub async fn start(database: &Path, solver: impl Solver) -> Self {
        Self::start_with(database, solver, settings()).await
    }

    pub async fn start_with(database: &Path, solver: impl Solver, settings: Settings) -> Self {
        let store = store::open(database).await.expect("the database opens");
        Self::start_on(store, solver, settings).await
    }

    pub async fn start_on(store: Arc<dyn Store>, solver: impl Solver, settings: Settings) -> Self {
        Self::start_for(store, solver, settings, Access::loopback()).await
    }

    pub async fn start_for(store: Arc<dyn Store>, solver: impl Solver, settings: Settings, access: Access) -> Self {
        let front = ListenOptions { listen: any_port(), connections: CONNECTIONS, access };
        let server = Server::start(front, store, Arc::new(solver), settings).await;
        let server = server.expect("the server starts");
        let url = format!("http://{}", server.address());
        let client = Client::builder().no_proxy().timeout(PATIENCE).build().expect("a client");
        Self { server, url, client }
    }

    /// Whether everything ended within the bound.
    pub async fn stop(self) -> bool {
        self.server.stop().await
    }

    pub fn address(&self) -> SocketAddr {
        self.server.address()
    }

    pub fn ask(&self, method: Method, path: &str) -> RequestBuilder {
        self.client.request(method, format!("{}{path}", self.url))
    }

    pub async fn get(&self, path: &str) -> Response {
        self.ask(Method::GET, path).send().await.expect("an answer")
    }

    pub async fn get_json(&self, path: &str) -> Value {
        let answer = self.get(path).await;
        assert_eq!(answer.status(), StatusCode::OK, "GET {path}");
        answer.json().await.expect("JSON")
    }

    pub async fn post(&self, path: &str, body: &Value) -> Response {
        self.ask(Method::POST, path).json(body).send().await.expect("an answer")
    }

    /// Queues a job and answers its id.
    pub async fn submit(&self, request: &Value) -> String {
        let answer = self.post("/v1/jobs", request).await;
        assert_eq!(answer.status(), StatusCode::ACCEPTED);
        let job: Value = answer.json().await.expect("a job");
        job["id"].as_str().expect("an id").to_owned()
    }

    /// Waits for a job to meet a condition.
    pub async fn until(&self, id: &str, condition: impl Fn(&Value) -> bool) -> Value {
        let began = Instant::now();
        loop {
            let job = self.get_json(&format!("/v1/jobs/{id}")).await;
            if condition(&job) {
                return job;
            }
            assert!(began.elapsed() < PATIENCE, "still {job}");
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    }

    pub async fn ended(&self, id: &str) -> Value {
        self.until(id, |job| !matches!(job["status"].as_str(), Some("queued" | "running"))).await
    }

    /// All stored increments as text.
    pub async fn lines(&self, id: &str) -> Vec<String> {
        let answer = self
            .ask(Method::GET, &format!("/v1/jobs/{id}/stream"))
            .header("accept", "application/x-ndjson")
            .send()
            .await
            .expect("an answer");
        answer.text().await.expect("a whole body").lines().map(str::to_owned).collect()
    }

    pub async fn stream(&self, id: &str, last_event_id: Option<&str>) -> EventStream {
        let mut ask = self.ask(Method::GET, &format!("/v1/jobs/{id}/stream"));
        if let Some(last) = last_event_id {
            ask = ask.header("last-event-id", last);
        }
        EventStream::of(ask.send().await.expect("an answer"))
    }
}

/// Reads server-sent events one by one.
pub struct EventStream {
    response: Response,
    text: String,
}

impl EventStream {
    pub fn of(response: Response) -> Self {
        assert_eq!(response.status(), StatusCode::OK);
        assert_eq!(response.headers()["content-type"], "text/event-stream");
        Self { response, text: String::new() }
    }

    /// `None`: the stream has ended.
    pub async fn next(&mut self) -> Option<Event> {
        self.try_next().await.expect("a stream that ends in order")
    }

    /// `None`: the stream broke off. What came of an event that is not whole does not count.
    pub async fn try_next(&mut self) -> Option<Option<Event>> {
        loop {
            if let Some((event, rest)) = self.text.split_once("\n\n") {
                let event = parse(event);
                self.text = rest.to_owned();
                return Some(Some(event));
            }
            let Some(chunk) = self.response.chunk().await.ok()? else { return Some(None) };
            self.text.push_str(std::str::from_utf8(&chunk).expect("text"));
        }
    }

    pub async fn rest(mut self) -> Vec<Event> {
        let mut events = Vec::new();
        while let Some(event) = self.next().await {
            events.push(event);
        }
        events
    }
}

fn parse(text: &str) -> Event {
    let mut event = Event::default();
    for line in text.lines() {
        match line.split_once(':') {
            Some(("event", value)) => event.event = value.trim_start().to_owned(),
            Some(("id", value)) => event.id = value.trim_start().to_owned(),
            Some(("data", value)) => event.data.push_str(value.trim_start()),
            Some(("retry", value)) => event.retry = value.trim_start().to_owned(),
            _ => {}
        }
    }
    event
}
