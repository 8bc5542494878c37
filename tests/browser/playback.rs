//! What goes along the path, and the pictures that are taken out of the page.
//!
//! Where there is no chromedriver these tests say that they are skipped; with `ARCSLIP_BROWSER=required` they fail there.

use crate::common::browser::Browser;
use crate::common::process::Served;
use crate::common::service::scene;
use serde_json::{Value, json};

const AT: &str = "Number(new URLSearchParams(location.search).get('at'))";
const PLAY: &str = "document.getElementById('play').getAttribute('aria-label')";
const SPACE: &str = " ";
const HOME: &str = "\u{e011}";
const END: &str = "\u{e010}";

async fn shown(browser: &Browser, served: &Served, request: &Value, more: &str) {
    let id = served.ended(request).await;
    browser.visit(&format!("{}/?jobs={id}{more}", served.url())).await;
    browser.until("document.querySelector('#structure-plot .main-svg') !== null").await;
}

#[tokio::test]
async fn a_path_is_played_and_paused_by_button_and_keyboard_at_a_chosen_speed() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    shown(&browser, &served, &scene("one-bar-truss"), "&at=70").await;
    browser.put("#speed", "0.1").await;
    browser.press("#play").await;
    assert_eq!(browser.ask(PLAY).await, "pause");
    browser.until(&format!("{AT} > 70")).await;
    browser.press("#play").await;
    assert_eq!(browser.ask(PLAY).await, "play");
    // By the keyboard, where nothing has the focus; at its end it stops by itself.
    browser.ask("document.activeElement.blur()").await;
    browser.keys(HOME).await;
    browser.until(&format!("{AT} === 0")).await;
    browser.put("#speed", "4").await;
    browser.keys(SPACE).await;
    assert_eq!(browser.ask(PLAY).await, "pause");
    browser.until(&format!("{AT} === 78 && {PLAY} === 'play'")).await;
    // From the end it begins again.
    browser.put("#speed", "0.25").await;
    browser.keys(SPACE).await;
    browser.until(&format!("{AT} > 0 && {AT} < 60")).await;
    browser.keys(SPACE).await;
    assert_eq!(browser.ask(PLAY).await, "play");
    browser.keys(END).await;
    browser.until(&format!("{AT} === 78 && document.getElementById('increment').value === '78'")).await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn a_reader_who_asks_for_less_motion_has_one_increment_a_second() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let less = json!({"features": [{"name": "prefers-reduced-motion", "value": "reduce"}]});
    browser.devtools("Emulation.setEmulatedMedia", less).await;
    shown(&browser, &served, &scene("one-bar-truss"), "&at=0").await;
    browser.until("document.querySelector('#structure .left-out').textContent.includes('less motion')").await;
    browser.put("#speed", "4").await;
    let began = browser.ask("performance.now()").await;
    browser.press("#play").await;
    browser.until(&format!("{AT} >= 2")).await;
    let took = browser.ask(&format!("performance.now() - {began}")).await;
    assert!(took.as_f64().is_some_and(|took| took >= 1900.0), "{took}");
    browser.close(served.url(), &[]).await;
}

/// Keeps the files that the page saves.
const KEEP: &str = "window.kept = []; const make = URL.createObjectURL; \
                    HTMLAnchorElement.prototype.click = function () { \
                      if (this.download) window.kept.push({name: this.download, blob: window.made.get(this.href)}); }; \
                    window.made = new Map(); \
                    URL.createObjectURL = (blob) => { const made = make(blob); window.made.set(made, blob); return made; };";

/// The name, media type, and bytes from one place to another of the file that was saved last.
async fn kept(browser: &Browser, number: usize) -> (String, String, Vec<u8>) {
    browser.until(&format!("window.kept.length === {number}")).await;
    let script = "const done = arguments[0]; const {name, blob} = window.kept.at(-1); blob.arrayBuffer()\
                  .then((buffer) => done([name, blob.type, [...new Uint8Array(buffer)]]));";
    let found = browser.page.execute_async(script, Vec::new()).await.expect("a file");
    let text = |place: usize| found[place].as_str().expect("text").to_owned();
    let bytes = found[2].as_array().expect("bytes").iter().map(|byte| byte.as_u64().expect("a byte") as u8).collect();
    (text(0), text(1), bytes)
}

#[tokio::test]
async fn the_structure_is_saved_as_png_and_svg_and_its_path_as_an_animation() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    shown(&browser, &served, &scene("klarbring"), "&at=3").await;
    browser.page.execute(KEEP, Vec::new()).await.expect("it runs");
    browser.press("#picture-svg").await;
    let (name, kind, bytes) = kept(&browser, 1).await;
    let text = String::from_utf8(bytes).expect("text");
    assert!(name.ends_with("-3.svg") && kind == "image/svg+xml" && text.starts_with("<svg"), "{name} {kind}");
    assert!(text.contains("increment 3, stage"), "it says what it shows");
    browser.press("#picture-png").await;
    let (name, kind, bytes) = kept(&browser, 2).await;
    assert!(name.ends_with("-3.png") && kind == "image/png" && bytes.starts_with(b"\x89PNG"), "{name} {kind}");
    browser.press("#animation").await;
    let (name, kind, bytes) = kept(&browser, 3).await;
    assert!(name.ends_with(".png") && kind == "image/apng" && bytes.starts_with(b"\x89PNG"), "{name} {kind}");
    // As many pictures as there are increments, and the browser can show them.
    let many = browser.ask("document.getElementById('increment').max").await;
    let many: u32 = many.as_str().expect("text").parse::<u32>().expect("a number") + 1;
    let place = bytes.windows(4).position(|part| part == b"acTL").expect("it is animated");
    assert_eq!(bytes[place + 4..place + 8], many.to_be_bytes());
    let controls = bytes.windows(4).filter(|part| part == b"fcTL").count();
    assert_eq!(u32::try_from(controls), Ok(many));
    let decoded = "const done = arguments[0]; window.kept.at(-1).blob.arrayBuffer().then(async (data) => { \
                   const decoder = new ImageDecoder({data, type: 'image/png'}); await decoder.tracks.ready; await decoder.completed; \
                   const last = await decoder.decode({frameIndex: decoder.tracks.selectedTrack.frameCount - 1}); \
                   done([decoder.tracks.selectedTrack.frameCount, last.image.displayWidth]); }).catch((problem) => done(String(problem)));";
    // `ImageDecoder` needs a safe context, as an address of the own machine is.
    let found = browser.page.execute_async(decoded, Vec::new()).await.expect("decoded");
    assert_eq!(found, json!([many, 900]));
    browser
        .until("document.getElementById('export-said').textContent.startsWith('The animation has been saved as ')")
        .await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn a_picture_that_the_browser_cannot_make_is_said() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    shown(&browser, &served, &scene("klarbring"), "&at=3").await;
    browser.ask("void (Plotly.toImage = () => Promise.reject(new Error('it has no canvas')))").await;
    for button in ["#picture-png", "#animation"] {
        browser.press(button).await;
        browser
            .until("document.getElementById('export-said').textContent === 'This cannot be made: it has no canvas.'")
            .await;
        browser.ask("document.getElementById('export-said').textContent = ''").await;
    }
    // The offer stands again.
    browser.until("document.getElementById('animation') !== null").await;
    browser.close(served.url(), &[]).await;
}
