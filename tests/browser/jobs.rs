//! The dashboard in a browser, served by the real program.
//!
//! Where there is no chromedriver these tests say that they are skipped; with `ARCSLIP_BROWSER=required` they fail there.

use crate::common::browser::Browser;
use crate::common::process::{self, Process};
use crate::common::service::{in_short_steps, indices, scene};
use serde_json::{Value, json};
use std::net::TcpListener;
use std::path::Path;
use std::process::Command;

/// The named points of the path that is drawn first.
const NAMED: &str = "document.getElementById('path-plot').data?.[1]";
const STATUS: &str = "document.getElementById('status')?.dataset.status";

fn numbers(values: &Value) -> Vec<f64> {
    values.as_array().expect("a list").iter().map(|value| value.as_f64().expect("a number")).collect()
}

#[tokio::test]
async fn a_scene_is_run_and_its_limit_points_are_drawn_and_named() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let service = Process::serve(&folder.path().join("jobs.db"), &[]);
    browser.page.goto(&format!("{}/?run&scene=one-bar-truss", service.url)).await.expect("a page");
    browser.until("document.getElementById('queue')?.disabled === false").await;
    let plan = browser.ask("document.getElementById('verdict').textContent").await;
    assert!(plan.as_str().is_some_and(|plan| plan.contains("Left out: second-order cones")), "{plan}");
    browser.ask("document.getElementById('queue').click()").await;
    browser.until(&format!("{STATUS} === 'stopped'")).await;
    browser.until(&format!("{NAMED}?.x.length === 3")).await;
    let drawn = browser.ask(NAMED).await;
    assert_eq!(drawn["text"], json!(["A", "B", "C"]), "two limits and the end");
    let client = process::client();
    let jobs = process::get(&client, &service.url, "/v1/jobs").await.expect("a list");
    let id = jobs["jobs"][0]["id"].as_str().expect("an id").to_owned();
    let lines = process::lines(&client, &service.url, &id).await;
    let stored: Vec<Value> = lines.iter().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let limits: Vec<&Value> = stored.iter().filter(|line| line["point"]["kind"] == "smooth_limit").collect();
    assert_eq!(limits.len(), 2);
    for (place, limit) in limits.iter().enumerate() {
        assert_eq!(drawn["y"][place], limit["load_factor"]);
        assert_eq!(drawn["x"][place], limit["displacements"]["tip"][0]);
    }
    let line = browser.ask("document.getElementById('path-plot').data[0]").await;
    let largest = numbers(&line["y"]).into_iter().fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(Some(largest), drawn["y"][0].as_f64(), "the first is the load that the structure bears");
    // The address alone shows the same again.
    let address = browser.page.current_url().await.expect("an address").to_string();
    assert!(address.contains(&id), "{address}");
    browser.page.goto(&address).await.expect("a page");
    browser.until(&format!("{NAMED}?.x.length === 3")).await;
    browser.until("document.querySelector('#structure-plot .main-svg') !== null").await;
    browser.close(&service.url, &[]).await;
}

#[tokio::test]
async fn a_broken_model_is_refused_at_its_line() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let service = Process::serve(&folder.path().join("jobs.db"), &[]);
    browser.page.goto(&format!("{}/?run&scene=one-bar-truss", service.url)).await.expect("a page");
    browser.until("document.getElementById('queue')?.disabled === false").await;
    let mut broken = scene("one-bar-truss");
    broken["model"]["contacts"][0]["node"] = json!("top");
    let text = serde_json::to_string_pretty(&broken).expect("JSON");
    let line = text.lines().position(|line| line.contains("\"top\"")).expect("it is there") + 1;
    browser.put("#request", &text).await;
    let told = browser.until("document.querySelector('#verdict .mistakes')?.textContent").await;
    let told = told.as_str().expect("text");
    assert!(told.contains(&format!("Line {line} ")) && told.contains("`top`") && told.contains("`tip`"), "{told}");
    assert_eq!(browser.ask("document.getElementById('queue').disabled").await, true);
    browser.put("#request", "{\n  \"model\": {,}\n}").await;
    browser.until("document.querySelector('#verdict .mistakes')?.textContent.includes('Line 2')").await;
    // The browser itself tells of every answer of that kind.
    browser.close(&service.url, &["status of 422", "status of 400"]).await;
}

