//! The table of the contacts of the shown increment.
//!
//! Where there is no chromedriver this test says that it is skipped; with `ARCSLIP_BROWSER=required` it fails there.

use crate::common::browser::Browser;
use crate::common::process::Served;
use crate::common::service::scene;
use serde_json::{Value, json};

const CELLS: &str = "[...document.querySelectorAll('#contacts tbody tr')].map((row) => \
                     [...row.children].map(({textContent}) => textContent))";
const HEAD: &str = "[...document.querySelectorAll('#contacts th')].map(({textContent}) => textContent)";
const SAID: &str = "document.getElementById('contacts-said')?.textContent";
/// Blocks, each of which stands on the floor.
const BLOCKS: usize = 25;

/// Numbers as the page shows them.
fn short(value: &Value) -> String {
    let value = value.as_f64().expect("a number");
    let rounded: f64 = format!("{value:.4e}").parse().expect("a number");
    rounded.to_string()
}

#[tokio::test]
async fn the_contacts_of_the_shown_increment_are_listed_with_units() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let mut request = scene("klarbring");
    request["model"]["units"] = json!({"length": "mm", "force": "N"});
    let id = served.ended(&request).await;
    let page = served.get(&format!("/v1/jobs/{id}/increments")).await;
    browser.visit(&format!("{}/?jobs={id}&at=5", served.url())).await;
    for index in [5, 9] {
        browser.put("#increment", &index.to_string()).await;
        browser
            .until(&format!("document.querySelector('#contacts h2')?.textContent === 'Contacts at increment {index}'"))
            .await;
        let contact = &page["increments"][index]["contacts"][0];
        let found = browser.ask(CELLS).await;
        let expected = json!([[
            contact["node"],
            contact["obstacle"],
            contact["status"],
            short(&contact["gap"]),
            short(&contact["normal_reaction"]),
            short(&contact["tangential_reaction"][0]),
            short(&contact["slip"][0]),
            short(&contact["slip_total"][0]),
            format!("{}, {}", short(&contact["reaction"][0]), short(&contact["reaction"][1])),
        ]]);
        assert_eq!(found, expected, "increment {index}");
    }
    let head = browser.ask(HEAD).await;
    assert_eq!([&head[3], &head[4], &head[7]], ["gap (mm)", "normal reaction (N)", "total slip (mm)"]);
    assert_eq!(head[8], "reaction x, y (N)");
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn many_contacts_come_in_pages_and_those_that_are_not_recorded_are_counted() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let block = |number: usize| format!("block{number}");
    let mut request = json!({
        "model": {
            "dimension": 2, "nodes": {}, "elements": [],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}, "contacts": [],
            "stages": [{"name": "press", "forces": {}, "until": {"load_above": 1}}],
        },
    });
    let model = &mut request["model"];
    for number in 0..BLOCKS {
        // One of them hangs above the floor, and is drawn up.
        let is_last = number == BLOCKS - 1;
        model["nodes"][block(number)] = json!([number, if is_last { 1 } else { 0 }]);
        model["stages"][0]["forces"][block(number)] = json!([0, if is_last { 1 } else { -1 }]);
        let list = |model: &mut Value, name: &str, item: Value| model[name].as_array_mut().expect("a list").push(item);
        list(model, "elements", json!({"kind": "spring", "nodes": [block(number)], "stiffness": [[2, 0], [0, 2]]}));
        list(model, "contacts", json!({"node": block(number), "obstacle": "floor", "friction": 0.3}));
    }
    let id = served.ended(&request).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{SAID} === 'Contacts 1 to 20 of 25; the others are on other pages.'")).await;
    assert_eq!(browser.ask(&format!("{CELLS}.length")).await, 20);
    browser.press("#contacts [data-key='Next contacts']").await;
    browser.until(&format!("{SAID}.startsWith('Contacts 21 to 25 of 25')")).await;
    assert_eq!(browser.ask(&format!("{CELLS}[0][0]")).await, "block20");
    browser.put("#contacts-shown", "free").await;
    browser.until(&format!("{SAID} === 'One contact.'")).await;
    assert_eq!(browser.ask(&format!("{CELLS}[0][0]")).await, "block24");
    request["analysis"] = json!({"record": {"contacts": [{"node": "block3", "obstacle": "floor"}]}});
    let bare = served.ended(&request).await;
    browser.visit(&format!("{}/?jobs={bare}", served.url())).await;
    browser.until(&format!("{SAID} === 'Of 25 contacts this increment records 1. One contact.'")).await;
    browser.close(served.url(), &[]).await;
}
