//! The client in Python against the real program: what it prints is the path, through a kill and a restart.

use crate::common::process::{Process, client, solved, until};
use crate::common::service::{in_short_steps, scene};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

const CLIENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/clients/arcslip.py");

fn python() -> Option<Command> {
    let found = Command::new("python3").arg("--version").output().is_ok_and(|output| output.status.success());
    if !found {
        eprintln!("skipped: no python3");
    }
    found.then(|| {
        let mut python = Command::new("python3");
        python.env("no_proxy", "*");
        python
    })
}

/// What the client has to print of each increment.
fn expected(lines: &[String]) -> Vec<(u64, f64)> {
    let of = |line: &String| {
        let row: Value = serde_json::from_str(line).expect("JSON");
        (row["index"].as_u64().expect("an index"), row["load_factor"].as_f64().expect("a load"))
    };
    lines.iter().map(of).collect()
}

fn printed(line: &str) -> (u64, f64) {
    let mut words = line.split(' ');
    let mut next = || words.next().expect("a word");
    (next().parse().expect("an index"), next().parse().expect("a load"))
}

fn serve(database: &Path, listen: &str) -> Process {
    let mut command = Command::new(env!("CARGO_BIN_EXE_arcslip"));
    command.args(["serve", "--listen", listen, "--lease", "400ms", "--database"]).arg(database);
    command.env("RUST_LOG", "error");
    Process::start(command)
}

#[tokio::test]
async fn the_python_client_reads_a_path_through_a_restart() {
    let Some(mut python) = python() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let (database, file) = (folder.path().join("jobs.db"), folder.path().join("request.json"));
    let request = in_short_steps("one-bar-truss", 2000, 500);
    std::fs::write(&file, request.to_string()).expect("written");
    let expected = expected(&solved(&request));

    let server = serve(&database, "127.0.0.1:0");
    let url = server.url.clone();
    let mut reader = python.arg(CLIENT).args([&url]).arg(&file).stdout(Stdio::piped()).spawn().expect("it starts");
    let mut lines = BufReader::new(reader.stdout.take().expect("its output")).lines().map_while(Result::ok);
    let job = lines.next().expect("a line").strip_prefix("job ").expect("the job").to_owned();
    let mut got: Vec<(u64, f64)> = lines.by_ref().take(20).map(|line| printed(&line)).collect();
    server.kill();
    let again = serve(&database, url.strip_prefix("http://").expect("an address"));
    let rest: Vec<String> = lines.collect();
    let (end, rest) = rest.split_last().expect("its end");
    got.extend(rest.iter().map(|line| printed(line)));

    assert_eq!(got, expected, "each increment once, in order");
    let ended = until(&client(), &again.url, &format!("/v1/jobs/{job}"), |job| job["status"] != "running").await;
    assert!(end.starts_with(ended["status"].as_str().expect("a status")), "{end}: {ended}");
    assert!(reader.wait().expect("it ends").success());
}

#[test]
fn the_python_client_says_where_a_request_is_wrong() {
    let Some(mut python) = python() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("request.json");
    let mut request = scene("one-bar-truss");
    request["model"]["contacts"][0]["friction"] = Value::from(-1.0);
    std::fs::write(&file, request.to_string()).expect("written");
    let server = serve(&folder.path().join("jobs.db"), "127.0.0.1:0");
    let output = python.arg(CLIENT).arg(&server.url).arg(&file).output().expect("it runs");
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let said = String::from_utf8(output.stderr).expect("text");
    assert!(said.contains("/model/contacts/0/friction"), "{said}");
}

#[test]
fn the_python_client_shows_its_token_where_one_is_asked_for() {
    let Some(mut python) = python() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let (tokens, file) = (folder.path().join("tokens"), folder.path().join("request.json"));
    let made = Command::new(env!("CARGO_BIN_EXE_arcslip")).args(["token", "ann"]).output().expect("it runs");
    std::fs::write(&tokens, &made.stdout).expect("written");
    std::fs::write(&file, scene("klarbring").to_string()).expect("written");
    let tokens = tokens.to_str().expect("a name");
    let server = Process::serve(&folder.path().join("jobs.db"), &["--tokens-file", tokens]);
    python.arg(CLIENT).arg(&server.url).arg(&file);
    let refused = python.output().expect("it runs");
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    assert!(String::from_utf8_lossy(&refused.stderr).contains("Authorization: Bearer"), "{refused:?}");
    let token = String::from_utf8(made.stderr).expect("text");
    let taken = python.env("ARCSLIP_TOKEN", token.trim()).output().expect("it runs");
    assert_eq!(taken.status.code(), Some(0), "{taken:?}");
    assert!(String::from_utf8_lossy(&taken.stdout).trim_end().ends_with("completed stages_completed"), "{taken:?}");
}
