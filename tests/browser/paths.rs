//! The plot of paths: any recorded quantity on either axis, stages and stretches, letters, sweeps in colour, files.
//!
//! Where there is no chromedriver these tests say that they are skipped; with `ARCSLIP_BROWSER=required` they fail there.

use crate::common::browser::Browser;
use crate::common::process::{self, Served};
use crate::common::service::scene;
use serde_json::{Value, json};
use std::process::Command;

const PATH: &str = "document.getElementById('path-plot')";
/// The lines of the key below the plot.
const KEY: &str = "[...document.querySelectorAll('#path-key li')].map(({textContent}) => textContent)";

/// The member of each stored increment at a pointer.
async fn stored(served: &Served, id: &str, pointer: &str) -> Vec<Value> {
    let page = served.get(&format!("/v1/jobs/{id}/increments?limit=10000")).await;
    let increments = page["increments"].as_array().expect("a list");
    increments.iter().map(|line| line.pointer(pointer).cloned().unwrap_or_default()).collect()
}

fn numbers(values: &[Value]) -> Vec<Option<f64>> {
    values.iter().map(Value::as_f64).collect()
}

/// What is drawn of a trace, without the interruptions.
async fn drawn(browser: &Browser, trace: usize, axis: &str) -> Vec<Option<f64>> {
    let found = browser
        .ask(&format!("(({{{axis}, customdata}}) => {axis}.filter((_, place) => customdata[place] !== null))({PATH}.data[{trace}])"))
        .await;
    numbers(found.as_array().expect("a list"))
}

#[tokio::test]
async fn rotations_and_moments_of_a_frame_are_drawn() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let frame = json!({"model": {
        "units": {"length": "m", "force": "kN"}, "dimension": 2,
        "nodes": {"wall": [0, 0], "knee": [1, 0], "tip": [2, 0]}, "supports": {"wall": ["x", "y", "rz"]},
        "elements": [{"kind": "beam", "nodes": ["wall", "knee", "tip"], "axial_stiffness": 100, "bending_stiffness": 3}],
        "stages": [{"name": "roll", "moments": {"tip": 3}, "until": {"load_above": 1}}],
    }});
    let id = served.ended(&frame).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{PATH}.data?.length > 1")).await;
    for (chosen, words) in [
        ("/displacements/tip/2", "rotation of tip"),
        ("/supports/wall/2", "moment of the support of wall [kN m]"),
        ("/elements/0/ends/1/bending_moment", "bending moment at the last node of beam 0 (wall–knee–tip) [kN m]"),
    ] {
        browser.put("#ordinate", chosen).await;
        browser.until(&format!("{PATH}.layout.yaxis.title.text === '{words}'")).await;
        assert_eq!(drawn(&browser, 0, "y").await, numbers(&stored(&served, &id, chosen).await), "{chosen}");
    }
    browser.until("document.getElementById('structure-plot').data?.some(({name}) => name?.startsWith('bar '))").await;
}

