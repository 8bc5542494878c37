//! The picture of the structure: axes that it fills, exaggeration, the triad, obstacles, loads, supports, forces, values by
//! hovering, and what is left out of a large one.
//!
//! Where there is no chromedriver these tests say that they are skipped; with `ARCSLIP_BROWSER=required` they fail there.

use crate::common::browser::Browser;
use crate::common::process::Served;
use crate::common::service::scene;
use serde_json::{Value, json};

const STRUCTURE: &str = "document.getElementById('structure-plot')";
const LEFT_OUT: &str = "document.querySelector('#structure .left-out').textContent";

fn trace(name: &str) -> String {
    format!("{STRUCTURE}.data?.find(({{name}}) => name === '{name}')")
}

/// Numbers of the page and of the service, which may differ by rounding.
fn near(found: &Value, expected: f64) -> bool {
    found.as_f64().is_some_and(|found| (found - expected).abs() <= 1e-9 * (1.0 + expected.abs()))
}

/// The widths in pixels of a unit along both axes, and the parts of the view that traces take, the given ones left out.
fn use_of_the_view(without: &[&str]) -> String {
    format!(
        "(({{data, _fullLayout: {{xaxis, yaxis}}}}) => {{ \
          const drawn = data.filter(({{name}}) => !{without:?}.some((one) => name.startsWith(one))); \
          const part = (axis, member) => {{ \
            const values = drawn.flatMap((one) => [...one[member]]).filter((value) => Number.isFinite(value)); \
            const [low, high] = axis.range; \
            return (Math.max(...values) - Math.min(...values)) / (high - low); }}; \
          return [xaxis._length / (xaxis.range[1] - xaxis.range[0]), yaxis._length / (yaxis.range[1] - yaxis.range[0]), \
                  part(xaxis, 'x'), part(yaxis, 'y')]; }})({STRUCTURE})"
    )
}

