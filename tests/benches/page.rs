//! How long the dashboard lets a reader wait, by the browser's own performance entries.
//!
//! Other work on the machine can only lengthen what is measured: each line has the median and the shortest of some tries.
//!
//! `cargo bench --bench page` (six tries), `cargo bench --bench page -- 3`. It needs Chromium and its chromedriver.

#[allow(dead_code)]
#[path = "../common/browser.rs"]
mod browser;
#[allow(dead_code)]
#[path = "../common/process.rs"]
mod process;
#[allow(dead_code)]
#[path = "../common/server.rs"]
mod server;
#[allow(dead_code)]
#[path = "../common/service.rs"]
mod service;
#[allow(dead_code)]
#[path = "../common/solver.rs"]
mod solver;

use browser::Browser;
use process::Process;
use server::TestServer;
use service::{in_short_steps, request};
use solver::MadeUp;
use std::time::Duration;

const TRIES: usize = 6;

/// Gathers the browser's entries of frames that took long, and how far apart frames were.
const WATCH: &str = "(() => {
    window.frames_watched = { long: [0], gaps: [0] };
    const take = (list) => window.frames_watched.long.push(...list.getEntries().map(({ duration }) => duration));
    for (const type of ['longtask', 'long-animation-frame']) new PerformanceObserver(take).observe({ type });
    let before = null;
    const frame = (now) => {
        if (before !== null) window.frames_watched.gaps.push(now - before);
        before = now;
        requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
    return true;
})()";
const LONGEST: &str =
    "['long', 'gaps'].map((kind) => window.frames_watched[kind].reduce((most, one) => Math.max(most, one)))";
const DRAWN: &str = "document.getElementById('path-plot').data?.[0]?.x.length";

/// Increments that are streamed: ten seconds of them and more.
const STREAMED: u64 = 2_600;

fn main() {
    let tries = std::env::args().find_map(|word| word.parse().ok()).unwrap_or(TRIES).max(1);
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    runtime.block_on(async {
        let Some(mut painted) = first_paint(tries).await else { return };
        let Some(mut frames) = frames(tries).await else { return };
        println!("| what | median | shortest |\n|---|--:|--:|");
        row("a stored path of 10,000 increments is on the screen", &mut painted);
        row("longest frame while 200 increments a second stream in", &mut frames);
    });
}

fn row(what: &str, milliseconds: &mut [f64]) {
    milliseconds.sort_by(f64::total_cmp);
    println!("| {what} | {:.0} ms | {:.0} ms |", milliseconds[milliseconds.len() / 2], milliseconds[0]);
}

/// Milliseconds from the start of the page's loading until a stored path is drawn, in browsers that have never seen the page.
async fn first_paint(tries: usize) -> Option<Vec<f64>> {
    let folder = tempfile::tempdir().expect("a folder");
    let service = Process::serve(&folder.path().join("jobs.db"), &[]);
    let client = process::client();
    // The start counts, too.
    let long = in_short_steps("one-bar-truss", 9_999, 5_500);
    let id = process::submit(&client, &service.url, "/v1/jobs", &long).await;
    let job = process::until(&client, &service.url, &format!("/v1/jobs/{id}"), process::has_ended).await;
    assert_eq!(job["progress"]["last_index"], 9_999);
    let mut found = Vec::new();
    for _ in 0..tries {
        let browser = Browser::open().await?;
        browser.visit(&format!("{}/?jobs={id}", service.url)).await;
        let entry = browser.until("performance.getEntriesByName('first path')[0]?.toJSON()").await;
        assert_eq!(entry["startTime"], 0.0, "the page's loading is part of it");
        let drawn = "document.getElementById('path-plot').data[0].customdata.filter(Number.isInteger).length";
        assert_eq!(browser.ask(drawn).await, 10_000);
        browser.until("document.querySelector('#structure-plot .main-svg') !== null").await;
        browser.close(&service.url, &[]).await;
        found.push(entry["duration"].as_f64().expect("milliseconds"));
    }
    Some(found)
}

/// Milliseconds of the longest frame, or gap between two, of each try.
async fn frames(tries: usize) -> Option<Vec<f64>> {
    let mut found = Vec::new();
    for _ in 0..tries {
        let browser = Browser::open().await?;
        let folder = tempfile::tempdir().expect("a folder");
        let server = TestServer::start(&folder.path().join("jobs.db"), MadeUp::pausing(Duration::from_millis(4))).await;
        let url = format!("http://{}", server.address());
        browser.visit(&url).await;
        browser.until("window.Plotly !== undefined").await;
        let id = server.submit(&request("streamed", STREAMED)).await;
        browser.ask(WATCH).await;
        // What a link to it does, without loading the page anew.
        browser
            .ask(&format!("(history.pushState(null, '', '/?jobs={id}'), dispatchEvent(new Event('popstate')))"))
            .await;
        server.ended(&id).await;
        browser.until("document.getElementById('status').textContent === 'completed'").await;
        browser.until(&format!("{DRAWN} === {STREAMED}")).await;
        let longest = browser.ask(LONGEST).await;
        browser.close(&url, &[]).await;
        assert!(server.stop().await);
        found.push([0, 1].map(|kind| longest[kind].as_f64().expect("milliseconds")).into_iter().fold(0.0, f64::max));
    }
    Some(found)
}
