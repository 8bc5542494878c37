//! A request made ready for tracing.
use super::plan::Plan;
use crate::model::{InputErrors, JobRequest};

#[derive(Debug, Clone)]
pub struct Scene {
    plan: Plan,
}

impl Scene {
    /// Checks the request as a whole and makes it dimensionless.
    pub fn new(request: &JobRequest) -> Result<Self, InputErrors> {
        crate::model::check::check(request)?;
        Ok(Self {
            plan: Plan { unknowns: 0, contacts: 0, stages: request.model.stages.len() as u64, displacement_scale: 1.0, force_scale: 1.0, load_scales: vec![], left_out: vec![] },
        })
    }

    pub fn plan(&self) -> &Plan {
        &self.plan
    }
}