#[tokio::test]
async fn the_structure_fills_the_view_at_one_scale_and_a_far_obstacle_does_not_push_it_aside() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let mut far = scene("one-bar-truss");
    far["model"]["obstacles"]["mountain"] = json!({"kind": "plane", "point": [500, 0], "normal": [-1, 0]});
    for request in [scene("one-bar-truss"), scene("arch-type-truss"), far.clone()] {
        let id = served.ended(&request).await;
        browser.visit(&format!("{}/?jobs={id}", served.url())).await;
        browser.until(&trace("node")).await;
        let found = browser.ask(&use_of_the_view(&["obstacle", "area", "force scale"])).await;
        let [across, up, wide, high] = [0, 1, 2, 3].map(|place| found[place].as_f64().expect("a number"));
        assert!((across / up - 1.0).abs() < 0.01, "one scale: {found}");
        assert!(wide.max(high) > 0.6, "it fills the view: {found}");
        // The obstacle goes little further than the feet.
        let found = browser.ask(&use_of_the_view(&["force scale"])).await;
        let is_within = |place: usize| found[place].as_f64().is_some_and(|part| part < 1.0);
        assert!((is_within(2) || request == far) && is_within(3), "all is in the view: {found}");
    }
    browser.until(&format!("{LEFT_OUT}.includes('“mountain” is too far from the structure')")).await;
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn displacements_are_exaggerated_and_the_picture_says_how_much() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("one-bar-truss")).await;
    let page = served.get(&format!("/v1/jobs/{id}/increments")).await;
    let moved = page["increments"][20]["displacements"]["tip"].clone();
    let [right, up] = [0, 1].map(|axis| moved[axis].as_f64().expect("a number"));
    browser.visit(&format!("{}/?jobs={id}&at=20", served.url())).await;
    let place = format!("(({{x, y}}) => [x[1], y[1]])({})", trace("node"));
    let captions = format!(
        "({STRUCTURE}.layout?.annotations ?? []).filter(({{name}}) => name === 'caption').map(({{text}}) => text)"
    );
    browser.until(&format!("{} !== undefined", trace("node"))).await;
    let found = browser.ask(&place).await;
    assert!(near(&found[0], -1.5 + right) && near(&found[1], up), "{found} {moved}");
    assert_eq!(browser.ask(&captions).await, json!([]));
    browser.put("#exaggeration", "0.5").await;
    browser.until(&format!("{captions}[0]?.startsWith('displacements × 0.5')")).await;
    let found = browser.ask(&place).await;
    assert!(near(&found[0], -1.5 + 0.5 * right), "{found} {moved}");
    browser.until("location.search.includes('exaggeration=0.5')").await;
    let address = browser.page.current_url().await.expect("an address").to_string();
    browser.visit(&address).await;
    browser.until(&format!("{captions}[0]?.startsWith('displacements × 0.5')")).await;
    // A factor that is none changes nothing and is told.
    browser.put("#exaggeration", "-3").await;
    browser.until("document.querySelector('#structure [role=alert]').textContent.startsWith('The factor is')").await;
    assert_eq!(browser.ask(&place).await, found);
    // Fitted, what moves most goes a tenth of the structure's size, to a digit.
    browser.press("#fit-exaggeration").await;
    browser.until(&format!("!{captions}[0]?.startsWith('displacements × 0.5')")).await;
    let found = browser.ask(&place).await;
    let way = (found[0].as_f64().expect("a number") + 1.5).hypot(found[1].as_f64().expect("a number"));
    assert!((0.05..0.2).contains(&(way / 1.5_f64.hypot(1.0))), "{way}");
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn a_triad_shows_the_axes_of_a_structure_in_space_and_turns_with_it() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let id = served.ended(&scene("curving-slip")).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    let triad = format!(
        "{STRUCTURE}.layout?.annotations?.filter(({{name}}) => name?.startsWith('triad')).map(({{text, ax, ay}}) => [text, ax, ay])"
    );
    browser.until(&format!("{triad}?.length === 3")).await;
    browser.put("#azimuth", "0").await;
    browser.put("#elevation", "0").await;
    // From the x axis one looks at y to the right and z upwards.
    browser.until(&format!("{triad}[1][1] > 29 && {triad}[2][2] < -29")).await;
    let found = browser.ask(&triad).await;
    assert_eq!([&found[0][0], &found[1][0], &found[2][0]], ["x", "y", "z"]);
    assert!(near(&found[0][1], 0.0) && near(&found[0][2], 0.0), "x comes towards the reader: {found}");
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn loads_point_at_their_nodes_and_supports_show_what_they_hold() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let mut request = scene("one-bar-truss");
    request["model"]["stages"] = json!([
        {"name": "push", "forces": {"tip": [1, 0]}, "until": {"load_above": 0.1}},
        {"name": "settle", "displacements": {"pin": [0, -0.1]}, "until": {"load_above": 0.5}},
        {"name": "raise", "obstacle_motion": {"floor": [0, 0.05]}, "until": {"load_above": 1}},
    ]);
    let id = served.ended(&request).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{} !== undefined", trace("motion of an obstacle"))).await;
    let found = browser
        .ask(&format!(
            "[{}, {}].map(({{x, y, text}}) => ({{x: [...x], y: [...y], text}}))",
            trace("load"),
            trace("imposed displacement")
        ))
        .await;
    let tip = browser.ask(&format!("(({{x, y}}) => [x[1], y[1]])({})", trace("node"))).await;
    // From the left, with its head at the node.
    assert_eq!([&found[0]["x"][1], &found[0]["y"][1]], [&tip[0], &tip[1]]);
    assert!(found[0]["x"][0].as_f64() < tip[0].as_f64() && found[0]["y"][0] == tip[1], "{found}");
    assert_eq!(found[0]["text"][0], "load on tip: (0.1, 0)");
    assert!(found[1]["y"][1].as_f64() < found[1]["y"][0].as_f64(), "downwards: {found}");
    assert_eq!(found[1]["text"][1], "imposed displacement of pin: (0, -0.05)");
    // A triangle for each component that is held.
    let triangles = format!("{}.x.filter((value) => value === null).length", trace("support"));
    assert_eq!(browser.ask(&triangles).await, 2);
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn obstacles_that_turn_are_drawn_where_they_are() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let request = json!({"model": {
        "dimension": 2,
        "nodes": {"block": [0, 0]},
        "elements": [{"kind": "spring", "nodes": ["block"], "stiffness": [[0.5, 0], [0, 0.5]]}],
        "obstacles": {"slope": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
        "contacts": [{"node": "block", "obstacle": "slope", "friction": 0.5}],
        "stages": [
            {"name": "weigh", "forces": {"block": [0, -1]}, "until": {"load_above": 1}},
            {"name": "tilt", "obstacle_rotation": {"slope": {"angle": 1}}, "until": {"load_above": 0.6}},
        ],
    }});
    let id = served.ended(&request).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{} !== undefined", trace("rotation of an obstacle"))).await;
    let edge = format!("(({{x, y}}) => [x[0], y[0], x.at(-2), y.at(-2)])({})", trace("obstacle"));
    let found = browser.ask(&edge).await;
    let at = |place: usize| found[place].as_f64().expect("a number");
    let slope = (at(3) - at(1)) / (at(2) - at(0));
    assert!((slope - 0.6_f64.tan()).abs() < 1e-9, "{found}");
    browser.close(served.url(), &[]).await;
}