const TEXT: &str = "document.getElementById('request').value";

#[tokio::test]
async fn a_mistake_after_other_letters_than_ascii_is_found_at_its_character() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let service = Process::serve(&folder.path().join("jobs.db"), &[]);
    browser.page.goto(&format!("{}/?run&scene=klarbring", service.url)).await.expect("a page");
    browser.until("document.getElementById('queue')?.disabled === false").await;
    browser.put("#request", "{\n\"\u{e4}\u{1f600}\" 1}").await;
    browser.until("document.querySelector('#verdict .mistakes')?.textContent.includes('line 2 column 6')").await;
    browser.ask("document.querySelector('#verdict .mistakes button').click()").await;
    let selected = "(({value, selectionStart, selectionEnd}) => value.slice(selectionStart, selectionEnd))\
                    (document.getElementById('request'))";
    assert_eq!(browser.ask(selected).await, "1");
    browser.close(&service.url, &["status of 400"]).await;
}

#[tokio::test]
async fn a_text_of_the_readers_own_is_named_so_and_brought_back_where_another_takes_its_place() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let service = Process::serve(&folder.path().join("jobs.db"), &[]);
    let client = process::client();
    let id = process::submit(&client, &service.url, "/v1/jobs", &scene("von-mises-truss")).await;
    process::until(&client, &service.url, &format!("/v1/jobs/{id}"), process::has_ended).await;
    browser.page.goto(&format!("{}/?run&scene=klarbring", service.url)).await.expect("a page");
    browser.until("document.getElementById('queue')?.disabled === false").await;
    let chosen = "document.getElementById('scene').selectedOptions[0].textContent";
    browser.put("#request", "{\"model\": 1}").await;
    assert_eq!(browser.ask(chosen).await, "klarbring, changed");
    browser.put("#scene", "one-bar-truss").await;
    browser.until(&format!("{TEXT}.includes('one-bar truss') && {chosen} === 'one-bar-truss'")).await;
    browser.press("#bring-back").await;
    assert_eq!(browser.ask(TEXT).await, "{\"model\": 1}");
    // Dropped beside the form: the browser does not leave the page for it.
    let dropped = "(() => { const dataTransfer = new DataTransfer(); \
                   dataTransfer.items.add(new File(['{\"model\": 2}'], 'own.json')); \
                   const event = new DragEvent('drop', { dataTransfer, bubbles: true, cancelable: true }); \
                   document.querySelector('header').dispatchEvent(event); return event.defaultPrevented; })()";
    assert_eq!(browser.ask(dropped).await, true);
    browser.until(&format!("{TEXT} === '{{\"model\": 2}}' && {chosen} === 'a text of your own'")).await;
    // There and back leaves a text as it was written.
    browser.put("#scene", "klarbring").await;
    browser.until(&format!("{TEXT}.includes(\"Klarbring's node\") && {chosen} === 'klarbring'")).await;
    let before = browser.ask(TEXT).await;
    browser.put("#kind", "sweep").await;
    browser.until(&format!("{TEXT}.includes('\"sweep\"')")).await;
    browser.put("#kind", "").await;
    browser.until(&format!("!{TEXT}.includes('\"sweep\"')")).await;
    assert_eq!(browser.ask(TEXT).await, before);
    assert_eq!(browser.ask(chosen).await, "klarbring");
    browser.put("#kind", "sweep").await;
    // Fields for what is varied change the text, and follow it.
    let values = "[aria-label='values of parameter 1']";
    browser.until(&format!("document.querySelector(\"{values}\")?.value.startsWith('0.1, 0.2')")).await;
    browser.put("[aria-label='parameter 1']", "/model/contacts/*/friction").await;
    browser.put(values, "0.25, 0.5").await;
    browser.put("#setting-refine", "3").await;
    browser.until("document.getElementById('verdict').textContent.includes('2 paths, each a job of its own, and up to 3 more')").await;
    let written = "JSON.stringify(JSON.parse(document.getElementById('request').value).sweep)";
    assert_eq!(browser.ask(written).await, "{\"replace\":{\"/model/contacts/*/friction\":[0.25,0.5]},\"refine\":3}");
    // What is told of each path.
    browser.press("#sweep-add-response").await;
    browser.put("[aria-label='name of response 1']", "reaction").await;
    browser.put("[aria-label='column of response 1']", "load_factor").await;
    browser.put("[aria-label='place of response 1']", "load_factor=0.25").await;
    let responses = "JSON.stringify(JSON.parse(document.getElementById('request').value).sweep.responses)";
    let expected = "{\"reaction\":{\"value\":\"load_factor\",\"at\":{\"value\":\"load_factor\",\"reaches\":0.25}}}";
    assert_eq!(browser.ask(responses).await, expected);
    browser.press("[aria-label='remove response 1']").await;
    assert_eq!(browser.ask(written).await, "{\"replace\":{\"/model/contacts/*/friction\":[0.25,0.5]},\"refine\":3}");
    // A warning of the runs stands in the plan.
    browser.put(values, "0.25, 30").await;
    browser.until("document.getElementById('verdict').textContent.includes('unusually large')").await;
    browser.put(values, "0.25, 0.5").await;
    browser.press("#sweep-add").await;
    browser.press("[aria-label='remove parameter 2']").await;
    browser.put("#kind", "").await;
    // The model of a job, though a text of one's own stands in the form.
    let again = "[...document.querySelectorAll('#heading button')].find(({textContent}) => /^Duplicate and edit/.test(textContent))";
    browser.ask(&format!("document.querySelector('#lists a[href=\"/?jobs={id}\"]').click()")).await;
    for _ in 0..2 {
        browser.until(&format!("{again} !== undefined && !document.getElementById('job').hidden")).await;
        browser.ask(&format!("{again}.click()")).await;
        browser.until(&format!("{TEXT}.includes('von Mises truss') && {chosen} === 'the model of a job'")).await;
        browser.put("#request", "{}").await;
        browser.ask("[...document.querySelectorAll('#run button')].find(({textContent}) => textContent === 'Close').click()").await;
    }
    browser.close(&service.url, &["status of 422"]).await;
}

