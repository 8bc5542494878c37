//! Exact solutions of scenes, as curves.
//!
//! [`recognise`] recognises models of families whose path is known in closed form, for any sizes and units. A solution
//! gives the path stage by stage, in smooth pieces between events. No solution uses the solver. The file of each family
//! derives the formulas.
//!
//! | family | scenes | known part of the path |
//! |---|---|---|
//! | [`one_bar`] | `one-bar-truss`, `one-bar-truss-rough` | up to the point where the bar is unstressed again |
//! | [`klarbring`] | `klarbring` | the whole path |
//! | [`slider_chain`] | `slider-chain` | up to the load at which all blocks slide |
//! | [`tractrix`] | `curving-slip` | while the bar is compressed, at most up to `w = c` |
//! | [`hump`] | `hump` | while the bar is compressed |
//! | [`bowl`] | `bowl` | up to the angle at which the load grows without bound |
//! | [`turning_drag`] | `turning-drag` | the whole path |
//! | [`von_mises`] | `von-mises-truss` | the whole path |
//!
//! If the `until` of a stage gives a load or a displacement, the curve ends there.

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

use crate::model::request::{Selection, StageControl};
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

    /// The stages of the path. Each stage ends at the load or the displacement of its `until`; unbounded branches
    /// extend to `reach`.
    pub fn stages(&self, reach: Reach) -> Vec<CurveStage> {
        let mut stages = self.solution.stages(reach);
        for (stage, loads) in stages.iter_mut().zip(&self.model.stages) {
            stage.end_at(&self.model, loads);
        }
        stages
    }
}

type Recognise = fn(&Model) -> Option<Box<dyn ExactSolution>>;

/// The exact solution of a request whose path is known in closed form. The model must belong to a family, and the
/// request must select the direction of largest dissipation where there are several directions, as the formulas do, and
/// follow the path by arc length.
pub fn recognise(request: &JobRequest) -> Option<Exact> {
    let model = &request.model;
    let jumps = model.stages.iter().any(|stage| stage.control != StageControl::Path);
    let turns = model.stages.iter().any(|stage| !stage.obstacle_rotation.is_empty());
    if request.analysis.selection != Selection::MaxDissipation || jumps || turns {
        return None;
    }
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
