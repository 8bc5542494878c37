//! The picture that `arcslip solve --plot` draws.

use crate::common::server::TestServer;
use crate::common::service::scene;
use arcslip::service::jobs::PathSolver;
use roxmltree::Document;
use std::path::Path;
use std::process::{Command, Output};

fn solve(scene: &str, picture: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_arcslip"))
        .args(["solve", scene, "--out", "/dev/null", "--plot"])
        .arg(picture)
        .args(more)
        .output()
        .expect("the program runs")
}

/// The picture of a scene as text.
fn picture(scene: &str, more: &[&str]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("picture.svg");
    let output = solve(scene, &file, more);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{scene}: {output:?}");
    std::fs::read_to_string(file).expect("a picture")
}

/// The texts of a picture, as a reader sees them.
fn texts(svg: &str) -> Vec<String> {
    let document = Document::parse(svg).expect("well-formed XML");
    assert_eq!(document.root_element().tag_name().name(), "svg");
    let texts = document.descendants().filter(|node| node.has_tag_name(("http://www.w3.org/2000/svg", "text")));
    texts.filter_map(|node| node.text()).map(|text| text.trim().to_owned()).collect()
}

/// How many shapes of that name and fill there are.
fn shapes(svg: &str, name: &str, fill: &str) -> usize {
    let document = Document::parse(svg).expect("well-formed XML");
    let fits = |node: &roxmltree::Node<'_, '_>| node.tag_name().name() == name && node.attribute("fill") == Some(fill);
    document.descendants().filter(fits).count()
}

fn count(texts: &[String], wanted: &str) -> usize {
    texts.iter().filter(|text| *text == wanted).count()
}

const SMOOTH_LIMIT: &str = "#BE1428";
const NONSMOOTH_LIMIT: &str = "#78288C";
const END: &str = "#222222";

#[test]
fn one_bar_truss_has_two_smooth_limits_and_an_end() {
    let svg = picture("one-bar-truss", &[]);
    let texts = texts(&svg);
    for wanted in [
        "one-bar truss, mu = 0.3",
        "displacement tip.x",
        "load factor",
        "stage push",
        "bifurcation points",
        "smooth limit, load factor 0.273315",
        "smooth limit, load factor -0.113982",
        "end, load factor 0",
    ] {
        assert_eq!(count(&texts, wanted), 1, "{wanted} in {texts:?}");
    }
    // Each letter and each mark is at the curve and in the legend.
    for letter in ["A", "B", "C"] {
        assert_eq!(count(&texts, letter), 2, "{letter}");
    }
    assert_eq!(count(&texts, "D"), 0);
    assert_eq!(shapes(&svg, "circle", SMOOTH_LIMIT), 4);
    assert_eq!(shapes(&svg, "polygon", NONSMOOTH_LIMIT), 0);
    assert_eq!(shapes(&svg, "polygon", END), 2);
}

#[test]
fn klarbring_has_two_stages_and_two_corners() {
    let svg = picture("klarbring", &["--against", "node.y"]);
    let texts = texts(&svg);
    for wanted in [
        "displacement node.y",
        "stage press",
        "stage pull",
        "end, load factor 1",
        "nonsmooth limit, load factor 1.5",
        "nonsmooth limit, load factor 1.25",
        "node on floor: stick to slip",
        "end, load factor 3",
    ] {
        assert_eq!(count(&texts, wanted), 1, "{wanted} in {texts:?}");
    }
    for letter in ["A", "B", "C", "D"] {
        assert_eq!(count(&texts, letter), 2, "{letter}");
    }
    assert_eq!(shapes(&svg, "polygon", NONSMOOTH_LIMIT), 4);
    assert_eq!(shapes(&svg, "polygon", END), 4);
}

#[test]
fn the_committed_pictures_are_what_is_drawn() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/check/scenes/pictures");
    for scene in ["one-bar-truss", "three-snapping-bars"] {
        let committed = std::fs::read_to_string(folder.join(format!("{scene}.svg"))).expect("a committed picture");
        let command = format!("solve {scene} --out /dev/null --plot src/check/scenes/pictures/{scene}.svg");
        assert!(picture(scene, &[]) == committed, "draw it anew: cargo run --release -- {command}");
    }
}

#[test]
fn an_unknown_displacement_is_bad_input_and_the_nearest_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("picture.svg");
    for (asked, nearest) in [("tpi.x", "tip.x"), ("tip.z", "tip.x"), ("tip", "tip.x"), ("Pin.y", "pin.y")] {
        let output = solve("one-bar-truss", &file, &["--against", asked]);
        assert_eq!(output.status.code(), Some(2), "{asked}");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(message.contains(&format!("--against `{asked}`")), "{message}");
        assert!(message.contains(&format!("did you mean `{nearest}`?")), "{message}");
        assert!(!file.exists());
    }
    let without_plot = Command::new(env!("CARGO_BIN_EXE_arcslip"))
        .args(["solve", "one-bar-truss", "--against", "tip.x"])
        .output()
        .expect("the program runs");
    assert_eq!(without_plot.status.code(), Some(2));
}

