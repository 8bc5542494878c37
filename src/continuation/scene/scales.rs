//! Length and forces that make a request dimensionless: see `scene`.

use crate::continuation::scene::build::{
    Contacts, ScaledModel, build_contacts, build_stage, build_structure, first_contacts, norm,
};
use crate::continuation::scene::characteristic_stiffness::resisting;
use crate::mechanics::structure::Structure;
use crate::model::request::{self, Analysis, Model};
use std::collections::HashMap;

/// Stiffnesses that differ by no more than this factor are alike: scales that differ so change the increments by no more.
const ALIKE: f64 = 2.0;
/// Bars that are up to so many times stiffer than what resists the load may set the scale of forces.
const FAR: f64 = 100.0;

/// Stages whose loads are asked what resists them; those after them go by the largest answer.
const MOST_STAGES: usize = 8;

/// What a request is divided by.
pub(super) struct RequestScales {
    /// `ℓ`
    pub length: f64,
    /// `φ`
    pub force: f64,
    /// The force that each stage's load scale goes by.
    pub resistances: Vec<f64>,
    /// `ℓ` over what it would be if none were given.
    pub stretched: f64,
    /// The structure by other scales, where it took one to find these.
    pub structure: Option<Structure>,
}

/// Elements and loads of a request, as far as scales need them.
struct Sizes {
    longest: f64,
    /// Axial stiffnesses of the bars.
    bars: Vec<f64>,
    /// Norms of the springs' matrices.
    springs: Vec<f64>,
    largest_load: f64,
    largest_motion: f64,
}

/// The load factor at which a stage is to end, if it says so; else 1.
fn expected_load_factor(stage: &request::Stage) -> f64 {
    let bounds = stage.until.iter().flat_map(|until| [until.load_above, until.load_below]);
    bounds.flatten().map(f64::abs).reduce(f64::max).unwrap_or(1.0)
}

fn least(values: &[f64]) -> f64 {
    values.iter().fold(f64::INFINITY, |least, value| least.min(*value))
}

fn most(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(*value))
}

impl Sizes {
    fn of(model: &Model) -> Self {
        let (mut longest, mut bars, mut springs) = (0.0_f64, Vec::new(), Vec::new());
        for element in &model.elements {
            match element {
                request::Element::Bar { nodes, axial_stiffness, .. } => {
                    let ends = (&model.nodes[&nodes[0]], &model.nodes[&nodes[1]]);
                    let difference: Vec<f64> = ends.0.iter().zip(ends.1).map(|(a, b)| a - b).collect();
                    longest = longest.max(norm(&difference));
                    bars.push(*axial_stiffness);
                }
                request::Element::Spring { stiffness, .. } => springs.push(norm(&stiffness.concat())),
            }
        }
        let (mut largest_load, mut largest_motion) = (0.0_f64, 0.0_f64);
        for stage in &model.stages {
            let factor = expected_load_factor(stage);
            for force in stage.forces.values() {
                largest_load = largest_load.max(factor * norm(force));
            }
            for motion in stage.displacements.values().chain(stage.obstacle_motion.values()) {
                largest_motion = largest_motion.max(factor * norm(motion));
            }
        }
        Self { longest, bars, springs, largest_load, largest_motion }
    }

    /// `ℓ` and `φ` by the force that resists where there are bars, or by the stiffness that does where there are only
    /// springs; and the `ℓ` that would be if none were given.
    fn scaled_by(&self, analysis: &Analysis, resistance: f64) -> (f64, f64, f64) {
        let has_springs = self.bars.is_empty() && resistance > 0.0;
        let largest = self.largest_load.max(resistance * self.largest_motion);
        let (mut length, mut force) = if !self.bars.is_empty() {
            (self.longest, resistance)
        } else if has_springs && largest > 0.0 {
            (largest / resistance, largest)
        } else {
            (1.0, 1.0)
        };
        let own = length;
        if let Some(given) = analysis.arc_length.displacement_scale {
            if has_springs {
                force = resistance * given;
            }
            length = given;
        }
        (length, force, own)
    }

    /// Whether any of the elements may set the scale.
    fn are_alike(&self) -> bool {
        self.springs.is_empty() && most(&self.bars) <= ALIKE * least(&self.bars)
    }

    /// The softest bar that is not much softer than what resists the load; what resists itself, where that bar is far
    /// stiffer. Without bars, the stiffest spring that is not much stiffer, and so on.
    fn near(&self, resisting: f64) -> f64 {
        let near = if self.bars.is_empty() {
            self.springs.iter().copied().filter(|stiffness| *stiffness <= ALIKE * resisting).reduce(f64::max)
        } else {
            self.bars.iter().copied().filter(|stiffness| ALIKE * stiffness >= resisting).reduce(f64::min)
        };
        near.filter(|near| *near <= FAR * resisting && resisting <= FAR * near).unwrap_or(resisting)
    }

    /// Where no stage's load tells: that of which as many are stiffer as softer.
    fn median(&self) -> f64 {
        let mut values = if self.bars.is_empty() { self.springs.clone() } else { self.bars.clone() };
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    }
}

/// The scales of a request that has been checked; `like`: a structure that may be the same but for its numbers.
pub(super) fn scales(
    model: &Model,
    analysis: &Analysis,
    numbers: &HashMap<&str, usize>,
    like: Option<&Structure>,
) -> RequestScales {
    let sizes = Sizes::of(model);
    let first = if sizes.bars.is_empty() { most(&sizes.springs) } else { least(&sizes.bars) };
    let (length, force, own) = sizes.scaled_by(analysis, first);
    if sizes.are_alike() || (sizes.bars.is_empty() && sizes.springs.is_empty()) {
        let resistances = vec![force; model.stages.len()];
        return RequestScales { length, force, resistances, stretched: length / own, structure: None };
    }
    let structure = build_structure(model, numbers, length, force, like);
    let Contacts { contacts, reported, .. } = build_contacts(model, numbers, length, &structure, &mut Vec::new());
    let first_contacts = first_contacts(&reported, contacts.len());
    let first_contacts = &first_contacts[..];
    let scaled =
        ScaledModel { model, analysis, numbers, structure: &structure, first_contacts, length, force, stretched: 1.0 };
    // An axial stiffness, or a spring's.
    let unit = if sizes.bars.is_empty() { force / length } else { force };
    let by_stage: Vec<Option<f64>> = model
        .stages
        .iter()
        .enumerate()
        .map(|(index, stage)| {
            let pattern = (index < MOST_STAGES).then(|| build_stage(stage, force, &scaled).pattern)?;
            resisting(&structure, &contacts, &pattern).map(|resisting| sizes.near(resisting * unit))
        })
        .collect();
    let known = by_stage.iter().flatten().copied();
    // Of springs the softest that resists, whose displacements are the largest.
    let whole = if sizes.bars.is_empty() { known.reduce(f64::min) } else { known.reduce(f64::max) };
    let whole = whole.unwrap_or_else(|| sizes.median());
    let (length, force, own) = sizes.scaled_by(analysis, whole);
    let resistances = if sizes.bars.is_empty() {
        vec![force; by_stage.len()]
    } else {
        by_stage.into_iter().map(|resistance| resistance.unwrap_or(force)).collect()
    };
    RequestScales { length, force, resistances, stretched: length / own, structure: Some(structure) }
}
