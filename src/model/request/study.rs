//! A study: one scene over a ladder of settings and over methods, as `POST /v1/studies` and `arcslip study` take it.

use crate::model::request::{Analysis, JobRequest, Method, Model};
use serde::{Deserialize, Serialize};

/// A model, how to trace it, and what is varied. A job request is one too: what is not said has defaults.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct StudyRequest {
    pub model: Model,
    /// As of a job. `method`, and of what is varied the single value, give way to what `study` says.
    /// `max_increments` bounds the paths of the longest arc length, or of `arc_length.max` where that is shorter; paths of
    /// shorter ones get more in proportion.
    #[serde(default)]
    pub analysis: Analysis,
    #[serde(default)]
    pub study: Study,
}

/// What a study varies. At most one of `arc_lengths`, `tolerances` and `penalties` is given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "server", schema(as = StudySettings))]
#[serde(default, deny_unknown_fields)]
pub struct Study {
    /// Each once. Absent: `auto`, `mpec` and `regularised`, or those that have what is varied.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(min_items = 1))]
    pub methods: Option<Vec<Method>>,
    /// Values of `arc_length.max`, falling, 1 to 20 of them; each is `arc_length.initial` too. The default:
    /// 0.2, 0.1, 0.05, 0.025.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(min_items = 1, max_items = 20))]
    pub arc_lengths: Option<Vec<f64>>,
    /// Values of `regularised.tolerance`, falling, 1 to 20 of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(min_items = 1, max_items = 20))]
    pub tolerances: Option<Vec<f64>>,
    /// Values of `regularised.normal_penalty` and `tangential_penalty` alike, rising, 1 to 20 of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "server", schema(min_items = 1, max_items = 20))]
    pub penalties: Option<Vec<f64>>,
    /// Times that each path is traced to be timed, after a first time that is not; 0 to 101.
    #[cfg_attr(feature = "server", schema(maximum = 101))]
    pub repeats: u64,
    pub reference: ReferenceChoice,
    /// The self-converged reference has the shortest arc length over this; 2 to 16.
    #[cfg_attr(feature = "server", schema(minimum = 2, maximum = 16))]
    pub refinement: u64,
}

impl Default for Study {
    fn default() -> Self {
        Self {
            methods: None,
            arc_lengths: None,
            tolerances: None,
            penalties: None,
            repeats: 5,
            reference: ReferenceChoice::default(),
            refinement: 4,
        }
    }
}

/// What errors are measured against.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum ReferenceChoice {
    /// The exact solution where one is known, a self-converged path otherwise.
    #[default]
    Auto,
    /// The exact solution; refused where none is known.
    Exact,
    /// A path of the method `auto` with shorter arc lengths.
    SelfConverged,
}

/// What the ladder varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Parameter {
    ArcLength,
    Tolerance,
    Penalty,
}

/// The rungs of a study without any of its own.
const ARC_LENGTHS: [f64; 4] = [0.2, 0.1, 0.05, 0.025];

impl Parameter {
    /// As the contract spells it.
    pub fn name(self) -> &'static str {
        match self {
            Self::ArcLength => "arc_length",
            Self::Tolerance => "tolerance",
            Self::Penalty => "penalty",
        }
    }

    /// The field of [`Study`] that holds its values.
    pub fn field(self) -> &'static str {
        match self {
            Self::ArcLength => "arc_lengths",
            Self::Tolerance => "tolerances",
            Self::Penalty => "penalties",
        }
    }

    /// The methods that have it.
    pub fn methods(self) -> &'static [Method] {
        match self {
            Self::ArcLength => &[Method::Auto, Method::Mpec, Method::Regularised],
            Self::Tolerance | Self::Penalty => &[Method::Regularised],
        }
    }
}

impl Study {
    /// What is varied and its values, from coarse to fine.
    pub fn ladder(&self) -> (Parameter, &[f64]) {
        match (&self.arc_lengths, &self.tolerances, &self.penalties) {
            (Some(values), _, _) => (Parameter::ArcLength, values),
            (None, Some(values), _) => (Parameter::Tolerance, values),
            (None, None, Some(values)) => (Parameter::Penalty, values),
            (None, None, None) => (Parameter::ArcLength, &ARC_LENGTHS),
        }
    }

    pub fn methods(&self) -> &[Method] {
        self.methods.as_deref().unwrap_or(self.ladder().0.methods())
    }
}

impl StudyRequest {
    /// The job of one method at one value of what is varied.
    pub fn job(&self, method: Method, value: f64) -> JobRequest {
        let (parameter, rungs) = self.study.ladder();
        let mut analysis = self.analysis.clone();
        analysis.method = method;
        if method != Method::Regularised {
            analysis.regularised = None;
        }
        if method != Method::Mpec {
            analysis.mpec = None;
        }
        match parameter {
            Parameter::ArcLength => {
                let longest = rungs.first().copied().unwrap_or(value);
                set_arc_length(&mut analysis, value, longest.min(self.analysis.arc_length.max));
            }
            Parameter::Tolerance => analysis.regularised.get_or_insert_default().tolerance = value,
            Parameter::Penalty => {
                let regularised = analysis.regularised.get_or_insert_default();
                regularised.normal_penalty = value;
                regularised.tangential_penalty = value;
            }
        }
        JobRequest { model: self.model.clone(), analysis }
    }

    /// The job of a path with the shortest arc length of the study over a divisor, by the method `auto`.
    pub fn finer_job(&self, divisor: f64) -> JobRequest {
        let (longest, shortest) = self.arc_lengths();
        let mut analysis = self.analysis.clone();
        analysis.method = Method::Auto;
        (analysis.mpec, analysis.regularised) = (None, None);
        // Rungs longer than the analysis' own arc length are no reason for more increments; the refinement is.
        let usual = longest.min(self.analysis.arc_length.max.max(shortest));
        set_arc_length(&mut analysis, shortest / divisor, usual);
        analysis.arc_length.min = analysis.arc_length.min.min(analysis.arc_length.max);
        JobRequest { model: self.model.clone(), analysis }
    }

    /// The longest and the shortest arc length.
    fn arc_lengths(&self) -> (f64, f64) {
        let all = self.analysis.arc_length.max;
        match self.study.ladder() {
            (Parameter::ArcLength, values) => {
                (values.first().copied().unwrap_or(all), values.last().copied().unwrap_or(all))
            }
            (Parameter::Tolerance | Parameter::Penalty, _) => (all, all),
        }
    }
}

/// Sets the arc length, and allows as long a path as with the usual one.
fn set_arc_length(analysis: &mut Analysis, value: f64, usual: f64) {
    analysis.arc_length.initial = value;
    analysis.arc_length.max = value;
    analysis.arc_length.jump = false;
    // What overflows the integer is cut to its largest value; the check bounds it before.
    let more = (usual / value).ceil().max(1.0);
    analysis.max_increments = (analysis.max_increments as f64 * more) as u64;
}