#[tokio::test]
async fn another_direction_is_followed_and_drawn_beside_the_path() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let service = Process::serve(&folder.path().join("jobs.db"), &[]);
    let client = process::client();
    let id = process::submit(&client, &service.url, "/v1/jobs", &scene("klarbring")).await;
    process::until(&client, &service.url, &format!("/v1/jobs/{id}"), process::has_ended).await;
    browser.page.goto(&format!("{}/?jobs={id}&at=7", service.url)).await.expect("a page");
    browser.until("document.querySelector('#directions button') !== null").await;
    browser.ask("document.querySelector('#directions button').click()").await;
    browser.until("document.querySelectorAll('#path .legend li').length >= 2").await;
    browser.until("document.getElementById('path-plot').data[2].customdata?.length > 1").await;
    let branch = process::get(&client, &service.url, &format!("/v1/jobs?parent={id}")).await.expect("a list");
    assert_eq!(branch["jobs"].as_array().map(Vec::len), Some(1));
    assert_eq!(branch["jobs"][0]["progress"]["max_increments"], 20, "about as far as the path, not as far as it may");
    let begins = browser.ask("(({data: [line, , branch]}) => [line.y[line.customdata.indexOf(7)], branch.y[0]])(document.getElementById('path-plot'))").await;
    assert_eq!(begins[0], begins[1], "it begins where it leaves the other");
    browser.close(&service.url, &[]).await;
}

/// From the form below the directions to the picture of the curve, and on to the list.
#[tokio::test]
async fn a_limit_point_is_followed_in_friction() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let service = Process::serve(&folder.path().join("jobs.db"), &[]);
    let client = process::client();
    let id = process::submit(&client, &service.url, "/v1/jobs", &scene("klarbring")).await;
    process::until(&client, &service.url, &format!("/v1/jobs/{id}"), process::has_ended).await;
    browser.page.goto(&format!("{}/?jobs={id}", service.url)).await.expect("a page");
    browser.until("document.querySelector('#continue') !== null").await;
    assert_eq!(browser.ask("document.getElementById('curve-parameter').value").await, "/model/contacts/0/friction");
    // A range without the model's own value is refused in words.
    browser.put("#curve-from", "1.6").await;
    browser.put("#curve-to", "2").await;
    browser.press("#continue").await;
    browser.until("document.querySelector('#continuing [role=alert]').textContent.includes('own value 1.5')").await;
    browser.put("#curve-from", "1").await;
    browser.press("#continue").await;
    browser.until("document.getElementById('curve-plot')?.data?.length >= 2").await;
    browser.until("document.getElementById('curve-status').textContent === 'completed'").await;
    browser.until("document.getElementById('curve').textContent.includes('the load no longer turns')").await;
    let drawn = browser.ask("document.getElementById('curve-plot').data.map(({name}) => name)").await;
    assert_eq!(drawn, json!(["limit point at a contact change", "change"]));
    assert!(browser.ask("location.search").await.as_str().expect("text").starts_with("?curve="));
    browser.until("document.querySelector('#lists a[href^=\"/?curve=\"]') !== null").await;
    browser.close(&service.url, &["status of 422"]).await;
}

