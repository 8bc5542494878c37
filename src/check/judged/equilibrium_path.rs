//! A path that a program traces and follows.

use crate::check::judged::checkpoint::{JudgedCheckpoint, JudgedCheckpointError};
use crate::check::judged::equilibrium_problem::EquilibriumProblem;
use crate::check::judged::increment::JudgedIncrement;
use crate::check::judged::path::JudgedPath;
use crate::check::judged::report::JudgedReport;
use crate::continuation::path::checkpoint::CheckpointError;
use crate::resources::cancel::CancelFlag;
use serde::{Deserialize, Serialize};
use std::fmt;

/// An equilibrium path: an iterator of increments, each with its measure of error.
///
/// It ends with `None`; why, [`report`](Self::report) says. That a path stops early is a result of the analysis and not an
/// error. One path may hold 4 GiB at a time; one that would hold more ends with `StopReason::MemoryLimit`.
pub struct EquilibriumPath<'a> {
    problem: &'a EquilibriumProblem,
    path: JudgedPath<'a>,
    cancel: CancelFlag,
    /// Index of the last increment.
    index: Option<u64>,
}

/// A path at one of its increments: all that its continuation depends on, but for the request.
///
/// Written by serde, as JSON too, and read back, it is the same bit for bit. What is written is no format that other
/// programs should read; another version of this crate may refuse it.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PathCheckpoint(JudgedCheckpoint);

impl<'a> EquilibriumPath<'a> {
    pub(super) fn from_start(problem: &'a EquilibriumProblem) -> Self {
        let cancel = CancelFlag::default();
        let path = JudgedPath::new(problem.request(), problem.scene(), cancel.clone());
        Self { problem, path, cancel, index: None }
    }

    pub(super) fn from_checkpoint(
        problem: &'a EquilibriumProblem,
        checkpoint: PathCheckpoint,
    ) -> Result<Self, JudgedCheckpointError> {
        let cancel = CancelFlag::default();
        let index = Some(checkpoint.0.path.index());
        let path = JudgedPath::resume(problem.request(), problem.scene(), checkpoint.0, cancel.clone())?;
        Ok(Self { problem, path, cancel, index })
    }

    /// Stop reason, totals of work, and the largest errors; `None` until the path has ended, that is until `next` has
    /// returned `None`.
    pub fn report(&self) -> Option<JudgedReport> {
        self.path.report()
    }

    /// For each direction listed at the last increment, whether it can be followed; empty where the path has one way on.
    pub fn followable(&self) -> Vec<bool> {
        self.path.open_directions()
    }

    /// A path of its own from the last increment along a direction listed there, by its place in
    /// [`Increment::directions`](crate::result::increment::Increment::directions).
    ///
    /// Its first increment, of index 0 and kind `Start`, is that point; loads, energies, arc length and the counts by which
    /// the stage may end are carried over.
    ///
    /// # Errors
    /// No such direction is listed, it is a mechanism, or the stage ends there along it; with `method: "regularised"` none
    /// is listed.
    ///
    /// ```
    /// use arcslip::{Element, EquilibriumProblem, Model, Obstacle, PointKind, Stage, Status};
    ///
    /// // Klarbring's node: on the falling branch it slips, but it could stick as well.
    /// let model = Model::new(2)
    ///     .node("node", [0.0, 0.0])
    ///     .element(Element::spring("node", [[1.0, -0.8], [-0.8, 1.0]]))
    ///     .obstacle("floor", Obstacle::plane([0.0, 0.0], [0.0, 1.0]))
    ///     .contact("node", "floor", 1.5)
    ///     .stage(Stage::new("press").force("node", [0.0, -1.0]).until_load_above(1.0))
    ///     .stage(Stage::new("pull").force("node", [1.0, 0.0]).until_load_above(3.0));
    /// let problem = EquilibriumProblem::new(model)?;
    /// let mut path = problem.trace();
    /// let falling = path.find(|point| point.increment.point.kind == PointKind::Regular && point.increment.point.bifurcation);
    /// let directions = falling.unwrap().increment.directions.unwrap();
    /// let sticking = directions.iter().position(|direction| direction.contacts == [Status::Stick]).unwrap();
    ///
    /// let mut branch = path.follow(sticking)?;
    /// assert_eq!(branch.next().unwrap().increment.point.kind, PointKind::Start);
    /// let corner = branch.find(|point| point.increment.point.event.is_some()).unwrap().increment;
    /// // Stuck, the load falls to the other side of the friction cone.
    /// let exact = 2.2 * corner.displacements["node"][0] - 1.5;
    /// assert!((corner.load_factor - exact).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn follow(&self, direction: usize) -> Result<Self, JudgedCheckpointError> {
        let (problem, cancel) = (self.problem, CancelFlag::default());
        let (Some(index), Some(checkpoint)) = (self.index, self.path.checkpoint()) else {
            return Err(CheckpointError::NothingListed.into());
        };
        let event = format!("follows direction {direction} of increment {index}");
        let path =
            JudgedPath::follow(problem.request(), problem.scene(), checkpoint, direction, event, cancel.clone())?;
        Ok(Self { problem, path, cancel, index: None })
    }

    /// The path at its last increment, to go on from there later, or in another process; `None` for
    /// `method: "regularised"`.
    pub fn checkpoint(&self) -> Option<PathCheckpoint> {
        self.path.checkpoint().map(PathCheckpoint)
    }

    /// A flag by which another thread can stop this path: it ends with `StopReason::Cancelled`.
    pub fn cancel_flag(&self) -> CancelFlag {
        self.cancel.clone()
    }
}

impl Iterator for EquilibriumPath<'_> {
    type Item = JudgedIncrement;

    fn next(&mut self) -> Option<JudgedIncrement> {
        let judged = self.path.next()?;
        self.index = Some(judged.increment.index);
        Some(judged)
    }
}

impl fmt::Debug for EquilibriumPath<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("EquilibriumPath").field("index", &self.index).finish_non_exhaustive()
    }
}