#[tokio::test]
async fn any_recorded_quantity_is_drawn_on_either_axis() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("lowered-pin")).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{PATH}.data?.length > 2")).await;
    let groups = browser.ask("[...document.querySelectorAll('#ordinate optgroup')].map(({label}) => label)").await;
    for group in ["Path", "Energies", "Displacements", "Reactions of supports", "Forces of bars", "Contacts"] {
        assert!(groups.as_array().expect("a list").contains(&json!(group)), "{group} in {groups}");
    }
    for (chosen, words) in [
        ("/supports/pin/1", "reaction y of the support of pin"),
        ("/elements/0/axial_force", "axial force of bar 0 (pin–tip)"),
        ("/contacts/0/slip_total/0", "slip in total (tangent 1) of tip on floor"),
        ("/measure/equilibrium", "measure: equilibrium"),
    ] {
        browser.put("#ordinate", chosen).await;
        browser.until(&format!("{PATH}.layout.yaxis.title.text === '{words}'")).await;
        assert_eq!(drawn(&browser, 0, "y").await, numbers(&stored(&served, &id, chosen).await), "{chosen}");
    }
    browser.put("#abscissa", "/contacts/0/normal_reaction").await;
    browser.until(&format!("{PATH}.layout.xaxis.title.text === 'normal reaction of tip on floor'")).await;
    assert_eq!(drawn(&browser, 0, "x").await, numbers(&stored(&served, &id, "/contacts/0/normal_reaction").await));
    // The address alone shows the same again; it follows what is chosen a little later.
    browser.until("location.search.includes('abscissa=') && location.search.includes('equilibrium')").await;
    let address = browser.page.current_url().await.expect("an address").to_string();
    browser.visit(&address).await;
    browser.until(&format!("{PATH}.layout?.xaxis.title.text === 'normal reaction of tip on floor'")).await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn several_quantities_share_a_plot_and_those_of_another_unit_have_an_axis_of_their_own() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("one-bar-truss")).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{PATH}.data?.length > 2")).await;
    browser.put("#ordinate-more", "/energy/strain").await;
    browser.until("document.querySelectorAll('#path .legend li').length >= 2").await;
    browser.put("#ordinate-more", "/energy/dissipated").await;
    browser.until(&format!("{PATH}.layout.yaxis2?.title.text === 'strain energy, dissipated energy'")).await;
    assert_eq!(drawn(&browser, 2, "y").await, numbers(&stored(&served, &id, "/energy/strain").await));
    assert_eq!(drawn(&browser, 4, "y").await, numbers(&stored(&served, &id, "/energy/dissipated").await));
    assert_eq!(
        browser.ask(&format!("[0, 2, 4].map((which) => {PATH}.data[which].yaxis)")).await,
        json!(["y", "y2", "y2"])
    );
    let names =
        browser.ask("[...document.querySelectorAll('#path .legend li')].map(({textContent}) => textContent)").await;
    assert_eq!(names[1], "strain energy (axis on the right)");
    browser.press("#path [aria-label='leave out strain energy']").await;
    browser.until(&format!("{PATH}.layout.yaxis2?.title.text === 'dissipated energy'")).await;
    browser.close(served.url(), &[]).await;
}

/// The colours of the picture of the command line, as the style sheet has them in light colours.
const STAGE: &str = "#46a528";
const BIFURCATION: &str = "#e67800";

#[tokio::test]
async fn stages_and_stretches_are_drawn_and_lettered_as_in_the_picture_of_the_command_line() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let folder = tempfile::tempdir().expect("a folder");
    let id = served.ended(&scene("lowered-pin")).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{PATH}.data?.[1]?.text.length > 0")).await;
    let picture = folder.path().join("path.svg");
    let mut command = Command::new(env!("CARGO_BIN_EXE_arcslip"));
    command.args(["solve", "lowered-pin", "--out"]).arg(folder.path().join("path.csv")).arg("--plot").arg(&picture);
    assert!(command.output().expect("it runs").status.success());
    let picture = std::fs::read_to_string(picture).expect("a picture");
    let letters = browser.ask(&format!("{PATH}.data[1].text.filter(Boolean)")).await;
    let letters = letters.as_array().expect("a list");
    for letter in letters {
        let letter = letter.as_str().expect("text");
        assert!(picture.lines().any(|line| line.trim() == letter), "{letter} is in the picture");
    }
    assert_eq!(letters.len(), events_of(&stored(&served, &id, "/point/kind").await));
    for words in ["stage lower", "stage push"] {
        assert!(picture.contains(words));
        browser.until(&format!("{KEY}.includes('{words}')")).await;
    }
    browser.until(&format!("{KEY}.some((words) => words.startsWith('the load falls'))")).await;
    browser.until(&format!("{KEY}.some((words) => words.startsWith('bifurcation points'))")).await;
    // The second stage is dashed in its colour, and what falls is dotted.
    let style = |name: &str| {
        format!("(({{line}}) => [line.color, line.dash])({PATH}.data.find(({{name}}) => name === '{name}'))")
    };
    assert_eq!(browser.ask(&style("rises 1")).await, json!([STAGE, "dash"]));
    assert_eq!(browser.ask(&style("bifurcation falls")).await, json!([BIFURCATION, "dot"]));
    browser.close(served.url(), &[]).await;
}

/// How many of these points the picture of the command line letters.
fn events_of(kinds: &[Value]) -> usize {
    let lettered = ["smooth_limit", "nonsmooth_limit", "contact_change", "end"];
    kinds.iter().filter(|kind| kind.as_str().is_some_and(|kind| lettered.contains(&kind))).count()
}

