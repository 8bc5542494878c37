//! Debian's Chromium, driven through chromedriver: what a reader of the dashboard sees and does.

use fantoccini::actions::{InputSource, KeyAction, KeyActions, MOUSE_BUTTON_LEFT, MouseActions, PointerAction};
use fantoccini::{Client, ClientBuilder};
use hyper_util::client::legacy::connect::HttpConnector;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const PATIENCE: Duration = Duration::from_secs(600);
const DRIVER: &str = "chromedriver";
/// It takes a port that is free by one protocol and ends where another program has it by the other.
const STARTS: usize = 5;
/// Width and height of the window; a laptop's.
const WINDOW: (u32, u32) = (1280, 800);
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
                &format!("--window-size={},{}", WINDOW.0, WINDOW.1), &folder,
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

    /// Goes to an address and waits for the scripts of the page.
    pub async fn visit(&self, address: &str) {
        self.page.goto(address).await.expect("a page");
    }

    /// Presses what a selector finds, as soon as it is there.
    pub async fn press(&self, selector: &str) {
        self.until(&format!("document.querySelector({selector:?})?.disabled === false")).await;
        self.ask(&format!("document.querySelector({selector:?}).click()")).await;
    }

    /// Sets a field, as one that has been typed into.
    pub async fn put(&self, selector: &str, value: &str) {
        let set = "const place = document.querySelector(arguments[0]); place.value = arguments[1]; \
                   place.dispatchEvent(new Event('input')); place.dispatchEvent(new Event('change'));";
        self.page.execute(set, vec![json!(selector), json!(value)]).await.expect("it runs");
    }

    /// Presses keys together and lets go of them, as a keyboard does: whatever has focus has them, also where the page
    /// draws it anew meanwhile.
    pub async fn keys(&self, keys: &str) {
        let pressed = keys.chars().map(|value| KeyAction::Down { value });
        let released = keys.chars().rev().map(|value| KeyAction::Up { value });
        let stroke = pressed.chain(released).fold(KeyActions::new("keyboard".to_owned()), InputSource::then);
        self.page.perform_actions(stroke).await.expect("pressed");
    }

    /// Moves the pointer to places of the window in turn, pressed between the first and the last where that is said.
    pub async fn drag(&self, places: &[(f64, f64)], is_pressed: bool) {
        let mut moves = MouseActions::new("mouse".to_owned());
        for (number, &(x, y)) in places.iter().enumerate() {
            moves = moves.then(PointerAction::MoveTo { duration: None, x, y });
            if is_pressed && number == 0 {
                moves = moves.then(PointerAction::Down { button: MOUSE_BUTTON_LEFT });
            }
        }
        if is_pressed {
            moves = moves.then(PointerAction::Up { button: MOUSE_BUTTON_LEFT });
        }
        self.page.perform_actions(moves).await.expect("moved");
    }

    /// The middle of what a selector finds, in the window.
    pub async fn middle_of(&self, selector: &str) -> (f64, f64) {
        let found = self
            .ask(&format!(
                "(({{left, top, width, height}}) => [left + width / 2, top + height / 2].map(Math.round))\
                 ((document.querySelector({selector:?}).scrollIntoView({{block: 'center'}}), \
                 document.querySelector({selector:?}).getBoundingClientRect()))"
            ))
            .await;
        let number = |place: usize| found[place].as_f64().expect("a number");
        (number(0), number(1))
    }

    /// A command of the browser's developer tools.
    pub async fn devtools(&self, command: &str, parameters: Value) -> Value {
        self.driver("goog/cdp/execute", &json!({"cmd": command, "params": parameters})).await
    }

    async fn driver(&self, call: &str, parameters: &Value) -> Value {
        let session = self.page.session_id().await.expect("its state").expect("a session");
        let place = format!("{}/session/{session}/{call}", self.url);
        let asked = reqwest::Client::builder().no_proxy().build().expect("a client").post(place);
        let mut answer: Value = asked.json(parameters).send().await.expect("an answer").json().await.expect("JSON");
        answer["value"].take()
    }

    /// What has been logged since it was asked for last.
    async fn log(&self, kind: &str) -> Vec<Value> {
        self.driver("se/log", &json!({"type": kind})).await.as_array().expect("a list").clone()
    }

    /// Closes it where nothing has been complained of in the console but what is expected, and every request of the page went
    /// to that service.
    pub async fn close(self, service: &str, expected: &[&str]) {
        let is_expected = |entry: &Value| {
            let text = entry["message"].as_str().unwrap_or_default();
            expected.iter().any(|part| text.contains(part))
        };
        let told = self.log("browser").await;
        let bad = |entry: &&Value| entry["level"] == "SEVERE" || entry["level"] == "WARNING";
        let bad: Vec<_> = told.iter().filter(bad).filter(|entry| !is_expected(entry)).collect();
        assert!(bad.is_empty(), "{bad:?}");
        assert!(self.asked_nobody_but(service).await > 10, "the page asks for more than that");
        self.page.clone().close().await.expect("closed");
    }

    /// Every request of the page went to that service; answers how many there were.
    async fn asked_nobody_but(&self, url: &str) -> usize {
        let mut requests = 0;
        for entry in self.log("performance").await {
            let told: Value = serde_json::from_str(entry["message"].as_str().expect("text")).expect("JSON");
            if told["message"]["method"] != "Network.requestWillBeSent" {
                continue;
            }
            let asked = told["message"]["params"]["request"]["url"].as_str().expect("an address").to_owned();
            // What the browser has within itself goes nowhere, its own first page among it.
            let is_within =
                ["data:", "blob:", "chrome:", "chrome-untrusted:"].iter().any(|scheme| asked.starts_with(scheme));
            assert!(is_within || asked.starts_with(&format!("{url}/")), "{asked}");
            requests += 1;
        }
        requests
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

/// The driver on a port of its own, and its address; `None` where there is none.
fn driver() -> Option<(Child, String)> {
    for _ in 0..STARTS {
        let mut child =
            Command::new(DRIVER).arg("--port=0").stdout(Stdio::piped()).stderr(Stdio::null()).spawn().ok()?;
        let mut lines = BufReader::new(child.stdout.take()?).lines().map_while(Result::ok);
        let port = lines.by_ref().find_map(|line| {
            let (_, port) = line.split_once("started successfully on port ")?;
            port.trim_end_matches('.').parse::<u16>().ok()
        });
        if let Some(port) = port {
            std::thread::spawn(move || lines.for_each(drop));
            return Some((child, format!("http://127.0.0.1:{port}")));
        }
        child.wait().expect("its end");
    }
    panic!("{DRIVER} does not say its port");
}