#[tokio::test]
async fn bars_are_coloured_by_the_recorded_force_with_a_scale_in_the_models_units() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let mut request = scene("arch-type-truss");
    request["model"]["units"] = json!({"length": "mm", "force": "kN"});
    let id = served.ended(&request).await;
    let page = served.get(&format!("/v1/jobs/{id}/increments")).await;
    let last = page["increments"].as_array().and_then(|list| list.last()).expect("an increment").clone();
    let forces: Vec<f64> = last["elements"]
        .as_array()
        .expect("recorded")
        .iter()
        .filter_map(|state| state["axial_force"].as_f64())
        .collect();
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{} !== undefined", trace("force scale"))).await;
    let scale = browser.ask(&format!("{}.marker", trace("force scale"))).await;
    let most = forces.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    assert!(near(&scale["cmax"], most) && near(&scale["cmin"], -most), "{most} {scale}");
    assert_eq!(scale["colorbar"]["title"]["text"], "axial force, tension positive (kN)");
    assert_eq!(browser.ask(&format!("{STRUCTURE}.layout.xaxis.title.text")).await, "x (mm)");
    let words = browser
        .ask(&format!("[...new Set({}.text)].filter((words) => words.startsWith('bar '))", trace("element values")))
        .await;
    let words: Vec<&str> = words.as_array().expect("words").iter().filter_map(Value::as_str).collect();
    assert_eq!(words.len(), forces.len());
    assert!(words.iter().all(|words| words.contains("axial force") && words.ends_with(" kN")), "{words:?}");
    // A bar of the largest force has the colour of the scale's end.
    let ends = ["#2560a8", "#a62a1d"].map(|colour| format!("{} !== undefined", trace(&format!("bar {colour}"))));
    assert_eq!(browser.ask(&ends.join(" || ")).await, true);
    // Where forces are not recorded they are computed, which is said.
    request["analysis"]["record"] = json!({"elements": "none"});
    let bare = served.ended(&request).await;
    browser.visit(&format!("{}/?jobs={bare}", served.url())).await;
    browser.until(&format!("{LEFT_OUT}.includes('computed from the displacements')")).await;
    let computed = browser.ask(&format!("{}.marker.cmax", trace("force scale"))).await;
    assert!(computed.as_f64().is_some_and(|found| (found / most - 1.0).abs() < 1e-6), "{computed} {most}");
    browser.close(served.url(), &[]).await;
}

