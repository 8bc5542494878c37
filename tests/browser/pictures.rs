//! The pictures of the dashboard that the README leads to.
//!
//! `ARCSLIP_PICTURES=write` puts what this takes in the place of those there are.
//!
//! Where there is no chromedriver this test says that it is skipped; with `ARCSLIP_BROWSER=required` it fails there.

use crate::common::browser::Browser;
use crate::common::process::{self, Process};
use crate::common::service::scene;
use serde_json::json;
use std::path::Path;

const FOLDER: &str = "src/service/http/dashboard/pictures";
/// Bytes that a picture may have.
const LARGEST: usize = 200_000;

#[tokio::test]
async fn the_readmes_pictures_show_what_the_page_shows() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let service = Process::serve(&folder.path().join("jobs.db"), &[]);
    let client = process::client();
    let mut ids = Vec::new();
    for name in ["curving-slip", "one-bar-truss"] {
        let id = process::submit(&client, &service.url, "/v1/jobs", &scene(name)).await;
        process::until(&client, &service.url, &format!("/v1/jobs/{id}"), process::has_ended).await;
        ids.push(id);
    }
    // The branch that sticks, from a point of the falling stretch.
    let direction = json!({"increment": 45, "direction": 0, "max_increments": 60});
    let branch = process::submit(&client, &service.url, &format!("/v1/jobs/{}/follow", ids[1]), &direction).await;
    process::until(&client, &service.url, &format!("/v1/jobs/{branch}"), process::has_ended).await;
    let readme = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).expect("a README");
    for (name, scheme, address) in [
        ("branch.png", "light", format!("/?jobs={},{branch}&at=45", ids[1])),
        ("space.png", "dark", format!("/?jobs={}&at=24", ids[0])),
    ] {
        let window = json!({"width": 1240, "height": 1040, "deviceScaleFactor": 1, "mobile": false});
        browser.devtools("Emulation.setDeviceMetricsOverride", window).await;
        browser.devtools("Emulation.setScrollbarsHidden", json!({"hidden": true})).await;
        let scheme = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        browser.devtools("Emulation.setEmulatedMedia", scheme).await;
        browser.visit(&format!("{}{address}", service.url)).await;
        // The exact path is laid over the others last.
        browser.until("document.getElementById('path-plot').data?.some(({name}) => name === 'exact')").await;
        browser.until("document.querySelector('#directions table') !== null").await;
        browser.until("document.getElementById('structure-plot').data?.some(({name}) => name === 'cone')").await;
        browser.until("document.querySelectorAll('#lists .thumbnail polyline').length === 3").await;
        browser.ask("document.activeElement.blur()").await;
        let picture = browser.page.screenshot().await.expect("a picture");
        assert!(picture.starts_with(b"\x89PNG") && picture.len() <= LARGEST, "{name}: {} bytes", picture.len());
        assert!(readme.contains(&format!("({FOLDER}/{name})")), "the README leads to {name}");
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(FOLDER).join(name);
        if std::env::var("ARCSLIP_PICTURES").as_deref() == Ok("write") {
            std::fs::write(&file, &picture).expect("written");
        }
        let stands = std::fs::read(&file).expect("it is there; ARCSLIP_PICTURES=write takes it").len();
        assert!(stands <= LARGEST, "{name}: {stands} bytes");
    }
    browser.close(&service.url, &[]).await;
}
