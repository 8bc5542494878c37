//! The models of a curve of limit points, made from its text for each value of the parameter.

use crate::model::input::error::{InputError, InputErrors};
use crate::model::input::limits::{MAX_CURVE_POINTS, MAX_NAME_BYTES, MAX_SWEEP_PLACES};
use crate::model::request::curve::CurveSettings;
use crate::model::request::{JobRequest, Method, OnPathEnd, StageControl};
use crate::model::runs::places_of;
use crate::model::template::Template;
use crate::model::{check, decode};
use serde_json::Value;

/// Steps over the range, where none is given.
const STEPS: f64 = 40.0;

/// A decoded curve, whose models are made one by one.
#[derive(Debug, Clone)]
pub struct ParameterCurve {
    pub name: Option<String>,
    pub settings: CurveSettings,
    /// The model's own value of the parameter.
    pub start: f64,
    /// Longest step.
    pub step: f64,
    /// Dimensions of the space.
    pub dimension: usize,
    template: Template,
}

impl ParameterCurve {
    /// Reads a curve and checks its model at its own value.
    ///
    /// # Errors
    /// As for [`decode::decode`]; a place without a number; a range without the model's own value, or with an end that
    /// makes no model; too many steps.
    pub fn read(text: &[u8]) -> Result<Self, InputErrors> {
        let settings = decode::curve(text)?;
        let one = |pointer: &str, detail: String| InputErrors(vec![InputError::new(pointer, detail)]);
        let mut base: Value = serde_json::from_slice(text).map_err(|error| one("", error.to_string()))?;
        let name = base.pointer("/model/name").and_then(Value::as_str);
        let name = name.filter(|name| name.len() <= MAX_NAME_BYTES).map(str::to_owned);
        if let Some(members) = base.as_object_mut() {
            members.remove("curve");
        }
        let wrong = |detail: String| one("/curve/parameter", detail);
        if !settings.parameter.starts_with("/model/") {
            return Err(wrong("a JSON pointer that begins with `/model/` is expected".to_owned()));
        }
        let places = places_of(&base, &settings.parameter, MAX_SWEEP_PLACES).map_err(wrong)?;
        let start = own_value(&base, &places).map_err(wrong)?;
        let [from, to] = settings.range;
        if !(from..=to).contains(&start) {
            let detail =
                format!("the model's own value {start} is not between {from} and {to}; the curve starts there");
            return Err(one("/curve/range", detail));
        }
        let step = settings.step.unwrap_or((to - from) / STEPS);
        if !(step > 0.0 && (to - from) / step <= MAX_CURVE_POINTS as f64) {
            let detail =
                format!("found {step}; a positive number, at most {MAX_CURVE_POINTS} steps of which fill the range");
            return Err(one("/curve/step", detail));
        }
        if settings.limit_point == Some(0) {
            return Err(one("/curve/limit_point", "found 0; limit points are counted from 1".to_owned()));
        }
        let places: Vec<(usize, String)> = places.into_iter().map(|place| (0, place)).collect();
        let template = Template::new(base, &places, &[start.into()]);
        let mut curve = Self { name, settings, start, step, dimension: 0, template };
        let request = curve.request(start)?;
        refuse_analysis(&request)?;
        curve.dimension = request.model.dimension;
        for end in curve.settings.range {
            curve.request(end).map_err(|errors| without_model(end, &errors))?;
        }
        Ok(curve)
    }

    /// Points at the longest step, at most; points where the curve changes come in addition.
    pub fn points(&self) -> u64 {
        let [from, to] = self.settings.range;
        // Both were checked: at most `MAX_CURVE_POINTS` steps.
        let steps = |width: f64| (width / self.step - 1e-9).ceil().max(0.0) as u64;
        1 + steps(to - self.start) + steps(self.start - from)
    }

    /// The model at a value of the parameter, checked.
    ///
    /// # Errors
    /// Mistakes that the model has with this value.
    pub fn request(&self, value: f64) -> Result<JobRequest, InputErrors> {
        let request = self.template.fill(&[value.into()]).1?;
        check::check(&request)?;
        Ok(request)
    }
}

/// The number at these places.
fn own_value(document: &Value, places: &[String]) -> Result<f64, String> {
    let mut own = None;
    for place in places {
        let found = match document.pointer(place) {
            Some(value) => value.as_f64().ok_or_else(|| format!("found {value} at `{place}`; a number is expected"))?,
            None => {
                return Err(format!("the model has no number at `{place}`; write the one at which the curve starts"));
            }
        };
        match own {
            Some(other) if other != found => {
                return Err(format!(
                    "found {found} at `{place}` and {other} at `{}`; equal numbers are expected",
                    places[0]
                ));
            }
            _ => own = Some(found),
        }
    }
    own.ok_or_else(|| "no place of the model has this pointer".to_owned())
}

/// The mistake that one of the ends of the range is.
fn without_model(end: f64, errors: &InputErrors) -> InputErrors {
    let found = errors.0.first().map_or_else(String::new, |first| format!("`{}`: {}", first.pointer, first.detail));
    let detail =
        format!("with {end} the model is refused: {found}; a range is expected all of whose values make a model");
    InputErrors(vec![InputError::new("/curve/range", detail)])
}

/// What a curve cannot follow.
fn refuse_analysis(request: &JobRequest) -> Result<(), InputErrors> {
    let mut mistakes = Vec::new();
    let mut refuse = |pointer: String, detail: &str| mistakes.push(InputError::new(pointer, detail));
    if request.analysis.method == Method::Regularised {
        refuse("/analysis/method".to_owned(), "penalised contacts have no limit points of their own kind; take `auto`");
    }
    if request.analysis.explore.is_some() {
        refuse("/analysis/explore".to_owned(), "a curve follows no other directions; leave it out");
    }
    if request.analysis.on_path_end == OnPathEnd::Jump {
        refuse("/analysis/on_path_end".to_owned(), "the state after a jump depends on its motion; take `stop`");
    }
    for (index, stage) in request.model.stages.iter().enumerate() {
        if stage.control == StageControl::Load {
            let detail = "under load control a structure jumps at its limit point; take `path`";
            refuse(format!("/model/stages/{index}/control"), detail);
        }
    }
    if mistakes.is_empty() { Ok(()) } else { Err(InputErrors(mistakes)) }
}
