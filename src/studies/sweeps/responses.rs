//! The responses of a path: values at places that a sweep asks for, found as the increments come.

use crate::check::measure::Errors;
use crate::model::input::names::{quoted, suggestion};
use crate::model::request::response::{NamedPlace, Response, ResponsePlace};
use crate::model::{InputError, InputErrors, JobRequest};
use crate::output::Table;
use crate::result::increment::{Increment, PointKind, Status};
use crate::studies::sweeps::LimitLoad;
use crate::studies::sweeps::table::is_column;
use indexmap::IndexMap;
use serde_json::Value;

/// Finds the responses of one path.
#[derive(Debug)]
pub struct ResponseFinder {
    /// `None` where nothing is sought.
    table: Option<Table>,
    /// The columns of the table that are looked at, ascending.
    columns: Vec<usize>,
    sought: IndexMap<String, SoughtResponse>,
    /// The increment before, in these columns.
    before: Option<PreviousIncrement>,
}

#[derive(Debug)]
struct PreviousIncrement {
    stage: std::sync::Arc<str>,
    values: Vec<Value>,
}

/// A response, and what is found of it so far.
#[derive(Debug)]
struct SoughtResponse {
    /// The place of its value among the columns.
    column: usize,
    at: ResponseLocation,
    stage: Option<String>,
    found: Option<Value>,
}

#[derive(Debug, Clone, Copy)]
enum ResponseLocation {
    FirstLimit,
    LargestLoad { so_far: f64 },
    FirstSlip,
    FirstContactChange,
    End,
    Reached { column: usize, number: f64 },
}

impl ResponseFinder {
    /// The responses of the path of a request.
    ///
    /// # Errors
    /// A column or a stage that the path does not have, or a place that cannot be seen in what is recorded.
    pub fn new(responses: &IndexMap<String, Response>, request: &JobRequest) -> Result<Self, InputErrors> {
        if responses.is_empty() {
            return Ok(Self { table: None, columns: Vec::new(), sought: IndexMap::new(), before: None });
        }
        let table = Table::of(request);
        let names = table.names();
        let mut mistakes = Vec::new();
        let mut sought = IndexMap::with_capacity(responses.len());
        for (name, response) in responses {
            let found = if is_column(name) {
                Err(("", "a column of the sweep's own table has this name; choose another".to_owned()))
            } else {
                SoughtResponse::new(response, request, &names)
            };
            match found {
                Ok(found) => {
                    sought.insert(name.clone(), found);
                }
                Err((member, detail)) => {
                    let name = name.replace('~', "~0").replace('/', "~1");
                    mistakes.push(InputError::new(format!("/sweep/responses/{name}{member}"), detail));
                }
            }
        }
        if !mistakes.is_empty() {
            return Err(InputErrors(mistakes));
        }
        let mut columns: Vec<usize> = sought.values().flat_map(SoughtResponse::columns).collect();
        columns.sort_unstable();
        columns.dedup();
        sought.values_mut().for_each(|sought| sought.look_among(&columns));
        Ok(Self { table: Some(table), columns, sought, before: None })
    }

    /// Looks at the next increment of the path.
    pub fn take(&mut self, increment: &Increment, measure: Option<&Errors>) {
        let Some(table) = &self.table else { return };
        let values = table.values(increment, measure, &self.columns);
        // A stage begins with a load factor of 0, which is no way between two increments.
        let before = self.before.take().filter(|before| before.stage == increment.stage).map(|before| before.values);
        for sought in self.sought.values_mut() {
            if sought.stage.as_deref().is_none_or(|stage| stage == &*increment.stage) {
                sought.look(increment, &values, before.as_deref());
            }
        }
        self.before = Some(PreviousIncrement { stage: increment.stage.clone(), values });
    }

    /// The responses by their names, null where the path does not reach the place; `None` where none are sought.
    pub fn found(self) -> Option<IndexMap<String, Value>> {
        let found = |(name, sought): (String, SoughtResponse)| (name, sought.found.unwrap_or_default());
        (!self.sought.is_empty()).then(|| self.sought.into_iter().map(found).collect())
    }
}

