//! Random small bodies of solids in the plane on rough obstacles.

use super::paths::typed;
use super::random::Numbers;
use arcslip::model::JobRequest;
use serde_json::{Value, json};

const KINDS: [&str; 4] = ["triangle3", "quadrilateral4", "triangle6", "quadrilateral8"];

/// A body of a few cells: its nodes by row and column, its solids, and the faces of its lower, upper and right side.
struct Body {
    model: Value,
    lower: Vec<String>,
    upper: Vec<String>,
    left: Vec<String>,
    upper_faces: Vec<Vec<String>>,
    right_faces: Vec<Vec<String>>,
}

fn name(column: usize, row: usize) -> String {
    format!("n{column}_{row}")
}

fn body(numbers: &mut Numbers) -> Body {
    let kind = KINDS[numbers.below(KINDS.len())];
    let is_quadratic = kind.ends_with('6') || kind.ends_with('8');
    let (columns, rows) =
        if is_quadratic { (1 + numbers.below(2), 1) } else { (1 + numbers.below(3), 1 + numbers.below(2)) };
    let by = if is_quadratic { 2 } else { 1 };
    let size = [numbers.between(0.7, 2.0), numbers.between(0.5, 1.2)];
    let lean = numbers.between(-0.15, 0.15);
    let mut model = json!({"dimension": 2, "nodes": {}, "elements": [], "supports": {}});
    for row in 0..=by * rows {
        for column in 0..=by * columns {
            // The middle of a quadratic quadrilateral is no node.
            if kind == "quadrilateral8" && column % 2 == 1 && row % 2 == 1 {
                continue;
            }
            let [x, y] = [column as f64 / (by * columns) as f64, row as f64 / (by * rows) as f64];
            // Edges stay straight, and the lower side level.
            model["nodes"][name(column, row)] = json!([size[0] * x + lean * y, size[1] * y * (1.0 + 0.1 * x)]);
        }
    }
    let plane = if numbers.chance(0.5) { "strain" } else { "stress" };
    let material = ["linear_elastic", "saint_venant_kirchhoff", "neo_hookean", "mooney_rivlin"][numbers.below(4)];
    model["materials"]["matter"] = if material == "mooney_rivlin" {
        json!({"kind": material, "c10": 0.3, "c01": 0.1, "bulk_modulus": numbers.between(2.0, 50.0)})
    } else {
        json!({"kind": material, "young": 2, "poisson": numbers.between(0.0, 0.49)})
    };
    let mut elements = Vec::new();
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let at = |along: usize, up: usize| name(by * column + along, by * row + up);
        let (far, middle) = (by, 1);
        let corners = [at(0, 0), at(far, 0), at(far, far), at(0, far)];
        let [a, b, c, d] = corners.clone();
        let solids: Vec<Vec<String>> = match kind {
            "triangle3" => vec![vec![a.clone(), b, c.clone()], vec![a, c, d]],
            "triangle6" => vec![
                vec![a.clone(), b, c.clone(), at(middle, 0), at(far, middle), at(middle, middle)],
                vec![a, c, d, at(middle, middle), at(middle, far), at(0, middle)],
            ],
            "quadrilateral4" => vec![corners.to_vec()],
            _ => {
                vec![[corners.to_vec(), vec![at(middle, 0), at(far, middle), at(middle, far), at(0, middle)]].concat()]
            }
        };
        elements.extend(
            solids.into_iter().map(|nodes| json!({"kind": kind, "nodes": nodes, "material": "matter", "plane": plane})),
        );
    }
    model["elements"] = elements.into();
    let line = |places: Vec<(usize, usize)>| {
        places.into_iter().map(|(column, row)| name(column, row)).collect::<Vec<String>>()
    };
    let (last, top) = (by * columns, by * rows);
    let lower = line((0..=last).map(|column| (column, 0)).collect());
    let upper = line((0..=last).map(|column| (column, top)).collect());
    let left = line((0..=top).map(|row| (0, row)).collect());
    let right = line((0..=top).map(|row| (last, row)).collect());
    let faces = |side: &[String]| side.windows(by + 1).step_by(by).map(<[String]>::to_vec).collect();
    let (upper_faces, right_faces) = (faces(&upper), faces(&right));
    Body { model, lower, upper, left, upper_faces, right_faces }
}

