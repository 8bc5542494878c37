//! A path put down at a point: everything that decides how it goes on, so that it can be taken up there again with the
//! same bits, or followed along another of the directions listed there (`follow`).
//!
//! Written as JSON, a checkpoint reads back to the same bits: serde_json writes the shortest digits that do, and reads
//! them exactly (`float_roundtrip`). What a scene says (structure, loads, settings) is not in it: a checkpoint is taken
//! up with the scene that it was made with, or with one that differs in `max_increments` alone.

use super::advance::Work;
use super::follow::{Followed, Listed};
use super::increment::Energy;
use super::loading::LoadPattern;
use super::report::Report;
use super::scene::Scene;
use super::state::{Rate, State};
use super::tracer::{Here, Path, Phase, StageCounts, Visited};
use crate::cancel::CancelFlag;
use crate::contact::Mode;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Changes when a checkpoint of before would be read as something else.
const VERSION: u32 = 1;

/// A path at one of its points.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Checkpoint {
    version: u32,
    phase: Phase,
    stage: usize,
    stage_over: bool,
    held: LoadPattern,
    here: Here,
    step: f64,
    index: u64,
    arc_length: f64,
    energy: Energy,
    largest_energy: f64,
    force_scale: f64,
    counts: StageCounts,
    work: Work,
    report: Report,
    elapsed_s: f64,
    listed: Option<Listed>,
    followed: Option<Followed>,
    visited: Vec<Arc<Visited>>,
    begun: Option<(State, Rate)>,
}

/// States that a path has passed, for telling a cycle. They only grow along a stage: kept apart from the checkpoints,
/// each is stored once.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Trail(Vec<Arc<Visited>>);

impl Trail {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Why a checkpoint cannot be taken up, or a direction not followed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CheckpointError {
    #[error("the checkpoint is of version {found}; this program reads version {VERSION}")]
    Version { found: u32 },
    #[error("the checkpoint does not fit the model: it has {found} {what}, the model {expected}")]
    OtherModel { what: &'static str, found: usize, expected: usize },
    #[error("no directions are listed at this point: the path has one way on")]
    NothingListed,
    #[error("found {found}; {listed} directions are listed at this point: 0 to {} would do", listed.saturating_sub(1))]
    NoSuchDirection { found: usize, listed: usize },
    #[error("direction {direction} is a mechanism, a motion that no element resists: no path goes that way")]
    Mechanism { direction: usize },
    #[error("stage \"{stage}\" ends at this point along direction {direction}: there is nothing of it to follow")]
    StageEnds { stage: String, direction: usize },
}

impl Checkpoint {
    /// Index of the increment at which the path was put down.
    pub fn index(&self) -> u64 {
        self.index
    }

    /// The running stage.
    pub fn stage(&self) -> usize {
        self.stage
    }

    pub fn trail_length(&self) -> usize {
        self.visited.len()
    }

    /// Takes the trail out, and of it the part that begins at this place.
    pub fn take_trail(&mut self, from: usize) -> Trail {
        let mut trail = std::mem::take(&mut self.visited);
        Trail(trail.split_off(from.min(trail.len())))
    }

    /// Puts the parts of a trail back, in the order in which they were taken.
    pub fn put_trail(&mut self, parts: impl IntoIterator<Item = Trail>) {
        let stage = self.stage;
        let visited = parts.into_iter().flat_map(|part| part.0).filter(|visited| visited.stage == stage);
        self.visited = visited.collect();
    }

    fn fits(&self, scene: &Scene) -> Result<(), CheckpointError> {
        if self.version != VERSION {
            return Err(CheckpointError::Version { found: self.version });
        }
        let same = |what: &'static str, found: usize, expected: usize| {
            if found == expected { Ok(()) } else { Err(CheckpointError::OtherModel { what, found, expected }) }
        };
        let (freedoms, contacts) = (scene.structure.freedoms(), scene.contacts.len());
        if self.stage >= scene.stages.len() {
            return same("stages", self.stage + 1, scene.stages.len());
        }
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
        same("degrees of freedom", self.held.forces.len(), freedoms)?;
        same("contacts", self.held.shifts.len(), contacts)?;
        if let Some((begun, direction)) = &self.begun {
            state(begun)?;
            rate(direction)?;
        }
        state(&self.here.state)?;
        modes(&self.here.modes)?;
        self.here.rate.iter().try_for_each(rate)?;
        self.here.drift.iter().try_for_each(rate)?;
        self.visited.iter().try_for_each(|visited| state(&visited.state).and_then(|()| modes(&visited.modes)))?;
        self.listed.iter().try_for_each(listed)?;
        self.followed.iter().try_for_each(|followed| listed(&followed.listed))
    }
}

impl<'a> Path<'a> {
    /// The path at its present point; after any call of `next`.
    pub fn checkpoint(&self) -> Checkpoint {
        // Named one by one: what a path learns to carry has to be carried here too.
        let Path {
            scene: _,
            cancel: _,
            began: _,
            elapsed_before: _,
            initial_strain: _,
            phase,
            stage,
            stage_over,
            held,
            here,
            step,
            index,
            arc_length,
            energy,
            largest_energy,
            force_scale,
            counts,
            work,
            report,
            visited,
            begun,
            listed,
            followed,
        } = self;
        Checkpoint {
            version: VERSION,
            phase: *phase,
            stage: *stage,
            stage_over: *stage_over,
            held: held.clone(),
            here: here.clone(),
            step: *step,
            index: *index,
            arc_length: *arc_length,
            energy: *energy,
            largest_energy: *largest_energy,
            force_scale: *force_scale,
            counts: *counts,
            work: *work,
            report: report.clone(),
            elapsed_s: self.elapsed_s(),
            listed: listed.clone(),
            followed: followed.clone(),
            visited: visited.clone(),
            begun: begun.clone(),
        }
    }

    /// Takes a path up where it was put down; its increments are the same, bit for bit, as if it had not been.
    ///
    /// # Errors
    /// A checkpoint of another model, or of another version of this program.
    pub fn resume(scene: &'a Scene, checkpoint: Checkpoint, cancel: CancelFlag) -> Result<Self, CheckpointError> {
        checkpoint.fits(scene)?;
        let mut path = Path::new(scene, cancel);
        let Checkpoint {
            version: _,
            phase,
            stage,
            stage_over,
            held,
            here,
            step,
            index,
            arc_length,
            energy,
            largest_energy,
            force_scale,
            counts,
            work,
            report,
            elapsed_s,
            listed,
            followed,
            visited,
            begun,
        } = checkpoint;
        path.phase = phase;
        path.stage = stage;
        path.stage_over = stage_over;
        path.held = held;
        path.here = here;
        path.step = step;
        path.index = index;
        path.arc_length = arc_length;
        path.energy = energy;
        path.largest_energy = largest_energy;
        path.force_scale = force_scale;
        path.counts = counts;
        path.work = work;
        path.report = report;
        path.elapsed_before = elapsed_s;
        path.listed = listed;
        path.followed = followed;
        path.visited = visited;
        path.begun = begun;
        Ok(path)
    }
}
