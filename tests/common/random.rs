//! Random small scenes, the same for the same seed on every machine.

use arcslip::model::JobRequest;
use serde_json::{Map, Value, json};

use super::paths::typed;

/// splitmix64 (G. L. Steele, D. Lea, C. H. Flood, *Fast splittable pseudorandom number generators*, OOPSLA 2014).
pub struct Numbers(pub u64);

impl Numbers {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [from, to); of three decimals, so that a document shows what it is.
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        let unit = (self.bits() >> 11) as f64 / (1_u64 << 53) as f64;
        ((from + (to - from) * unit) * 1000.0).round() / 1000.0
    }

    pub fn chance(&mut self, probability: f64) -> bool {
        self.between(0.0, 1.0) < probability
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    pub fn vector(&mut self, dimension: usize, size: f64) -> Vec<f64> {
        (0..dimension).map(|_| self.between(-size, size)).collect()
    }

    /// `Aᵀ A + least 1`
    pub fn positive_definite(&mut self, least: f64, most: f64) -> Vec<Vec<f64>> {
        let rows: Vec<Vec<f64>> = (0..3).map(|_| self.vector(3, most.sqrt())).collect();
        let product = |i: usize, j: usize| rows.iter().map(|row| row[i] * row[j]).sum::<f64>();
        let entry = |i: usize, j: usize| product(i, j) + if i == j { least } else { 0.0 };
        (0..3).map(|i| (0..3).map(|j| entry(i, j)).collect()).collect()
    }

    pub fn friction(&mut self) -> f64 {
        if self.chance(0.2) { 0.0 } else { self.between(0.05, 2.0) }
    }
}

/// One to three tips on bars to pins above them, tied to one another, near a floor that may slant and near balls, on
/// whose outside or inside they lie; pressed, then pushed, some by a moving floor or pin. In space where the seed is a
/// multiple of 5. The last coordinate is the height.
pub fn random_scene(seed: u64) -> JobRequest {
    typed(random_document(seed))
}

