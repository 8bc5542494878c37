//! Debian's Chromium, driven through chromedriver: what a reader of the dashboard sees and does.

use fantoccini::{Client, ClientBuilder};
use hyper_util::client::legacy::connect::HttpConnector;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const PATIENCE: Duration = Duration::from_secs(60);
const DRIVER: &str = "chromedriver";
/// With the value `required` a test fails where there is no browser, and does not pass by.
const VARIABLE: &str = "ARCSLIP_BROWSER";

pub struct Browser {
    driver: Child,
    url: String,
    pub page: Client,
    _profile: TempDir,
}

impl Browser {
    /// `None`: there is none here; the test that asks says so.
    pub async fn open() -> Option<Self> {
        let Some((driver, url)) = driver() else {
            assert!(
                std::env::var(VARIABLE).as_deref() != Ok("required"),
                "there is no {DRIVER}, and {VARIABLE} asks for it"
            );
            eprintln!("skipped: there is no {DRIVER}");
            return None;
        };
        let profile = tempfile::tempdir().expect("a folder");
        let folder = format!("--user-data-dir={}", profile.path().display());
        let options = json!({
            "goog:chromeOptions": {"args": [
                "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
                "--disable-background-networking", "--disable-component-update", "--disable-sync",
                "--window-size=1300,950", folder,
            ]},
            "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
        });
        let Value::Object(capabilities) = options else { unreachable!("an object") };
        let page = ClientBuilder::new(HttpConnector::new()).capabilities(capabilities).connect(&url).await;
        Some(Self { driver, url, page: page.expect("a browser"), _profile: profile })
    }

    /// What a script answers.
    pub async fn ask(&self, script: &str) -> Value {
        self.page.execute(&format!("return ({script});"), Vec::new()).await.expect("it runs")
    }

    /// Waits until what a script answers is neither null nor false.
    pub async fn until(&self, script: &str) -> Value {
        let began = Instant::now();
        loop {
            let found = self.ask(script).await;
            if !matches!(found, Value::Null | Value::Bool(false)) {
                return found;
            }
            if began.elapsed() > PATIENCE {
                let shown = self.ask("document.body.innerText").await;
                panic!("`{script}` does not come to it; shown is {shown}; told was {:?}", self.log("browser").await);
            }
            tokio::time::sleep(Duration::from_millis(30)).await;
        }
    }

    /// What has been logged since it was asked for last.
    async fn log(&self, kind: &str) -> Vec<Value> {
        let session = self.page.session_id().await.expect("its state").expect("a session");
        let place = format!("{}/session/{session}/se/log", self.url);
        let asked = reqwest::Client::builder().no_proxy().build().expect("a client").post(place);
        let answer: Value =
            asked.json(&json!({"type": kind})).send().await.expect("an answer").json().await.expect("JSON");
        answer["value"].as_array().expect("a list").clone()
    }

    /// Nothing has been complained of in the console.
    pub async fn is_content(&self) {
        let told = self.log("browser").await;
        let bad: Vec<_> =
            told.iter().filter(|entry| entry["level"] == "SEVERE" || entry["level"] == "WARNING").collect();
        assert!(bad.is_empty(), "{bad:?}");
    }

    /// Every request of the page went to that service; answers how many there were.
    pub async fn asked_nobody_but(&self, url: &str) -> usize {
        let mut requests = 0;
        for entry in self.log("performance").await {
            let told: Value = serde_json::from_str(entry["message"].as_str().expect("text")).expect("JSON");
            if told["message"]["method"] != "Network.requestWillBeSent" {
                continue;
            }
            let asked = told["message"]["params"]["request"]["url"].as_str().expect("an address").to_owned();
            // What the browser has within itself goes nowhere, its own first page among it.
            let is_within = ["data:", "blob:", "chrome:"].iter().any(|scheme| asked.starts_with(scheme));
            assert!(is_within || asked.starts_with(&format!("{url}/")), "{asked}");
            requests += 1;
        }
        requests
    }

    pub async fn close(self) {
        self.page.clone().close().await.expect("closed");
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Asked to end, it takes its browser along.
        let id = i32::try_from(self.driver.id()).ok().and_then(Pid::from_raw);
        let _ = id.map(|id| kill_process(id, Signal::TERM));
        let _ = self.driver.wait();
    }
}

/// The driver on a port of its own, and its address.
fn driver() -> Option<(Child, String)> {
    let mut child = Command::new(DRIVER).arg("--port=0").stdout(Stdio::piped()).stderr(Stdio::null()).spawn().ok()?;
    let mut lines = BufReader::new(child.stdout.take()?).lines().map_while(Result::ok);
    let port = lines.by_ref().find_map(|line| {
        let (_, port) = line.split_once("started successfully on port ")?;
        port.trim_end_matches('.').parse::<u16>().ok()
    });
    std::thread::spawn(move || lines.for_each(drop));
    Some((child, format!("http://127.0.0.1:{}", port.expect("it says its port"))))
}
