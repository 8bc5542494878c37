//! Scenes of plane beams with any number of elements, and their exact solutions.
//!
//! The models are documents without an analysis. The solutions are those of the same beam, extensible and where the scene
//! says so shearable, by shooting: what differs from a path is the error of the elements alone.
//!
//! | scene | exact |
//! |---|---|
//! | [`RoughArch`] | onset of slip, turn of the drop, load minimum, maximum while stuck |
//! | [`DeepArch`] | the first load maximum of a hinged and clamped arch |
//! | [`LeeFrame`] | both limit points |
//! | [`roll_up`] | the circle (closed form) |
//! | [`DeadForce`] | the tip of a cantilever |
//! | [`SqueezedRing`] | the plates' force while they touch the ring at points |
//! | [`ColumnBetweenWalls`] | the wall's force, the load from which a stretch lies on the wall |
//! | [`DraggedTip`] | place and reaction of a tip that slips on a moving floor |
//! | [`SnapFit`] | the forces while a hook slides over a round catch |

mod arches;
mod frames;
mod pressed;
mod reissner;
mod shooting;
mod sliding;
#[cfg(test)]
mod tests;

pub use arches::{ArchPoint, DeepArch, RoughArch};
pub use frames::{DeadForce, LeeFrame, LimitPoint, roll_up};
pub use pressed::{ColumnBetweenWalls, SqueezedRing};
pub use reissner::BeamSection;
pub use sliding::{DraggedTip, SnapFit, TipPoint};

use serde_json::{Map, Value, json};

/// A chain of beams through places, of two or three nodes each; nodes are called by the prefix and their number from
/// `first` on.
struct BeamChain {
    nodes: Map<String, Value>,
    beams: Vec<Value>,
}

impl BeamChain {
    fn new(places: &[[f64; 2]], nodes_of_a_beam: usize, section: &BeamSection) -> Self {
        let mut chain = Self { nodes: Map::new(), beams: Vec::new() };
        chain.extend(places, nodes_of_a_beam, section);
        chain
    }

    /// Adds beams from the last node, if there is one, through further places.
    fn extend(&mut self, places: &[[f64; 2]], nodes_of_a_beam: usize, section: &BeamSection) {
        let first = self.nodes.len().saturating_sub(1);
        let added = places.len() - usize::from(self.nodes.is_empty());
        for place in places {
            self.nodes.insert(format!("n{}", self.nodes.len()), json!(place));
        }
        let stride = nodes_of_a_beam - 1;
        for start in (first..first + added).step_by(stride) {
            let names: Vec<String> = (start..=start + stride).map(|node| format!("n{node}")).collect();
            let mut beam = json!({"kind": "beam", "nodes": names, "axial_stiffness": section.axial,
                                  "bending_stiffness": section.bending});
            if section.shear_flexibility > 0.0 {
                beam["shear_stiffness"] = json!(section.shear_flexibility.recip());
            }
            self.beams.push(beam);
        }
    }

    fn last(&self) -> String {
        format!("n{}", self.nodes.len() - 1)
    }
}

/// Places on a circle of radius 1 around the origin, from one angle to another, angles from the vertical, clockwise.
fn on_circle(from: f64, to: f64, parts: usize) -> Vec<[f64; 2]> {
    let angle = |part: usize| from + (to - from) * part as f64 / parts as f64;
    (0..=parts).map(|part| [angle(part).sin(), angle(part).cos()]).collect()
}

/// Places on a straight line, at equal distances.
fn on_line(from: [f64; 2], to: [f64; 2], parts: usize) -> Vec<[f64; 2]> {
    let share = |part: usize| part as f64 / parts as f64;
    let between = |part: usize, k: usize| from[k] * (1.0 - share(part)) + to[k] * share(part);
    (0..=parts).map(|part| [between(part, 0), between(part, 1)]).collect()
}

/// A floor `y >= height`.
fn floor(height: f64) -> Value {
    json!({"kind": "plane", "point": [0, height], "normal": [0, 1]})
}
