//! A template for requests that differ in a few places; the common parts are read and written once.

use crate::model::decode;
use crate::model::input::error::InputErrors;
use crate::model::request::{JobRequest, Model};
use serde_json::{Map, Value};

/// A document, split into the members of its model and the other members of its root.
#[derive(Debug, Clone)]
pub(super) struct Template {
    members: Vec<Member>,
    /// The request with the first values, if it can be read; apart from the varied places all requests are equal to it.
    first: Option<JobRequest>,
    /// Whether a name may stand for a set, a surface or a part of a mesh: parts of the model then depend on others.
    has_names_of_parts: bool,
}

#[derive(Debug, Clone)]
struct Member {
    name: String,
    /// A member of the model, not of the root.
    of_model: bool,
    content: Content,
}

#[derive(Debug, Clone)]
enum Content {
    /// JSON text without varied places.
    Common(String),
    /// The value of the member, and the varied places within it: the number of the value, and the rest of its pointer.
    Varied(Value, Vec<(usize, String)>),
}

impl Template {
    /// The template of a document with varied values, which [`fill`](Self::fill) inserts at JSON pointers, each with the number
    /// of its value; `first` are valid examples of the values.
    pub fn new(mut document: Value, places: &[(usize, String)], first: &[Value]) -> Self {
        // Missing members follow in the order in which they are inserted.
        for (number, pointer) in places {
            put(&mut document, pointer, first.get(*number).cloned().unwrap_or_default());
        }
        let mut members = Vec::new();
        let root = if let Value::Object(root) = document { root } else { Map::new() };
        for (name, value) in root {
            match value {
                Value::Object(model)
                    if name == "model" && !model.is_empty() && places.iter().all(|(_, place)| place != "/model") =>
                {
                    for (name, value) in model {
                        let content = Content::new(value, &format!("/model/{}", escaped(&name)), places);
                        members.push(Member { name, of_model: true, content });
                    }
                }
                value => {
                    let content = Content::new(value, &format!("/{}", escaped(&name)), places);
                    members.push(Member { name, of_model: false, content });
                }
            }
        }
        let mut template = Self { members, first: None, has_names_of_parts: false };
        let text = template.text(first, true);
        template.has_names_of_parts = ["\"@", "\"mesh\"", "\"surface\""].iter().any(|mark| text.contains(mark));
        template.first = decode::decode(text.as_bytes()).ok();
        template
    }

    /// The document with these values, and the decoded request.
    ///
    /// # Errors
    /// As for [`decode::decode`].
    pub fn fill(&self, values: &[Value]) -> (String, Result<JobRequest, InputErrors>) {
        let text = self.text(values, true);
        let request = self.read(values).map_or_else(|| decode::decode(text.as_bytes()), Ok);
        (text, request)
    }

    /// The request, composed of its common and its varied parts; `None` if this is not possible, for example because of mistakes.
    fn read(&self, values: &[Value]) -> Option<JobRequest> {
        let first = self.first.as_ref().filter(|_| !self.has_names_of_parts)?;
        let differing = decode::decode(self.text(values, false).as_bytes()).ok()?;
        let JobRequest { model: other, analysis } = differing;
        let mut model = first.model.clone();
        for member in self.members.iter().filter(|member| member.of_model && !member.content.is_common()) {
            let Model { name, units, dimension, nodes, supports, elements, obstacles, contacts, stages, .. } = &other;
            let Model { materials, surfaces, sets, .. } = &other;
            match member.name.as_str() {
                "name" => model.name.clone_from(name),
                "units" => model.units.clone_from(units),
                "dimension" => model.dimension = *dimension,
                "nodes" => model.nodes.clone_from(nodes),
                "supports" => model.supports.clone_from(supports),
                "materials" => model.materials.clone_from(materials),
                "elements" => model.elements.clone_from(elements),
                "surfaces" => model.surfaces.clone_from(surfaces),
                "sets" => model.sets.clone_from(sets),
                "obstacles" => model.obstacles.clone_from(obstacles),
                "contacts" => model.contacts.clone_from(contacts),
                "stages" => model.stages.clone_from(stages),
                _ => return None,
            }
        }
        Some(JobRequest { model, analysis })
    }

    /// The text of the document; unless `whole`, the common members of the model are empty.
    fn text(&self, values: &[Value], whole: bool) -> String {
        let mut text = String::from("{");
        let mut in_model = false;
        for member in &self.members {
            if in_model && !member.of_model {
                text.push('}');
            }
            if text.len() > 1 && !text.ends_with('{') {
                text.push(',');
            }
            if member.of_model && !in_model {
                text.push_str("\"model\":{");
            }
            in_model = member.of_model;
            text.push_str(&Value::from(member.name.as_str()).to_string());
            text.push(':');
            match &member.content {
                Content::Common(_) if member.of_model && !whole && empty(&member.name).is_some() => {
                    text.push_str(empty(&member.name).unwrap_or_default());
                }
                Content::Common(common) => text.push_str(common),
                Content::Varied(value, places) => {
                    let mut value = value.clone();
                    for (index, rest) in places {
                        put(&mut value, rest, values.get(*index).cloned().unwrap_or_default());
                    }
                    text.push_str(&value.to_string());
                }
            }
        }
        text.push_str(if in_model { "}}" } else { "}" });
        text
    }
}

