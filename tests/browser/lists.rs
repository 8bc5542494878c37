//! The lists beside the view: search, words for what ended a path, small pictures, runs of a sweep, a phone's drawer.
//!
//! Where there is no chromedriver these tests say that they are skipped; with `ARCSLIP_BROWSER=required` they fail there.

use crate::common::browser::Browser;
use crate::common::process::{self, Served};
use crate::common::service::scene;
use serde_json::{Value, json};

/// The names of the jobs that are listed.
const NAMES: &str =
    "[...document.querySelectorAll('#lists [aria-label=Jobs] li.pictured a')].map(({textContent}) => textContent)";

/// The text of what a selector finds first.
fn text_of(selector: &str) -> String {
    format!("document.querySelector({selector:?})?.textContent")
}

/// A sweep of the friction of the one-bar truss; its id.
async fn swept(served: &Served) -> String {
    let mut request = scene("one-bar-truss");
    request["sweep"] = json!({"replace": {"/model/contacts/0/friction": [0.1, 0.2, 0.4]}});
    let id = process::submit(&served.client, served.url(), "/v1/sweeps", &request).await;
    process::until(&served.client, served.url(), &format!("/v1/sweeps/{id}"), process::has_ended).await;
    id
}

#[tokio::test]
async fn jobs_are_found_by_name_id_and_what_ended_them() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let truss = served.ended(&scene("one-bar-truss")).await;
    served.ended(&scene("klarbring")).await;
    browser.visit(&format!("{}/", served.url())).await;
    browser.until(&format!("{NAMES}.length === 2")).await;
    for text in ["TRUSS", "mechanism", &truss[truss.len() - 8..]] {
        browser.put("#search", text).await;
        browser.until(&format!("{NAMES}.join() === 'one-bar truss, mu = 0.3'")).await;
        let told = browser.ask(&text_of("#lists [aria-label=Jobs] + div")).await;
        assert_eq!(told, "1 found among all 2.", "{text}");
    }
    // The address follows a little later.
    browser.until("location.search.includes('search=')").await;
    browser.put("#search", "nowhere").await;
    browser.until(&format!("{} === 'Nothing found among all 2.'", text_of("#lists [aria-label=Jobs] + div"))).await;
    browser.put("#search", "").await;
    browser.until(&format!("{NAMES}.length === 2")).await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn what_is_not_loaded_is_said_not_to_be_searched() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let mut request = scene("klarbring");
    request["analysis"] = json!({"max_increments": 1});
    for _ in 0..41 {
        process::submit(&served.client, served.url(), "/v1/jobs", &request).await;
    }
    browser.visit(&format!("{}/?search=klarbring", served.url())).await;
    let told = text_of("#lists [aria-label=Jobs] + div p");
    browser
        .until(&format!("{told} === '40 found among the 40 newest; older ones are not loaded and not searched.'"))
        .await;
    browser.press("#lists [data-key=older]").await;
    browser.until(&format!("{told} === '41 found among all 41.'")).await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn a_mechanism_is_an_end_and_no_failure() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("one-bar-truss")).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{} === 'ended: mechanism'", text_of("#status"))).await;
    browser.until(&format!("{} === 'ended: mechanism'", text_of("#lists .status"))).await;
    let colours = "['stopped', 'failed'].map((name) => { const one = document.createElement('span'); \
                   one.className = `status ${name}`; document.body.append(one); return getComputedStyle(one).color; })";
    let colours = browser.ask(colours).await;
    assert_ne!(colours[0], colours[1]);
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn a_row_in_sight_has_a_picture_of_its_path() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("one-bar-truss")).await;
    let stored = served.get(&format!("/v1/jobs/{id}")).await["progress"]["last_index"].as_u64().expect("an index") + 1;
    browser.visit(&format!("{}/", served.url())).await;
    let points = "document.querySelector('#lists .thumbnail polyline')?.getAttribute('points')?.split(' ').length";
    browser.until(&format!("{points} === {stored}")).await;
    let calls = "performance.getEntriesByType('resource').filter(({name}) => name.includes('/columns')).length";
    assert_eq!(browser.ask(calls).await, 1, "drawing the list again asks for nothing");
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn runs_stand_under_their_sweep_and_are_named_by_their_values() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let sweep = swept(&served).await;
    browser.visit(&format!("{}/", served.url())).await;
    browser.until(&format!("{NAMES}.join() === 'friction 0.1,friction 0.2,friction 0.4'")).await;
    assert_eq!(browser.ask("document.querySelector('#lists details').open").await, false);
    browser.ask("document.querySelector('#lists details summary').click()").await;
    let jobs = served.get(&format!("/v1/jobs?sweep={sweep}")).await;
    let runs: Vec<&Value> = jobs["jobs"].as_array().expect("a list").iter().collect();
    let second = runs.iter().find(|job| job["sweep"]["run"] == 1).expect("a run")["id"].as_str().expect("an id");
    browser.ask(&format!("document.querySelector('#lists a[href=\"/?jobs={second}\"]').click()")).await;
    browser.until(&format!("location.search === '?jobs={second}'")).await;
    assert_eq!(browser.ask("document.querySelector('#lists details').open").await, true, "as the reader left it");
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn a_sweep_shows_its_responses() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let mut request = scene("one-bar-truss");
    request["sweep"] = json!({
        "replace": {"/model/contacts/0/friction": [0.1, 0.2, 0.4]},
        "responses": {
            "tip": {"value": "tip.x", "at": "first_limit"},
            "at last": {"value": "tip/floor.status", "at": "end"},
            "load": {"value": "load_factor", "at": "end"},
        },
    });
    let id = process::submit(&served.client, served.url(), "/v1/sweeps", &request).await;
    process::until(&served.client, served.url(), &format!("/v1/sweeps/{id}"), process::has_ended).await;
    browser.visit(&format!("{}/?sweep={id}", served.url())).await;
    browser.until("document.getElementById('sweep-plot')?.data?.[0].x.length === 3").await;
    let drawn = browser.ask("document.getElementById('sweep-plot').data[0].y").await;
    let rows = served.get(&format!("/v1/sweeps/{id}/rows")).await;
    let rows = rows["rows"].as_array().expect("rows");
    let found = |run: usize| &rows.iter().find(|row| row["run"] == run).expect("a run")["responses"];
    assert_eq!(drawn, json!([found(0)["tip"], found(1)["tip"], found(2)["tip"]]));
    browser.put("#sweep-response", "load").await;
    browser.until(&format!("document.getElementById('sweep-plot').data[0].y[2] === {}", found(2)["load"])).await;
    let table = browser.ask("document.querySelector('#sweep table').textContent").await;
    let table = table.as_str().expect("text");
    assert!(table.contains("at last") && table.contains(found(0)["at last"].as_str().expect("a status")), "{table}");
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn on_a_phone_the_list_is_a_drawer_within_reach() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("klarbring")).await;
    let phone = json!({"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": true});
    browser.devtools("Emulation.setDeviceMetricsOverride", phone).await;
    let in_sight = "(({top, height}) => height > 0 && top < innerHeight)(document.getElementById('lists').getBoundingClientRect())";
    let expanded = "document.getElementById('open-lists').getAttribute('aria-expanded')";
    // Where nothing is shown the list is.
    browser.visit(&format!("{}/", served.url())).await;
    browser.until(&format!("{in_sight} && {expanded} === 'true' && {NAMES}.length === 1")).await;
    browser.ask("document.querySelector('#lists li a').click()").await;
    browser.until(&format!("location.search === '?jobs={id}' && !{in_sight} && {expanded} === 'false'")).await;
    browser.press("#open-lists").await;
    browser.until(&format!("{in_sight} && document.getElementById('lists').contains(document.activeElement)")).await;
    assert!(browser.ask("document.documentElement.scrollWidth").await.as_u64().is_some_and(|width| width <= 390));
    browser.keys("\u{e00c}").await;
    browser.until(&format!("!{in_sight} && document.activeElement.id === 'open-lists'")).await;
    browser.close(served.url(), &[]).await;
}
