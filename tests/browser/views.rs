//! What a reader of the dashboard sees and sets: settings, directions, energies, the structure in space, studies, every scene.
//!
//! Where there is no chromedriver these tests say that they are skipped; with `ARCSLIP_BROWSER=required` they fail there.

use crate::common::browser::Browser;
use crate::common::process::{self, Served};
use crate::common::service::scene;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

const STATUS: &str = "document.getElementById('status')?.dataset.status";
const PATH: &str = "document.getElementById('path-plot')";
const MARK: &str = "document.getElementById('path-plot').data[2]";
const STRUCTURE: &str = "document.getElementById('structure-plot')";

#[tokio::test]
async fn settings_have_words_and_defaults_and_agree_with_the_text() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    browser.visit(&format!("{}/?run&scene=klarbring", served.url())).await;
    browser.until("document.getElementById('queue')?.disabled === false").await;
    let document = served.get("/openapi.json").await;
    let analysis = &document["components"]["schemas"]["Analysis"]["properties"];
    let shown = browser.ask("document.getElementById('settings').textContent").await;
    let words = analysis["max_increments"]["description"].as_str().expect("text").replace('\n', " ");
    assert!(shown.as_str().is_some_and(|shown| shown.contains(&words)), "{shown}");
    let standard = browser.ask("document.getElementById('setting-max_increments').placeholder").await;
    assert_eq!(standard, format!("{} (default)", analysis["max_increments"]["default"]));
    // From the fields into the text, the rest of which stays as it was written.
    let before = browser.ask("document.getElementById('request').value").await;
    browser.put("#setting-max_increments", "7").await;
    browser.put("#setting-arc_length-max", "0.25").await;
    browser.put("#setting-selection", "straightest").await;
    let after = browser.ask("document.getElementById('request').value").await;
    let (before, after) = (before.as_str().expect("text"), after.as_str().expect("text"));
    let request: Value = serde_json::from_str(after).expect("JSON");
    assert_eq!(
        request["analysis"],
        json!({"max_increments": 7, "arc_length": {"max": 0.25}, "selection": "straightest"})
    );
    assert_eq!(request["model"], scene("klarbring")["model"]);
    assert!(after.starts_with(before.trim_end().trim_end_matches('}').trim_end()), "{after}");
    // What is as by default is not written.
    browser.put("#setting-arc_length-max", "").await;
    browser.put("#setting-selection", "").await;
    let text = browser.ask("document.getElementById('request').value").await;
    let request: Value = serde_json::from_str(text.as_str().expect("text")).expect("JSON");
    assert_eq!(request["analysis"], json!({"max_increments": 7}));
    // From the text into the fields.
    let mut other = scene("klarbring");
    other["analysis"] = json!({"method": "mpec", "arc_length": {"jump": false}, "max_increments": 5});
    browser.put("#request", &other.to_string()).await;
    let names = "['method', 'max_increments', 'selection', 'arc_length-jump']";
    let fields = format!("{names}.map((name) => document.getElementById(`setting-${{name}}`).value)");
    assert_eq!(browser.ask(&fields).await, json!(["mpec", "5", "", "false"]));
    // A text that cannot be read takes no settings.
    browser.put("#request", "{").await;
    assert_eq!(browser.ask("document.querySelector('fieldset.settings').disabled").await, true);
    browser.put("#request", &other.to_string()).await;
    browser.press("#queue").await;
    browser.until(&format!("{STATUS} === 'completed'")).await;
    let jobs = served.get("/v1/jobs").await;
    let id = jobs["jobs"][0]["id"].as_str().expect("an id");
    assert_eq!(served.get(&format!("/v1/jobs/{id}/request")).await["analysis"]["method"], "mpec");
    browser.close(served.url(), &["status of 4"]).await;
}