impl Content {
    /// Of the member at that pointer.
    fn new(value: Value, at: &str, places: &[(usize, String)]) -> Self {
        let rest = |pointer: &str| {
            let rest = pointer.strip_prefix(at)?;
            (rest.is_empty() || rest.starts_with('/')).then(|| rest.to_owned())
        };
        let places: Vec<(usize, String)> =
            places.iter().filter_map(|(number, pointer)| Some((*number, rest(pointer)?))).collect();
        if places.is_empty() { Self::Common(value.to_string()) } else { Self::Varied(value, places) }
    }

    fn is_common(&self) -> bool {
        matches!(self, Self::Common(_))
    }
}

/// What a large member of a model is like with nothing in it.
fn empty(member: &str) -> Option<&'static str> {
    match member {
        "nodes" | "supports" | "obstacles" => Some("{}"),
        "elements" | "contacts" | "stages" => Some("[]"),
        _ => None,
    }
}

/// A name as a step of a JSON pointer.
pub(super) fn escaped(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}

/// The place of an item as RFC 6901 writes it: digits, and no zero before others.
pub(super) fn item(name: &str) -> Option<usize> {
    let is_plain = name.bytes().all(|byte| byte.is_ascii_digit()) && (name == "0" || !name.starts_with('0'));
    if is_plain { name.parse().ok() } else { None }
}

/// Inserts a value at a place: members of objects may be missing, items of arrays not.
fn put(document: &mut Value, pointer: &str, value: Value) {
    let mut at = document;
    for step in pointer.split('/').skip(1) {
        let name = step.replace("~1", "/").replace("~0", "~");
        if at.is_null() {
            *at = Value::Object(Map::new());
        }
        at = match at {
            Value::Object(members) => members.entry(name).or_insert(Value::Null),
            Value::Array(items) => match item(&name).and_then(|index| items.get_mut(index)) {
                Some(item) => item,
                None => return,
            },
            _ => return,
        };
    }
    *at = value;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::scenes;
    use serde_json::json;

    /// The document as it is with each value put in it by itself.
    fn plainly(document: &Value, pointers: &[&str], values: &[Value]) -> String {
        let mut document = document.clone();
        pointers.iter().zip(values).for_each(|(pointer, value)| put(&mut document, pointer, value.clone()));
        document.to_string()
    }

    #[test]
    fn what_is_filled_in_is_what_reading_the_whole_gives() {
        let mut document: Value = serde_json::from_str(scenes::find("arch-type-truss").unwrap().request).unwrap();
        document["analysis"] = json!({"max_increments": 5});
        let (mut filled, mut refused) = (0, 0);
        let sets: [(&[&str], Vec<Vec<Value>>); 9] = [
            (&["/model/contacts/0/friction"], vec![vec![json!(0.1)], vec![json!(0.7)], vec![json!("x")]]),
            (&["/model/name"], vec![vec![json!("a/b~\"c")], vec![json!(7)]]),
            (&["/model/dimension"], vec![vec![json!(2)], vec![json!(3)]]),
            (
                &["/model/nodes/b1", "/model/nodes/new"],
                vec![vec![json!([-1, 0.3]), json!([0, 9])], vec![json!([0]), json!(0)]],
            ),
            (
                &["/model/stages", "/analysis/arc_length/max"],
                vec![vec![json!([]), json!(0.2)], vec![json!([{"a": 1}]), json!(0.1)]],
            ),
            (&["/analysis"], vec![vec![json!({"max_increments": 3})], vec![json!(null)]]),
            (
                &["/model/elements/0", "/model/supports/b0", "/model/obstacles/floor/point"],
                vec![vec![
                    json!({"kind": "bar", "nodes": ["b0", "b1"], "axial_stiffness": 2}),
                    json!(["x"]),
                    json!([0, 1]),
                ]],
            ),
            (&["/model/unknown", "/analysis/mpec/certificate"], vec![vec![json!(1), json!("skip")]]),
            (
                &["/model/sets", "/model/supports"],
                vec![
                    vec![json!({"foot": {"nodes": ["b0"]}}), json!({"@foot": ["x", "y"]})],
                    vec![json!({"foot": {"nodes": ["b0", "b1"]}}), json!({"@foot": ["x", "y"]})],
                ],
            ),
        ];
        for root in ["model", "analysis"] {
            for (pointers, values) in &sets {
                for first in values {
                    let places: Vec<_> = pointers.iter().map(|pointer| (*pointer).to_owned()).enumerate().collect();
                    let template = Template::new(document.clone(), &places, first);
                    for values in values {
                        let (text, request) = template.fill(values);
                        let whole = plainly(&document, pointers, values);
                        assert_eq!(serde_json::from_str::<Value>(&text).unwrap().to_string(), text);
                        assert_eq!(text, whole, "{pointers:?}");
                        let expected = decode::decode(whole.as_bytes());
                        match (&request, &expected) {
                            (Ok(request), Ok(expected)) => assert_eq!(request, expected),
                            (Err(found), Err(expected)) => assert_eq!(format!("{found:?}"), format!("{expected:?}")),
                            _ => panic!("{pointers:?}: {request:?}, {expected:?}"),
                        }
                        filled += usize::from(template.read(values).is_some());
                        refused += usize::from(expected.is_err());
                    }
                }
            }
            // The same with the analysis before the model.
            let object = document.as_object_mut().unwrap();
            let moved = object.shift_remove(root).unwrap();
            object.insert(root.to_owned(), moved);
        }
        assert!(filled > 20 && refused > 20, "{filled} {refused}");
    }
}
