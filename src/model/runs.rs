//! The runs of a sweep, made one by one from its text; mistakes in a run are reported at their place in the sweep.

use crate::model::input::error::{InputError, InputErrors};
use crate::model::input::limits::{MAX_NAME_BYTES, MAX_SWEEP_PLACES, MAX_SWEEP_RESPONSES, MAX_SWEEP_RUNS};
use crate::model::input::names::suggestion;
use crate::model::request::column_units::unit_of;
use crate::model::request::response::Response;
use crate::model::request::sweep::{Combine, SweepParameter, Variation};
use crate::model::request::{JobRequest, Units};
use crate::model::template::{Template, escaped, item};
use crate::model::{check, decode};
use serde::Deserialize;
use serde_json::Value;
use std::ops::Range;

/// The step of a pointer that stands for every item.
const ANY: &str = "*";

/// A decoded sweep, whose runs are made and checked one by one.
#[derive(Debug, Clone)]
pub struct Sweep {
    pub name: Option<String>,
    pub variation: Variation,
    runs: u64,
    template: Template,
}

/// A run of a sweep.
#[derive(Debug, Clone)]
pub struct Run {
    /// The job request of the run, as JSON text.
    pub text: String,
    pub request: JobRequest,
}

impl Sweep {
    /// Reads a sweep; its runs are checked in [`run`](Self::run).
    ///
    /// # Errors
    /// As for [`decode::decode`]; places that the document cannot have; too many runs.
    pub fn read(text: &[u8]) -> Result<Self, InputErrors> {
        let mut form = decode::replacements(text)?;
        let wrong = |error: serde_json::Error| InputErrors(vec![InputError::new("", error.to_string())]);
        let mut base: Value = serde_json::from_slice(text).map_err(wrong)?;
        let name = base.pointer("/model/name").and_then(Value::as_str);
        // If other names replace this name, nothing else checks it.
        let name = name.filter(|name| name.len() <= MAX_NAME_BYTES).map(str::to_owned);
        let posted = base.as_object_mut().and_then(|members| members.remove("sweep")).unwrap_or_default();
        let mut mistakes = Vec::new();
        if form.responses.len() > MAX_SWEEP_RESPONSES {
            let detail = format!("found {} responses; at most {MAX_SWEEP_RESPONSES} are taken", form.responses.len());
            mistakes.push(InputError::new("/sweep/responses", detail));
        }
        let mut parameters = Vec::with_capacity(form.replace.len());
        let mut places = Vec::new();
        for pointer in std::mem::take(&mut form.replace) {
            let values = posted.get("replace").and_then(|replace| replace.get(&pointer)).and_then(Value::as_array);
            match places_of(&base, &pointer, MAX_SWEEP_PLACES - places.len()) {
                Ok(found) => places.extend(found.into_iter().map(|place| (parameters.len(), place))),
                Err(detail) => mistakes.push(InputError::new(place_of(&pointer), detail)),
            }
            parameters.push(SweepParameter { pointer, values: values.cloned().unwrap_or_default() });
        }
        mistakes.extend(within_another(&parameters));
        let runs = match count(form.combine, &parameters) {
            Ok(runs) => runs,
            Err(mistake) => {
                mistakes.push(mistake);
                0
            }
        };
        if mistakes.is_empty() {
            mistakes.extend(check_refinement(form.refine, runs, &parameters).err());
        }
        if mistakes.is_empty() {
            let (combine, responses, refine) = (form.combine, form.responses, form.refine);
            let units =
                base.pointer("/model/units").and_then(|units| Units::deserialize(units).ok()).unwrap_or_default();
            let unit_of =
                |(name, response): (&String, &Response)| Some((name.clone(), unit_of(&response.value, &units)?));
            let response_units = responses.iter().filter_map(unit_of).collect();
            let variation = Variation { parameters, combine, responses, refine, response_units, warnings: Vec::new() };
            let template = Template::new(base, &places, &variation.values(0));
            Ok(Self { name, variation, runs, template })
        } else {
            Err(InputErrors(mistakes))
        }
    }

    /// The number of runs, at least 1.
    pub fn runs(&self) -> u64 {
        self.runs
    }

