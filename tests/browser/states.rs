//! The dashboard where there is little to be seen or much to be typed: nothing yet, nothing any more, tokens, the keyboard, a
//! phone.
//!
//! Where there is no chromedriver these tests say that they are skipped; with `ARCSLIP_BROWSER=required` they fail there.

use crate::common::browser::Browser;
use crate::common::process::{self, Process, Served};
use crate::common::server::TestServer;
use crate::common::service::{occupation, request, scene};
use crate::common::solver::MadeUp;
use arcslip::service::http::access::tokens;
use serde_json::{Value, json};
use std::process::Command;

const STATUS: &str = "document.getElementById('status')?.dataset.status";
const STRUCTURE: &str = "document.getElementById('structure-plot')";

#[tokio::test]
async fn the_list_of_calls_is_that_of_the_service() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
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
    let served = Served::start();
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
async fn what_is_not_recorded_is_not_drawn_as_if_it_were() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let mut request = scene("three-snapping-bars");
    request["analysis"]["record"] = json!({"nodes": ["tip2"], "contacts": [], "every": 10});
    let id = served.ended(&request).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until("document.getElementById('structure').textContent.includes('nodes 1 are recorded')").await;
    let bars = "document.getElementById('structure-plot').data.filter(({name}) => name.startsWith('bar '))";
    let words = browser.ask(&format!("{bars}.flatMap(({{text}}) => text).filter(Boolean)")).await;
    for words in words.as_array().expect("a list").iter().filter_map(Value::as_str) {
        assert!(!words.contains("tip0") && !words.contains("tip1"), "{words}");
    }
    // Directions without contacts have no column of them.
    let mut bare = scene("klarbring");
    bare["analysis"] = json!({"record": {"contacts": []}});
    let bare = served.ended(&bare).await;
    browser.visit(&format!("{}/?jobs={bare}&at=7", served.url())).await;
    browser.until("document.querySelector('#directions table') !== null").await;
    let head = "[...document.querySelectorAll('#directions th')].map(({textContent}) => textContent)";
    assert_eq!(browser.ask(head).await, json!(["", "", "load rate", "dissipation rate"]));
    // One that is gone does not hide the other, whichever stands first.
    let gone = "00000000-0000-7000-8000-000000000000";
    for shared in [format!("{gone},{id}"), format!("{id},{gone}")] {
        browser.visit(&format!("{}/?jobs={shared}", served.url())).await;
        browser.until("document.getElementById('notice').textContent.includes('Not all jobs can be shown')").await;
        browser.until(&format!("{STATUS} !== undefined && !document.getElementById('job').hidden")).await;
    }
    browser.close(served.url(), &["status of 404"]).await;
}

#[tokio::test]
async fn an_address_that_asks_for_what_there_is_not_shows_what_there_is_and_says_so() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("klarbring")).await;
    let twice = format!("{id},{}", id.to_uppercase());
    browser.visit(&format!("{}/?jobs={twice}&abscissa=arc_length,/arc_length&status=nothing", served.url())).await;
    browser
        .until("document.getElementById('notice').textContent.includes('There is no “arc_length,/arc_length” here')")
        .await;
    browser.until("document.getElementById('path-plot').layout?.xaxis.title.text === 'displacement x of node'").await;
    // The exact path alone.
    browser.until("document.querySelectorAll('#path .legend li').length === 1").await;
    assert_eq!(browser.ask("document.getElementById('filter').value").await, "");
    browser.until("document.querySelectorAll('#lists a').length === 1").await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn the_structure_of_a_job_that_waits_is_drawn_as_the_model_has_it() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let service = Process::serve(&folder.path().join("jobs.db"), &["--workers", "1"]);
    let client = process::client();
    let running = process::submit(&client, &service.url, "/v1/jobs", &occupation()).await;
    let id = process::submit(&client, &service.url, "/v1/jobs", &scene("one-bar-truss")).await;
    browser.visit(&format!("{}/?jobs={id}", service.url)).await;
    browser.until("document.getElementById('structure').textContent.includes('No increment yet')").await;
    let node = format!("{STRUCTURE}.data?.find(({{name}}) => name === 'node')");
    assert_eq!(browser.ask(&format!("(({{x, y}}) => [x, y])({node})")).await, json!([[0, -1.5], [1, 0]]));
    assert_eq!(browser.ask(STATUS).await, "queued");
    // The one before it is cancelled by the keyboard, and what can be done then has the focus.
    browser.ask(&format!("document.querySelector('#lists a[href=\"/?jobs={running}\"]').click()")).await;
    let cancel = "[...document.querySelectorAll('#heading button')].find(({textContent}) => textContent === 'Cancel')";
    browser.until(&format!("{cancel} !== undefined && ({cancel}.focus(), true)")).await;
    browser.keys(ENTER).await;
    browser.until(&format!("{STATUS} === 'cancelled'")).await;
    browser.until("document.querySelector('#heading button') === document.activeElement").await;
    browser.ask("history.back()").await;
    browser.until(&format!("{STATUS} === 'stopped'")).await;
    browser.until("document.getElementById('structure').textContent.includes('Increment 78')").await;
    browser.close(&service.url, &[]).await;
}

