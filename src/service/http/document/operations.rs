//! What the calls' own descriptions leave out: problems, tags, examples, and where an answer leads.

use crate::check::scenes;
use serde_json::{Value, json};
use utoipa::openapi::link::Link;
use utoipa::openapi::path::{Operation, Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::schema::SchemaType;
use utoipa::openapi::{ContentBuilder, Header, Object, Ref, RefOr, ResponseBuilder, Schema, Type};

/// Calls whose answers carry a tag where what they tell of is finished.
const TAGGED: [&str; 15] = [
    "get_job",
    "get_request",
    "list_increments",
    "get_columns",
    "get_exact_path",
    "get_path_csv",
    "get_study",
    "get_study_table_csv",
    "get_study_table_txt",
    "get_study_picture",
    "get_sweep",
    "list_sweep_rows",
    "get_sweep_table_csv",
    "get_sweep_table_txt",
    "get_sweep_picture",
];
/// What can be asked of a job that has been queued, by its id; of a study likewise.
const OF_A_JOB: [&str; 11] = [
    "get_job",
    "get_request",
    "list_increments",
    "get_columns",
    "get_exact_path",
    "get_path_csv",
    "stream_increments",
    "follow_direction",
    "cancel_job",
    "retry_job",
    "delete_job",
];
const OF_A_STUDY: [&str; 7] = [
    "get_study",
    "stream_study",
    "get_study_table_csv",
    "get_study_table_txt",
    "get_study_picture",
    "cancel_study",
    "delete_study",
];
const OF_A_SWEEP: [&str; 8] = [
    "get_sweep",
    "list_sweep_rows",
    "stream_sweep",
    "get_sweep_table_csv",
    "get_sweep_table_txt",
    "get_sweep_picture",
    "cancel_sweep",
    "delete_sweep",
];
/// The scene that examples are of.
const EXAMPLE: &str = "klarbring";

pub(super) fn complete(operation: &mut Operation) -> serde_json::Result<()> {
    let content = ContentBuilder::new().schema(Some(Ref::from_schema_name("Problem"))).build();
    let problem = ResponseBuilder::new().description("A problem.").content("application/problem+json", content).build();
    operation.responses.responses.insert("default".to_owned(), RefOr::T(problem));
    for parameter in operation.parameters.iter_mut().flatten() {
        if let RefOr::T(parameter) = parameter {
            never_null(parameter);
        }
    }
    let id = operation.operation_id.clone().unwrap_or_default();
    if TAGGED.contains(&id.as_str()) {
        tagged(operation);
    }
    match id.as_str() {
        "submit_job" => {
            leads_to(operation, &OF_A_JOB);
            exemplified(operation, scene()?);
        }
        "submit_study" => {
            leads_to(operation, &OF_A_STUDY);
            let mut study = scene()?;
            study["study"] = json!({"methods": ["auto", "mpec"], "arc_lengths": [0.5, 0.25], "repeats": 1});
            exemplified(operation, study);
        }
        "submit_sweep" => {
            leads_to(operation, &OF_A_SWEEP);
            let mut sweep = scene()?;
            sweep["sweep"] = json!({"replace": {"/model/contacts/0/friction": [0.1, 0.2]}, "combine": "grid"});
            exemplified(operation, sweep);
        }
        "follow_direction" => {
            leads_to(operation, &OF_A_JOB);
            exemplified(operation, json!({"increment": 7, "direction": 0, "max_increments": 6}));
        }
        _ => {}
    }
    Ok(())
}

fn scene() -> serde_json::Result<Value> {
    serde_json::from_str(scenes::find(EXAMPLE).map_or("{}", |scene| scene.request))
}

/// A parameter that is left out is not there: `null` is no value of it.
fn never_null(parameter: &mut Parameter) {
    match &mut parameter.schema {
        Some(RefOr::T(Schema::Object(object))) => {
            if let SchemaType::Array(types) = &mut object.schema_type {
                types.retain(|known| *known != Type::Null);
                if let [only] = types.as_slice() {
                    object.schema_type = SchemaType::Type(only.clone());
                }
            }
        }
        Some(RefOr::T(Schema::OneOf(choice))) => {
            choice.items.retain(|item| {
                !matches!(item, RefOr::T(Schema::Object(object)) if object.schema_type == SchemaType::Type(Type::Null))
            });
            if let [only] = choice.items.as_slice() {
                parameter.schema = Some(only.clone());
            }
        }
        _ => {}
    }
}

/// What tags add to a call.
fn tagged(operation: &mut Operation) {
    let text = || Some(Object::with_type(Type::String));
    let tag = Header::builder().schema(text()).description(Some("Of a finished one.")).build();
    if let Some(RefOr::T(found)) = operation.responses.responses.get_mut("200") {
        found.headers.insert("ETag".to_owned(), tag.into());
    }
    let known = ResponseBuilder::new().description("The client has it already.").build();
    operation.responses.responses.insert("304".to_owned(), RefOr::T(known));
    let asked = ParameterBuilder::new()
        .name("If-None-Match")
        .parameter_in(ParameterIn::Header)
        .description(Some("Tags of what the client has."))
        .schema(text())
        .build();
    operation.parameters.get_or_insert_default().push(asked.into());
}

fn leads_to(operation: &mut Operation, calls: &[&str]) {
    let Some(RefOr::T(queued)) = operation.responses.responses.get_mut("202") else { return };
    for call in calls {
        let link = Link::builder().operation_id(*call).parameter("id", "$response.body#/id").build();
        queued.links.insert((*call).to_owned(), link.into());
    }
}

fn exemplified(operation: &mut Operation, example: Value) {
    let Some(RefOr::T(body)) = &mut operation.request_body else { return };
    if let Some(RefOr::T(content)) = body.content.get_mut("application/json") {
        content.example = Some(example);
    }
}
