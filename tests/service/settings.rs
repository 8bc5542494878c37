//! Settings of the real program: where they come from, that they are told at start, and who may call where it listens.

use crate::common::process::{PATIENCE, Process, client, get, has_ended, submit, until};
use crate::common::service::in_short_steps;
use reqwest::StatusCode;
use serde_json::Value;
use std::fs::File;
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

fn arcslip(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_arcslip"));
    command.args(arguments);
    command
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("text")
}

/// The settings that a log of JSON lines tells: name, value, where it is from.
fn told(log: &Path) -> Vec<(String, String, String)> {
    let text = std::fs::read_to_string(log).expect("a log");
    let lines = text.lines().map(|line| serde_json::from_str::<Value>(line).expect("a line of JSON"));
    let settings = lines.filter(|line| line["fields"]["message"] == "setting");
    let member = |line: &Value, name: &str| line["fields"][name].as_str().expect("text").to_owned();
    settings.map(|line| (member(&line, "name"), member(&line, "value"), member(&line, "from"))).collect()
}

/// A server with its log in a file.
fn serve(folder: &Path, mut command: Command) -> Process {
    command.env("RUST_LOG", "info").env("ARCSLIP_LOG", "json").current_dir(folder);
    command.stderr(File::create(folder.join("log")).expect("a file"));
    Process::start(command)
}

#[test]
fn the_version_names_the_commit_that_the_program_is_built_from() {
    let told = text(&arcslip(&["--version"]).output().expect("the program runs").stdout);
    let commit = told.strip_prefix(concat!("arcslip ", env!("CARGO_PKG_VERSION"), " (")).expect("name and version");
    // Development builds are not made anew for each commit.
    let is_named = |name: &str| name == "development build" || name.bytes().all(|byte| byte.is_ascii_hexdigit());
    assert!(commit.strip_suffix(")\n").is_some_and(is_named), "{told}");
}

fn refused(mut command: Command) -> String {
    let output: Output = command.output().expect("the program runs");
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    text(&output.stderr)
}

#[tokio::test]
async fn the_command_line_goes_before_the_environment_that_before_the_file_and_that_before_the_default() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = folder.path().join("arcslip.toml");
    let lines = "listen = \"127.0.0.1:0\"\nworkers = 3\nlease = \"20s\"\nmax-queued = 7\nallow-origin = [\"https://a.example\", \
                 \"https://b.example\"]\ndemo = true\n";
    std::fs::write(&config, lines).expect("written");
    let mut command = arcslip(&["serve", "--config", "arcslip.toml", "--max-queued", "30"]);
    command.env("ARCSLIP_MAX_QUEUED", "9").env("ARCSLIP_LEASE", "15s");
    let process = serve(folder.path(), command);
    let settings = told(&folder.path().join("log"));
    for (name, value, from) in [
        ("max-queued", "30", "the command line"),
        ("lease", "15s", "the environment"),
        ("workers", "3", "the file"),
        ("listen", "127.0.0.1:0", "the file"),
        ("allow-origin", "https://a.example,https://b.example", "the file"),
        ("demo", "true", "the file"),
        ("max-attempts", "3", "default"),
        ("open", "false", "default"),
    ] {
        let expected = (name.to_owned(), value.to_owned(), from.to_owned());
        assert!(settings.contains(&expected), "{name}: {settings:?}");
    }
    // They are in force, too.
    let client = client();
    let ready = get(&client, &process.url, "/readyz").await.expect("an answer");
    assert_eq!(ready["workers"], 3);
    let document = get(&client, &process.url, "/openapi.json").await.expect("a document");
    assert!(document["info"]["description"].as_str().expect("text").contains("| jobs and studies that wait | 30 |"));
    let jobs = get(&client, &process.url, "/v1/jobs").await.expect("a list");
    assert!(!jobs["jobs"].as_array().expect("jobs").is_empty(), "the demonstration is queued");
}

/// Connections leave the files that the database needs.
#[tokio::test(flavor = "multi_thread")]
async fn where_few_files_may_be_open_fewer_connections_are_served_and_jobs_go_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut command = Command::new("sh");
    let line =
        format!("ulimit -n 128; exec {} serve --listen 127.0.0.1:0 --database jobs.db", env!("CARGO_BIN_EXE_arcslip"));
    command.args(["-c", &line]);
    let process = serve(folder.path(), command);
    let client = client();
    let id = submit(&client, &process.url, "/v1/jobs", &in_short_steps("one-bar-truss", 3000, 3000)).await;
    let address = process.url.strip_prefix("http://").expect("an address");
    let idle: Vec<TcpStream> = (0..200).map(|_| TcpStream::connect(address).expect("connected")).collect();
    tokio::time::sleep(Duration::from_millis(500)).await;
    drop(idle);
    let job = until(&client, &process.url, &format!("/v1/jobs/{id}"), has_ended).await;
    assert_eq!(job["status"], "completed", "{job}");
    let log = std::fs::read_to_string(folder.path().join("log")).expect("a log");
    assert!(log.contains("fewer connections are served"), "{log}");
}

