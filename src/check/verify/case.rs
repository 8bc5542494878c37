//! A request with a known solution, and the result of solving it.

use crate::check::measure::Judge;
use crate::check::verify::compare::worse;
use crate::continuation::path::iterator::Path;
use crate::continuation::scene::Scene;
use crate::model::JobRequest;
use crate::model::request::{Element, Method};
use crate::resources::cancel::CancelFlag;
use crate::result::increment::Increment;
use crate::result::stop_reason::StopReason;
use serde::Serialize;
use std::sync::Arc;

/// The largest error of state (equilibrium, supports, contact, friction, cone, reported values, arc length) that an
/// increment may have.
pub const STATE_BAR: f64 = 1e-10;

/// The largest error of the energy balance and of the strain energy, over the largest energy so far.
pub const ENERGY_BAR: f64 = 1e-6;

pub(crate) const BOTH: &[Method] = &[Method::Auto, Method::Mpec];

pub(crate) const AUTO: &[Method] = &[Method::Auto];

/// Error of a path against the exact solution, dimensionless; infinite if a required point is missing.
pub(crate) type PathError = Arc<dyn Fn(&[Increment]) -> f64 + Send + Sync>;

/// A request and its known solution.
#[derive(Clone)]
pub struct Case {
    /// The scene, or the family of extreme cases.
    pub family: &'static str,
    /// The member of the family.
    pub name: String,
    pub request: JobRequest,
    /// The methods that solve the case.
    pub methods: &'static [Method],
    /// The case takes more than a few seconds.
    pub long: bool,
    ending: ExpectedEnding,
    bar: f64,
    error: PathError,
}

/// The expected end of a case.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ExpectedEnding {
    Stops(StopReason),
    /// Every stage ends, or the path stops earlier for this reason.
    MayStop(StopReason),
    /// The request is refused, and the first mistake is at this pointer.
    Refused(&'static str),
}

/// The result of a case.
#[derive(Debug, Clone, Serialize)]
pub struct CaseRow {
    pub family: &'static str,
    pub case: String,
    pub method: Method,
    /// Error against the exact solution, dimensionless; `None` if the error is not finite.
    pub error: Option<f64>,
    pub bar: f64,
    /// The largest error of state over all increments, by the measure; `None` if the error is not finite.
    pub state_error: Option<f64>,
    /// The largest error of the energy balance and of the strain energy, by the measure; `None` if the error is not
    /// finite.
    pub energy_error: Option<f64>,
    /// The reason for the end of the path, or the place of the first mistake in a refused request.
    pub stop_reason: String,
    /// Number of increments after the start.
    pub increments: u64,
    pub time_s: f64,
    pub pass: bool,
}

impl CaseRow {
    /// The name of the method, as in a request.
    pub fn method_name(&self) -> &'static str {
        match self.method {
            Method::Auto => "auto",
            Method::Mpec => "mpec",
            Method::Regularised => "regularised",
        }
    }
}

impl Case {
    pub(crate) fn new(family: &'static str, name: impl Into<String>, request: JobRequest) -> Self {
        Self {
            family,
            name: name.into(),
            request,
            methods: BOTH,
            long: false,
            ending: ExpectedEnding::Stops(StopReason::StagesCompleted),
            bar: 1e-10,
            error: Arc::new(|_| 0.0),
        }
    }

    pub(crate) fn exact(mut self, bar: f64, error: impl Fn(&[Increment]) -> f64 + Send + Sync + 'static) -> Self {
        (self.bar, self.error) = (bar, Arc::new(error));
        self
    }

    pub(crate) fn ends(mut self, reason: StopReason) -> Self {
        self.ending = ExpectedEnding::Stops(reason);
        self
    }

    pub(crate) fn or_ends(mut self, reason: StopReason) -> Self {
        self.ending = ExpectedEnding::MayStop(reason);
        self
    }

    pub(crate) fn refused(mut self, pointer: &'static str) -> Self {
        (self.ending, self.methods) = (ExpectedEnding::Refused(pointer), AUTO);
        self
    }

    pub(crate) fn by(mut self, methods: &'static [Method]) -> Self {
        self.methods = methods;
        self
    }

    /// The case and, if all elements are springs and jumps are allowed, the same case without jumps, in steps.
    pub(crate) fn with_steps(self) -> Vec<Self> {
        let elements = &self.request.model.elements;
        let linear = elements.iter().all(|element| matches!(element, Element::Spring { .. }));
        if !linear || !self.request.analysis.arc_length.jump || matches!(self.ending, ExpectedEnding::Refused(_)) {
            return vec![self];
        }
        let mut in_steps = self.clone();
        in_steps.name += ", in steps";
        in_steps.request.analysis.arc_length.jump = false;
        vec![self, in_steps]
    }

    /// Solves the case by a method and evaluates the result.
    pub fn solve(&self, method: Method) -> CaseRow {
        let mut request = self.request.clone();
        request.analysis.method = method;
        let mut row = CaseRow {
            family: self.family,
            case: self.name.clone(),
            method,
            error: None,
            bar: self.bar,
            state_error: None,
            energy_error: None,
            stop_reason: String::new(),
            increments: 0,
            time_s: 0.0,
            pass: false,
        };
        let scene = match Scene::new(&request) {
            Ok(scene) => scene,
            Err(errors) => {
                let first = errors.0.first().map_or("", |error| error.pointer.as_str());
                row.stop_reason = format!("refused at {first}");
                row.pass = match self.ending {
                    ExpectedEnding::Refused(pointer) => errors.0.first().is_some_and(|error| error.pointer == pointer),
                    ExpectedEnding::Stops(_) | ExpectedEnding::MayStop(_) => false,
                };
                return row;
            }
        };
        let mut path = Path::new(&scene, CancelFlag::default());
        let mut judge = Judge::new(&request, scene.plan().displacement_scale, &scene.plan().load_scales);
        let (mut state_error, mut energy_error) = (0.0_f64, 0.0_f64);
        let mut increments = Vec::new();
        for increment in path.by_ref() {
            let errors = judge.judge(&increment);
            state_error = worse(state_error, errors.largest_of_state());
            energy_error = worse(worse(energy_error, errors.energy), errors.strain_energy);
            increments.push(increment);
        }
        let Some(report) = path.report() else { return row };
        let error = (self.error)(&increments);
        let ended = match self.ending {
            ExpectedEnding::Stops(reason) => report.stop_reason == reason,
            ExpectedEnding::MayStop(reason) => [StopReason::StagesCompleted, reason].contains(&report.stop_reason),
            ExpectedEnding::Refused(_) => false,
        };
        row.stop_reason = serde_json::to_value(report.stop_reason)
            .ok()
            .and_then(|value| value.as_str().map(str::to_owned))
            .unwrap_or_default();
        row.increments = report.increments;
        row.time_s = report.elapsed_s;
        row.pass = ended && error <= self.bar && state_error <= STATE_BAR && energy_error <= ENERGY_BAR;
        let finite = |value: f64| value.is_finite().then_some(value);
        (row.error, row.state_error, row.energy_error) = (finite(error), finite(state_error), finite(energy_error));
        row
    }
}
