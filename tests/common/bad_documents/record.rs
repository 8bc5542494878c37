//! What is to be kept of the increments.

use serde_json::{Value, json};

use super::{BadDocument, elsewhere};

pub fn record() -> Vec<BadDocument> {
    let spoilt =
        |name, pointer, record: Value, detail| elsewhere(name, &[("/analysis/record", record)], pointer, detail);
    vec![
        spoilt("a record as a list", "/analysis/record", json!(["tip"]), "a record, an object, is expected"),
        spoilt("unknown part of a record", "/analysis/record/node", json!({"node": ["tip"]}), "did you mean `nodes`?"),
        spoilt("recorded nodes as text", "/analysis/record/nodes", json!({"nodes": "tip"}), "an array"),
        spoilt(
            "an unknown recorded node",
            "/analysis/record/nodes/1",
            json!({"nodes": ["tip", "pn"]}),
            "did you mean `pin`?",
        ),
        spoilt("a node recorded twice", "/analysis/record/nodes/1", json!({"nodes": ["tip", "tip"]}), "twice"),
        spoilt(
            "an unknown range of contacts",
            "/analysis/record/contacts",
            json!({"contacts": "in_rech"}),
            "did you mean `in_reach`?",
        ),
        spoilt(
            "recorded contacts as a number",
            "/analysis/record/contacts",
            json!({"contacts": 3}),
            "\"all\", \"in_reach\" or a list of contacts",
        ),
        spoilt(
            "a recorded contact as text",
            "/analysis/record/contacts/0",
            json!({"contacts": ["tip"]}),
            "a recorded contact, an object, is expected",
        ),
        spoilt(
            "a recorded contact without obstacle",
            "/analysis/record/contacts/0",
            json!({"contacts": [{"node": "tip"}]}),
            "the field `obstacle` is missing",
        ),
        spoilt(
            "a recorded contact's unknown node",
            "/analysis/record/contacts/0/node",
            json!({"contacts": [{"node": "top", "obstacle": "floor"}]}),
            "did you mean `tip`?",
        ),
        spoilt(
            "a recorded contact's unknown obstacle",
            "/analysis/record/contacts/0/obstacle",
            json!({"contacts": [{"node": "tip", "obstacle": "flor"}]}),
            "did you mean `floor`?",
        ),
        spoilt(
            "a recorded contact that is none",
            "/analysis/record/contacts/0",
            json!({"contacts": [{"node": "pin", "obstacle": "floor"}]}),
            "there is no contact of `pin` with `floor`",
        ),
        spoilt(
            "a contact recorded twice",
            "/analysis/record/contacts/1",
            json!({"contacts": [{"node": "tip", "obstacle": "floor"}, {"node": "tip", "obstacle": "floor"}]}),
            "twice",
        ),
        spoilt("every 0th", "/analysis/record/every", json!({"every": 0}), "1 or more is expected"),
        spoilt("directions as a number", "/analysis/record/directions", json!({"directions": 1}), "true or false"),
        elsewhere("keep all as a number", &[("/analysis/keep_all", json!(1))], "/analysis/keep_all", "true or false"),
        elsewhere(
            "explored, but no directions recorded",
            &[
                ("/analysis/explore", json!({"depth": 1, "max_jobs": 1})),
                ("/analysis/record", json!({"directions": false})),
            ],
            "/analysis/record/directions",
            "`explore` follows directions",
        ),
    ]
}