#[tokio::test]
async fn the_last_bifurcation_is_shown_where_none_is_chosen_and_energies_are_drawn_over_the_path() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("klarbring")).await;
    let page = served.get(&format!("/v1/jobs/{id}/increments")).await;
    let increments = page["increments"].as_array().expect("a list");
    let last = increments.iter().rfind(|line| line["point"]["bifurcation"] == true).expect("one");
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    let told = browser.until("document.querySelector('#directions h2')?.textContent").await;
    assert_eq!(told, format!("Directions at increment {}, the last bifurcation of the path", last["index"]));
    // The energy that friction has taken, over the path.
    browser.put("#ordinate", "/energy/dissipated").await;
    browser.until(&format!("{PATH}.layout.yaxis.title.text === 'dissipated energy'")).await;
    let drawn = browser.ask(&format!("{PATH}.data[0].y.filter((value) => value !== null)")).await;
    let drawn: Vec<_> = drawn.as_array().expect("a list").iter().map(Value::as_f64).collect();
    let stored: Vec<_> = increments.iter().map(|line| line["energy"]["dissipated"].as_f64()).collect();
    assert_eq!(drawn, stored);
    browser.until("location.search.includes('ordinate=%2Fenergy%2Fdissipated')").await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn structure_and_path_point_at_each_other_and_space_is_turned_by_dragging() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("curving-slip")).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{STRUCTURE}.data?.length > 3")).await;
    let size = browser.ask(&format!("{MARK}.marker.size")).await.as_f64().expect("a number");
    // A page that is still drawing moves what the pointer is over.
    let began = Instant::now();
    let (x, y) = loop {
        let (x, y) = browser.middle_of("#structure-plot").await;
        browser.drag(&[(x - 2.0, y), (x, y)], false).await;
        tokio::time::sleep(Duration::from_millis(100)).await;
        if browser.ask(&format!("{MARK}.marker.size > {size}")).await == true {
            break (x, y);
        }
        assert!(began.elapsed() < process::PATIENCE, "the mark does not grow");
        browser.drag(&[(1.0, 1.0)], false).await;
    };
    let places = format!("{STRUCTURE}.data.find(({{name}}) => name === 'node').x");
    let before = browser.ask(&places).await;
    browser.drag(&[(x, y), (x + 40.0, y + 10.0), (x + 80.0, y + 20.0)], true).await;
    browser.until(&format!("{places}.join() !== '{}'", join(&before))).await;
    assert_ne!(browser.ask("document.getElementById('azimuth').value").await, "-60", "the slider goes along");
    browser.until("/[?&]turn=-?[0-9]+,[0-9]+/.test(location.search)").await;
    // Over a point of the path its structure is shown.
    let place = "(({left, top}, {_fullLayout: {xaxis, yaxis}, data: [line]}) => [left + xaxis._offset + xaxis.c2p(line.x[9]), \
                 top + yaxis._offset + yaxis.c2p(line.y[9])])(document.getElementById('path-plot').getBoundingClientRect(), document.getElementById('path-plot'))";
    browser.middle_of("#path-plot").await;
    let found = browser.ask(place).await;
    let (x, y) = (found[0].as_f64().expect("a number"), found[1].as_f64().expect("a number"));
    browser.drag(&[(x - 3.0, y), (x, y)], false).await;
    browser.until("/^Increment (8|9|10),/.test(document.querySelector('#structure .slider + p').textContent)").await;
    browser.close(served.url(), &[]).await;
}

fn join(numbers: &Value) -> String {
    let numbers = numbers.as_array().expect("a list").iter();
    numbers
        .map(|number| if number.is_null() { String::new() } else { number.to_string() })
        .collect::<Vec<_>>()
        .join(",")
}