#[test]
fn a_file_of_settings_that_is_wrong_is_told_with_what_would_do() {
    let folder = tempfile::tempdir().expect("a folder");
    for (lines, expected) in [
        ("worker = 3", "there is no setting `worker`; did you mean `workers`?"),
        ("config = \"other\"", "there is no setting `config`"),
        ("workers = 1025", "--workers"),
        ("workers = 1.5", "workers: found a float; a text, a whole number or true or false would do"),
        ("workers = [", "TOML"),
        ("workers = [1, 2]", "workers: found a list; one value is expected"),
        ("max-queued = []", "max-queued: found a list"),
        ("demo = \"perhaps\"", "--demo"),
    ] {
        std::fs::write(folder.path().join("arcslip.toml"), lines).expect("written");
        let mut command = arcslip(&["serve", "--config", "arcslip.toml"]);
        command.current_dir(folder.path());
        let told = refused(command);
        assert!(told.starts_with("arcslip.toml: ") && told.contains(expected), "{lines}: {told}");
    }
    let mut command = arcslip(&["serve", "--config", "nowhere.toml"]);
    command.current_dir(folder.path());
    assert!(refused(command).starts_with("nowhere.toml: "));
}

#[test]
fn where_others_reach_it_somebody_has_to_say_who_may_call() {
    let folder = tempfile::tempdir().expect("a folder");
    let tokens = folder.path().join("tokens");
    let file = tokens.to_str().expect("a name");
    for listen in ["0.0.0.0:0", "[::]:0", "192.0.2.1:80"] {
        let told = refused(arcslip(&["serve", "--listen", listen]));
        assert!(told.contains("--tokens-file") && told.contains("--open"), "{told}");
    }
    let both = ["serve", "--open", "--tokens-file", file];
    assert!(refused(arcslip(&both)).contains("give one of them"));
    let with_tokens = ["serve", "--listen", "0.0.0.0:0", "--tokens-file", file];
    assert!(refused(arcslip(&with_tokens)).contains("tokens: "), "there is no such file");
    std::fs::write(&tokens, "# nobody\n").expect("written");
    assert!(refused(arcslip(&with_tokens)).contains("there is no token in it"));
    assert!(refused(arcslip(&["serve", "--allow-origin", "evil"])).contains("is no origin"));
    assert!(refused(arcslip(&["token", "a/b"])).contains("is no name"));
    assert!(refused(arcslip(&["token", "ann", "--scopes", "all"])).contains("is no scope"));
}

#[tokio::test]
async fn a_token_made_on_the_command_line_opens_the_door_until_it_is_struck_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let tokens = folder.path().join("tokens");
    let make = |name: &str| {
        let made = arcslip(&["token", name]).output().expect("the program runs");
        assert!(made.status.success());
        (text(&made.stdout), text(&made.stderr).trim().to_owned())
    };
    let ((ann, token), (bob, other)) = (make("ann"), make("bob"));
    assert!(!ann.contains(&token) && ann.starts_with("ann read,submit "));
    std::fs::write(&tokens, &ann).expect("written");
    let mut command = arcslip(&["serve", "--listen", "0.0.0.0:0", "--database", "jobs.db"]);
    command.env("ARCSLIP_TOKENS_FILE", &tokens);
    let process = serve(folder.path(), command);
    let url = process.url.replace("0.0.0.0", "127.0.0.1");
    let client = client();
    let asked = async |token: &str| {
        let ask = client.get(format!("{url}/v1/jobs")).bearer_auth(token);
        ask.send().await.expect("an answer").status()
    };
    assert_eq!((asked(&token).await, asked(&other).await), (StatusCode::OK, StatusCode::UNAUTHORIZED));
    let until = async |token: &str, status: StatusCode| {
        let began = Instant::now();
        while asked(token).await != status {
            assert!(began.elapsed() < PATIENCE, "never {status}");
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    };
    std::fs::write(&tokens, &bob).expect("written");
    process.hang_up();
    until(&other, StatusCode::OK).await;
    assert_eq!(asked(&token).await, StatusCode::UNAUTHORIZED);
    // A file that is none changes nothing.
    std::fs::write(&tokens, "bob").expect("written");
    process.hang_up();
    let began = Instant::now();
    while !std::fs::read_to_string(folder.path().join("log")).expect("a log").contains("the tokens stay as they were") {
        assert!(began.elapsed() < PATIENCE);
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
    assert_eq!(asked(&other).await, StatusCode::OK);
    let log = std::fs::read_to_string(folder.path().join("log")).expect("a log");
    assert!(!log.contains(&token) && !log.contains(&other), "no token is ever logged");
}
