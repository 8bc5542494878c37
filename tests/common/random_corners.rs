//! Random nodes between obstacles in space, the same for the same seed on every machine.

use super::paths::typed;
use super::random::Numbers;
use arcslip::model::JobRequest;
use arcslip::{Obstacle, Polyline, Side};
use serde_json::{Map, Value, json};

type Vector = [f64; 3];

fn add(a: &Vector, factor: f64, b: &Vector) -> Vector {
    [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]]
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(a: &Vector) -> Vector {
    add(&[0.0; 3], 1.0 / dot(a, a).sqrt(), a)
}

/// One vector of a random direction and a size between two bounds.
fn of_size(numbers: &mut Numbers, least: f64, most: f64) -> Vector {
    let direction = loop {
        let [x, y, z] = numbers.vector(3, 1.0)[..] else { continue };
        let found = [x, y, z];
        if (0.1..1.0).contains(&dot(&found, &found)) {
            break unit(&found);
        }
    };
    add(&[0.0; 3], numbers.between(least, most), &direction)
}

/// One node or two on springs and slanting bars of differing stiffness, tied to each other, each before a plane or on a ball
/// or in a bowl, and before a plane at any angle to that; some before a third. Friction is 0 to 2. Pressed into the corner,
/// then pushed in one or two stages.
pub fn random_corner(seed: u64) -> JobRequest {
    let mut numbers = Numbers(seed.wrapping_mul(104_729).wrapping_add(17));
    let nodes_count = if numbers.chance(0.6) { 1 } else { 2 };
    let (mut nodes, mut supports, mut elements) = (Map::new(), Map::new(), Vec::new());
    let (mut obstacles, mut contacts) = (Map::new(), Vec::new());
    let (mut press, mut pushes) = (Map::new(), [Map::new(), Map::new()]);
    let stages_count = if numbers.chance(0.6) { 2 } else { 3 };
    for index in 0..nodes_count {
        let name = format!("node{index}");
        let place = add(&[2.3 * f64::from(index), 0.0, 0.0], 1.0, &of_size(&mut numbers, 0.0, 0.4));
        let factor =
            10.0_f64.powf(if numbers.chance(0.8) { numbers.between(-0.5, 0.5) } else { numbers.between(-1.5, 1.5) });
        let stiffness: Vec<Vec<f64>> = numbers
            .positive_definite(0.2, 1.0)
            .iter()
            .map(|row| row.iter().map(|value| value * factor).collect())
            .collect();
        elements.push(json!({"kind": "spring", "nodes": [name], "stiffness": stiffness}));
        let pin = format!("pin{index}");
        nodes.insert(pin.clone(), json!(add(&place, 1.0, &of_size(&mut numbers, 0.6, 1.6))));
        supports.insert(pin.clone(), json!(["x", "y", "z"]));
        let axial = numbers.between(0.2, 2.5);
        elements.push(json!({"kind": "bar", "nodes": [pin, name], "axial_stiffness": axial}));
        if index > 0 {
            let ends = ["node0".to_owned(), name.clone()];
            let tie = numbers.between(0.3, 1.5);
            elements.push(if numbers.chance(0.5) {
                json!({"kind": "bar", "nodes": ends, "axial_stiffness": tie})
            } else {
                json!({"kind": "spring", "nodes": ends, "stiffness": [[tie, 0, 0], [0, tie, 0], [0, 0, tie]]})
            });
        }
        let first = of_size(&mut numbers, 1.0, 1.0);
        let mut normals = vec![first];
        let others = if numbers.chance(0.1) { 2 } else { 1 };
        for _ in 0..others {
            let across = loop {
                let other = of_size(&mut numbers, 1.0, 1.0);
                let across = add(&other, -dot(&other, &first), &first);
                if dot(&across, &across) > 0.1 {
                    break unit(&across);
                }
            };
            let angle = numbers.between(10.0, 170.0).to_radians();
            normals.push(add(&add(&[0.0; 3], angle.cos(), &first), angle.sin(), &across));
        }
        for (which, normal) in normals.iter().enumerate() {
            let gap =
                if numbers.chance(if which == 0 { 0.8 } else { 0.5 }) { 0.0 } else { numbers.between(0.005, 0.1) };
            let obstacle = format!("obstacle{index}{which}");
            let data = if which == 0 && numbers.chance(0.35) {
                let (radius, inside) = (numbers.between(0.6, 2.0), numbers.chance(0.5));
                let (side, way) = if inside { ("inside", radius - gap) } else { ("outside", -radius - gap) };
                json!({"kind": "ball", "center": add(&place, way, normal), "radius": radius, "side": side})
            } else {
                json!({"kind": "plane", "point": add(&place, -gap, normal), "normal": normal})
            };
            obstacles.insert(obstacle.clone(), data);
            contacts.push(json!({"node": name, "obstacle": obstacle, "friction": numbers.friction()}));
        }
        nodes.insert(name.clone(), json!(place));
        let into = normals.iter().fold([0.0; 3], |sum, normal| add(&sum, -numbers.between(0.05, 0.4), normal));
        press.insert(name.clone(), json!(add(&into, 1.0, &of_size(&mut numbers, 0.0, 0.3))));
        for push in &mut pushes {
            push.insert(name.clone(), json!(of_size(&mut numbers, 0.2, 1.3)));
        }
    }
    let [first, second] = pushes;
    let mut stages: Vec<Value> = Vec::new();
    for (stage, forces) in [press, first, second].into_iter().enumerate().take(stages_count) {
        let until = if stage == 0 { 1.0 } else { numbers.between(0.6, 1.6) };
        stages.push(json!({"name": format!("stage{stage}"), "forces": forces, "until": {"load_above": until, "load_below": -1.0}}));
    }
    typed(json!({
        "model": {
            "name": format!("random corner {seed}"), "dimension": 3, "nodes": nodes, "supports": supports,
            "elements": elements, "obstacles": obstacles, "contacts": contacts, "stages": stages
        },
        "analysis": {"arc_length": {"initial": 0.1, "min": 1e-9, "max": 0.2}, "max_increments": 400}
    }))
}