impl SoughtResponse {
    /// The member of the response that is wrong, and why.
    fn new(response: &Response, request: &JobRequest, names: &[String]) -> Result<Self, (&'static str, String)> {
        let column = |member: &'static str, name: &str| {
            let known = || suggestion(name, names.iter().map(String::as_str));
            let found = names.iter().position(|known| known == name);
            let unrecorded = "; an increment has what `analysis.record` asks for";
            found.ok_or_else(|| (member, format!("the path has no column {}{}{unrecorded}", quoted(name), known())))
        };
        let at = match &response.at {
            ResponsePlace::Named(NamedPlace::FirstLimit) => ResponseLocation::FirstLimit,
            ResponsePlace::Named(NamedPlace::LargestLoad) => {
                ResponseLocation::LargestLoad { so_far: f64::NEG_INFINITY }
            }
            ResponsePlace::Named(NamedPlace::FirstSlip) if !names.iter().any(|name| name.ends_with(".status")) => {
                return Err(("/at", "no contact is recorded, so that no slip can be seen".to_owned()));
            }
            ResponsePlace::Named(NamedPlace::FirstSlip) => ResponseLocation::FirstSlip,
            ResponsePlace::Named(NamedPlace::FirstContactChange) => ResponseLocation::FirstContactChange,
            ResponsePlace::Named(NamedPlace::End) => ResponseLocation::End,
            ResponsePlace::Reached(reached) if !reached.reaches.is_finite() => {
                return Err(("/at/reaches", format!("found {}; a finite number is expected", reached.reaches)));
            }
            ResponsePlace::Reached(reached) => {
                ResponseLocation::Reached { column: column("/at/value", &reached.value)?, number: reached.reaches }
            }
        };
        if let Some(stage) = &response.stage {
            let stages = || request.model.stages.iter().map(|stage| stage.name.as_str());
            if !stages().any(|known| known == stage) {
                return Err(("/stage", format!("there is no stage {}{}", quoted(stage), suggestion(stage, stages()))));
            }
        }
        Ok(Self { column: column("/value", &response.value)?, at, stage: response.stage.clone(), found: None })
    }

    /// The columns of the table that are looked at.
    fn columns(&self) -> impl Iterator<Item = usize> {
        let reached = if let ResponseLocation::Reached { column, .. } = self.at { Some(column) } else { None };
        [self.column].into_iter().chain(reached)
    }

    /// Looks at these columns alone from now on.
    fn look_among(&mut self, columns: &[usize]) {
        let place = |column: usize| columns.partition_point(|other| *other < column);
        self.column = place(self.column);
        if let ResponseLocation::Reached { column, .. } = &mut self.at {
            *column = place(*column);
        }
    }

    fn look(&mut self, increment: &Increment, values: &[Value], before: Option<&[Value]>) {
        let value = |values: &[Value]| values.get(self.column).cloned();
        let here = match &mut self.at {
            ResponseLocation::LargestLoad { so_far } if increment.load_factor > *so_far => {
                *so_far = increment.load_factor;
                value(values)
            }
            ResponseLocation::End => value(values),
            _ if self.found.is_some() => None,
            ResponseLocation::LargestLoad { .. } => None,
            ResponseLocation::FirstLimit => LimitLoad::at(increment).and_then(|_| value(values)),
            ResponseLocation::FirstContactChange => {
                let changes = matches!(increment.point.kind, PointKind::ContactChange | PointKind::NonsmoothLimit);
                changes.then(|| value(values)).flatten()
            }
            ResponseLocation::FirstSlip => {
                let slips = increment.contacts.iter().any(|contact| contact.status == Status::Slip);
                slips.then(|| value(before.unwrap_or(values))).flatten()
            }
            ResponseLocation::Reached { column, number } => reached(*column, *number, self.column, values, before),
        };
        if here.is_some() {
            self.found = here;
        }
    }
}

/// The value in a column where another one reaches a number between two increments, or at the second.
fn reached(at: usize, number: f64, column: usize, values: &[Value], before: Option<&[Value]>) -> Option<Value> {
    let read = |values: &[Value], column: usize| values.get(column).and_then(Value::as_f64);
    let after = read(values, at)?;
    if after == number {
        return values.get(column).cloned();
    }
    let before = before?;
    let (from, passed) = (read(before, at)?, read(before, at)? < number);
    if from == number || passed == (after < number) {
        return None;
    }
    let part = (number - from) / (after - from);
    match (read(before, column), read(values, column)) {
        (Some(first), Some(last)) => Some(Value::from(first + part * (last - first))),
        // A word, such as a status, holds until it changes.
        _ => before.get(column).cloned(),
    }
}
