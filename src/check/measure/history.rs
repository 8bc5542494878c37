//! The history of a judge, with which a path that is resumed, or followed along another direction, is judged as if it had not
//! been interrupted.

use crate::check::measure::Judge;
use crate::check::measure::posted::{Loading, Posted};
use crate::check::measure::vector::Vector;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The version of the format, which changes with its meaning.
const VERSION: u32 = 2;

/// The data of the previous point by which the next increment is judged.
#[derive(Debug, Clone)]
pub(super) struct Before {
    pub displacements: Vec<Vector>,
    pub shifts: Vec<Vector>,
    /// `-r_t/|r_t|` in space of the contacts that are on their cones; in 3D only.
    pub directions: BTreeMap<usize, Vector>,
    /// Load factor in the current stage.
    pub load: f64,
    pub arc_length: f64,
}

impl Before {
    pub fn at_rest(posted: &Posted) -> Self {
        Self {
            displacements: vec![Vector::zeros(); posted.nodes.len()],
            shifts: vec![Vector::zeros(); posted.moving],
            directions: BTreeMap::new(),
            load: 0.0,
            arc_length: 0.0,
        }
    }
}

/// The history of a [`Judge`], in the units of the user. Its numbers are read back from JSON exactly.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct History {
    version: u32,
    /// Loads at which the previous stages ended.
    reached: Vec<f64>,
    load: f64,
    arc_length: f64,
    /// One for each node.
    displacements: Vec<Vector>,
    /// Directions of slip of the contacts that have one, in order.
    directions: Vec<(usize, Vector)>,
    largest_force: f64,
    largest_energy: f64,
}

/// Why a history cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum HistoryError {
    #[error("the measure's history is of version {found}; this program reads version {VERSION}")]
    Version { found: u32 },
    #[error("the measure's history does not fit the model: it has {found} {what}, the model {expected}")]
    OtherModel { what: &'static str, found: usize, expected: usize },
}

impl Judge {
    pub fn history(&self) -> History {
        History {
            version: VERSION,
            reached: self.reached.clone(),
            load: self.before.load,
            arc_length: self.before.arc_length,
            displacements: self.before.displacements.clone(),
            directions: self.before.directions.iter().map(|(contact, direction)| (*contact, *direction)).collect(),
            largest_force: self.largest_force,
            largest_energy: self.largest_energy,
        }
    }

    /// The judge with its own history, or that of another judge of the same model.
    ///
    /// # Errors
    /// The history is of another model, or of another version of this program.
    pub fn taking_up(mut self, history: History) -> Result<Self, HistoryError> {
        let History { version, reached, load, arc_length, displacements, directions, largest_force, largest_energy } =
            history;
        if version != VERSION {
            return Err(HistoryError::Version { found: version });
        }
        let posted = &self.posted;
        let contacts = posted.contacts.len();
        for (what, found, expected) in [
            ("nodes", displacements.len(), posted.nodes.len()),
            ("contacts", directions.iter().fold(contacts, |most, (contact, _)| most.max(contact + 1)), contacts),
            ("finished stages", reached.len(), reached.len().min(posted.stages.len().saturating_sub(1))),
        ] {
            if found != expected {
                return Err(HistoryError::OtherModel { what, found, expected });
            }
        }
        let mut held = Loading::none(posted);
        let mut loading = held.clone();
        for (stage, load) in posted.stages.iter().zip(&reached) {
            loading.set(&held, stage, *load);
            std::mem::swap(&mut held, &mut loading);
        }
        loading.set(&held, &posted.stages[reached.len()], load);
        self.stage = reached.len();
        self.reached = reached;
        self.held = held;
        let mut before =
            Before { displacements, shifts: loading.shifts.clone(), load, arc_length, ..Before::at_rest(posted) };
        before.directions.extend(directions);
        self.before = before;
        self.apart.begin(&self.posted, &loading, &self.before.displacements);
        self.largest_force = largest_force;
        self.largest_energy = largest_energy;
        Ok(self)
    }
}
