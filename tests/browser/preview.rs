//! The picture of a model in the form of a new run, before it is queued.
//!
//! Where there is no chromedriver this test says that it is skipped; with `ARCSLIP_BROWSER=required` it fails there.

use crate::common::browser::Browser;
use crate::common::process::Served;
use crate::common::service::scene;
use serde_json::json;

const PREVIEW: &str = "document.getElementById('preview-plot')";
const SAID: &str = "document.getElementById('preview-said').textContent";

fn trace(name: &str) -> String {
    format!("{PREVIEW}?.data?.find(({{name}}) => name === '{name}')")
}

#[tokio::test]
async fn a_model_is_drawn_as_it_is_written_and_what_cannot_be_drawn_is_said() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    browser.visit(&format!("{}/?run&scene=one-bar-truss", served.url())).await;
    for name in ["node", "support", "obstacle", "load"] {
        browser.until(&format!("{} !== undefined", trace(name))).await;
    }
    let node = format!("(({{x, y}}) => [x, y].join())({})", trace("node"));
    assert_eq!(browser.ask(&node).await, "0,-1.5,1,0");
    assert_eq!(browser.ask(SAID).await, "");
    // As it is changed.
    let mut request = scene("one-bar-truss");
    request["model"]["nodes"]["tip"] = json!([-2, 0]);
    browser.put("#request", &request.to_string()).await;
    browser.until(&format!("{node} === '0,-2,1,0'")).await;
    // What is wrong is left out and named; the rest is drawn.
    request["model"]["elements"][0]["nodes"] = json!(["pin", "top"]);
    request["model"]["obstacles"]["wall"] = json!({"kind": "plane", "point": [0, 0], "normal": [0, 0]});
    browser.put("#request", &request.to_string()).await;
    browser.until(&format!("{SAID}.includes('Element 0 is not drawn: there is no node “top”.')")).await;
    let told = browser.ask(SAID).await;
    assert!(told.as_str().is_some_and(|told| told.contains("“wall” is not drawn: its normal")), "{told}");
    assert_eq!(browser.ask(&format!("{} !== undefined", trace("node"))).await, true);
    assert_eq!(browser.ask(&format!("{PREVIEW}.data.some(({{name}}) => name.startsWith('bar '))")).await, false);
    browser.put("#request", "{\"model\": {").await;
    browser.until(&format!("{PREVIEW}.hidden && {SAID}.startsWith('The text is not JSON yet: ')")).await;
    // In space it can be turned.
    browser.put("#request", &scene("curving-slip").to_string()).await;
    browser.until(&format!("!{PREVIEW}.hidden && {SAID} === ''")).await;
    let before = browser.ask(&node).await;
    browser.put("#preview-azimuth", "30").await;
    browser.until(&format!("{node} !== '{}'", before.as_str().expect("text"))).await;
    // Obstacles that are in space alone: round, and straight across a section.
    let mut request = scene("curving-slip");
    let finite = format!("[...({}).x].filter(Number.isFinite).length", trace("obstacle"));
    let flat = browser.ask(&finite).await.as_u64().expect("a count");
    request["model"]["obstacles"]["drum"] =
        json!({"kind": "cylinder", "point": [0, 0, -0.3], "axis": [0, -3, 0], "radius": 0.3});
    request["model"]["obstacles"]["ramp"] = json!({"kind": "polyline", "points": [[-1, -0.1], [0, -0.1], [1, 0.2]],
        "rounding": 0.2, "section": {"origin": [0, 0, 0], "x": [1, 0, 0], "y": [0, 0, 1]}});
    browser.put("#request", &request.to_string()).await;
    // Two circles of the drum, and more.
    browser.until(&format!("{SAID} === '' && {finite} > {}", flat + 98)).await;
    // The twelve edges of a box, without the diagonals of its faces.
    let flat = browser.ask(&finite).await.as_u64().expect("a count");
    request["model"]["obstacles"]["block"] = json!({"kind": "box", "center": [0, 0.2, -0.5], "size": [1, 0.5, 0.6]});
    browser.put("#request", &request.to_string()).await;
    browser.until(&format!("{SAID} === '' && {finite} === {}", flat + 24)).await;
    request["model"]["obstacles"]["block"]["size"] = json!([1, 0, 0.6]);
    browser.put("#request", &request.to_string()).await;
    browser.until(&format!("{SAID}.includes('“block” is not drawn: its size has to be 3 numbers above 0')")).await;
    request["model"]["obstacles"].as_object_mut().expect("members").remove("block");
    request["model"]["obstacles"]["drum"]["axis"] = json!([0, 0, 0]);
    request["model"]["obstacles"]["ramp"].as_object_mut().expect("members").remove("section");
    browser.put("#request", &request.to_string()).await;
    browser.until(&format!("{SAID}.includes('“drum” is not drawn: its axis has to be a direction')")).await;
    browser.until(&format!("{SAID}.includes('“ramp” is not drawn: in space its section')")).await;
    browser.close(served.url(), &["status of 4"]).await;
}