    /// Adds values of the only parameter, a run for each; the new runs.
    ///
    /// # Errors
    /// There are several parameters, or too many runs.
    pub fn add_values(&mut self, values: Vec<Value>) -> Result<Range<u64>, InputErrors> {
        let (before, combine) = (self.runs, self.variation.combine);
        let several = "further values need one parameter, and these are several";
        let [parameter] = self.variation.parameters.as_mut_slice() else {
            return Err(InputErrors(vec![InputError::new("/sweep/replace", several)]));
        };
        parameter.values.extend(values);
        self.runs = count(combine, &self.variation.parameters).map_err(|error| InputErrors(vec![error]))?;
        Ok(before..self.runs)
    }

    /// Takes back the values of the only parameter after so many runs.
    pub fn drop_values_after(&mut self, runs: usize) {
        if let [parameter] = self.variation.parameters.as_mut_slice() {
            parameter.values.truncate(runs);
            self.runs = parameter.values.len() as u64;
        }
    }

    /// Makes and checks a run.
    ///
    /// # Errors
    /// The mistakes in the run, each with its place in the sweep.
    pub fn run(&self, run: u64) -> Result<Run, InputErrors> {
        let (text, request) = self.template.fill(&self.variation.values(run));
        let request = request.map_err(|errors| self.located(run, errors))?;
        check::check(&request).map_err(|errors| self.located(run, errors))?;
        if request.analysis.explore.is_some() {
            let detail = "a sweep follows no other directions; leave it out";
            return Err(self.located(run, InputErrors(vec![InputError::new("/analysis/explore", detail)])));
        }
        Ok(Run { text, request })
    }

    /// In how many of the first `runs` runs the value at the given place of the sweep is inserted; `None` if no value is there.
    pub fn runs_at(&self, pointer: &str, runs: u64) -> Option<u64> {
        let (parameter, choice) = pointer.rsplit_once('/')?;
        let choice: usize = choice.parse().ok()?;
        let place = self.variation.parameters.iter().position(|one| place_of(&one.pointer) == parameter)?;
        let has_it = |run: &u64| self.variation.choices(*run).get(place) == Some(&choice);
        Some((0..runs).filter(has_it).count() as u64)
    }

    /// Mistakes in a run as mistakes in the sweep: a mistake at an inserted value is reported at that value.
    pub fn located(&self, run: u64, errors: InputErrors) -> InputErrors {
        let (parameters, choices) = (&self.variation.parameters, self.variation.choices(run));
        let located = errors.0.into_iter().map(|error| {
            let about = |parameter: &&SweepParameter| {
                is_within(&error.pointer, &parameter.pointer) || is_within(&parameter.pointer, &error.pointer)
            };
            // A mistake of a whole object may be due to any of its values.
            let found = parameters.iter().position(|parameter| about(&parameter));
            match found.filter(|_| error.pointer.len() > 1) {
                Some(place) => {
                    let parameter = &parameters[place];
                    let at = format!("{}/{}", place_of(&parameter.pointer), choices[place]);
                    InputError::new(at, format!("{}: {}", error.place(), error.detail))
                }
                None => error,
            }
        });
        InputErrors(located.collect())
    }
}

/// The place of a pointer in the document of the sweep.
fn place_of(pointer: &str) -> String {
    format!("/sweep/replace/{}", pointer.replace('~', "~0").replace('/', "~1"))
}

/// Whether a pointer is equal to another one or below it; a step `*` may be any.
fn is_within(pointer: &str, other: &str) -> bool {
    let mut steps = pointer.split('/');
    other.split('/').all(|wanted| steps.next().is_some_and(|step| step == wanted || [step, wanted].contains(&ANY)))
}

fn within_another(parameters: &[SweepParameter]) -> Option<InputError> {
    parameters.iter().enumerate().find_map(|(place, one)| {
        let others = parameters.iter().enumerate().filter(|(other, _)| *other != place);
        let outer = others.map(|(_, other)| other).find(|other| is_within(&one.pointer, &other.pointer))?;
        let detail = format!("it lies within `{}`, which is replaced as a whole; leave one of them out", outer.pointer);
        Some(InputError::new(place_of(&one.pointer), detail))
    })
}

