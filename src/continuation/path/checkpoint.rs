//! Checkpoints: everything at a point that determines the continuation of a path, so that the path can be resumed there
//! bit for bit, or followed along another of the directions listed there (`branch_switching`).
//!
//! Written as JSON, a checkpoint is read back bit for bit: serde_json writes the shortest digits that identify a
//! number, and reads them exactly (`float_roundtrip`). A checkpoint does not contain the scene (structure, loads,
//! settings): it is resumed with the scene with which it was made, or with one that differs in `max_increments` alone.

#![warn(missing_docs)]

use crate::continuation::path_state::path_context::PathTrace;
use crate::continuation::path_state::resumable_state::{Listed, Progress};
use crate::continuation::path_state::visited_states::Numbered;
use crate::continuation::scene::Scene;
use crate::mechanics::contact::Mode;
use crate::mechanics::problem::state::{Rate, State};
use crate::resources::cancel::CancelFlag;
use serde::{Deserialize, Serialize};

/// Increased whenever an earlier checkpoint would be misread.
const VERSION: u32 = 11;

/// A path at one of its points.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checkpoint {
    version: u32,
    elapsed_s: f64,
    at: Progress,
}

/// States that a path has passed, to detect a cycle. Along a stage new states are added and old ones removed: stored
/// apart from the checkpoints, each state is stored once, and each checkpoint gets back the states that it contained.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Trail(Vec<Numbered>);

impl Trail {
    /// Whether it has no states.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Why a checkpoint cannot be resumed, or a direction not followed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CheckpointError {
    /// Written by another version of this crate.
    #[error("the checkpoint is of version {found}; this program reads version {VERSION}")]
    Version {
        /// The version of the format that was found.
        found: u32,
    },
    /// Made with another model.
    #[error("the checkpoint does not fit the model: it has {found} {what}, the model {expected}")]
    OtherModel {
        /// What differs in number, in words.
        what: &'static str,
        /// How many of them the checkpoint has.
        found: usize,
        /// How many the model has.
        expected: usize,
    },
    /// The path has one way on, or does not list directions.
    #[error("no directions are listed at this point: the path has one way on")]
    NothingListed,
    /// The point has no direction of this place.
    #[error("found {found}; {listed} directions are listed at this point: 0 to {} would do", listed.saturating_sub(1))]
    NoSuchDirection {
        /// The place asked for, from 0.
        found: usize,
        /// Number of directions listed.
        listed: usize,
    },
    /// A motion that no element resists.
    #[error("direction {direction} is a mechanism, a motion that no element resists: no path goes that way")]
    Mechanism {
        /// Its place in the list, from 0.
        direction: usize,
    },
    /// The stage ends at the point if the path leaves it this way.
    #[error("stage \"{stage}\" ends at this point along direction {direction}: there is nothing of it to follow")]
    StageEnds {
        /// Name of the stage.
        stage: String,
        /// Place of the direction in the list, from 0.
        direction: usize,
    },
}

impl Checkpoint {
    /// Index of the increment at which the checkpoint was made.
    pub fn index(&self) -> u64 {
        self.at.totals.index
    }

    /// The running stage.
    pub fn stage(&self) -> usize {
        self.at.stage
    }

    /// The number of states recorded so far, including those already removed.
    pub fn trail_length(&self) -> u64 {
        self.at.visited.seen()
    }

    /// Takes the trail out of the checkpoint and returns the part of it that begins at the state of this number.
    pub fn take_trail(&mut self, from: u64) -> Trail {
        Trail(self.at.visited.take(from))
    }

    /// Puts the parts of a trail back, in the order in which they were taken out.
    pub fn put_trail(&mut self, parts: impl IntoIterator<Item = Trail>) {
        let stage = self.at.stage;
        self.at.visited.put(parts.into_iter().flat_map(|part| part.0), stage);
    }

    fn fits(&self, scene: &Scene) -> Result<(), CheckpointError> {
        if self.version != VERSION {
            return Err(CheckpointError::Version { found: self.version });
        }
        let same = |what: &'static str, found: usize, expected: usize| {
            if found == expected { Ok(()) } else { Err(CheckpointError::OtherModel { what, found, expected }) }
        };
        let (freedoms, all) = (scene.structure.freedoms(), scene.contacts.len());
        if self.at.stage >= scene.stages.len() {
            return same("stages", self.at.stage + 1, scene.stages.len());
        }
        let near = &self.at.near;
        if !near.is_sorted_by(|one, next| one < next) || near.last().is_some_and(|last| *last >= all) {
            return same("contacts", near.last().map_or(0, |last| last + 1), all);
        }
        if !self.at.references.is_empty() {
            same("degrees of freedom", self.at.references.len(), freedoms)?;
        }
        let contacts = near.len();
        let state = |state: &State| {
            same("degrees of freedom", state.displacement.len(), freedoms)?;
            same("contacts", state.reactions.len(), contacts)
        };
        let rate = |rate: &Rate| {
            same("degrees of freedom", rate.displacement.len(), freedoms)?;
            same("contacts", rate.reactions.len(), contacts)
        };
        let modes = |modes: &[Mode]| same("contacts", modes.len(), contacts);
        let listed = |listed: &Listed| {
            listed.arriving.iter().try_for_each(|arriving| modes(&arriving.modes))?;
            listed.options.iter().try_for_each(|option| rate(&option.rate).and_then(|()| modes(&option.modes)))
        };
        same("stages before", self.at.reached.len(), self.at.stage)?;
        if let Some((begun, direction)) = &self.at.begun {
            state(begun)?;
            rate(direction)?;
        }
        state(&self.at.here.state)?;
        modes(&self.at.here.modes)?;
        if let Some(motion) = &self.at.motion {
            state(&motion.from)?;
            motion.row.iter().try_for_each(state)?;
            if !motion.velocity.is_empty() {
                same("degrees of freedom", motion.velocity.len(), freedoms)?;
            }
        }
        self.at.here.rate.iter().try_for_each(rate)?;
        self.at.here.drift.iter().try_for_each(rate)?;
        self.at.here.before.iter().try_for_each(|before| state(&before.state).and_then(|()| rate(&before.rate)))?;
        self.at.visited.states().try_for_each(|visited| {
            same("degrees of freedom", visited.displacement.len(), freedoms)?;
            let last = visited.held.iter().map(|held| held.contact).max();
            last.filter(|last| *last >= all).map_or(Ok(()), |last| same("contacts", last + 1, all))
        })?;
        self.at.listed.iter().try_for_each(listed)?;
        self.at.followed.iter().try_for_each(|followed| listed(&followed.listed))
    }
}

/// A checkpoint of the path at its present point.
pub(crate) fn put_down(trace: &PathTrace<'_>) -> Checkpoint {
    Checkpoint { version: VERSION, elapsed_s: trace.elapsed_s(), at: trace.at.clone() }
}

/// Resumes a path from a checkpoint.
pub(crate) fn take_up<'a>(
    scene: &'a Scene,
    checkpoint: Checkpoint,
    cancel: CancelFlag,
) -> Result<PathTrace<'a>, CheckpointError> {
    checkpoint.fits(scene)?;
    Ok(PathTrace::at(scene, checkpoint.at, checkpoint.elapsed_s, cancel))
}
