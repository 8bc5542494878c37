//! What a reader of the dashboard does with it: settings, directions, energies, the structure in space, studies, states in
//! which there is nothing to be seen, tokens, the keyboard.
//!
//! Where there is no chromedriver these tests say that they are skipped; with `ARCSLIP_BROWSER=required` they fail there.
#![cfg(feature = "server")]

mod common;

use arcslip::http::access::tokens;
use common::browser::Browser;
use common::process::{self, Process};
use common::service::scene;
use serde_json::{Value, json};
use std::process::Command;

const STATUS: &str = "document.getElementById('status')?.textContent";
const PATH: &str = "document.getElementById('path-plot')";
const MARK: &str = "document.getElementById('path-plot').data[2]";
const STRUCTURE: &str = "document.getElementById('structure-plot')";

struct Served {
    service: Process,
    client: reqwest::Client,
    _folder: tempfile::TempDir,
}

fn serve() -> Served {
    let folder = tempfile::tempdir().expect("a folder");
    let service = Process::serve(&folder.path().join("jobs.db"), &[]);
    Served { service, client: process::client(), _folder: folder }
}

impl Served {
    fn url(&self) -> &str {
        &self.service.url
    }

    /// A job that has ended.
    async fn ended(&self, request: &Value) -> String {
        let id = process::submit(&self.client, self.url(), "/v1/jobs", request).await;
        process::until(&self.client, self.url(), &format!("/v1/jobs/{id}"), process::has_ended).await;
        id
    }

    async fn get(&self, place: &str) -> Value {
        process::get(&self.client, self.url(), place).await.expect("an answer")
    }
}

#[tokio::test]
async fn settings_have_words_and_defaults_and_agree_with_the_text() {
    let Some(browser) = Browser::open().await else { return };
    let served = serve();
    browser.visit(&format!("{}/?run&scene=klarbring", served.url())).await;
    browser.until("document.getElementById('queue')?.disabled === false").await;
    let document = served.get("/openapi.json").await;
    let analysis = &document["components"]["schemas"]["Analysis"]["properties"];
    let shown = browser.ask("document.getElementById('settings').textContent").await;
    let words = analysis["max_increments"]["description"].as_str().expect("text").replace('\n', " ");
    assert!(shown.as_str().is_some_and(|shown| shown.contains(&words)), "{shown}");
    let standard = browser.ask("document.getElementById('setting-max_increments').placeholder").await;
    assert_eq!(standard, format!("{} (default)", analysis["max_increments"]["default"]));
    // From the fields into the text, the rest of which stays as it was written.
    let before = browser.ask("document.getElementById('request').value").await;
    browser.put("#setting-max_increments", "7").await;
    browser.put("#setting-arc_length-max", "0.25").await;
    browser.put("#setting-selection", "straightest").await;
    let after = browser.ask("document.getElementById('request').value").await;
    let (before, after) = (before.as_str().expect("text"), after.as_str().expect("text"));
    let request: Value = serde_json::from_str(after).expect("JSON");
    assert_eq!(
        request["analysis"],
        json!({"max_increments": 7, "arc_length": {"max": 0.25}, "selection": "straightest"})
    );
    assert_eq!(request["model"], scene("klarbring")["model"]);
    assert!(after.starts_with(before.trim_end().trim_end_matches('}').trim_end()), "{after}");
    // What is as by default is not written.
    browser.put("#setting-arc_length-max", "").await;
    browser.put("#setting-selection", "").await;
    let text = browser.ask("document.getElementById('request').value").await;
    let request: Value = serde_json::from_str(text.as_str().expect("text")).expect("JSON");
    assert_eq!(request["analysis"], json!({"max_increments": 7}));
    // From the text into the fields.
    let mut other = scene("klarbring");
    other["analysis"] = json!({"method": "mpec", "arc_length": {"jump": false}, "max_increments": 5});
    browser.put("#request", &other.to_string()).await;
    let names = "['method', 'max_increments', 'selection', 'arc_length-jump']";
    let fields = format!("{names}.map((name) => document.getElementById(`setting-${{name}}`).value)");
    assert_eq!(browser.ask(&fields).await, json!(["mpec", "5", "", "false"]));
    // A text that cannot be read takes no settings.
    browser.put("#request", "{").await;
    assert_eq!(browser.ask("document.querySelector('fieldset.settings').disabled").await, true);
    browser.put("#request", &other.to_string()).await;
    browser.press("#queue").await;
    browser.until(&format!("{STATUS} === 'completed'")).await;
    let jobs = served.get("/v1/jobs").await;
    let id = jobs["jobs"][0]["id"].as_str().expect("an id");
    assert_eq!(served.get(&format!("/v1/jobs/{id}/request")).await["analysis"]["method"], "mpec");
    browser.close(served.url(), &["status of 4"]).await;
}