fn count(combine: Combine, parameters: &[SweepParameter]) -> Result<u64, InputError> {
    if let Some(empty) = parameters.iter().find(|parameter| parameter.values.is_empty()) {
        return Err(InputError::new(place_of(&empty.pointer), "there is no value; at least one is expected"));
    }
    let lengths = || parameters.iter().map(|parameter| parameter.values.len() as u64);
    let runs = match combine {
        Combine::Grid => lengths().try_fold(1_u64, u64::checked_mul).unwrap_or(u64::MAX),
        Combine::List => {
            let first = lengths().next().unwrap_or_default();
            if let Some(other) = parameters.iter().find(|parameter| parameter.values.len() as u64 != first) {
                let found = other.values.len();
                let detail =
                    format!("found {found} values; as many as of the first place, {first}, are expected of a list");
                return Err(InputError::new(place_of(&other.pointer), detail));
            }
            first
        }
    };
    if runs > MAX_SWEEP_RUNS {
        let detail = format!("these are {runs} runs; at most {MAX_SWEEP_RUNS} are taken");
        return Err(InputError::new("/sweep/replace", detail));
    }
    Ok(runs)
}

/// A refinement is of one parameter with numbers, and within the bound of runs.
fn check_refinement(refine: u64, runs: u64, parameters: &[SweepParameter]) -> Result<(), InputError> {
    let refused = |detail| Err(InputError::new("/sweep/refine", detail));
    match parameters {
        _ if refine == 0 => Ok(()),
        [one] if one.values.len() < 2 || !one.values.iter().all(Value::is_number) => {
            refused("one parameter with two numbers or more is expected".to_owned())
        }
        [_] => match runs.saturating_add(refine) {
            all if all > MAX_SWEEP_RUNS => refused(format!("these are {all} runs; at most {MAX_SWEEP_RUNS} are taken")),
            _ => Ok(()),
        },
        _ => refused("one parameter with two numbers or more is expected, and these are several parameters".to_owned()),
    }
}

/// The places at which a value is inserted: those of the pointer, with every item of a list or member of an object in place of
/// a step `*`, unless the object has a member of this name. Members of objects may be missing, items of arrays not.
///
/// There are at most `most`.
pub(super) fn places_of(document: &Value, pointer: &str, most: usize) -> Result<Vec<String>, String> {
    if !["/model/", "/analysis/"].iter().any(|root| pointer.starts_with(root)) {
        return Err("a JSON pointer that begins with `/model/` or `/analysis/` is expected".to_owned());
    }
    let mut places = Vec::new();
    add_places(document, String::new(), pointer, most, &mut places)?;
    Ok(places)
}

/// Adds the places of the steps that are `left` from a value on, which stands at `walked`.
fn add_places(at: &Value, walked: String, left: &str, most: usize, places: &mut Vec<String>) -> Result<(), String> {
    if places.len() >= most {
        return Err(format!("a sweep puts values into {MAX_SWEEP_PLACES} places at most, and these are more"));
    }
    let Some(steps) = left.strip_prefix('/') else {
        places.push(walked);
        return Ok(());
    };
    let (step, rest) = steps.find('/').map_or((steps, ""), |end| steps.split_at(end));
    let name = step.replace("~1", "/").replace("~0", "~");
    let here = || if walked.is_empty() { "the document" } else { &walked };
    match at {
        Value::Object(members) if name == ANY && !members.contains_key(ANY) => {
            if members.is_empty() {
                return Err(format!("`{}` has no members", here()));
            }
            members.iter().try_for_each(|(name, value)| {
                add_places(value, format!("{walked}/{}", escaped(name)), rest, most, places)
            })
        }
        Value::Object(members) => match members.get(&name) {
            Some(value) => add_places(value, format!("{walked}/{step}"), rest, most, places),
            None if left.split('/').any(|step| step == ANY) => {
                let near = suggestion(&name, members.keys().map(String::as_str));
                Err(format!("`{}` has no member `{name}` whose items could be replaced{near}", here()))
            }
            None => {
                places.push(walked + left);
                Ok(())
            }
        },
        Value::Array(items) if name == ANY => {
            if items.is_empty() {
                return Err(format!("`{}` has no items", here()));
            }
            (0..).zip(items).try_for_each(|(index, value): (usize, _)| {
                add_places(value, format!("{walked}/{index}"), rest, most, places)
            })
        }
        Value::Array(items) => {
            let found = item(&name).and_then(|index| items.get(index));
            let found = found.ok_or_else(|| format!("`{}` has {}, and none `{name}`", here(), counted(items.len())))?;
            add_places(found, format!("{walked}/{step}"), rest, most, places)
        }
        Value::Null => {
            places.push(walked + left);
            Ok(())
        }
        _ => Err(format!("`{}` is neither an object nor an array", here())),
    }
}

