//! A checked request, of which paths are traced.

use crate::check::judged::checkpoint::JudgedCheckpointError;
use crate::check::judged::equilibrium_path::{EquilibriumPath, PathCheckpoint};
use crate::continuation::scene::Scene;
use crate::model::{InputErrors, JobRequest};
use crate::result::plan::Plan;

/// A model and its analysis, checked and made dimensionless: what paths are traced of.
///
/// Paths borrow it, so that several can be traced at once, by several threads too.
#[derive(Debug, Clone)]
pub struct EquilibriumProblem {
    request: JobRequest,
    scene: Scene,
}

impl EquilibriumProblem {
    /// Checks a request; a [`Model`](crate::model::Model) alone is one, with the default analysis.
    ///
    /// # Errors
    /// All that is wrong with it, each with its place as a JSON pointer: names that do not exist, numbers out of range, nodes
    /// within an obstacle, loads that nothing balances; and a structure too large for the memory that a solve may take.
    ///
    /// ```
    /// use arcslip::{Element, EquilibriumProblem, Model, Stage};
    ///
    /// let model = Model::new(2)
    ///     .node("left", [0.0, 0.0])
    ///     .element(Element::bar("left", "right", 1.0))
    ///     .stage(Stage::new("pull").force("left", [1.0, 0.0]));
    /// let errors = EquilibriumProblem::new(model).unwrap_err();
    /// assert_eq!(errors.0[0].pointer, "/model/elements/0/nodes/1");
    /// ```
    pub fn new(request: impl Into<JobRequest>) -> Result<Self, InputErrors> {
        let request = request.into();
        let scene = Scene::new(&request)?;
        Ok(Self { request, scene })
    }

    /// The request.
    pub fn request(&self) -> &JobRequest {
        &self.request
    }

    /// Unknowns, the scales that make quantities dimensionless, and what of the method this model does not need.
    pub fn plan(&self) -> &Plan {
        self.scene.plan()
    }

    pub(super) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The path from the undeformed structure, through all stages.
    ///
    /// Nothing is computed before its first increment is asked for.
    pub fn trace(&self) -> EquilibriumPath<'_> {
        EquilibriumPath::from_start(self)
    }

    /// Goes on with a path from a checkpoint: the increments and the report are those of the uninterrupted path, bit for
    /// bit, except for `elapsed_s`.
    ///
    /// # Errors
    /// The checkpoint is of another model, or of another version of this crate.
    pub fn resume(&self, checkpoint: PathCheckpoint) -> Result<EquilibriumPath<'_>, JudgedCheckpointError> {
        EquilibriumPath::from_checkpoint(self, checkpoint)
    }
}