fn random_document(seed: u64) -> Value {
    let mut numbers = Numbers(seed);
    let dimension = if seed.is_multiple_of(5) { 3 } else { 2 };
    let up = dimension - 1;
    let tips = if dimension == 3 { 1 + numbers.below(2) } else { 1 + numbers.below(3) };
    let (mut nodes, mut supports, mut elements) = (Map::new(), Map::new(), Vec::new());
    let (mut obstacles, mut contacts) = (Map::new(), Vec::new());
    let mut normal = numbers.vector(dimension, 0.3);
    normal[up] = 1.0;
    if numbers.chance(0.6) {
        normal[..up].fill(0.0);
    }
    obstacles.insert("floor".into(), json!({"kind": "plane", "point": vec![0.0; dimension], "normal": normal}));
    let components = &["x", "y", "z"][..dimension];
    for tip in 0..tips {
        let name = format!("tip{tip}");
        let mut place = numbers.vector(dimension, 0.2);
        place[0] += 2.0 * tip as f64;
        // On one slanting bar a tip snaps over its floor; on as many as there are dimensions it is held without one.
        let bars = if numbers.chance(0.6) { 1 } else { dimension };
        let gap = if bars == 1 || numbers.chance(0.5) { 0.0 } else { numbers.between(0.02, 0.2) };
        place[up] = gap - (0..up).map(|k| place[k] * normal[k]).sum::<f64>();
        for pin in 0..bars {
            let pin_name = format!("pin{tip}{pin}");
            // Apart from one another, so that the bars span the space.
            let mut pin_place: Vec<f64> = place.iter().map(|x| x + numbers.between(-0.2, 0.2)).collect();
            pin_place[up] = place[up] + numbers.between(0.5, 1.2);
            let angle = 0.4 + 2.2 * pin as f64 + if bars == 1 { numbers.between(0.0, 6.0) } else { 0.0 };
            pin_place[0] += numbers.between(0.8, 1.4) * angle.cos();
            if dimension == 3 {
                pin_place[1] += numbers.between(0.8, 1.4) * angle.sin();
            }
            nodes.insert(pin_name.clone(), json!(pin_place));
            supports.insert(pin_name.clone(), json!(components));
            let stiffness = numbers.between(0.3, 2.0);
            elements.push(json!({"kind": "bar", "nodes": [pin_name, name.clone()], "axial_stiffness": stiffness}));
        }
        if tip > 0 {
            let ends = [format!("tip{}", tip - 1), name.clone()];
            elements.push(json!({"kind": "bar", "nodes": ends, "axial_stiffness": numbers.between(0.2, 1.0)}));
        }
        // In space one bar and a smooth floor would leave a motion free.
        let friction = if bars == 1 { numbers.between(0.05, 2.0) } else { numbers.friction() };
        contacts.push(json!({"node": name.clone(), "obstacle": "floor", "friction": friction}));
        if numbers.chance(0.4) {
            let inside = numbers.chance(0.3);
            let (radius, room) = (numbers.between(0.3, 1.5), numbers.between(0.0, 0.15));
            let radius = if inside { radius + 0.5 } else { radius };
            let mut towards = numbers.vector(dimension, 1.0);
            // Outside: beside the tip or below it. Inside: its centre above the tip.
            towards[up] = if inside { 1.0 } else { -0.2 - towards[up].abs() };
            let size = towards.iter().map(|value| value * value).sum::<f64>().sqrt();
            let distance = if inside { radius - room } else { radius + room };
            let center: Vec<f64> = place.iter().zip(&towards).map(|(x, t)| x + distance * t / size).collect();
            let side = if inside { "inside" } else { "outside" };
            let ball = format!("ball{tip}");
            obstacles.insert(ball.clone(), json!({"kind": "ball", "center": center, "radius": radius, "side": side}));
            contacts.push(json!({"node": name.clone(), "obstacle": ball, "friction": numbers.friction()}));
        }
        nodes.insert(name, json!(place));
    }
    let (mut press, mut push) = (Map::new(), Map::new());
    for tip in 0..tips {
        let mut down = vec![0.0; dimension];
        down[up] = -numbers.between(0.01, 0.2);
        press.insert(format!("tip{tip}"), json!(down));
        let mut force = numbers.vector(dimension, 1.0);
        force[up] = 0.5 * force[up] - 0.2;
        push.insert(format!("tip{tip}"), json!(force));
    }
    let mut last = json!({"name": "push", "forces": push});
    if numbers.chance(0.15) {
        last["obstacle_motion"] = json!({"floor": numbers.vector(dimension, 0.5)});
    }
    if numbers.chance(0.15) {
        last["displacements"] = json!({"pin00": numbers.vector(dimension, 0.5)});
    }
    let mut stages: Vec<Value> = Vec::new();
    if numbers.chance(0.5) {
        stages.push(json!({"name": "press", "forces": press, "until": {"load_above": 1}}));
    }
    stages.push(last);
    json!({
        "model": {
            "name": format!("random scene {seed}"), "dimension": dimension, "nodes": nodes, "supports": supports,
            "elements": elements, "obstacles": obstacles, "contacts": contacts, "stages": stages
        },
        "analysis": {"arc_length": {"initial": 0.05, "min": 1e-9, "max": 0.2}, "max_increments": 40}
    })
}

