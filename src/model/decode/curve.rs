//! Reads what a curve of limit points follows.

use crate::model::decode::reader::{Fields, Input, count, number, numbers, text};
use crate::model::input::mistakes::Mistakes;
use crate::model::request::curve::CurveSettings;

const CURVE: Fields = Fields {
    what: "what a curve follows",
    known: &["parameter", "range", "step", "limit_point", "increment"],
    later: &[],
};

pub(super) fn curve(input: &Input, mistakes: &mut Mistakes) -> Option<CurveSettings> {
    let object = input.object(&CURVE, mistakes)?;
    let parameter = object.required("parameter", mistakes, text);
    let range = object.required("range", mistakes, range);
    let step = object.optional("step", mistakes, number);
    let limit_point = object.optional("limit_point", mistakes, count);
    let increment = object.optional("increment", mistakes, count);
    if input.has("limit_point") && input.has("increment") {
        return input
            .note("`limit_point` and `increment` both say which limit point is meant; leave one out", mistakes);
    }
    Some(CurveSettings {
        parameter: parameter?,
        range: range?,
        step: step?,
        limit_point: limit_point?,
        increment: increment?,
    })
}

fn range(input: &Input, mistakes: &mut Mistakes) -> Option<[f64; 2]> {
    let found = numbers(input, mistakes)?;
    match found[..] {
        [from, to] if from < to => Some([from, to]),
        _ => {
            let listed: Vec<String> = found.iter().take(3).map(f64::to_string).collect();
            let detail =
                format!("found [{}]; two numbers, the second larger than the first, are expected", listed.join(", "));
            input.note(&detail, mistakes)
        }
    }
}