#[test]
fn names_and_magnitudes_do_not_spoil_the_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let (model, file) = (folder.path().join("model.json"), folder.path().join("picture.svg"));
    let scene = arcslip::check::scenes::find("von-mises-truss").expect("a built-in scene").request;
    let renamed = scene.replace("apex", r#"a<&>\"'.\ufffe b"#);
    let mut request: serde_json::Value = serde_json::from_str(&renamed).expect("JSON");
    for element in request["model"]["elements"].as_array_mut().expect("elements") {
        let stiffness = element["axial_stiffness"].as_f64().expect("a stiffness");
        element["axial_stiffness"] = (stiffness * 1e-30).into();
    }
    // Ends by displacement do not know the forces' unit.
    request["model"]["stages"][0]["until"] = serde_json::json!({"limit_points": 2});
    std::fs::write(&model, request.to_string()).expect("a model");
    let output = solve(model.to_str().expect("a path"), &file, &["--against", "a<&>\"'.\u{fffe} b.y"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let texts = texts(&std::fs::read_to_string(file).expect("a picture"));
    assert_eq!(count(&texts, "displacement a<&>\"'.\u{fffd} b.y"), 1, "{texts:?}");
    assert!(texts.iter().any(|text| text.starts_with("load factor / 1e-")), "{texts:?}");
}

#[test]
fn extensions_say_the_format_and_unknown_ones_are_refused_before_anything_is_traced() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |out: &str, more: &[&str]| {
        let place = folder.path().join(out);
        let mut command = Command::new(env!("CARGO_BIN_EXE_arcslip"));
        let output = command.args(["solve", "klarbring", "--out"]).arg(&place).args(more).output().expect("it runs");
        (
            output.status.code(),
            String::from_utf8_lossy(&output.stderr).into_owned(),
            std::fs::read_to_string(place).ok(),
        )
    };
    let pieces = || std::fs::read_dir(folder.path().join("path")).map(Iterator::count).ok();
    for (name, more, begins) in [
        ("path.csv", &[][..], "index,stage,"),
        ("path.NDJSON", &[], "{\"index\":0,"),
        ("plain", &[], "{\"index\":0,"),
        ("path.table", &["--format", "csv"], "index,stage,"),
        ("path.pvd", &[], "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\""),
    ] {
        let (status, told, written) = run(name, more);
        assert!(status == Some(0) && written.expect("a file").starts_with(begins), "{name}: {told}");
    }
    assert_eq!(run("rows.ndjson", &[]).2.map(|lines| lines.lines().count()), pieces());
    assert_eq!(run("path.parquet", &[]).0, Some(0));
    for name in ["path.parquet", "path.nodes.parquet", "path.elements.parquet", "path.contacts.parquet"] {
        let bytes = std::fs::read(folder.path().join(name)).expect("a table");
        assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"), "{name}");
    }
    for (name, more, told_of) in [
        ("path.xlsx", &[][..], "the extension `xlsx` names no format"),
        ("nowhere/path.csv", &[], "--out: there is no folder"),
        (
            "other.csv",
            &["--plot", "picture.jpeg"],
            "the extension `jpeg` names no format of a picture; `svg` and `png` do",
        ),
    ] {
        let (status, told, written) = run(name, more);
        assert!(status == Some(2) && told.contains(told_of) && written.is_none(), "{name}: {told}");
    }
}

/// The signature of a PNG file, and its width and height.
fn size_of_png(bytes: &[u8]) -> [u32; 2] {
    assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n");
    [16, 20].map(|from| u32::from_be_bytes(bytes[from..from + 4].try_into().expect("four bytes")))
}

#[tokio::test]
async fn the_service_draws_the_same_pictures() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = TestServer::start(&folder.path().join("jobs.db"), PathSolver).await;
    let id = server.submit(&scene("klarbring")).await;
    let job = server.ended(&id).await;
    let place = job["links"]["picture"].as_str().expect("a place").to_owned();
    let drawn = async |place: &str| server.get(place).await.bytes().await.expect("a body").to_vec();
    let file = folder.path().join("picture.png");
    for (asked, more) in [("", &[][..]), ("?against=node.y", &["--against", "node.y"])] {
        assert_eq!(drawn(&format!("{place}{asked}")).await, picture("klarbring", more).into_bytes());
        solve("klarbring", &file, more);
        let pixels = drawn(&format!("{}{asked}", place.replace(".svg", ".png"))).await;
        assert_eq!(pixels, std::fs::read(&file).expect("a picture"));
        assert_eq!(size_of_png(&pixels)[0], 2 * 1040);
    }
    for (wrong, expected, told) in [
        ("?against=node.q", 404, "against `node.q`: the model has no such displacement (NODE.COMPONENT)"),
        ("?against=", 404, "against ``"),
        ("?node=p", 400, "there is no parameter `node`"),
    ] {
        let answer = server.get(&format!("{place}{wrong}")).await;
        let status = answer.status();
        let answer: serde_json::Value = answer.json().await.expect("JSON");
        assert!(status == expected && answer["detail"].as_str().expect("text").contains(told), "{wrong}: {answer}");
    }
}
