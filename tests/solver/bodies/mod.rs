//! Bodies that touch each other.

mod arches;
mod bad_bodies;
mod belts;
mod blocks;
mod bricks;
mod crossed_bars;
mod hertz;
mod hooks;
mod itself;
mod quadratic_faces;
mod random_pairs;
mod revolution;
mod spheres;
mod tube;

use crate::common::paths::{Traced, judged};
use arcslip::JobRequest;
use arcslip::result::increment::{Increment, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Map, Value, json};

/// A mapped mesh of quadrilaterals, its parts named with a prefix.
pub struct Sheet {
    pub nodes: Map<String, Value>,
    pub elements: Vec<Value>,
    prefix: String,
    columns: usize,
    rows: usize,
}

impl Sheet {
    /// `place` maps the unit square; the columns follow the first direction.
    pub fn new(prefix: &str, [columns, rows]: [usize; 2], place: impl Fn(f64, f64) -> [f64; 2]) -> Self {
        let mut sheet = Self { nodes: Map::new(), elements: Vec::new(), prefix: prefix.to_owned(), columns, rows };
        for row in 0..=rows {
            for column in 0..=columns {
                let at = place(column as f64 / columns as f64, row as f64 / rows as f64);
                sheet.nodes.insert(sheet.name(column, row), json!(at));
            }
        }
        for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(right, up)| sheet.name(column + right, row + up));
            sheet.elements.push(json!({
                "kind": "quadrilateral4", "nodes": corners, "material": "matter", "plane": "strain"
            }));
        }
        sheet
    }

    pub fn name(&self, column: usize, row: usize) -> String {
        format!("{}{column}_{row}", self.prefix)
    }

    /// The nodes of the lowest and of the highest row.
    pub fn lowest(&self) -> Vec<String> {
        (0..=self.columns).map(|column| self.name(column, 0)).collect()
    }

    pub fn highest(&self) -> Vec<String> {
        (0..=self.columns).map(|column| self.name(column, self.rows)).collect()
    }
}

/// Faces between nodes in a row.
pub fn faces(nodes: &[String]) -> Value {
    json!({"faces": nodes.windows(2).map(<[String]>::to_vec).collect::<Vec<_>>()})
}

/// A model of two sheets; the upper surface of the first touches the lower surface of the second, which carries the
/// multipliers unless `swapped`.
pub fn pair(lower: &Sheet, upper: &Sheet, material: &Value, friction: f64, swapped: bool) -> Value {
    let (mut nodes, mut elements) = (lower.nodes.clone(), lower.elements.clone());
    nodes.extend(upper.nodes.clone());
    elements.extend(upper.elements.clone());
    let (surface, against) = if swapped { ("below", "above") } else { ("above", "below") };
    json!({
        "dimension": 2, "nodes": nodes, "elements": elements, "supports": {},
        "materials": {"matter": material},
        "surfaces": {
            "below": faces(&lower.highest()), "above": faces(&upper.lowest()), "top": faces(&upper.highest()),
        },
        "contacts": [{"surface": surface, "against": against, "friction": friction}],
    })
}

/// Adds supports of nodes.
pub fn support(model: &mut Value, nodes: &[String], components: &[&str]) {
    for node in nodes {
        let held = model["supports"].get(node).cloned().unwrap_or(json!([]));
        let mut held: Vec<Value> = held.as_array().cloned().unwrap_or_default();
        for component in components.iter().map(|component| json!(component)) {
            if !held.contains(&component) {
                held.push(component);
            }
        }
        model["supports"][node] = json!(held);
    }
}

/// Prescribed displacements of nodes.
pub fn moved(nodes: &[String], motion: [f64; 2]) -> Value {
    nodes.iter().map(|node| (node.clone(), json!(motion))).collect::<Map<_, _>>().into()
}

/// Prescribed displacements of nodes in space.
pub fn moved_in_space(nodes: &[String], motion: [f64; 3]) -> Value {
    nodes.iter().map(|node| (node.clone(), json!(motion))).collect::<Map<_, _>>().into()
}

/// Counts the contacts of a path that are free, stick and slip; every increment is within the measure, its energy within a bar.
pub fn count_within_the_measure(path: &Traced, energy: f64, seed: u64, statuses: &mut [usize; 3]) {
    for (increment, errors) in path.increments.iter().zip(&path.errors) {
        assert!(errors.largest_of_state() <= 1e-9, "seed {seed}, increment {}: {errors:?}", increment.index);
        assert!(errors.energy <= energy, "seed {seed}, increment {}: {errors:?}", increment.index);
        for contact in &increment.contacts {
            statuses[match contact.status {
                Status::Free => 0,
                Status::Stick => 1,
                Status::Slip => 2,
            }] += 1;
        }
    }
}

/// The increments of a path to the end of its last stage, all within the measure.
pub fn whole_path(request: &JobRequest) -> Vec<Increment> {
    let traced = judged(request);
    assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted);
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        assert!(errors.largest_of_state() < 1e-9 && errors.energy < 1e-6, "increment {}: {errors:?}", increment.index);
    }
    traced.increments
}
