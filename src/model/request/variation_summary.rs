//! What lists show of what a sweep varies: the places, how many values each has, and as many of them as are short.

use crate::model::request::sweep::{Combine, Variation};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Bytes of the places that are shown, with their values, past the first; and of the values of one place.
const PLACES: usize = 2048;
const VALUES: usize = 128;
/// The names of a place's members.
const NAMES: usize = 48;

/// What a sweep varies, shortened to some kilobytes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(default)]
pub struct VariationSummary {
    /// The first ones.
    pub parameters: Vec<ParameterSummary>,
    /// How many there are in all.
    pub parameter_count: u64,
    pub combine: Combine,
}

/// One place and the first values that are put there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "server", schema(as = SweepParameterSummary))]
pub struct ParameterSummary {
    /// JSON pointer into the request.
    pub pointer: String,
    /// The first ones, as many as are short; they may be none.
    pub values: Vec<Value>,
    /// How many there are in all.
    #[serde(default)]
    pub value_count: u64,
}

impl VariationSummary {
    /// Of a variation.
    pub fn of(variation: &Variation) -> Self {
        let (mut parameters, mut left) = (Vec::new(), PLACES);
        for parameter in &variation.parameters {
            let (mut values, mut room) = (Vec::new(), VALUES);
            for value in &parameter.values {
                let Some(rest) = bytes(value, room).and_then(|bytes| room.checked_sub(bytes)) else { break };
                room = rest;
                values.push(value.clone());
            }
            let taken = NAMES + parameter.pointer.len() + VALUES - room;
            if taken > left && !parameters.is_empty() {
                break;
            }
            left = left.saturating_sub(taken);
            let value_count = parameter.values.len() as u64;
            parameters.push(ParameterSummary { pointer: parameter.pointer.clone(), values, value_count });
        }
        Self { parameters, parameter_count: variation.parameters.len() as u64, combine: variation.combine }
    }

    /// As it is stored; of sweeps that were stored whole, of the whole.
    ///
    /// # Errors
    /// It is neither.
    pub fn read(text: &str) -> serde_json::Result<Self> {
        let summary: Self = serde_json::from_str(text)?;
        if summary.parameter_count > 0 || summary.parameters.is_empty() {
            return Ok(summary);
        }
        Ok(Self::of(&serde_json::from_str(text)?))
    }
}

/// Of a value as JSON; none of one that is plainly longer than there is room for, so that nothing long is written.
fn bytes(value: &Value, room: usize) -> Option<usize> {
    match value {
        Value::String(text) if text.len() > room => None,
        Value::Array(items) if items.len() > room => None,
        Value::Object(members) if members.len() > room => None,
        Value::Array(items) => items.iter().try_fold(2, |sum, item| Some(sum + 1 + bytes(item, room)?)),
        Value::Object(members) => {
            members.iter().try_fold(2, |sum, (name, item)| Some(sum + name.len() + 4 + bytes(item, room)?))
        }
        plain => Some(plain.to_string().len() + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::request::sweep::SweepParameter;
    use serde_json::json;

    fn variation(parameters: usize, values: Value) -> Variation {
        let values = values.as_array().cloned().unwrap_or_default();
        let parameter =
            |place| SweepParameter { pointer: format!("/model/contacts/{place}/friction"), values: values.clone() };
        Variation {
            parameters: (0..parameters).map(parameter).collect(),
            combine: Combine::List,
            responses: Default::default(),
            refine: 0,
            response_units: Default::default(),
            warnings: Vec::new(),
        }
    }

    #[test]
    fn a_short_one_is_whole_and_a_long_one_a_few_kilobytes() {
        let short = VariationSummary::of(&variation(2, json!([0.1, "auto", null, [1, {"a": true}]])));
        assert_eq!(short.parameters[1].values, [json!(0.1), json!("auto"), Value::Null, json!([1, {"a": true}])]);
        assert_eq!((short.parameters[1].value_count, short.parameter_count), (4, 2));
        let long = json!((0..100_000).map(|number| number as f64 * 1e-7).collect::<Vec<_>>());
        for large in [
            variation(1, long.clone()),
            variation(5_000, json!([0.1, 0.2])),
            variation(2, json!(["x".repeat(1 << 20)])),
            variation(2, json!([[[long]]])),
        ] {
            let summary = VariationSummary::of(&large);
            assert_eq!(summary.parameter_count, large.parameters.len() as u64);
            assert_eq!(summary.parameters[0].value_count, large.parameters[0].values.len() as u64);
            assert!(serde_json::to_string(&summary).unwrap().len() < 2 * PLACES);
        }
    }

    #[test]
    fn sweeps_that_were_stored_whole_are_read_too() {
        let whole = variation(2, json!([0.1, 0.2]));
        let summary = VariationSummary::of(&whole);
        assert_eq!(VariationSummary::read(&serde_json::to_string(&whole).unwrap()).unwrap(), summary);
        assert_eq!(VariationSummary::read(&serde_json::to_string(&summary).unwrap()).unwrap(), summary);
        assert_eq!(VariationSummary::read("{}").unwrap(), VariationSummary::default());
    }
}