/// A random body: free on a rough floor, clamped above a floor or a ball that moves, or clamped at its left over a floor.
pub fn random_solid(seed: u64) -> JobRequest {
    let mut numbers = Numbers(seed.wrapping_mul(9176).wrapping_add(11));
    let Body { mut model, lower, upper, left, upper_faces, right_faces } = body(&mut numbers);
    model["name"] = json!(format!("random solid {seed}"));
    model["surfaces"] = json!({"upper": {"faces": upper_faces}, "right": {"faces": right_faces}});
    // Without friction a free body could move along the floor.
    let (way, least) = [(0, 0.1), (1, 0.0), (2, 0.0)][numbers.below(3)];
    let friction = numbers.friction().max(least);
    let contact = |node: &String| json!({"node": node, "obstacle": "floor", "friction": friction});
    model["contacts"] = lower.iter().map(contact).collect();
    let floor = |gap: f64| json!({"kind": "plane", "point": [0, -gap], "normal": [0, 1]});
    let clamp = |model: &mut Value, nodes: &[String]| {
        nodes.iter().for_each(|node| model["supports"][node] = json!(["x", "y"]));
    };
    match way {
        0 => {
            model["obstacles"]["floor"] = floor(0.0);
            let press = numbers.between(0.02, 0.2);
            model["stages"] = json!([
                {"name": "press", "tractions": {"upper": [0, -press]}, "until": {"load_above": 1}},
                {"name": "push", "tractions": {"upper": [numbers.between(-1.0, 1.0), 0], "right": [0, numbers.between(-0.2, 0.2)]}}
            ]);
        }
        1 => {
            clamp(&mut model, &upper);
            model["obstacles"]["floor"] = if numbers.chance(0.5) {
                floor(numbers.between(0.0, 0.02))
            } else {
                let radius = numbers.between(0.6, 3.0);
                json!({"kind": "ball", "center": [numbers.between(0.0, 1.0), -radius - 0.01], "radius": radius})
            };
            let rise = numbers.between(0.05, 0.15);
            model["stages"] = json!([
                {"name": "raise", "obstacle_motion": {"floor": [0.0, rise]}, "until": {"load_above": 1}},
                {"name": "drag", "obstacle_motion": {"floor": [numbers.between(-0.3, 0.3), numbers.between(-0.2, 0.05)]},
                 "until": {"load_above": 1}}
            ]);
        }
        _ => {
            clamp(&mut model, &left);
            let own: Vec<Value> = model["contacts"]
                .as_array()
                .into_iter()
                .flatten()
                .filter(|one| one["node"] != left[0].as_str())
                .cloned()
                .collect();
            model["contacts"] = own.into();
            model["obstacles"]["floor"] = floor(numbers.between(0.0, 0.05));
            model["stages"] = json!([
                {"name": "weigh", "body_forces": {"matter": [0, -numbers.between(0.01, 0.1)]}, "until": {"load_above": 1}},
                {"name": "load", "tractions": {"right": [numbers.between(-0.2, 0.2), -numbers.between(0.05, 0.3)]},
                 "until": {"load_above": 1.5}}
            ]);
        }
    }
    if seed.is_multiple_of(3) {
        follow(&mut model);
    }
    typed(json!({
        "model": model,
        "analysis": {"arc_length": {"initial": 0.05, "min": 1e-9, "max": 0.2}, "max_increments": 40}
    }))
}

/// Turns tractions across the right side into pressures that follow it.
fn follow(model: &mut Value) {
    for stage in model["stages"].as_array_mut().into_iter().flatten().filter_map(Value::as_object_mut) {
        let Some(tractions) = stage.get_mut("tractions").and_then(Value::as_object_mut) else { continue };
        let right = tractions.remove("right");
        if tractions.is_empty() {
            stage.remove("tractions");
        }
        if let Some(across) = right.and_then(|right| right[0].as_f64().zip(right[1].as_f64())) {
            stage.insert("pressures".to_owned(), json!({"right": across.0 + across.1}));
        }
    }
}