/// The same with cylinders in place of balls, touched at the same points, with axes of any direction; `None` where there is
/// no ball.
pub fn random_corner_on_cylinders(seed: u64) -> Option<JobRequest> {
    on_round(seed, |center, axis, _, radius, side| {
        Obstacle::cylinder(add(&center, 1.0, &axis).to_vec(), axis.to_vec(), radius, side)
    })
}

/// The same with curves through points of a circle, straight across their plane.
pub fn random_corner_on_curves(seed: u64) -> Option<JobRequest> {
    on_round(seed, |center, axis, outward, radius, side| {
        let up = unit(&cross(&axis, &outward));
        let point = |k: u32| {
            let angle = std::f64::consts::TAU * f64::from(k) / 24.0;
            vec![radius * angle.cos(), radius * angle.sin()]
        };
        let curve = Polyline { points: (0..24).map(point).collect(), ..Polyline::default() };
        Obstacle::Polyline(curve.closed(side).in_space(center, outward, up))
    })
}

/// With other round obstacles in place of balls, made of the centre, a vector across the outward normal at the node, this
/// normal, the radius and the free side.
fn on_round(seed: u64, round: impl Fn(Vector, Vector, Vector, f64, Side) -> Obstacle) -> Option<JobRequest> {
    let mut numbers = Numbers(seed.wrapping_mul(15_485_863).wrapping_add(5));
    let mut request = random_corner(seed);
    let model = &mut request.model;
    let mut count = 0;
    for contact in &model.contacts {
        let obstacle = &mut model.obstacles[&contact.obstacle];
        let Obstacle::Ball { center, radius, side } = obstacle else { continue };
        let place = &model.nodes[&contact.node];
        let center: Vector = [center[0], center[1], center[2]];
        let outward = unit(&[0, 1, 2].map(|k| place[k] - center[k]));
        let other = of_size(&mut numbers, 1.0, 1.0);
        let axis = add(&other, -dot(&other, &outward), &outward);
        *obstacle = round(center, axis, outward, *radius, *side);
        count += 1;
    }
    (count > 0).then_some(request)
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