/// A browser opens six connections to a host, and each of these has a stream.
#[tokio::test]
async fn more_jobs_than_a_browser_has_connections_are_followed_together() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let service = Process::serve(&folder.path().join("jobs.db"), &["--workers", "0"]);
    let client = process::client();
    let mut ids = Vec::new();
    for _ in 0..8 {
        ids.push(process::submit(&client, &service.url, "/v1/jobs", &scene("klarbring")).await);
    }
    browser.visit(&format!("{}/?jobs={}", service.url, ids.join(","))).await;
    browser.until("document.querySelectorAll('#lists input:checked').length === 8").await;
    browser.until(&format!("{STATUS} === 'queued'")).await;
    // The last to have had a turn, and the first.
    for id in [&ids[7], &ids[0]] {
        let cancel = client.post(format!("{}/v1/jobs/{id}/cancel", service.url)).send().await.expect("an answer");
        assert_eq!(cancel.status(), 202);
    }
    browser.until("document.querySelectorAll('#lists .status.cancelled').length === 2").await;
    browser.until(&format!("{STATUS} === 'cancelled'")).await;
    browser.close(&service.url, &[]).await;
}

#[tokio::test]
async fn what_has_been_read_of_a_long_path_is_drawn_while_the_rest_is_read() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::default()).await;
    let url = format!("http://{}", server.address());
    let id = server.submit(&request("long", 12_000)).await;
    server.ended(&id).await;
    let held = "const whole = window.fetch; window.fetch = async (place, ...more) => { \
                if (/columns.*after=/.test(place)) await new Promise((go) => { window.letGo = go; }); \
                return whole(place, ...more); };";
    browser.devtools("Page.addScriptToEvaluateOnNewDocument", json!({"source": held})).await;
    browser.visit(&format!("{url}/?jobs={id}")).await;
    let drawn = "document.getElementById('path-plot').data?.[0]?.x.length";
    browser.until(&format!("{drawn} === 10000 && window.letGo !== undefined")).await;
    browser.ask("window.letGo()").await;
    browser.until(&format!("{drawn} === 12000")).await;
    browser.close(&url, &[]).await;
    assert!(server.stop().await);
}

#[tokio::test]
async fn a_text_of_very_many_lines_is_checked_and_run() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    browser.visit(&format!("{}/?run&scene=klarbring", served.url())).await;
    browser.until("document.getElementById('queue')?.disabled === false").await;
    browser
        .ask(
            "(() => { const text = document.getElementById('request'); text.value = '\\n'.repeat(150000) + text.value; \
              text.dispatchEvent(new Event('input')); })()",
        )
        .await;
    // Not until it has been checked as it is now.
    browser.until("document.getElementById('queue').disabled === false").await;
    browser.press("#queue").await;
    browser.until(&format!("{STATUS} === 'completed'")).await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn a_job_is_deleted_after_a_question_and_by_the_keyboard_alone() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
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
    browser.ask("document.getElementById('skip').focus()").await;
    browser.keys(ENTER).await;
    browser.until(&format!("{focused} === 'view'")).await;
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
    assert_eq!(browser.ask(focused).await, "view");
    browser.close(served.url(), &[]).await;
}

const TAB: &str = "\u{e004}";
const SHIFT_TAB: &str = "\u{e008}\u{e004}";
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
    // No header can hold it.
    browser.put("#given-token", "arc_\u{2022}\u{2022}").await;
    browser.press("#use-token").await;
    browser.until("document.querySelector('#token [role=alert]').textContent.startsWith('That is no token')").await;
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
async fn nothing_is_wider_than_a_phone() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("curving-slip")).await;
    let branching = served.ended(&scene("one-bar-truss")).await;
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
        browser.until("document.querySelectorAll('#lists a').length === 3").await;
        let width = browser.ask("document.documentElement.scrollWidth").await;
        assert!(width.as_u64().is_some_and(|width| width <= 390), "{address}: {width}");
        // Words end where what they are of begins.
        let overlapping = "[...document.querySelectorAll('.setting label')].filter((label) => label.scrollWidth > \
                           label.clientWidth).map(({textContent}) => textContent)";
        assert_eq!(browser.ask(overlapping).await, json!([]), "{address}");
    }
    browser.visit(&format!("{}/?jobs={branching}", served.url())).await;
    browser.until("document.querySelector('#directions button[aria-label]') !== null").await;
    let follow = browser
        .ask(
            "(({left, right, height}) => [left, right, height])\
             (document.querySelector('#directions button[aria-label]').getBoundingClientRect())",
        )
        .await;
    let [left, right, height] = [0, 1, 2].map(|place| follow[place].as_f64().expect("a number"));
    assert!(left > 0.0 && right < 390.0 && height < 40.0, "{follow}");
    browser.close(served.url(), &[]).await;
}