#[tokio::test]
async fn a_study_is_queued_listed_and_drawn() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    browser.visit(&format!("{}/?run&scene=von-mises-truss&as=study", served.url())).await;
    browser.until("document.getElementById('setting-repeats') !== null").await;
    browser.put("#setting-repeats", "1").await;
    browser.put("#setting-arc_lengths", "0.2, 0.1").await;
    browser
        .until("document.getElementById('verdict').textContent.includes('arc length 0.2, 0.1, timed 1 times')")
        .await;
    browser.press("#queue").await;
    browser.until("document.getElementById('study-status')?.textContent === 'completed'").await;
    browser.until("document.getElementById('study-plot').layout?.xaxis.title.text === 'run time, s'").await;
    let drawn = browser
        .ask("document.getElementById('study-plot').data.map(({name, x, y}) => [name.split(',')[0], x, y])")
        .await;
    let id = served.get("/v1/studies").await["studies"][0]["id"].as_str().expect("an id").to_owned();
    let study = served.get(&format!("/v1/studies/{id}")).await;
    let rows = study["report"]["rows"].as_array().expect("rows");
    for line in drawn.as_array().expect("lines") {
        let own: Vec<&Value> =
            rows.iter().filter(|row| row["method"] == line[0] && !row["path_error"].is_null()).collect();
        let part =
            |name: &str| Value::Array(own.iter().map(|row| row.pointer(name).expect("a value").clone()).collect());
        assert!(own.len() == 2 && line[1] == part("/time/median_s"), "{line}");
        assert_eq!(line[2], part("/path_error"));
    }
    assert_eq!(browser.ask("document.querySelectorAll('#study tbody tr').length").await, rows.len());
    let link = browser.ask("document.querySelector('#lists a[aria-current]')?.getAttribute('href')").await;
    assert_eq!(link, format!("/?study={id}"));
    let address = browser.page.current_url().await.expect("an address").to_string();
    assert!(address.contains(&id), "{address}");
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn a_sweep_is_queued_listed_and_drawn_and_its_paths_over_one_another() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    browser.visit(&format!("{}/?run&scene=one-bar-truss&as=sweep", served.url())).await;
    browser.until("document.getElementById('verdict').textContent.includes('5 paths, each a job of its own')").await;
    browser.press("#queue").await;
    browser.until("document.getElementById('sweep-status')?.textContent === 'completed'").await;
    browser.until("document.getElementById('sweep-plot').data?.[0].x.length === 5").await;
    let drawn = browser.ask("document.getElementById('sweep-plot').data.map(({x, y}) => [x, y])").await;
    let id = served.get("/v1/sweeps").await["sweeps"][0]["id"].as_str().expect("an id").to_owned();
    let rows = served.get(&format!("/v1/sweeps/{id}/rows")).await;
    let mut rows: Vec<&Value> = rows["rows"].as_array().expect("rows").iter().collect();
    rows.sort_by_key(|row| row["run"].as_u64());
    let part = |name: &str| Value::Array(rows.iter().map(|row| row.pointer(name).expect("a value").clone()).collect());
    assert_eq!(drawn, json!([[part("/values/0"), part("/first_limit/load_factor")]]));
    assert_eq!(browser.ask("document.querySelectorAll('#sweep tbody tr').length").await, 5);
    let link = browser.ask("document.querySelector('#lists a[aria-current]')?.getAttribute('href')").await;
    assert_eq!(link, format!("/?sweep={id}"));
    browser.press("#overlay").await;
    browser.until("document.querySelectorAll('#lists input:checked').length === 5").await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn every_built_in_scene_is_drawn() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let scenes = served.get("/v1/scenes").await;
    for summary in scenes["scenes"].as_array().expect("a list") {
        let name = summary["name"].as_str().expect("a name");
        let id = served.ended(&scene(name)).await;
        browser.visit(&format!("{}/?jobs={id}", served.url())).await;
        browser.until(&format!("{STRUCTURE}?.data?.some(({{name}}) => name === 'node')")).await;
        let kept =
            served.get(&format!("/v1/jobs/{id}")).await["progress"]["last_index"].as_u64().expect("an index") + 1;
        assert_eq!(
            browser.ask(&format!("{PATH}.data[0].customdata.filter(Number.isInteger).length")).await,
            kept,
            "{name}"
        );
        let has_number = "document.getElementById('stop').textContent.includes('increments. ')";
        assert_eq!(browser.ask(has_number).await, true, "{name}");
        assert_eq!(browser.ask("document.getElementById('notice').hidden").await, true, "{name}");
    }
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn paths_drawn_together_are_told_apart_by_what_differs() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let smooth = served.ended(&scene("one-bar-truss")).await;
    let mut rough = scene("one-bar-truss");
    rough["model"]["contacts"][0]["friction"] = json!(0.6);
    rough["analysis"] = json!({"method": "mpec"});
    let rough = served.ended(&rough).await;
    browser.visit(&format!("{}/?jobs={smooth},{rough}", served.url())).await;
    browser.until(&format!("{PATH}.data?.length >= 5")).await;
    let key =
        browser.ask("[...document.querySelectorAll('#path .legend li')].map(({textContent}) => textContent)").await;
    assert_eq!(key[0], "one-bar truss, mu = 0.3, friction 0.3, method default");
    assert_eq!(key[1], "one-bar truss, mu = 0.3, friction 0.6, method mpec");
    // The name of a job shows that job alone.
    browser.ask("document.querySelectorAll('#lists a')[0].click()").await;
    browser.until(&format!("location.search === '?jobs={rough}'")).await;
    browser.until(&format!("{PATH}.data[2].name === 'chosen increment'")).await;
    browser.close(served.url(), &[]).await;
}

