//! Random small scenes, the same for the same seed on every machine.

use arcslip::model::JobRequest;
use serde_json::{Map, Value, json};

use super::paths::typed;

/// splitmix64 (G. L. Steele, D. Lea, C. H. Flood, *Fast splittable pseudorandom number generators*, OOPSLA 2014).
struct Numbers(u64);

impl Numbers {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [from, to); of three decimals, so that a document shows what it is.
    fn between(&mut self, from: f64, to: f64) -> f64 {
        let unit = (self.bits() >> 11) as f64 / (1_u64 << 53) as f64;
        ((from + (to - from) * unit) * 1000.0).round() / 1000.0
    }

    fn chance(&mut self, probability: f64) -> bool {
        self.between(0.0, 1.0) < probability
    }

    fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    fn vector(&mut self, dimension: usize, size: f64) -> Vec<f64> {
        (0..dimension).map(|_| self.between(-size, size)).collect()
    }

    fn friction(&mut self) -> f64 {
        if self.chance(0.2) { 0.0 } else { self.between(0.05, 2.0) }
    }
}

/// One to three tips on bars to pins above them, tied to one another, near a floor that may slant and near balls, on
/// whose outside or inside they lie; pressed, then pushed, some by a moving floor or pin. In space where the seed is a
/// multiple of 5. The last coordinate is the height.
pub fn random_scene(seed: u64) -> JobRequest {
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
    typed(json!({
        "model": {
            "name": format!("random scene {seed}"), "dimension": dimension, "nodes": nodes, "supports": supports,
            "elements": elements, "obstacles": obstacles, "contacts": contacts, "stages": stages
        },
        "analysis": {"arc_length": {"initial": 0.05, "min": 1e-9, "max": 0.2}, "max_increments": 40}
    }))
}
