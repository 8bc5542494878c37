//! Exact solutions of scenes, as curves.
//!
//! [`recognise`] recognises models of families whose whole path is known in closed form, for any sizes and units; a solution
//! then gives the path stage by stage, in smooth pieces between events. Nothing here uses the solver. The formulas are derived in each family's file.
//!
//! | family | scene | of which the path is known |
//! |---|---|---|
//! | [`one_bar`] | `one-bar-truss` | up to where the bar is unstressed again |
//! | [`klarbring`] | `klarbring` | all |
//! | [`slider_chain`] | `slider-chain` | up to where all blocks slide |
//! | [`tractrix`] | `curving-slip` | while the bar is compressed |
//! | [`hump`] | `hump` | while the bar is compressed |
//! | [`bowl`] | `bowl` | up to where the load grows without bound |
//! | [`turning_drag`] | `turning-drag` | all |
//! | [`von_mises`] | `von-mises-truss` | all |
//!
//! Where a stage's `until` names a load or a displacement, the curve ends there.

pub mod bowl;
pub mod curve;
pub mod hump;
pub mod klarbring;
pub mod one_bar;
pub(crate) mod pattern;
pub mod slider_chain;
pub(crate) mod solution;
#[cfg(test)]
mod tests;
pub mod tractrix;
pub mod turning_drag;
pub mod von_mises;
pub(crate) mod zeros;

use crate::check::scenes::exact::solution::ExactSolution;
pub use curve::{CurvePlace, CurveStage, Piece, Reach};

use crate::model::request::Selection;
use crate::model::{JobRequest, Model};

/// The exact solution of a request, if its model belongs to a known family.
pub struct Exact {
    solution: Box<dyn ExactSolution>,
    model: Model,
}

impl Exact {
    pub fn name(&self) -> &'static str {
        self.solution.name()
    }

    pub fn formula(&self) -> &'static str {
        self.solution.formula()
    }

    /// The path's stages, each ended where its `until` names a load or a displacement; unbounded branches go as far as
    /// `reach`.
    pub fn stages(&self, reach: Reach) -> Vec<CurveStage> {
        let mut stages = self.solution.stages(reach);
        for (stage, loads) in stages.iter_mut().zip(&self.model.stages) {
            stage.end_at(&self.model, loads);
        }
        stages
    }
}

type Recognise = fn(&Model) -> Option<Box<dyn ExactSolution>>;

/// Whether the request's path is known in closed form: by its model, and by its selecting the direction of largest
/// dissipation where there are several, as the formulas do.
pub fn recognise(request: &JobRequest) -> Option<Exact> {
    if request.analysis.selection != Selection::MaxDissipation {
        return None;
    }
    let model = &request.model;
    let families: [Recognise; 8] = [
        |model| Some(Box::new(one_bar::OneBarScene::recognise(model)?)),
        |model| Some(Box::new(klarbring::KlarbringScene::recognise(model)?)),
        |model| Some(Box::new(slider_chain::SliderChain::recognise(model)?)),
        |model| Some(Box::new(tractrix::CurvingSlip::recognise(model)?)),
        |model| Some(Box::new(hump::OverHump::recognise(model)?)),
        |model| Some(Box::new(bowl::Bowl::recognise(model)?)),
        |model| Some(Box::new(turning_drag::TurningDrag::recognise(model)?)),
        |model| Some(Box::new(von_mises::VonMisesScene::recognise(model)?)),
    ];
    let solution = families.iter().find_map(|recognise| recognise(model))?;
    Some(Exact { solution, model: model.clone() })
}
