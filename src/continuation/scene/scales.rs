//! Length and force scales that make a request dimensionless: see `scene`.

use crate::continuation::scene::build::{
    Contacts, ScaledModel, build_contacts, build_stage, build_structure, first_contacts, norm,
};
use crate::continuation::scene::characteristic_stiffness::resisting;
use crate::continuation::scene::solid_loads::LoadedSolids;
use crate::continuation::scene::solid_scales::solid_scales;
use crate::continuation::scene::tolerances::{LARGEST_STIFFNESS_RATIO, SIMILAR_STIFFNESS_RATIO};
use crate::continuation::scene::turning_obstacles::TurningObstacles;
use crate::mechanics::structure::Structure;
use crate::model::check::scope::size;
use crate::model::request::{self, Analysis, Model};
use std::collections::HashMap;

/// Largest number of stages whose resisting stiffness is computed; later ones use the largest result.
pub(super) const MOST_STAGES: usize = 8;

/// The scales by which a request is divided.
pub(super) struct RequestScales {
    /// `ℓ`
    pub length: f64,
    /// `φ`
    pub force: f64,
    /// For each stage the force on which its load scale is based.
    pub resistances: Vec<f64>,
    /// `ℓ` relative to its default value.
    pub stretched: f64,
    /// The structure with preliminary scales, where it was needed to find these.
    pub structure: Option<Structure>,
}

/// Sizes of the elements and loads of a request, as far as scales need them.
struct Sizes {
    longest: f64,
    /// Axial stiffnesses of the bars.
    bars: Vec<f64>,
    /// Norms of the springs' matrices.
    springs: Vec<f64>,
    largest_load: f64,
    largest_motion: f64,
}

/// The load factor at which a stage is to end, if specified; otherwise 1.
pub(super) fn expected_load_factor(stage: &request::Stage) -> f64 {
    let bounds = stage.until.iter().flat_map(|until| [until.load_above, until.load_below]);
    bounds.flatten().chain(stage.history.iter().copied()).map(f64::abs).reduce(f64::max).unwrap_or(1.0)
}

/// For each obstacle that turns, the longest way from its pivot to a node in front of it.
fn longest_arms(model: &Model) -> HashMap<&str, f64> {
    let turning = model.turning_obstacles();
    let mut arms: HashMap<&str, f64> = HashMap::new();
    for contact in &model.contacts {
        let Some((name, pivot)) = turning.get_key_value(contact.obstacle.as_str()) else { continue };
        let way: Vec<f64> =
            model.nodes[&contact.node].iter().zip(pivot.place).map(|(place, from)| place - from).collect();
        let longest = arms.entry(name).or_default();
        *longest = longest.max(norm(&way));
    }
    arms
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
                _ => {}
            }
        }
        let (mut largest_load, mut largest_motion) = (0.0_f64, 0.0_f64);
        let arms = longest_arms(model);
        for stage in &model.stages {
            let factor = expected_load_factor(stage);
            for force in stage.forces.values() {
                largest_load = largest_load.max(factor * norm(force));
            }
            for motion in stage.displacements.values().chain(stage.obstacle_motion.values()) {
                largest_motion = largest_motion.max(factor * norm(motion));
            }
            for (name, rotation) in &stage.obstacle_rotation {
                let arm = arms.get(name.as_str()).copied().unwrap_or(0.0);
                largest_motion = largest_motion.max(factor * rotation.angle.abs() * arm);
            }
        }
        Self { longest, bars, springs, largest_load, largest_motion }
    }

    /// `ℓ` and `φ` from the resisting force where there are bars, or from the resisting stiffness where there are only
    /// springs; and the default `ℓ`.
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

    /// Whether any of the elements may determine the scale.
    fn are_alike(&self) -> bool {
        self.springs.is_empty() && most(&self.bars) <= SIMILAR_STIFFNESS_RATIO * least(&self.bars)
    }

    /// The softest bar that is not much softer than the resisting stiffness; the resisting stiffness itself, where this
    /// bar is far stiffer. Without bars, the stiffest spring that is not much stiffer, and so on.
    fn near(&self, resisting: f64) -> f64 {
        let near = if self.bars.is_empty() {
            self.springs
                .iter()
                .copied()
                .filter(|stiffness| *stiffness <= SIMILAR_STIFFNESS_RATIO * resisting)
                .reduce(f64::max)
        } else {
            self.bars
                .iter()
                .copied()
                .filter(|stiffness| SIMILAR_STIFFNESS_RATIO * stiffness >= resisting)
                .reduce(f64::min)
        };
        near.filter(|near| *near <= LARGEST_STIFFNESS_RATIO * resisting && resisting <= LARGEST_STIFFNESS_RATIO * near)
            .unwrap_or(resisting)
    }

    /// The median stiffness, used where no stage's load determines one.
    fn median(&self) -> f64 {
        let mut values = if self.bars.is_empty() { self.springs.clone() } else { self.bars.clone() };
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    }
}

/// The smallest bending stiffness of the beams.
fn least_bending(model: &Model) -> Option<f64> {
    let of = |element: &request::Element| match element {
        request::Element::Beam { bending_stiffness, .. } => Some(bending_stiffness.least()),
        _ => None,
    };
    model.elements.iter().filter_map(of).reduce(f64::min)
}

/// The scales of a request that has been checked; `like`: a structure that may be identical except for its numbers.
pub(super) fn scales(
    model: &Model,
    analysis: &Analysis,
    numbers: &HashMap<&str, usize>,
    loaded_solids: &LoadedSolids<'_>,
    like: Option<&Structure>,
) -> RequestScales {
    if let Some(bending) = least_bending(model) {
        // Of the size of the load at which the whole buckles, whatever the mesh.
        let (own, force) = (size(model), bending / size(model).powi(2));
        let length = analysis.arc_length.displacement_scale.unwrap_or(own);
        let resistances = vec![force; model.stages.len()];
        return RequestScales { length, force, resistances, stretched: length / own, structure: None };
    }
    if let Some(scales) = solid_scales(model, analysis, numbers, loaded_solids, like) {
        return scales;
    }
    let sizes = Sizes::of(model);
    let first = if sizes.bars.is_empty() { most(&sizes.springs) } else { least(&sizes.bars) };
    let (length, force, own) = sizes.scaled_by(analysis, first);
    if sizes.are_alike() || (sizes.bars.is_empty() && sizes.springs.is_empty()) {
        let resistances = vec![force; model.stages.len()];
        return RequestScales { length, force, resistances, stretched: length / own, structure: None };
    }
    let structure = build_structure(model, numbers, (length, force), loaded_solids, like);
    let turning = TurningObstacles::of(model);
    let Contacts { contacts, reported, .. } =
        build_contacts(model, numbers, length, (&structure, &turning, &loaded_solids.basis), &mut Vec::new());
    let first_contacts = first_contacts(&reported, contacts.len());
    let first_contacts = &first_contacts[..];
    let scaled = ScaledModel {
        model,
        analysis,
        numbers,
        structure: &structure,
        loaded_solids,
        turning: &turning,
        first_contacts,
        length,
        force,
        stretched: 1.0,
    };
    // The unit of an axial stiffness, or of a spring's stiffness.
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
    // For springs the softest that resists, whose displacements are the largest.
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