#[tokio::test]
async fn the_last_bifurcation_is_shown_where_none_is_chosen_and_energies_are_drawn_over_the_path() {
    let Some(browser) = Browser::open().await else { return };
    let served = serve();
    let id = served.ended(&scene("klarbring")).await;
    let page = served.get(&format!("/v1/jobs/{id}/increments")).await;
    let increments = page["increments"].as_array().expect("a list");
    let last = increments.iter().rfind(|line| line["point"]["bifurcation"] == true).expect("one");
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    let told = browser.until("document.querySelector('#directions h2')?.textContent").await;
    assert_eq!(told, format!("Directions at increment {}, the last bifurcation of the path", last["index"]));
    // The energy that friction has taken, over the path.
    browser.put("#ordinate", "/energy/dissipated").await;
    browser.until(&format!("{PATH}.layout.yaxis.title.text === 'dissipated energy'")).await;
    let drawn = browser.ask(&format!("{PATH}.data[0].y.filter((value) => value !== null)")).await;
    let drawn: Vec<_> = drawn.as_array().expect("a list").iter().map(Value::as_f64).collect();
    let stored: Vec<_> = increments.iter().map(|line| line["energy"]["dissipated"].as_f64()).collect();
    assert_eq!(drawn, stored);
    browser.until("location.search.includes('ordinate=%2Fenergy%2Fdissipated')").await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn structure_and_path_point_at_each_other_and_space_is_turned_by_dragging() {
    let Some(browser) = Browser::open().await else { return };
    let served = serve();
    let id = served.ended(&scene("curving-slip")).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{STRUCTURE}.data?.length > 3")).await;
    let size = browser.ask(&format!("{MARK}.marker.size")).await.as_f64().expect("a number");
    let (x, y) = browser.middle_of("#structure-plot").await;
    browser.drag(&[(x - 2.0, y), (x, y)], false).await;
    browser.until(&format!("{MARK}.marker.size > {size}")).await;
    let places = format!("{STRUCTURE}.data.find(({{name}}) => name === 'node').x");
    let before = browser.ask(&places).await;
    browser.drag(&[(x, y), (x + 40.0, y + 10.0), (x + 80.0, y + 20.0)], true).await;
    browser.until(&format!("{places}.join() !== '{}'", join(&before))).await;
    assert_ne!(browser.ask("document.getElementById('azimuth').value").await, "-60", "the slider goes along");
    browser.until("/[?&]turn=-?[0-9]+,[0-9]+/.test(location.search)").await;
    // Over a point of the path its structure is shown.
    let place = "(({left, top}, {_fullLayout: {xaxis, yaxis}, data: [line]}) => [left + xaxis._offset + xaxis.c2p(line.x[9]), \
                 top + yaxis._offset + yaxis.c2p(line.y[9])])(document.getElementById('path-plot').getBoundingClientRect(), document.getElementById('path-plot'))";
    browser.middle_of("#path-plot").await;
    let found = browser.ask(place).await;
    let (x, y) = (found[0].as_f64().expect("a number"), found[1].as_f64().expect("a number"));
    browser.drag(&[(x - 3.0, y), (x, y)], false).await;
    browser.until("/^Increment (8|9|10),/.test(document.querySelector('#structure .slider + p').textContent)").await;
    browser.close(served.url(), &[]).await;
}

fn join(numbers: &Value) -> String {
    let numbers = numbers.as_array().expect("a list").iter();
    numbers
        .map(|number| if number.is_null() { String::new() } else { number.to_string() })
        .collect::<Vec<_>>()
        .join(",")
}

#[tokio::test]
async fn a_study_is_queued_listed_and_drawn() {
    let Some(browser) = Browser::open().await else { return };
    let served = serve();
    browser.visit(&format!("{}/?run&scene=von-mises-truss&as=study", served.url())).await;
    browser.until("document.getElementById('setting-repeats') !== null").await;
    browser.put("#setting-repeats", "1").await;
    browser.put("#setting-arc_lengths", "0.2, 0.1").await;
    browser
        .until("document.getElementById('verdict').textContent.includes('arc length 0.2, 0.1, timed 1 times')")
        .await;
    browser.press("#queue").await;
    browser.until("document.getElementById('study-status')?.textContent === 'completed'").await;
    browser.until("document.getElementById('study-plot').layout?.xaxis.title.text === 'run time, s'").await;
    let drawn = browser
        .ask("document.getElementById('study-plot').data.map(({name, x, y}) => [name.split(',')[0], x, y])")
        .await;
    let id = served.get("/v1/studies").await["studies"][0]["id"].as_str().expect("an id").to_owned();
    let study = served.get(&format!("/v1/studies/{id}")).await;
    let rows = study["report"]["rows"].as_array().expect("rows");
    for line in drawn.as_array().expect("lines") {
        let own: Vec<&Value> =
            rows.iter().filter(|row| row["method"] == line[0] && !row["path_error"].is_null()).collect();
        let part =
            |name: &str| Value::Array(own.iter().map(|row| row.pointer(name).expect("a value").clone()).collect());
        assert!(own.len() == 2 && line[1] == part("/time/median_s"), "{line}");
        assert_eq!(line[2], part("/path_error"));
    }
    assert_eq!(browser.ask("document.querySelectorAll('#study tbody tr').length").await, rows.len());
    let link = browser.ask("document.querySelector('#lists a[aria-current]')?.getAttribute('href')").await;
    assert_eq!(link, format!("/?study={id}"));
    let address = browser.page.current_url().await.expect("an address").to_string();
    assert!(address.contains(&id), "{address}");
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn every_built_in_scene_is_drawn() {
    let Some(browser) = Browser::open().await else { return };
    let served = serve();
    let scenes = served.get("/v1/scenes").await;
    for summary in scenes["scenes"].as_array().expect("a list") {
        let name = summary["name"].as_str().expect("a name");
        let id = served.ended(&scene(name)).await;
        browser.visit(&format!("{}/?jobs={id}", served.url())).await;
        browser.until(&format!("{STRUCTURE}?.data?.some(({{name}}) => name === 'node')")).await;
        let kept = served.get(&format!("/v1/jobs/{id}")).await["progress"]["increments"].clone();
        assert_eq!(
            browser.ask(&format!("{PATH}.data[0].customdata.filter(Number.isInteger).length")).await,
            kept,
            "{name}"
        );
        let has_number = "document.getElementById('stop').textContent.includes('increments. ')";
        assert_eq!(browser.ask(has_number).await, true, "{name}");
        assert_eq!(browser.ask("document.getElementById('notice').hidden").await, true, "{name}");
    }
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn the_list_of_calls_is_that_of_the_service() {
    let Some(browser) = Browser::open().await else { return };
    let served = serve();
    browser.visit(&format!("{}/", served.url())).await;
    browser.until("document.querySelector('#lists .quiet')?.textContent.startsWith('There are no jobs yet')").await;
    browser.ask("document.querySelector('#calls > summary').click()").await;
    browser.until("document.querySelectorAll('#calls tr').length > 20").await;
    let listed = browser.ask("[...document.querySelectorAll('#calls tr')].map((row) => [...row.children].slice(0, 2).map(({textContent}) => textContent).join(' '))").await;
    let document = served.get("/openapi.json").await;
    let listed: Vec<&str> = listed.as_array().expect("rows").iter().filter_map(Value::as_str).collect();
    for (path, calls) in document["paths"].as_object().expect("paths") {
        for method in calls.as_object().expect("calls").keys() {
            let call = format!("{} {path}", method.to_uppercase());
            assert!(listed.contains(&call.as_str()), "{call} in {listed:?}");
        }
    }
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn what_cannot_be_shown_says_so_and_is_tried_again() {
    let Some(browser) = Browser::open().await else { return };
    let served = serve();
    let url = served.url().to_owned();
    browser.visit(&format!("{url}/?status=failed&jobs=00000000-0000-7000-8000-000000000000")).await;
    browser.until("document.getElementById('notice').textContent.startsWith('The job cannot be shown: ')").await;
    browser.until("document.querySelector('#lists .quiet')?.textContent === 'No job is failed.'").await;
    let id = served.ended(&scene("klarbring")).await;
    browser.visit(&format!("{url}/")).await;
    browser.until("document.querySelector('#lists a') !== null").await;
    browser.until("window.Plotly !== undefined").await;
    served.service.terminated().await;
    browser.ask("document.querySelector('#lists a').click()").await;
    browser.until("document.getElementById('notice').textContent.includes('The service cannot be reached.')").await;
    assert_eq!(browser.ask("document.querySelector('#notice button').textContent").await, "Try again");
    assert!(browser.page.current_url().await.expect("an address").to_string().contains(&id));
    browser.close(&url, &["status of 404", "net::ERR_"]).await;
}

#[tokio::test]
async fn a_job_is_deleted_after_a_question_and_by_the_keyboard_alone() {
    let Some(browser) = Browser::open().await else { return };
    let served = serve();
    let id = served.ended(&scene("von-mises-truss")).await;
    browser.visit(&format!("{}/?jobs={id}&at=3", served.url())).await;
    browser.until(&format!("{STRUCTURE}.data?.length > 2")).await;
    let focused = "document.activeElement.id || document.activeElement.textContent";
    // Along the path by the arrows of the slider.
    browser.ask("document.getElementById('increment').focus()").await;
    browser.keys(RIGHT).await;
    browser.until("new URLSearchParams(location.search).get('at') === '4'").await;
    browser.until("document.querySelector('#structure .slider + p').textContent.startsWith('Increment 4,')").await;
    // Every control is reached in turn, with its focus to be seen, and none keeps it.
    browser.ask("document.querySelector('h1 a').focus()").await;
    let mut passed = Vec::new();
    for _ in 0..80 {
        browser.keys(TAB).await;
        let found = browser.ask(&format!("document.activeElement === document.body ? null : {focused}")).await;
        let Some(name) = found.as_str() else { break };
        let outline = browser.ask("getComputedStyle(document.activeElement).outlineStyle").await;
        assert_ne!(outline, "none", "{name}");
        passed.push(name.to_owned());
    }
    for control in ["open-run", "filter", "delete", "ordinate", "abscissa", "increment", "Diagnostics"] {
        assert!(passed.iter().any(|name| name == control), "{control} in {passed:?}");
    }
    // A question in the page itself, answered with no first.
    browser.ask("document.getElementById('delete').focus()").await;
    browser.keys(ENTER).await;
    browser
        .until("document.querySelector('.asking [role=alert]')?.textContent.startsWith('Delete “von Mises truss”')")
        .await;
    assert_eq!(browser.ask(focused).await, "No");
    browser.keys(ESCAPE).await;
    browser.until(&format!("{focused} === 'delete'")).await;
    assert_eq!(served.get(&format!("/v1/jobs/{id}")).await["status"], "completed");
    browser.keys(ENTER).await;
    browser.keys(SHIFT_TAB).await;
    assert_eq!(browser.ask(focused).await, "Yes");
    browser.keys(ENTER).await;
    browser.until("document.getElementById('notice').textContent.startsWith('Choose a job')").await;
    assert_eq!(served.get(&format!("/v1/jobs/{id}")).await["status"], 404);
    browser.close(served.url(), &[]).await;
}

const TAB: &str = "\u{e004}";
const SHIFT_TAB: &str = "\u{e008}\u{e004}\u{e008}";
const ENTER: &str = "\u{e007}";
const ESCAPE: &str = "\u{e00c}";
const RIGHT: &str = "\u{e014}";

#[tokio::test]
async fn a_service_that_asks_for_tokens_is_given_one() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let (token, hash) = tokens::make().expect("randomness");
    let file = folder.path().join("tokens");
    std::fs::write(&file, format!("ann read,submit {hash}\n")).expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_arcslip"));
    command.args(["serve", "--listen", "127.0.0.1:0", "--database"]).arg(folder.path().join("jobs.db"));
    command.env("ARCSLIP_TOKENS_FILE", &file).env("RUST_LOG", "error");
    let service = Process::start(command);
    let asks = "document.getElementById('given-token') !== null";
    browser.visit(&format!("{}/?run&scene=klarbring", service.url)).await;
    browser.until(asks).await;
    browser.put("#given-token", "arc_of_someone_else").await;
    browser.press("#use-token").await;
    browser.until("sessionStorage.length === 1").await;
    browser.until(asks).await;
    browser.put("#given-token", &token).await;
    browser.ask("document.getElementById('given-token').focus()").await;
    browser.keys(ENTER).await;
    browser.press("#queue").await;
    browser.until(&format!("{STATUS} === 'completed'")).await;
    assert_eq!(browser.ask("document.getElementById('token').hidden").await, true);
    browser.until("document.querySelectorAll('#lists a').length === 1").await;
    browser.close(&service.url, &["status of 401"]).await;
}

#[tokio::test]
async fn paths_drawn_together_are_told_apart_by_what_differs() {
    let Some(browser) = Browser::open().await else { return };
    let served = serve();
    let smooth = served.ended(&scene("one-bar-truss")).await;
    let mut rough = scene("one-bar-truss");
    rough["model"]["contacts"][0]["friction"] = json!(0.6);
    rough["analysis"] = json!({"method": "mpec"});
    let rough = served.ended(&rough).await;
    browser.visit(&format!("{}/?jobs={smooth},{rough}", served.url())).await;
    browser.until(&format!("{PATH}.data?.length >= 5")).await;
    let key =
        browser.ask("[...document.querySelectorAll('#path .legend li')].map(({textContent}) => textContent)").await;
    assert_eq!(key[0], "one-bar truss, mu = 0.3, friction 0.3, method default");
    assert_eq!(key[1], "one-bar truss, mu = 0.3, friction 0.6, method mpec");
    // The name of a job shows that job alone.
    browser.ask("document.querySelectorAll('#lists a')[0].click()").await;
    browser.until(&format!("location.search === '?jobs={rough}'")).await;
    browser.until(&format!("{PATH}.data.length < 5")).await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn nothing_is_wider_than_a_phone() {
    let Some(browser) = Browser::open().await else { return };
    let served = serve();
    let id = served.ended(&scene("curving-slip")).await;
    let study = json!({"model": scene("von-mises-truss")["model"], "study": {"repeats": 1, "arc_lengths": [0.2, 0.1]}});
    let study = process::submit(&served.client, served.url(), "/v1/studies", &study).await;
    process::until(&served.client, served.url(), &format!("/v1/studies/{study}"), process::has_ended).await;
    let phone = json!({"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": true});
    browser.devtools("Emulation.setDeviceMetricsOverride", phone).await;
    for (address, is_there) in [
        (format!("/?jobs={id}&figures"), "document.querySelector('#diagnostics-plot .main-svg') !== null"),
        ("/?run&scene=capstan".to_owned(), "document.getElementById('queue')?.disabled === false"),
        ("/?run&scene=capstan&as=study".to_owned(), "document.getElementById('queue')?.disabled === false"),
        (format!("/?study={study}"), "document.querySelectorAll('#study tbody tr').length > 3"),
    ] {
        browser.visit(&format!("{}{address}", served.url())).await;
        browser.until(is_there).await;
        browser.until("document.querySelectorAll('#lists a').length === 2").await;
        let width = browser.ask("document.documentElement.scrollWidth").await;
        assert!(width.as_u64().is_some_and(|width| width <= 390), "{address}: {width}");
    }
    browser.close(served.url(), &[]).await;
}
