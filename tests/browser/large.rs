//! A model whose increments are so large that a page of them has room for few.
//!
//! Where there is no chromedriver these tests say that they are skipped; with `ARCSLIP_BROWSER=required` they fail there.

use crate::common::browser::Browser;
use crate::common::process::Served;
use crate::common::service::scene;
use serde_json::{Value, json};

const STRUCTURE: &str = "document.getElementById('structure-plot')";
const WORDS: &str = "document.querySelector('#structure .slider + p').textContent";
/// Nodes beside the truss, each on a spring of its own.
const BESIDE: usize = 900;

/// The one-bar truss with many nodes that move with the load.
fn large() -> Value {
    let mut request = scene("one-bar-truss");
    let model = &mut request["model"];
    for number in 0..BESIDE {
        let name = format!("beside{number}");
        let place = 0.3 + number as f64 / BESIDE as f64;
        model["nodes"][&name] = json!([place, 2.0 + 0.2 * (12.0 * place).sin()]);
        let spring = json!({"kind": "spring", "nodes": [name], "stiffness": [[3.0, 0.1], [0.1, 2.0]]});
        model["elements"].as_array_mut().expect("elements").push(spring);
        model["stages"][0]["forces"][&name] = json!([0.01 * place, 0.001]);
    }
    request
}

#[tokio::test]
async fn the_structure_and_the_directions_of_large_increments_are_shown() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&large()).await;
    // As many increments as the page asks for at once have no room in one answer.
    let page = served.get(&format!("/v1/jobs/{id}/increments?limit=64")).await;
    let increments = page["increments"].as_array().expect("a list");
    assert!(increments.len() < 33, "{}: the increments are large", increments.len());
    let job = served.get(&format!("/v1/jobs/{id}")).await;
    let last = job["progress"]["last_index"].as_u64().expect("a number");
    assert!(last > 40, "{last}");
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{WORDS}.startsWith('Increment {last},')")).await;
    browser.until(&format!("{STRUCTURE}.data?.length > 3")).await;
    let drawn = browser.ask(&format!("{STRUCTURE}.data.find(({{name}}) => name === 'node').x.length")).await;
    assert!(drawn.as_u64().is_some_and(|drawn| drawn > BESIDE as u64), "{drawn}");
    let told = browser.until("document.querySelector('#directions h2')?.textContent").await;
    assert!(told.as_str().is_some_and(|told| told.starts_with("Directions at increment ")), "{told}");
    browser.until("document.querySelectorAll('#directions tbody tr').length > 1").await;
    // Any of them, forth and back.
    for index in [last / 2, last / 2 + 1, last / 3, 0] {
        browser.put("#increment", &index.to_string()).await;
        browser.until(&format!("{WORDS}.startsWith('Increment {index},')")).await;
    }
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn what_the_service_does_not_give_is_said() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("klarbring")).await;
    browser.visit(served.url()).await;
    browser.until("document.querySelector('#notice p')?.textContent.startsWith('Choose')").await;
    // What is stored is answered without one of them.
    let less = "const before = window.fetch; window.fetch = async (place, options) => { \
                const answer = await before(place, options); \
                if (!String(place).includes('/increments?')) return answer; \
                const page = await answer.json(); \
                const increments = page.increments.filter(({index}) => index !== 2); \
                return new Response(JSON.stringify({...page, increments}), {status: 200}); }";
    browser.page.execute(less, Vec::new()).await.expect("it runs");
    let shown =
        format!("history.pushState(null, '', '/?jobs={id}&at=2') ?? dispatchEvent(new PopStateEvent('popstate'))");
    browser.ask(&shown).await;
    let missing = "cannot be shown: the service does not give it.";
    browser.until(&format!("{WORDS} === 'Increment 2 {missing}'")).await;
    let told = "document.querySelector('#directions [role=alert]')?.textContent";
    browser.until(&format!("{told} === 'The directions at increment 2 {missing}'")).await;
    // The others are shown.
    browser.put("#increment", "1").await;
    browser.until(&format!("{WORDS}.startsWith('Increment 1,')")).await;
    browser.close(served.url(), &[]).await;
}
