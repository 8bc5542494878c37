//! Values of the structure by hovering, and what a large structure leaves out.
//!
//! Where there is no chromedriver these tests say that they are skipped; with `ARCSLIP_BROWSER=required` they fail there.

use crate::common::browser::Browser;
use crate::common::process::{self, Served};
use crate::common::service::scene;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

const STRUCTURE: &str = "document.getElementById('structure-plot')";
const LEFT_OUT: &str = "document.querySelector('#structure .left-out').textContent";

fn trace(name: &str) -> String {
    format!("{STRUCTURE}.data?.find(({{name}}) => name === '{name}')")
}

/// What is said of the point of a trace when the pointer is over it.
async fn hovered(browser: &Browser, name: &str, point: usize) -> String {
    let place = format!(
        "(({{left, top}}, {{_fullLayout: {{xaxis, yaxis}}}}, {{x, y}}) => [left + xaxis._offset + xaxis.c2p(x[{point}]), \
         top + yaxis._offset + yaxis.c2p(y[{point}])])({STRUCTURE}.getBoundingClientRect(), {STRUCTURE}, {})",
        trace(name)
    );
    let began = Instant::now();
    loop {
        browser.middle_of("#structure-plot").await;
        let found = browser.ask(&place).await;
        let [x, y] = [0, 1].map(|axis| found[axis].as_f64().expect("a number"));
        browser.drag(&[(x - 2.0, y), (x, y)], false).await;
        tokio::time::sleep(Duration::from_millis(150)).await;
        let told = "document.querySelector('#structure-plot .hoverlayer')?.textContent";
        if let Some(told) = browser.ask(told).await.as_str().filter(|told| !told.is_empty()) {
            return told.to_owned();
        }
        assert!(began.elapsed() < process::PATIENCE, "nothing is said of {name}");
        browser.drag(&[(1.0, 1.0)], false).await;
    }
}

#[tokio::test]
async fn elements_nodes_and_contacts_tell_their_values_by_hovering() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let mut request = scene("one-bar-truss");
    request["model"]["units"] = json!({"length": "m", "force": "kN"});
    request["model"]["elements"][0]["name"] = json!("strut");
    let id = served.ended(&request).await;
    browser.visit(&format!("{}/?jobs={id}&at=20", served.url())).await;
    browser.until(&format!("{} !== undefined", trace("element values"))).await;
    let element = hovered(&browser, "element values", 2).await;
    assert!(element.contains("bar strut") && element.contains("axial force -") && element.contains(" kN"), "{element}");
    let tip = hovered(&browser, "node", 1).await;
    for words in
        ["tip", "displacement (", " m", "tip on floor: slip", "gap 0 m", "normal reaction ", "tangential reaction ("]
    {
        assert!(tip.contains(words), "{words}: {tip}");
    }
    let pin = hovered(&browser, "node", 0).await;
    assert!(pin.contains("held in x, y, reaction (") && pin.contains("kN"), "{pin}");
    browser.close(served.url(), &[]).await;
}

/// The one-bar truss with very many nodes that are held, joined to a grid of bars.
fn large() -> Value {
    let mut request = scene("one-bar-truss");
    let model = &mut request["model"];
    for number in 0..620 {
        let name = format!("n{number}");
        model["nodes"][&name] = json!([0.01 * f64::from(number), 3]);
        model["supports"][&name] = json!(["x", "y"]);
    }
    request
}

#[tokio::test]
async fn a_large_structure_is_drawn_with_less_detail_and_says_what_is_left_out() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let small = served.ended(&scene("one-bar-truss")).await;
    let id = served.ended(&large()).await;
    let look = format!(
        "[{}.mode, {STRUCTURE}.data.find(({{name}}) => name.startsWith('bar ')).line.width, \
         {STRUCTURE}.data.some(({{name}}) => name === 'node name'), {STRUCTURE}.data.some(({{name}}) => name === 'undeformed')]",
        trace("node")
    );
    browser.visit(&format!("{}/?jobs={small}", served.url())).await;
    browser.until(&format!("{} !== undefined", trace("node"))).await;
    assert_eq!(browser.ask(&look).await, json!(["markers", 4, true, true]));
    assert!(browser.ask(LEFT_OUT).await.as_str().is_some_and(str::is_empty));
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{} !== undefined", trace("node"))).await;
    assert_eq!(browser.ask(&look).await, json!(["lines", 1.5, false, false]));
    let told = browser.ask(LEFT_OUT).await;
    assert!(told.as_str().is_some_and(|told| told.contains("With 622 nodes, lines are thin")), "{told}");
    assert_eq!(browser.ask("document.getElementById('node-names').disabled").await, true);
    // The nodes still tell what they are.
    let tip = hovered(&browser, "node", 2).await;
    assert!(tip.contains("tip"), "{tip}");
    browser.close(served.url(), &[]).await;
}