/// The program on that port.
fn serve_on(port: u16, database: &Path) -> Process {
    let mut command = Command::new(env!("CARGO_BIN_EXE_arcslip"));
    command.args(["serve", "--listen", &format!("127.0.0.1:{port}"), "--database"]).arg(database);
    command.env("RUST_LOG", "error");
    Process::start(command)
}

#[tokio::test]
async fn a_path_goes_on_growing_without_a_gap_after_a_restart() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let port = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a port").port();
    let service = serve_on(port, &database);
    let client = process::client();
    let url = service.url.clone();
    // Long enough to be under way when the program goes down.
    let mut request = in_short_steps("one-bar-truss", 800_000, 500_000);
    request["analysis"]["record"] = json!({"every": 400, "directions": false});
    let id = process::submit(&client, &url, "/v1/jobs", &request).await;
    browser.page.goto(&format!("{url}/?jobs={id}")).await.expect("a page");
    browser.until("document.getElementById('path-plot').data?.[0]?.x.length > 20").await;
    service.terminated().await;
    browser.until("document.getElementById('connection').textContent.startsWith('Disconnected')").await;
    let before = browser.ask("document.getElementById('path-plot').data[0].x.length").await;
    let again = serve_on(port, &database);
    browser.until("document.getElementById('connection').textContent === ''").await;
    process::until(&client, &again.url, &format!("/v1/jobs/{id}"), process::has_ended).await;
    browser.until(&format!("['stopped', 'completed'].includes({STATUS})")).await;
    let drawn = browser.ask("document.getElementById('path-plot').data[0].customdata.filter(Number.isInteger)").await;
    let drawn = numbers(&drawn);
    let lines = process::lines(&client, &again.url, &id).await;
    let stored: Vec<f64> = indices(lines.iter().map(String::as_str)).into_iter().map(|index| index as f64).collect();
    assert!(before.as_u64().is_some_and(|before| before < stored.len() as u64), "it was cut: {before}");
    assert!(drawn == stored, "without gap or repeat: {} of {}", drawn.len(), stored.len());
    browser.close(&url, &["net::ERR_"]).await;
}

#[tokio::test]
async fn a_service_that_goes_while_an_ended_job_is_looked_at_is_told_and_found_again() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let database = folder.path().join("jobs.db");
    let port = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr()).expect("a port").port();
    let service = serve_on(port, &database);
    let (client, url) = (process::client(), service.url.clone());
    let id = process::submit(&client, &url, "/v1/jobs", &scene("klarbring")).await;
    process::until(&client, &url, &format!("/v1/jobs/{id}"), process::has_ended).await;
    browser.page.goto(&format!("{url}/?jobs={id}")).await.expect("a page");
    browser.until("document.getElementById('structure-plot').data?.length > 2").await;
    service.terminated().await;
    // It has to be asked for what was not asked for before.
    browser.put("#ordinate", "/energy/dissipated").await;
    browser.until("document.getElementById('connection').textContent.startsWith('Disconnected')").await;
    browser.until("document.getElementById('notice').textContent.includes('The service cannot be reached.')").await;
    let _again = serve_on(port, &database);
    browser.until("document.getElementById('connection').textContent === ''").await;
    let title = "document.getElementById('path-plot').layout.yaxis.title.text";
    browser.until(&format!("{title} === 'dissipated energy'")).await;
    browser.until("document.getElementById('notice').hidden").await;
    browser.close(&url, &["net::ERR_"]).await;
}