/// Names below the plot of the paths.
const LEGEND: &str = "[...document.querySelectorAll('#path .legend li')].map(({textContent}) => textContent)";

#[tokio::test]
async fn a_path_keeps_its_colour_and_the_reader_the_zoom_when_another_becomes_the_first() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let one = served.ended(&scene("one-bar-truss")).await;
    let mut rough = scene("one-bar-truss");
    rough["model"]["contacts"][0]["friction"] = json!(0.6);
    let other = served.ended(&rough).await;
    browser.visit(&format!("{}/?jobs={one},{other}", served.url())).await;
    browser.until(&format!("{PATH}.data?.some(({{name}}) => name === 'exact')")).await;
    browser.ask(&format!("{PATH}.querySelector('[data-title=\"Zoom in\"]').click()")).await;
    let colour = |job: usize| format!("{PATH}.data[{}].line.color", 2 * job);
    let ranges = format!("[{PATH}.layout.xaxis.range, {PATH}.layout.yaxis.range]");
    browser.until(&format!("{PATH}.layout.xaxis.autorange === false")).await;
    let before = browser.ask(&format!("[{}, {}, ...{ranges}]", colour(0), colour(1))).await;
    assert_ne!(before[0], before[1]);
    // As a click on a point of the other path does.
    browser.ask(&format!("void {PATH}.emit('plotly_click', {{points: [{{curveNumber: 2, customdata: 5}}]}})")).await;
    browser.until(&format!("location.search.startsWith('?jobs={other},{one}')")).await;
    browser.until(&format!("{} === '{}'", colour(0), before[1].as_str().expect("a colour"))).await;
    let after = browser.ask(&format!("[{}, {}, ...{ranges}]", colour(1), colour(0))).await;
    assert_eq!(after, before);
    // One that goes takes its colour along.
    browser.ask(&format!("document.querySelector('[data-key=\"draw {other}\"]').click()")).await;
    browser
        .until(&format!(
            "{PATH}.data[2].name === 'chosen increment' && {} === '{}'",
            colour(0),
            before[0].as_str().expect("a colour")
        ))
        .await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn many_paths_differ_in_colour_or_dash_and_in_name_and_one_that_is_not_drawn_says_so() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let mut ids = Vec::new();
    for _ in 0..9 {
        ids.push(served.ended(&scene("klarbring")).await);
    }
    let direction = json!({"increment": 7, "direction": 0, "max_increments": 3});
    let branch =
        process::submit(&served.client, served.url(), &format!("/v1/jobs/{}/follow", ids[0]), &direction).await;
    process::until(&served.client, served.url(), &format!("/v1/jobs/{branch}"), process::has_ended).await;
    ids.insert(1, branch);
    ids.insert(2, served.ended(&scene("one-bar-truss")).await);
    browser.visit(&format!("{}/?jobs={}", served.url(), ids.join(","))).await;
    browser.until(&format!("{PATH}.data?.length >= 23")).await;
    let looks = format!(
        "new Set({PATH}.data.slice(0, 22).filter(({{line}}) => line).map(({{line}}) => line.color + line.dash)).size"
    );
    assert_eq!(browser.ask(&looks).await, 11);
    let names = browser.ask(LEGEND).await;
    let names: Vec<&str> = names.as_array().expect("names").iter().filter_map(Value::as_str).take(11).collect();
    for (place, name) in names.iter().enumerate() {
        assert!(!names[..place].contains(name), "{names:?}");
    }
    assert!(names[1].contains("branch at ") && names[1].contains("direction 0"), "{names:?}");
    assert!(names[2].ends_with("(not drawn: it has no displacement x of node)"), "{names:?}");
    let drawn = browser.ask(&format!("{PATH}.data[4].y.filter((value) => value !== null).length")).await;
    assert_eq!(drawn, 0, "it does not widen the range of the loads either");
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn going_back_restores_from_where_a_structure_was_seen_and_the_title_says_what_is_shown() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let one = served.ended(&scene("curving-slip")).await;
    let other = served.ended(&scene("turning-drag")).await;
    browser.visit(&format!("{}/?jobs={one}", served.url())).await;
    browser.until("document.getElementById('azimuth') !== null").await;
    browser.until("document.title === 'curving slip, mu = 0.8 – arcslip'").await;
    browser.put("#azimuth", "35").await;
    browser.until("location.search.includes('turn=35,25')").await;
    let open = |id: &str| format!("document.querySelector('#lists a[href=\"/?jobs={id}\"]').click()");
    browser.ask(&open(&other)).await;
    browser.until(&format!("location.search.startsWith('?jobs={other}')")).await;
    browser.until("!document.title.startsWith('curving slip')").await;
    browser.put("#azimuth", "-80").await;
    browser.until("location.search.includes('turn=-80,25')").await;
    browser.ask("document.querySelector('#diagnostics summary').click()").await;
    browser.until("location.search.includes('figures')").await;
    browser.ask("history.back()").await;
    browser.until("document.title === 'curving slip, mu = 0.8 – arcslip'").await;
    browser.until("document.getElementById('azimuth').value === '35'").await;
    assert_eq!(browser.ask("document.querySelector('#diagnostics details').open").await, false);
    // The whole of the plane is in the picture, from wherever it is looked at.
    let inside = "(({data, layout: {xaxis, yaxis}}) => { const {x, y} = data.find(({name}) => name === 'obstacle'); \
                  const within = (values, [low, high]) => values.every((value) => value === null || (value > low && value < high)); \
                  return within(x, xaxis.range) && within(y, yaxis.range); })(document.getElementById('structure-plot'))";
    browser.until(inside).await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn of_very_many_nodes_one_is_named_to_be_drawn_against() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let mut request = scene("one-bar-truss");
    for number in 0..300 {
        request["model"]["nodes"][format!("n{number}")] = json!([number, 3]);
        request["model"]["supports"][format!("n{number}")] = json!(["x", "y"]);
    }
    let id = served.ended(&request).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until("document.getElementById('abscissa-node')?.value === 'tip'").await;
    let listed = "[...document.getElementById('abscissa').options].filter(({textContent}) => textContent.includes('n29')).length";
    assert_eq!(browser.ask(listed).await, 0);
    browser.put("#abscissa", "?displacements/0").await;
    browser.put("#abscissa-node", "n29").await;
    browser.until(&format!("{PATH}.layout.xaxis.title.text === 'displacement x of n29'")).await;
    let proposed = "[...document.querySelectorAll('#abscissa-names option')].map(({value}) => value).includes('n291')";
    assert_eq!(browser.ask(proposed).await, true);
    browser.put("#abscissa", "arc_length").await;
    browser.until(&format!("{PATH}.layout.xaxis.title.text === 'arc length'")).await;
    assert_eq!(browser.ask("document.getElementById('abscissa-node').disabled").await, true);
    browser.close(served.url(), &[]).await;
}
