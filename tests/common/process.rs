//! The real program as a process of its own, which can be killed.

use reqwest::{Client, Response, StatusCode};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::ffi::OsStr;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// For what has to come: a guard against a test that hangs, and no more, so that a busy machine fails nothing.
pub const PATIENCE: Duration = Duration::from_secs(600);

pub struct Process {
    child: Child,
    pub url: String,
}

impl Process {
    /// `arcslip serve` on a port of its own, with further arguments.
    pub fn serve(database: &(impl AsRef<OsStr> + ?Sized), arguments: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_arcslip"));
        command.args(["serve", "--listen", "127.0.0.1:0", "--database"]).arg(database).args(arguments);
        command.env("RUST_LOG", "error");
        Self::start(command)
    }

    /// `arcslip work`, with further arguments; it listens nowhere.
    pub fn work(database: &(impl AsRef<OsStr> + ?Sized), arguments: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_arcslip"));
        command.args(["work", "--database"]).arg(database).args(arguments);
        command.env("RUST_LOG", "error");
        Self::started(command, " works on ").expect("it says where it works")
    }

    /// A program that prints `... listens on URL`.
    pub fn start(command: Command) -> Self {
        Self::try_start(command).expect("it says where it listens")
    }

    /// `None`: it ended before it said so.
    pub fn try_start(command: Command) -> Option<Self> {
        Self::started(command, " listens on ")
    }

    fn started(mut command: Command, says: &str) -> Option<Self> {
        let mut child = command.stdout(Stdio::piped()).spawn().expect("the program starts");
        let mut lines = BufReader::new(child.stdout.take().expect("its output")).lines();
        let url =
            lines.by_ref().map_while(Result::ok).find_map(|line| line.split_once(says).map(|(_, url)| url.to_owned()));
        let Some(url) = url else {
            child.wait().expect("its end");
            return None;
        };
        // What it still prints must not fill the pipe.
        std::thread::spawn(move || lines.for_each(drop));
        Some(Self { child, url })
    }

    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// SIGKILL: nothing is put in order.
    pub fn kill(mut self) {
        self.child.kill().expect("killed");
        self.child.wait().expect("gone");
    }

    /// SIGSTOP: it stands still, with everything that it holds. A signal that is sent has not yet come: a thread that runs
    /// goes on for a moment, so each is waited for.
    pub fn stop(&self) {
        self.signal(Signal::STOP);
        let began = Instant::now();
        while !self.stands_still() {
            assert!(began.elapsed() < PATIENCE, "it goes on");
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Whether each of its threads is stopped, as Linux tells it.
    fn stands_still(&self) -> bool {
        let threads = std::fs::read_dir(format!("/proc/{}/task", self.id())).expect("its threads");
        threads.map_while(Result::ok).all(|thread| {
            // The state follows the name, which is in parentheses. A thread that has ended meanwhile has no file.
            let line = std::fs::read_to_string(thread.path().join("stat")).unwrap_or_default();
            line.rsplit_once(") ").is_none_or(|(_, rest)| rest.starts_with('T'))
        })
    }

    /// SIGCONT: it goes on as if no time had passed.
    pub fn go_on(&self) {
        self.signal(Signal::CONT);
    }

    /// SIGHUP: it reads again what it reads at its start.
    pub fn hang_up(&self) {
        self.signal(Signal::HUP);
    }

    /// SIGTERM: it puts everything in order and ends; answers its exit status and how long that took.
    pub async fn terminated(mut self) -> (Option<i32>, Duration) {
        let began = Instant::now();
        self.signal(Signal::TERM);
        loop {
            if let Some(status) = self.child.try_wait().expect("its state") {
                return (status.code(), began.elapsed());
            }
            assert!(began.elapsed() < PATIENCE, "it still runs");
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    }

    fn signal(&self, signal: Signal) {
        let id = i32::try_from(self.id()).ok().and_then(Pid::from_raw).expect("a process");
        kill_process(id, signal).expect("signalled");
    }

    /// Waits until the process has ended by itself.
    pub async fn gone(mut self) {
        let began = Instant::now();
        while self.child.try_wait().expect("its state").is_none() {
            assert!(began.elapsed() < PATIENCE, "it still runs");
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The program with a database of its own.
pub struct Served {
    pub service: Process,
    pub client: Client,
    _folder: TempDir,
}

impl Served {
    pub fn start() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let service = Process::serve(&folder.path().join("jobs.db"), &[]);
        Self { service, client: client(), _folder: folder }
    }

    pub fn url(&self) -> &str {
        &self.service.url
    }

    /// A job that has ended.
    pub async fn ended(&self, request: &Value) -> String {
        let id = submit(&self.client, self.url(), "/v1/jobs", request).await;
        until(&self.client, self.url(), &format!("/v1/jobs/{id}"), has_ended).await;
        id
    }

    pub async fn get(&self, place: &str) -> Value {
        get(&self.client, self.url(), place).await.expect("an answer")
    }
}

pub fn client() -> Client {
    Client::builder().no_proxy().timeout(PATIENCE).build().expect("a client")
}

pub async fn submit(client: &Client, url: &str, place: &str, request: &Value) -> String {
    let answer: Response = client.post(format!("{url}{place}")).json(request).send().await.expect("an answer");
    assert_eq!(answer.status(), StatusCode::ACCEPTED);
    let job: Value = answer.json().await.expect("a job");
    job["id"].as_str().expect("an id").to_owned()
}

/// `None` where nobody answers.
pub async fn get(client: &Client, url: &str, place: &str) -> Option<Value> {
    client.get(format!("{url}{place}")).send().await.ok()?.json().await.ok()
}

pub fn has_ended(job: &Value) -> bool {
    !matches!(job["status"].as_str(), Some("queued" | "running"))
}

/// Waits for a job to meet a condition.
pub async fn until(client: &Client, url: &str, place: &str, condition: impl Fn(&Value) -> bool) -> Value {
    let began = Instant::now();
    loop {
        if let Some(job) = get(client, url, place).await.filter(&condition) {
            return job;
        }
        assert!(began.elapsed() < PATIENCE, "{place} does not come to it");
        tokio::time::sleep(Duration::from_millis(2)).await;
    }
}

/// All stored increments of an ended job as text.
pub async fn lines(client: &Client, url: &str, id: &str) -> Vec<String> {
    let ask = client.get(format!("{url}/v1/jobs/{id}/stream")).header("accept", "application/x-ndjson");
    let text = ask.send().await.expect("an answer").text().await.expect("a whole body");
    text.lines().map(str::to_owned).collect()
}

/// What `arcslip solve` prints of a request.
pub fn solved(request: &Value) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("request.json");
    std::fs::write(&file, request.to_string()).expect("written");
    let output =
        Command::new(env!("CARGO_BIN_EXE_arcslip")).arg("solve").arg(&file).output().expect("the program runs");
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    String::from_utf8(output.stdout).expect("text").lines().map(str::to_owned).collect()
}
