//! The manual in a browser: read at a desk and on a phone, in light and dark.
//!
//! Where there is no chromedriver this test says that it is skipped; with `ARCSLIP_BROWSER=required` it fails there.

use crate::common::browser::Browser;
use crate::common::process::Process;
use arcslip::manual::CHAPTERS;
use serde_json::json;

async fn follow(browser: &Browser, link: &str) {
    browser.until(&format!("document.querySelector({link:?})")).await;
    browser.ask(&format!("document.querySelector({link:?}).click()")).await;
}

#[tokio::test]
async fn the_manual_is_read_at_a_desk_and_on_a_phone() {
    let Some(browser) = Browser::open().await else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let service = Process::serve(&folder.path().join("jobs.db"), &[]);
    browser.visit(&format!("{}/", service.url)).await;
    follow(&browser, "header a[href='/manual']").await;
    browser.until("document.querySelectorAll('.contents dt').length").await;
    follow(&browser, &format!(".contents a[href='/manual/{}']", CHAPTERS[0].name)).await;
    browser.until(&format!("document.querySelector('[aria-current]')?.textContent === '{}'", CHAPTERS[0].title)).await;
    let mut backgrounds = Vec::new();
    for (width, scheme) in [(1280, "light"), (390, "dark")] {
        let window = json!({"width": width, "height": 844, "deviceScaleFactor": 1, "mobile": width < 500});
        browser.devtools("Emulation.setDeviceMetricsOverride", window).await;
        let scheme = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        browser.devtools("Emulation.setEmulatedMedia", scheme).await;
        for chapter in CHAPTERS {
            browser.visit(&format!("{}/manual/{}", service.url, chapter.name)).await;
            assert_eq!(browser.ask("document.querySelector('h1').textContent").await, chapter.title);
            // Tables and code scroll; the page does not.
            let widest = "document.documentElement.scrollWidth <= document.documentElement.clientWidth";
            assert_eq!(browser.ask(widest).await, true, "{} at {width}", chapter.name);
            browser.until("[...document.images].every((picture) => picture.complete)").await;
            let drawn = "[...document.images].every((picture) => picture.naturalWidth > 0)";
            assert_eq!(browser.ask(drawn).await, true, "{}", chapter.name);
        }
        backgrounds.push(browser.ask("getComputedStyle(document.body).backgroundColor").await);
    }
    assert_ne!(backgrounds[0], backgrounds[1], "light and dark");
    browser.close(&service.url, &[]).await;
}
