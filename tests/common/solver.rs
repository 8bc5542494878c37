//! A solver that makes increments up: as many as `max_increments` says, the same in every run but for `elapsed_s`.

use arcslip::check::judged::{JudgedCheckpoint, JudgedIncrement, JudgedReport, MeasureReport, Step};
use arcslip::check::measure::{Errors, Maxima};
use arcslip::model::{InputErrors, JobRequest};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{
    ContactState, Diagnostics, ElementState, Energy, Increment, Point, PointKind, Status,
};
use arcslip::result::plan::Plan;
use arcslip::result::report::Report;
use arcslip::result::stop_reason::StopReason;
use arcslip::service::jobs::Solver;
use arcslip::service::jobs::solving::solver::{Accept, Beginning, Place, ResumeError};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

/// Models of this name panic at their third increment.
pub const PANICS: &str = "panics";

/// Models of this name are locating a bifurcation point whenever they wait.
pub const LOCATES: &str = "locates";

/// Models of this name end the process.
pub const ABORTS: &str = "aborts";

#[derive(Clone, Default)]
pub struct MadeUp {
    /// Between increments.
    pub pause: Duration,
    /// Waits before this index until [`MadeUp::let_go`].
    pub hold_at: Option<u64>,
    released: Arc<AtomicBool>,
    /// Solves begun; told apart by it, `elapsed_s` shows which run an increment is from.
    pub runs: Arc<AtomicU64>,
}

impl MadeUp {
    pub fn holding_at(index: u64) -> Self {
        Self { hold_at: Some(index), ..Self::default() }
    }

    pub fn pausing(pause: Duration) -> Self {
        Self { pause, ..Self::default() }
    }

    pub fn let_go(&self) {
        self.released.store(true, Ordering::Relaxed);
    }

    fn wait(&self, index: u64, cancel: &CancelFlag) {
        std::thread::sleep(self.pause);
        while self.hold_at == Some(index) && !self.released.load(Ordering::Relaxed) && !cancel.is_cancelled() {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

impl Solver for MadeUp {
    fn plan(&self, request: &JobRequest) -> Result<Plan, InputErrors> {
        Ok(Plan {
            unknowns: 2,
            contacts: 1,
            stages: request.model.stages.len() as u64,
            displacement_scale: 1.0,
            force_scale: 1.0,
            load_scales: vec![1.0],
            left_out: vec![],
            warnings: vec![],
        })
    }

    fn check_beginning(&self, _request: &JobRequest, _beginning: Beginning) -> Result<(), InputErrors> {
        Ok(())
    }

    fn solve(
        &self,
        request: &JobRequest,
        _beginning: Option<Beginning>,
        cancel: CancelFlag,
        accept: Accept<'_>,
    ) -> Result<Option<JudgedReport>, InputErrors> {
        let run = self.runs.fetch_add(1, Ordering::Relaxed) + 1;
        if request.model.name.as_deref() == Some(ABORTS) {
            std::process::abort();
        }
        let mut stop_reason = StopReason::MaxIncrements;
        let mut increments = 0;
        for index in 0..request.analysis.max_increments {
            let locates = request.model.name.as_deref() == Some(LOCATES);
            let locating = locates.then(arcslip::resources::budget::locating_bifurcation);
            self.wait(index, &cancel);
            drop(locating);
            if cancel.is_cancelled() {
                stop_reason = StopReason::Cancelled;
                break;
            }
            assert!(!(request.model.name.as_deref() == Some(PANICS) && index == 3), "a made-up defect");
            increments += 1;
            let judged = judged(index, run);
            let step = Step { index, diagnostics: judged.increment.diagnostics, given: Some(judged) };
            if accept(step, &Nowhere).is_break() {
                return Ok(None);
            }
        }
        let report = Report {
            stop_reason,
            sentence: stop_reason.sentence().to_owned(),
            increments,
            elapsed_s: run as f64,
            largest_residual: 0.0,
            largest_complementarity: 0.0,
            largest_energy_error: 0.0,
            factorisations: increments,
            bifurcation_factorisations: 0,
            newton_iterations: increments,
            qp_solves: 0,
            mpec_solves: 0,
            sqp_iterations: 0,
            certificates: 0,
            mpec_fallbacks: 0,
        };
        let measure = MeasureReport { largest: Maxima::default(), bar: None, off_measure: 0 };
        Ok(Some(JudgedReport { report, measure }))
    }

    fn resume(
        &self,
        request: &JobRequest,
        _checkpoint: JudgedCheckpoint,
        cancel: CancelFlag,
        accept: Accept<'_>,
    ) -> Result<Option<JudgedReport>, ResumeError> {
        Ok(self.solve(request, None, cancel, accept)?)
    }
}

/// What is made up cannot be put down.
struct Nowhere;

impl Place for Nowhere {
    fn alternatives(&self) -> &[u64] {
        &[]
    }

    fn checkpoint(&self) -> Option<JudgedCheckpoint> {
        None
    }
}

fn judged(index: u64, run: u64) -> JudgedIncrement {
    JudgedIncrement { increment: increment(index, run), measure: Errors::default() }
}

fn increment(index: u64, run: u64) -> Increment {
    let along = index as f64 * 0.1;
    Increment {
        index,
        stage: "push, \"slowly\"".into(),
        load_factor: along.sin(),
        arc_length: along,
        step: 0.1,
        displacements: [("tip".into(), vec![along.cos() / 3.0, -1e-300])].into_iter().collect(),
        contacts: vec![ContactState {
            node: "tip".into(),
            obstacle: "floor".into(),
            status: Status::Slip,
            gap: 0.0,
            normal_reaction: along,
            tangential_reaction: [-0.3 * along].into_iter().collect(),
            reaction: [-0.3 * along, along].into_iter().collect(),
            slip: [0.1].into_iter().collect(),
            slip_total: [along].into_iter().collect(),
            indeterminate: false,
        }],
        elements: vec![ElementState {
            element: 0,
            name: None,
            axial_force: Some(-along),
            force: None,
            ends: None,
            moment: None,
            stress: None,
            von_mises: None,
        }],
        supports: [("pin".into(), vec![0.1 * along, -along])].into_iter().collect(),
        applied_forces: [along, 0.0].into_iter().collect(),
        point: Point {
            kind: if index == 0 { PointKind::Start } else { PointKind::Regular },
            bifurcation: false,
            event: None,
            better_direction: false,
            unexplored_modes: 0,
            degenerate: false,
        },
        directions: None,
        stability: None,
        other_motion: None,
        energy: Energy { external_work: along, strain: 0.6 * along, dissipated: 0.4 * along, released: 0.0 },
        diagnostics: Diagnostics { elapsed_s: run as f64, ..Diagnostics::default() },
    }
}