/// A frame with all that beams bring: bent members, a hinge, a rotational spring, a moment, and diagrams of the forces.
#[tokio::test]
async fn beams_are_drawn_as_they_are_bent_with_the_forces_in_them() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let beam =
        |nodes: [&str; 2]| json!({"kind": "beam", "nodes": nodes, "axial_stiffness": 1e5, "bending_stiffness": 300.0});
    let mut hinged = beam(["m", "c"]);
    hinged["releases"] = json!({"c": ["rz"]});
    let frame = json!({
        "model": {
            "name": "portal frame", "dimension": 2, "units": {"length": "m", "force": "kN"},
            "nodes": {"a": [0, 0], "b": [0, 3], "m": [2, 3], "c": [4, 3], "d": [4, 0]},
            "supports": {"a": ["x", "y"], "d": ["x", "y", "rz"]},
            "elements": [beam(["a", "b"]), beam(["b", "m"]), hinged, beam(["c", "d"]),
                         {"kind": "rotational_spring", "nodes": ["a"], "stiffness": 50}],
            "stages": [{"name": "push", "forces": {"m": [10, -40]}, "moments": {"b": -20}, "until": {"load_above": 1}}]
        },
        "analysis": {"max_increments": 100}
    });
    let id = served.ended(&frame).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&trace("node")).await;
    for name in ["hinge", "rotational spring", "moment arrow", "moment of a support arrow", "undeformed", "support"] {
        browser.until(&trace(name)).await;
    }
    // Between the ends of each member there are points, off the straight line.
    let bent = format!(
        "{STRUCTURE}.data.filter(({{name}}) => name.startsWith('bar ')).reduce((sum, {{x}}) => sum + x.filter(Number.isFinite).length, 0)"
    );
    assert_eq!(browser.ask(&bent).await, 4 * 13, "twelve pieces of each member");
    let page = served.get(&format!("/v1/jobs/{id}/increments?limit=1000")).await;
    let last = page["increments"].as_array().and_then(|list| list.last()).expect("an increment").clone();
    for (kind, words) in
        [("bending_moment", "bending moment"), ("shear_force", "shear force"), ("axial_force", "axial force")]
    {
        browser.put("#diagram", kind).await;
        // What the height means is of this diagram alone: words for the pointer name the other forces too.
        let said =
            format!("{STRUCTURE}.layout.annotations.some(({{text}}) => text.startsWith('{words}: full height '))");
        browser.until(&said).await;
        let values: Vec<f64> = last["elements"]
            .as_array()
            .expect("elements")
            .iter()
            .filter_map(|state| state["ends"].as_array())
            .flatten()
            .map(|end| end[kind].as_f64().expect("a number"))
            .collect();
        assert_eq!(values.len(), 8);
        let told = browser.ask(&format!("{}.text.filter(Boolean).length", trace("diagram values"))).await;
        assert_eq!(told, 8, "a value at each end");
        // The largest value stands beside its place.
        let labels = browser.ask(&format!("{}.text", trace("diagram label"))).await;
        assert_eq!(labels.as_array().map(Vec::len), Some(1), "{labels}");
    }
    browser.close(served.url(), &[]).await;
}

/// A beam in space is drawn as it bends, and its support's force on it as an arrow; a malformed id is told.
#[tokio::test]
async fn a_beam_in_space_is_curved_and_its_support_pushes() {
    let Some(browser) = Browser::open().await else { return };
    let served = Served::start();
    let beam = json!({
        "kind": "beam", "nodes": ["root", "tip"], "axial_stiffness": 1e4, "bending_stiffness": [1, 1],
        "torsional_stiffness": 1, "orientation": [0, 1, 0],
    });
    let request = json!({"model": {
        "dimension": 3, "nodes": {"root": [0, 0, 0], "tip": [1, 0, 0]}, "elements": [beam],
        "supports": {"root": ["x", "y", "z", "rx", "ry", "rz"]},
        "stages": [{"name": "pull", "forces": {"tip": [0, 1, 1]}, "until": {"load_above": 2}}],
    }});
    let id = served.ended(&request).await;
    browser.visit(&format!("{}/?jobs={id}", served.url())).await;
    browser.until(&format!("{} !== undefined", trace("reaction of a support"))).await;
    let points = format!(
        "Math.max(...{STRUCTURE}.data.filter(({{name}}) => name?.startsWith('bar ')).map(({{x}}) => x.length))"
    );
    assert!(browser.ask(&points).await.as_f64().is_some_and(|points| points > 10.0), "the beam is bent");
    // What is in the way can be left out.
    for what in ["loads", "reactions"] {
        let drawn = trace(if what == "loads" { "load" } else { "reaction of a support" });
        browser.press(&format!("#show-{what}")).await;
        browser.until(&format!("{drawn} === undefined")).await;
        browser.press(&format!("#show-{what}")).await;
        browser.until(&format!("{drawn} !== undefined")).await;
    }
    // Forces and reactions as tables.
    let heading =
        |words: &str| format!("document.querySelector('#contacts h2')?.textContent.startsWith('{words} at increment')");
    browser.until(&heading("Members")).await;
    browser.put("#states-kind", "supports").await;
    browser.until(&heading("Supports")).await;
    let holds = "document.querySelector('#contacts tbody td:nth-child(2)').textContent";
    assert_eq!(browser.ask(holds).await, "x, y, z, rx, ry, rz");
    browser.visit(&format!("{}/?jobs={id},abc", served.url())).await;
    browser.until(&format!("{} !== undefined", trace("reaction of a support"))).await;
    browser
        .until("document.getElementById('notice').textContent.includes('“abc” where the id of a job is expected')")
        .await;
    browser.visit(&format!("{}/?jobs=abc", served.url())).await;
    browser
        .until("document.getElementById('notice').textContent.includes('“abc” where the id of a job is expected')")
        .await;
    browser.close(served.url(), &[]).await;
}