/// A random scene in the plane whose bars are mostly beams: straight ones of one or two elements and curved ones, with and
/// without shear, some hinged at their ends, some clamped to their pins; with rotational springs and moments.
pub fn random_frame(seed: u64) -> JobRequest {
    // Multiples of 5 are in space.
    let mut document = random_document(5 * (seed / 4) + 1 + seed % 4);
    let mut numbers = Numbers(seed.wrapping_mul(6271).wrapping_add(3));
    let model = &mut document["model"];
    model["name"] = json!(format!("random frame {seed}"));
    let place = |model: &Value, node: &str| [0, 1].map(|k| model["nodes"][node][k].as_f64().expect("a coordinate"));
    let mut turning: Vec<String> = Vec::new();
    let bars = std::mem::take(model["elements"].as_array_mut().expect("elements"));
    let mut elements = Vec::new();
    for (number, bar) in bars.into_iter().enumerate() {
        if numbers.chance(0.25) {
            elements.push(bar);
            continue;
        }
        let ends = [0, 1].map(|k| bar["nodes"][k].as_str().expect("a node").to_owned());
        let [from, to] = [place(model, &ends[0]), place(model, &ends[1])];
        let chord = [to[0] - from[0], to[1] - from[1]];
        let axial = bar["axial_stiffness"].as_f64().expect("a stiffness");
        let bending = axial * chord[0].hypot(chord[1]).powi(2) * numbers.between(0.002, 0.03);
        let mut section = json!({"kind": "beam", "axial_stiffness": axial, "bending_stiffness": bending});
        if numbers.chance(0.3) {
            section["shear_stiffness"] = json!(axial * numbers.between(0.1, 0.5));
        }
        let shape = numbers.below(3);
        let middle = format!("middle{number}");
        if shape > 0 {
            let rise = if shape == 1 { 0.0 } else { numbers.between(-0.15, 0.15) };
            let at = [from[0] + 0.5 * chord[0] - rise * chord[1], from[1] + 0.5 * chord[1] + rise * chord[0]];
            model["nodes"][&middle] = json!(at);
            turning.push(middle.clone());
        }
        let chains: Vec<Vec<&str>> = match shape {
            0 => vec![vec![&ends[0], &ends[1]]],
            1 => vec![vec![&ends[0], &middle], vec![&middle, &ends[1]]],
            _ => vec![vec![&ends[0], &middle, &ends[1]]],
        };
        let hinged = [numbers.chance(0.2), numbers.chance(0.2)];
        for nodes in chains {
            let mut beam = section.clone();
            beam["nodes"] = json!(nodes);
            for (end, hinged) in ends.iter().zip(hinged).filter(|(end, _)| nodes.contains(&end.as_str())) {
                if hinged {
                    beam["releases"][end] = json!(["rz"]);
                } else {
                    turning.push(end.clone());
                }
            }
            elements.push(beam);
        }
    }
    for node in &turning {
        if node.starts_with("pin") && numbers.chance(0.5) {
            model["supports"][node] = json!(["x", "y", "rz"]);
        }
        if node.starts_with("tip") && numbers.chance(0.3) {
            let stiffness = numbers.between(0.05, 0.5);
            elements.push(json!({"kind": "rotational_spring", "nodes": [node], "stiffness": stiffness}));
        }
    }
    model["elements"] = json!(elements);
    let tips: Vec<&String> = turning.iter().filter(|node| node.starts_with("tip")).collect();
    if let (Some(tip), true) = (tips.first(), numbers.chance(0.3)) {
        let stages = model["stages"].as_array_mut().expect("stages");
        stages.last_mut().expect("a stage")["moments"] = json!({tip.as_str(): numbers.between(-0.2, 0.2)});
    }
    // Stiffer than bars: a longer way to the same events.
    document["analysis"]["max_increments"] = json!(60);
    typed(document)
}

