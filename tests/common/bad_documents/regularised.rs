//! Parameters of the regularised method.

use serde_json::{Value, json};

use super::{BadDocument, elsewhere};

pub fn regularised() -> Vec<BadDocument> {
    let spoilt = |name, pointer, parameters: Value, detail| {
        let method = ("/analysis/method", json!("regularised"));
        elsewhere(name, &[method, ("/analysis/regularised", parameters)], pointer, detail)
    };
    let place = "/analysis/regularised";
    vec![
        elsewhere(
            "regularised parameters of another method",
            &[(place, json!({"normal_penalty": 1e4}))],
            place,
            "which is not the one chosen",
        ),
        spoilt("regularised as a number", place, json!(1e4), "a regularisation, an object, is expected"),
        spoilt(
            "unknown regularised parameter",
            "/analysis/regularised/normal_penality",
            json!({"normal_penality": 1e4}),
            "did you mean `normal_penalty`?",
        ),
        spoilt(
            "no normal penalty",
            "/analysis/regularised/normal_penalty",
            json!({"normal_penalty": 0}),
            "above 0 is expected",
        ),
        spoilt(
            "negative tangential penalty",
            "/analysis/regularised/tangential_penalty",
            json!({"tangential_penalty": -1e4}),
            "above 0 is expected",
        ),
        spoilt(
            "no desired iterations",
            "/analysis/regularised/desired_iterations",
            json!({"desired_iterations": 0}),
            "1 or more",
        ),
        spoilt(
            "absurd desired iterations",
            "/analysis/regularised/desired_iterations",
            json!({"desired_iterations": 1_000_000}),
            "at most 1000",
        ),
        spoilt("tolerance of 1", "/analysis/regularised/tolerance", json!({"tolerance": 1}), "between 0 and 1"),
        spoilt("no tolerance", "/analysis/regularised/tolerance", json!({"tolerance": 0}), "above 0 is expected"),
        spoilt(
            "negative load weight",
            "/analysis/regularised/load_weight",
            json!({"load_weight": -1}),
            "0 or more is expected",
        ),
        spoilt(
            "unknown load sign",
            "/analysis/regularised/load_sign",
            json!({"load_sign": "determinate"}),
            "did you mean `determinant`?",
        ),
    ]
}