fn counted(items: usize) -> String {
    if items == 1 { "1 item".to_owned() } else { format!("{items} items") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::scenes;
    use serde_json::json;

    fn sweep(replace: Value, combine: &str) -> Result<Sweep, Vec<(String, String)>> {
        let mut document: Value = serde_json::from_str(scenes::find("one-bar-truss").unwrap().request).unwrap();
        document["sweep"] = json!({"replace": replace, "combine": combine});
        let told = |errors: InputErrors| errors.0.into_iter().map(|error| (error.pointer, error.detail)).collect();
        Sweep::read(document.to_string().as_bytes()).map_err(told)
    }

    const FRICTION: &str = "/model/contacts/0/friction";
    const LONGEST: &str = "/analysis/arc_length/max";

    #[test]
    fn a_grid_has_every_pair_and_a_list_those_that_stand_together() {
        let values = json!({FRICTION: [0.1, 0.2], LONGEST: [0.5, 0.25, 0.125]});
        let grid = sweep(values, "grid").unwrap();
        assert_eq!(grid.runs(), 6);
        let pairs: Vec<Vec<Value>> = (0..6).map(|run| grid.variation.values(run)).collect();
        assert_eq!(pairs[0], [json!(0.1), json!(0.5)]);
        assert_eq!(pairs[1], [json!(0.1), json!(0.25)]);
        assert_eq!(pairs[5], [json!(0.2), json!(0.125)]);
        let run = grid.run(4).unwrap().request;
        assert_eq!((run.model.contacts[0].friction, run.analysis.arc_length.max), (0.2, 0.25));
        let list = sweep(json!({FRICTION: [0.1, 0.2], LONGEST: [0.5, 0.25]}), "list").unwrap();
        assert_eq!(list.runs(), 2);
        assert_eq!(list.variation.values(1), [json!(0.2), json!(0.25)]);
    }

    #[test]
    fn what_is_not_said_can_be_replaced_and_the_rest_stays_as_it_was_posted() {
        let sweep = sweep(json!({"/analysis/max_modes": [7]}), "grid").unwrap();
        let run = sweep.run(0).unwrap();
        assert_eq!(run.request.analysis.max_modes, 7);
        let mut posted: Value = serde_json::from_str(scenes::find("one-bar-truss").unwrap().request).unwrap();
        posted["analysis"]["max_modes"] = json!(7);
        let order = |text: &str| serde_json::from_str::<Value>(text).unwrap().to_string();
        assert_eq!(order(&run.text), posted.to_string(), "the order of nodes is part of a model");
    }

    #[test]
    fn a_star_stands_for_every_item() {
        let mut document: Value = serde_json::from_str(scenes::find("two-snapping-bars").unwrap().request).unwrap();
        let replace = |pointer: &str| json!({"replace": {pointer: [0.25, 0.75]}});
        for pointer in ["/model/contacts/*/friction", "/*/contacts/*/friction"] {
            document["sweep"] = replace(pointer);
            let read = Sweep::read(document.to_string().as_bytes());
            if pointer.starts_with("/*") {
                assert!(read.unwrap_err().0[0].detail.contains("begins with `/model/`"));
                continue;
            }
            let sweep = read.unwrap();
            assert_eq!(sweep.runs(), 2);
            assert_eq!(sweep.variation.parameters[0].pointer, pointer);
            let contacts = sweep.run(1).unwrap().request.model.contacts;
            assert!(contacts.len() > 1 && contacts.iter().all(|contact| contact.friction == 0.75));
        }
        // Every member of an object, and a mistake in any of them is told at the value.
        document["sweep"] = json!({"replace": {"/model/nodes/*/1": [0.5], "/model/contacts/*/friction": [0.1, -1]}});
        let sweep = Sweep::read(document.to_string().as_bytes()).unwrap();
        let nodes = sweep.run(0).unwrap().request.model.nodes;
        assert!(nodes.values().all(|node| node[1] == 0.5));
        assert_eq!(sweep.run(1).unwrap_err().0[0].pointer, "/sweep/replace/~1model~1contacts~1*~1friction/1");
        // A member of this name is that member.
        document["model"]["supports"]["*"] = json!(["x"]);
        document["sweep"] = json!({"replace": {"/model/supports/*": [["y"]]}});
        let text = Sweep::read(document.to_string().as_bytes()).unwrap().template.fill(&[json!(["y"])]).0;
        let text: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(text["model"]["supports"]["*"], json!(["y"]));
        assert!(text["model"]["supports"].as_object().unwrap().values().any(|held| *held != json!(["y"])));
    }

    #[test]
    fn mistakes_are_told_at_their_place_in_the_sweep() {
        let refused = |replace, combine| sweep(replace, combine).unwrap_err();
        let one = |found: Vec<(String, String)>| found.into_iter().next().unwrap();
        let (at, detail) = one(refused(json!({"/model/contacts/7/friction": [0.1]}), "grid"));
        assert_eq!(at, "/sweep/replace/~1model~1contacts~17~1friction");
        assert!(detail.contains("1 item, and none `7`"), "{detail}");
        assert!(one(refused(json!({"/sweep": [1]}), "grid")).1.contains("`/model/`"));
        assert!(one(refused(json!({"/model/name/x": [1]}), "grid")).1.contains("neither an object"));
        assert!(one(refused(json!({FRICTION: []}), "grid")).1.contains("at least one"));
        assert!(one(refused(json!({FRICTION: [0.1], LONGEST: [1, 2]}), "list")).1.contains("a list"));
        assert!(one(refused(json!({FRICTION: [0.1], "/model/contacts/0": [{}]}), "grid")).1.contains("within"));
        let every = "/model/contacts/*/friction";
        assert!(one(refused(json!({FRICTION: [0.1], every: [0.2]}), "grid")).1.contains("within"));
        assert!(one(refused(json!({"/model/keep/*": [1]}), "grid")).1.contains("no member `keep`"));
        assert!(one(refused(json!({"/model/dimension/*": [1]}), "grid")).1.contains("neither an object"));
        let many: Vec<f64> = (1..2_000).map(f64::from).collect();
        assert!(one(refused(json!({FRICTION: many, LONGEST: many}), "grid")).1.contains("at most"));
        for name in ["00", "+0", "-", "", "1"] {
            let pointer = format!("/model/contacts/{name}/friction");
            assert!(one(refused(json!({pointer: [0.1]}), "grid")).1.contains("and none"), "{name}");
        }
        assert!(one(refused(json!({}), "grid")).1.contains("at least one"));
        assert!(one(refused(json!([1]), "grid")).1.contains("an object"));
        assert!(one(refused(json!({FRICTION: [0.1]}), "all")).1.contains("`all` is not"));

        let sweep = sweep(json!({FRICTION: [0.1, -0.5]}), "grid").unwrap();
        assert!(sweep.run(0).is_ok());
        let wrong = sweep.run(1).unwrap_err().0;
        assert_eq!(wrong[0].pointer, "/sweep/replace/~1model~1contacts~10~1friction/1");
        assert!(wrong[0].detail.starts_with("model.contacts[0].friction: "), "{}", wrong[0].detail);
        let many: serde_json::Map<String, Value> =
            (0..1_000).map(|one| (format!("/model/contacts/*/member{one}"), json!([1]))).collect();
        let contacts = vec![json!({}); 1_000];
        let flood = json!({"model": {"contacts": contacts}, "sweep": {"replace": many}});
        let told = Sweep::read(flood.to_string().as_bytes()).unwrap_err();
        assert!(told.0.last().unwrap().detail.contains("250000 places at most"), "{told}");
        let explore = self::sweep(json!({"/analysis/explore": [{}]}), "grid").unwrap();
        assert_eq!(explore.run(0).unwrap_err().0[0].pointer, "/sweep/replace/~1analysis~1explore/0");
    }
}
