//! A sweep: one model, and values put in places of it, a job each, as `POST /v1/sweeps` and `arcslip sweep` take it.

use crate::model::request::response::Response;
use crate::model::request::{Analysis, Model};
use crate::result::plan::Warning;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A model, how to trace it, and what is put in its places. Members in whose place something is put may be left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct SweepRequest {
    pub model: Model,
    #[serde(default)]
    pub analysis: Analysis,
    pub sweep: Replacements,
}

/// What is put where.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct Replacements {
    /// JSON pointers (RFC 6901) into this document, below `/model` or `/analysis`, each with the values to put there, such as
    /// `{"/model/contacts/0/friction": [0.1, 0.2]}`. A step `*` stands for every item of a list or member of an object.
    pub replace: IndexMap<String, Vec<Value>>,
    #[serde(default)]
    pub combine: Combine,
    /// What is told of each path, by a name of one's own.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub responses: IndexMap<String, Response>,
    /// Further runs at most, each in the middle of the two values of the only parameter between which the first response, or
    /// the first limit load, changes most; chosen when the runs before them have ended.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[cfg_attr(feature = "server", schema(maximum = 100_000))]
    pub refine: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_zero(number: &u64) -> bool {
    *number == 0
}

/// How values of several places meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Combine {
    /// Each with each; those of the last place change fastest.
    #[default]
    Grid,
    /// The first of each, then the second of each and so on: all lists are equally long.
    List,
}

/// One place and what is put there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "server", schema(as = SweepParameter))]
pub struct SweepParameter {
    /// JSON pointer into the request.
    pub pointer: String,
    pub values: Vec<Value>,
}

/// What is varied, how, and what is told of each path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
pub struct Variation {
    /// In the order of the request.
    pub parameters: Vec<SweepParameter>,
    pub combine: Combine,
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub responses: IndexMap<String, Response>,
    /// Further runs at most, where the first response changes most.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub refine: u64,
    /// The labels of the units of responses that have one, where the model names its units; by the names of the responses.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub response_units: IndexMap<String, String>,
    /// What is valid in its runs and may be a mistake.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Warning>,
}

impl Variation {
    /// The name of a response with the label of its unit, where it has one.
    pub fn headed(&self, response: &str) -> String {
        self.response_units.get(response).map_or_else(|| response.to_owned(), |unit| format!("{response} [{unit}]"))
    }

    /// Which of its values each parameter has in a run.
    pub(crate) fn choices(&self, run: u64) -> Vec<usize> {
        let mut left = usize::try_from(run).unwrap_or(usize::MAX);
        let mut choices: Vec<usize> = self
            .parameters
            .iter()
            .rev()
            .map(|parameter| match self.combine {
                Combine::List => left,
                Combine::Grid => {
                    let choice = left % parameter.values.len().max(1);
                    left /= parameter.values.len().max(1);
                    choice
                }
            })
            .collect();
        choices.reverse();
        choices
    }

    /// The values of a run, in the order of the parameters.
    pub fn values(&self, run: u64) -> Vec<Value> {
        let chosen = self.parameters.iter().zip(self.choices(run));
        chosen.map(|(parameter, choice)| parameter.values.get(choice).cloned().unwrap_or_default()).collect()
    }
}