#[tokio::test]
async fn runs_of_a_sweep_are_coloured_by_what_is_swept() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let mut request = scene("one-bar-truss");
    let replace = json!({"/model/contacts/0/friction": [0.1, 0.2, 0.4], "/model/elements/0/axial_stiffness": [1, 2]});
    request["sweep"] = json!({"replace": replace});
    let id = process::submit(&served.client, served.url(), "/v1/sweeps", &request).await;
    process::until(&served.client, served.url(), &format!("/v1/sweeps/{id}"), process::has_ended).await;
    browser.visit(&format!("{}/?sweep={id}", served.url())).await;
    browser.press("#overlay").await;
    let bar = format!("{PATH}.data?.find(({{name}}) => name === 'colour bar')?.marker");
    browser.until(&format!("{bar} !== undefined")).await;
    assert_eq!(
        browser.ask(&format!("[{bar}.cmin, {bar}.cmax, {bar}.colorbar.title.text]")).await,
        json!([0.1, 0.4, "friction"])
    );
    browser.until(&format!("{PATH}.querySelector('.colorbar') !== null")).await;
    let looks = format!("[0, 1, 2, 3, 4, 5].map((run) => {PATH}.data[2 * run].line)");
    let looks = browser.ask(&looks).await;
    assert_eq!(looks[0]["color"], looks[1]["color"], "of one friction");
    assert_ne!(looks[0]["color"], looks[2]["color"]);
    assert_ne!(looks[0]["dash"], looks[1]["dash"], "of another stiffness");
    let names =
        browser.ask("[...document.querySelectorAll('#path .legend li')].map(({textContent}) => textContent)").await;
    assert_eq!(names[1], "friction 0.1, axial stiffness 2");
    assert_eq!(
        browser.ask("document.getElementById('path-words').textContent.includes('have no letters')").await,
        true
    );
    browser.put("#colour-by", "1").await;
    browser.until(&format!("{bar}.colorbar.title.text === 'axial stiffness'")).await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn the_plot_is_saved_as_picture_and_as_table() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("one-bar-truss")).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{PATH}.data?.[1]?.text.length > 0")).await;
    // What is handed to the browser to be saved is kept here in its place.
    let kept = "window.saved = []; const made = URL.createObjectURL; \
                URL.createObjectURL = (blob) => { window.saved.push(blob); return made.call(URL, blob); }; \
                HTMLAnchorElement.prototype.click = () => {};";
    browser.ask(&format!("(() => {{ {kept} return true; }})()")).await;
    for (button, kind) in [("#path-png", "image/png"), ("#path-svg", "image/svg+xml"), ("#path-points", "text/csv")] {
        browser.press(button).await;
        browser.until(&format!("window.saved.some(({{type}}) => type === '{kind}')")).await;
    }
    let texts = "['image/svg+xml', 'text/csv'].forEach(async (kind) => { \
                 (window.texts ??= {})[kind] = await window.saved.find(({type}) => type === kind).text(); })";
    browser.ask(&format!("({texts}, true)")).await;
    browser.until("Object.keys(window.texts ?? {}).length === 2").await;
    let texts = browser.ask("window.texts").await;
    let (picture, table) = (texts["image/svg+xml"].as_str().expect("text"), texts["text/csv"].as_str().expect("text"));
    for words in ["A: limit point", "bifurcation points", "stage push", "displacement x of tip", "load factor"] {
        assert!(picture.contains(words), "{words}");
    }
    let loads = stored(&served, &id, "/load_factor").await;
    assert_eq!(table.lines().next(), Some("job,increment,stage,/displacements/tip/0,load_factor"));
    assert_eq!(table.lines().count(), loads.len() + 1);
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn what_is_not_recorded_is_said_below_the_plot() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let mut request = scene("one-bar-truss");
    request["analysis"] = json!({"record": {"every": 5, "elements": "none"}});
    let id = served.ended(&request).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    let words = "document.getElementById('path-words')?.textContent";
    let told = browser.until(&format!("{words} && {words} !== '' ? {words} : null")).await;
    let told = told.as_str().expect("text");
    assert!(told.contains("0 of 1 elements") && told.contains("one in 5 is recorded"), "{told}");
    assert_eq!(
        browser.ask("document.querySelector('#ordinate optgroup[label=\"Forces of bars\"]')").await,
        Value::Null
    );
    // An address that asks for what is not there is told so.
    browser.visit(&format!("{}/?jobs={id}&ordinate=/elements/0/axial_force", served.url())).await;
    browser
        .until("document.getElementById('notice').textContent.includes('There is no “/elements/0/axial_force” here')")
        .await;
    browser.close(served.url(), &[]).await;
}
