//! The plan of a study.

use crate::continuation::scene::Scene;
use crate::model::request::Method;
use crate::model::request::study::{Parameter, StudyRequest};
use crate::model::{InputErrors, check};
use crate::studies::error_against_time::reference::{ReferenceKind, describe_exact, describe_fine, exact_of};
use serde::{Deserialize, Serialize};

/// What a study is going to do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "server", schema(as = StudyPlan))]
pub struct StudyPlan {
    pub parameter: Parameter,
    /// From coarse to fine.
    pub values: Vec<f64>,
    pub methods: Vec<Method>,
    /// Times that each path is timed.
    pub repeats: u64,
    /// Methods times values.
    pub rows: u64,
    /// Paths in all, but for the reference's.
    pub runs: u64,
    /// What errors will be measured against.
    pub reference: ReferenceKind,
    pub reference_is: String,
    /// Of the scene, by the first method.
    pub scene: crate::result::plan::Plan,
}

/// Checks a study and every job that it leads to.
///
/// # Errors
/// All mistakes of the study, or else of the first job that has some.
pub fn plan(request: &StudyRequest) -> Result<StudyPlan, InputErrors> {
    check::study(request)?;
    let (parameter, values) = request.study.ladder();
    let methods = request.study.methods();
    let fine = request.finer_job(request.study.refinement as f64);
    let mut scene = None;
    // The model is the same for all jobs and the varied values have been checked: one job per method is enough.
    for method in methods {
        let planned = Scene::new(&request.job(*method, values[0]))?.plan().clone();
        scene.get_or_insert(planned);
    }
    let fine_scene = Scene::new(&fine)?;
    let exact = exact_of(request, &fine)?;
    let rows = (methods.len() * values.len()) as u64;
    Ok(StudyPlan {
        parameter,
        values: values.to_vec(),
        methods: methods.to_vec(),
        repeats: request.study.repeats,
        rows,
        runs: rows * (request.study.repeats + 1),
        reference: if exact.is_some() { ReferenceKind::Exact } else { ReferenceKind::SelfConverged },
        reference_is: exact.as_ref().map_or_else(|| describe_fine(&fine), describe_exact),
        scene: scene.unwrap_or_else(|| fine_scene.plan().clone()),
    })
}

impl StudyPlan {
    /// Method and value of a row.
    pub(super) fn row(&self, row: u64) -> (Method, f64) {
        let (row, rungs) = (row as usize, self.values.len());
        (self.methods[row / rungs], self.values[row % rungs])
    }
}