/// One to three tips in space on a floor that may slant, on balls or in bowls that touch them at the apex: on springs
/// that couple normal and tangential or do not, on bars straight above or below, tied to one another by bars or springs.
/// Pressed first, or not at all, so that many begin to slip without reaction; then pushed in up to three stages, some
/// along the obstacle only.
pub fn random_space(seed: u64) -> JobRequest {
    let mut numbers = Numbers(seed.wrapping_mul(7919).wrapping_add(1));
    let tips = 1 + numbers.below(3);
    let (mut nodes, mut supports, mut elements) = (Map::new(), Map::new(), Vec::new());
    let (mut obstacles, mut contacts) = (Map::new(), Vec::new());
    let level = numbers.chance(0.6);
    let mut normal = numbers.vector(3, 0.3);
    normal[2] = 1.0;
    if level {
        normal[..2].fill(0.0);
    }
    obstacles.insert("floor".into(), json!({"kind": "plane", "point": [0, 0, 0], "normal": normal}));
    for tip in 0..tips {
        let name = format!("tip{tip}");
        let mut place = numbers.vector(3, 0.3);
        place[0] += 1.5 * tip as f64;
        let on_ball = numbers.chance(0.3);
        let gap = if numbers.chance(0.75) { 0.0 } else { numbers.between(0.0, 0.1) };
        place[2] = gap - normal[0] * place[0] - normal[1] * place[1];
        let friction = if numbers.chance(0.15) { 0.0 } else { numbers.between(0.0, 1.5) };
        let mut obstacle = "floor".to_owned();
        if on_ball {
            let radius = [0.5, 1.0, 2.0][numbers.below(3)];
            let (side, up) = if numbers.chance(0.5) { ("inside", radius - gap) } else { ("outside", -radius - gap) };
            let center = [place[0], place[1], place[2] + up];
            obstacle = format!("ball{tip}");
            let ball = json!({"kind": "ball", "center": center, "radius": radius, "side": side});
            obstacles.insert(obstacle.clone(), ball);
        }
        contacts.push(json!({"node": name, "obstacle": obstacle, "friction": friction}));
        let isotropic = |k: f64| json!([[k, 0, 0], [0, k, 0], [0, 0, k]]);
        let stiffness = match numbers.below(3) {
            0 => isotropic(numbers.between(0.3, 2.0)),
            1 => json!(numbers.positive_definite(0.2, 1.0)),
            _ => {
                let weak = isotropic(numbers.between(0.05, 0.5));
                let below = numbers.chance(0.5);
                let mut pin_place = place.clone();
                if numbers.chance(0.5) {
                    pin_place[0] += numbers.between(-1.0, 1.0);
                    pin_place[1] += numbers.between(-1.0, 1.0);
                }
                pin_place[2] += if below { -numbers.between(0.4, 1.5) } else { numbers.between(0.4, 1.5) };
                let pin = format!("pin{tip}");
                let ends = [pin.clone(), name.clone()];
                nodes.insert(pin.clone(), json!(pin_place));
                supports.insert(pin, json!(["x", "y", "z"]));
                elements.push(json!({"kind": "bar", "nodes": ends, "axial_stiffness": numbers.between(0.3, 2.0)}));
                weak
            }
        };
        elements.push(json!({"kind": "spring", "nodes": [name], "stiffness": stiffness}));
        if tip > 0 {
            let ends = [format!("tip{}", tip - 1), name.clone()];
            if numbers.chance(0.6) {
                elements.push(json!({"kind": "bar", "nodes": ends, "axial_stiffness": numbers.between(0.2, 1.5)}));
            } else if numbers.chance(0.7) {
                let stiffness = numbers.positive_definite(0.1, 0.6);
                elements.push(json!({"kind": "spring", "nodes": ends, "stiffness": stiffness}));
            }
        }
        nodes.insert(name, json!(place));
    }
    let mut stages: Vec<Value> = Vec::new();
    if numbers.chance(0.6) {
        let press: Map<String, Value> =
            (0..tips).map(|tip| (format!("tip{tip}"), json!([0, 0, -numbers.between(0.01, 0.3)]))).collect();
        stages.push(json!({"name": "press", "forces": press, "until": {"load_above": 1}}));
    }
    let pushes = 1 + numbers.below(3);
    for push in 0..pushes {
        let mut forces = Map::new();
        for tip in 0..tips {
            if tip > 0 && numbers.chance(0.3) {
                continue;
            }
            let mut force = numbers.vector(3, 0.6);
            match numbers.below(4) {
                0 => force[2] = 0.0,
                1 => force[2] = -force[2].abs(),
                2 => force = vec![0.0, if numbers.chance(0.5) { 1.0 } else { -1.0 }, 0.0],
                _ => {}
            }
            forces.insert(format!("tip{tip}"), json!(force));
        }
        let until = if push + 1 < pushes { numbers.between(0.2, 1.2) } else { 2.0 };
        stages.push(json!({"name": format!("push{push}"), "forces": forces, "until": {"load_above": until}}));
    }
    typed(json!({
        "model": {
            "name": format!("random scene in space {seed}"), "dimension": 3, "nodes": nodes, "supports": supports,
            "elements": elements, "obstacles": obstacles, "contacts": contacts, "stages": stages
        },
        "analysis": {"arc_length": {"initial": 0.05, "min": 1e-9, "max": 0.2}, "max_increments": 60}
    }))
}
