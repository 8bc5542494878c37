//! The history of a judge. A judge with this history checks a path that is resumed, or followed along another
//! direction, as if the path had not been interrupted.

#![warn(missing_docs)]

use crate::check::measure::Judge;
use crate::check::measure::numbers::MeasuredVector;
use crate::check::measure::posted::{Posted, PostedLoading};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The version of the format. The version changes when the meaning of the data changes.
const VERSION: u32 = 5;

/// The data of the previous point that the check of the next increment needs.
#[derive(Debug, Clone)]
pub(super) struct PreviousPoint {
    pub displacements: Vec<MeasuredVector>,
    pub rotations: Vec<MeasuredVector>,
    /// Translations and angles of the moving obstacles.
    pub shifts: Vec<MeasuredVector>,
    pub turns: Vec<f64>,
    /// `-r_t/|r_t|` in space of the contacts that are on their friction cones; in 3D only.
    pub directions: BTreeMap<usize, MeasuredVector>,
    /// `slip_total` of the contacts that have slipped.
    pub slips: BTreeMap<usize, [f64; 2]>,
    /// Load factor in the current stage.
    pub load: f64,
    pub arc_length: f64,
    /// Energy given off by jumps so far.
    pub released: f64,
}

impl PreviousPoint {
    pub fn at_rest(posted: &Posted) -> Self {
        Self {
            displacements: vec![MeasuredVector::zeros(); posted.nodes.len()],
            rotations: vec![MeasuredVector::zeros(); posted.rotations()],
            shifts: vec![MeasuredVector::zeros(); posted.moving.len()],
            turns: vec![0.0; posted.moving.len()],
            directions: BTreeMap::new(),
            slips: BTreeMap::new(),
            load: 0.0,
            arc_length: 0.0,
            released: 0.0,
        }
    }
}

/// The history of a [`Judge`], in the units of the user. Writing to JSON and reading back preserves the numbers
/// exactly.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JudgeHistory {
    version: u32,
    /// Load factors at which the previous stages ended.
    reached: Vec<f64>,
    load: f64,
    arc_length: f64,
    #[serde(default)]
    released: f64,
    /// One displacement for each node.
    displacements: Vec<MeasuredVector>,
    /// One rotation vector for each node, then those of released ends; absent where there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    rotations: Vec<MeasuredVector>,
    /// The contacts with a direction of slip, in order, and their directions.
    directions: Vec<(usize, MeasuredVector)>,
    /// The contacts that have slipped, in order, and the sums of their slips.
    slips: Vec<(usize, [f64; 2])>,
    largest_force: f64,
    largest_energy: f64,
}

/// Why a history cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum HistoryError {
    /// Written by another version of this crate.
    #[error("the measure's history is of version {found}; this program reads version {VERSION}")]
    Version {
        /// The version of the format that was found.
        found: u32,
    },
    /// Made with another model.
    #[error("the measure's history does not fit the model: it has {found} {what}, the model {expected}")]
    OtherModel {
        /// What differs in number, in words.
        what: &'static str,
        /// How many of them the history has.
        found: usize,
        /// How many the model has.
        expected: usize,
    },
}

pub fn history_of(judge: &Judge) -> JudgeHistory {
    JudgeHistory {
        version: VERSION,
        reached: judge.reached.clone(),
        load: judge.before.load,
        arc_length: judge.before.arc_length,
        released: judge.before.released,
        displacements: judge.before.displacements.clone(),
        rotations: if judge.posted.has_rotations() { judge.before.rotations.clone() } else { Vec::new() },
        directions: judge.before.directions.iter().map(|(contact, direction)| (*contact, *direction)).collect(),
        slips: judge.before.slips.iter().map(|(contact, slip)| (*contact, *slip)).collect(),
        largest_force: judge.largest_force,
        largest_energy: judge.largest_energy,
    }
}

/// The judge with the recorded history of this judge, or of another judge of the same model.
///
/// # Errors
/// The history belongs to another model or has another version.
pub fn take_up(mut judge: Judge, history: JudgeHistory) -> Result<Judge, HistoryError> {
    let JudgeHistory {
        version,
        reached,
        load,
        arc_length,
        released,
        displacements,
        mut rotations,
        directions,
        slips,
        largest_force,
        largest_energy,
    } = history;
    if version != VERSION {
        return Err(HistoryError::Version { found: version });
    }
    let posted = &judge.posted;
    let contacts = posted.contacts.len();
    if rotations.is_empty() {
        rotations.resize(posted.rotations(), MeasuredVector::zeros());
    }
    for (what, found, expected) in [
        ("nodes", displacements.len(), posted.nodes.len()),
        ("rotations", rotations.len(), posted.rotations()),
        ("contacts", directions.iter().fold(contacts, |most, (contact, _)| most.max(contact + 1)), contacts),
        ("contacts", slips.iter().fold(contacts, |most, (contact, _)| most.max(contact + 1)), contacts),
        ("finished stages", reached.len(), reached.len().min(posted.stages.len().saturating_sub(1))),
    ] {
        if found != expected {
            return Err(HistoryError::OtherModel { what, found, expected });
        }
    }
    let mut held = PostedLoading::none(posted);
    let mut loading = held.clone();
    for (stage, load) in posted.stages.iter().zip(&reached) {
        loading.set(&held, stage, *load);
        std::mem::swap(&mut held, &mut loading);
    }
    loading.set(&held, &posted.stages[reached.len()], load);
    judge.stage = reached.len();
    judge.reached = reached;
    judge.held = held;
    let mut before = PreviousPoint {
        displacements,
        rotations,
        shifts: loading.shifts.clone(),
        turns: loading.turns.clone(),
        load,
        arc_length,
        released,
        ..PreviousPoint::at_rest(posted)
    };
    before.directions.extend(directions);
    before.slips.extend(slips);
    judge.before = before;
    judge.apart.begin(&judge.posted, &loading, &judge.before.displacements);
    judge.largest_force = largest_force;
    judge.largest_energy = largest_energy;
    Ok(judge)
}
