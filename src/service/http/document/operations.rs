//! What the descriptions of the calls leave out because many calls share it: the id, the idempotency key and the address of
//! a resource, problems, entity tags, links and examples.

use crate::check::scenes;
use crate::service::http::input::extract::LONGEST_KEY;
use serde_json::{Value, json};
use utoipa::openapi::link::Link;
use utoipa::openapi::path::{Operation, Parameter, ParameterBuilder, ParameterIn};
use utoipa::openapi::schema::SchemaType;
use utoipa::openapi::{
    ContentBuilder, Header, KnownFormat, Object, ObjectBuilder, Ref, RefOr, Required, ResponseBuilder, Schema,
    SchemaFormat, Type,
};

/// The resources: the beginning of their addresses, and their names.
const RESOURCES: [(&str, &str); 4] =
    [("/v1/jobs", "job"), ("/v1/studies", "study"), ("/v1/sweeps", "sweep"), ("/v1/curves", "curve")];
/// Calls that queue a new resource.
const QUEUEING: [&str; 6] =
    ["submit_job", "submit_study", "submit_sweep", "submit_curve", "follow_direction", "continue_job"];
/// The call that queues a known resource again.
const QUEUEING_AGAIN: &str = "retry_job";

/// Calls whose answers carry an entity tag once their resource has ended.
const TAGGED: [&str; 24] = [
    "get_job",
    "get_request",
    "list_increments",
    "get_columns",
    "get_exact_path",
    "get_path_csv",
    "get_results_pvd",
    "get_results_parquet",
    "get_path_picture",
    "get_path_picture_png",
    "get_study",
    "get_study_table_csv",
    "get_study_table_txt",
    "get_study_picture",
    "get_sweep",
    "list_sweep_rows",
    "get_sweep_table_csv",
    "get_sweep_table_txt",
    "get_sweep_picture",
    "get_curve",
    "list_curve_rows",
    "get_curve_table_csv",
    "get_curve_table_txt",
    "get_curve_picture",
];
/// The calls that take the id of a job that has been queued.
const OF_A_JOB: [&str; 16] = [
    "get_job",
    "get_request",
    "list_increments",
    "get_columns",
    "get_exact_path",
    "get_path_csv",
    "get_results_pvd",
    "get_results_parquet",
    "get_path_picture",
    "get_path_picture_png",
    "stream_increments",
    "follow_direction",
    "continue_job",
    "cancel_job",
    "retry_job",
    "delete_job",
];
/// The calls that take the id of a study.
const OF_A_STUDY: [&str; 7] = [
    "get_study",
    "stream_study",
    "get_study_table_csv",
    "get_study_table_txt",
    "get_study_picture",
    "cancel_study",
    "delete_study",
];
/// The calls that take the id of a sweep.
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
/// The calls that take the id of a curve.
const OF_A_CURVE: [&str; 8] = [
    "get_curve",
    "list_curve_rows",
    "stream_curve",
    "get_curve_table_csv",
    "get_curve_table_txt",
    "get_curve_picture",
    "cancel_curve",
    "delete_curve",
];
/// Answers by operation, status and media type, and a `problem`; written by a test.
const EXAMPLES: &str = include_str!("examples.json");
/// The built-in scene in the examples.
const EXAMPLE: &str = "klarbring";
/// What varies in the examples.
const FRICTION: &str = "/model/contacts/0/friction";

/// Completes the description of the operation at an address.
pub(super) fn complete(path: &str, operation: &mut Operation) -> serde_json::Result<()> {
    let content = ContentBuilder::new().schema(Some(Ref::from_schema_name("Problem"))).build();
    let problem = ResponseBuilder::new().description("A problem.").content("application/problem+json", content).build();
    operation.responses.responses.insert("default".to_owned(), RefOr::T(problem));
    for parameter in operation.parameters.iter_mut().flatten() {
        if let RefOr::T(parameter) = parameter {
            never_null(parameter);
        }
    }
    let id = operation.operation_id.clone().unwrap_or_default();
    if let Some((_, resource)) = RESOURCES.iter().find(|(address, _)| path.starts_with(address)) {
        if path.contains("{id}") {
            identified(operation, resource);
        }
        if QUEUEING.contains(&id.as_str()) {
            repeatable(operation, resource);
        }
        if QUEUEING.contains(&id.as_str()) || id == QUEUEING_AGAIN {
            located(operation, resource);
        }
    }
    if TAGGED.contains(&id.as_str()) {
        tagged(operation);
    }
    answered(operation, &id)?;
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
            sweep["sweep"] = json!({"replace": {FRICTION: [1.5, 2.0]}, "combine": "grid"});
            exemplified(operation, sweep);
        }
        "submit_curve" => {
            leads_to(operation, &OF_A_CURVE);
            let mut curve = scene()?;
            curve["curve"] = json!({"parameter": FRICTION, "range": [1.4, 1.8], "step": 0.1});
            exemplified(operation, curve);
        }
        "continue_job" => {
            leads_to(operation, &OF_A_CURVE);
            exemplified(operation, json!({"parameter": FRICTION, "range": [1.4, 1.8], "step": 0.1}));
        }
        "follow_direction" => {
            leads_to(operation, &OF_A_JOB);
            exemplified(operation, json!({"increment": 7, "direction": 0, "max_increments": 6}));
        }
        _ => {}
    }
    Ok(())
}

/// Adds what the service has answered to such a call.
fn answered(operation: &mut Operation, id: &str) -> serde_json::Result<()> {
    let mut examples: Value = serde_json::from_str(EXAMPLES)?;
    for (status, response) in &mut operation.responses.responses {
        let RefOr::T(response) = response else { continue };
        for (media_type, content) in &mut response.content {
            let RefOr::T(content) = content else { continue };
            let example =
                if status == "default" { &mut examples["problem"] } else { &mut examples[id][status][media_type] };
            content.example = Some(example.take()).filter(|example| !example.is_null());
        }
    }
    Ok(())
}

fn scene() -> serde_json::Result<Value> {
    serde_json::from_str(scenes::find(EXAMPLE).map_or("{}", |scene| scene.request))
}

/// Removes `null` from the values of a parameter: an optional parameter is left out instead.
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

/// Adds the id of the resource in the address, unless the call describes the id itself.
fn identified(operation: &mut Operation, resource: &str) {
    let parameters = operation.parameters.get_or_insert_default();
    let is_id = |parameter: &RefOr<Parameter>| matches!(parameter, RefOr::T(parameter) if parameter.name == "id");
    if parameters.iter().any(is_id) {
        return;
    }
    let uuid =
        ObjectBuilder::new().schema_type(Type::String).format(Some(SchemaFormat::KnownFormat(KnownFormat::Uuid)));
    let id = ParameterBuilder::new()
        .name("id")
        .parameter_in(ParameterIn::Path)
        .required(Required::True)
        .description(Some(format!("The {resource}'s id.")))
        .schema(Some(uuid.build()))
        .build();
    parameters.insert(0, id.into());
}

/// Adds the idempotency key of a call that queues a resource.
fn repeatable(operation: &mut Operation, resource: &str) {
    let text = ObjectBuilder::new().schema_type(Type::String);
    let text = text.min_length(Some(1)).max_length(Some(LONGEST_KEY)).pattern(Some("^[ -~]+$"));
    let description = format!(
        "Sent again with the same body, it answers the {resource} of the first time; with another body it is refused."
    );
    let key = ParameterBuilder::new()
        .name("Idempotency-Key")
        .parameter_in(ParameterIn::Header)
        .description(Some(description))
        .schema(Some(text.build()))
        .build();
    operation.parameters.get_or_insert_default().push(key.into());
}

/// Adds the address of the queued resource to the answer.
fn located(operation: &mut Operation, resource: &str) {
    let text = Some(Object::with_type(Type::String));
    let location = Header::builder().schema(text).description(Some(format!("The {resource}'s address."))).build();
    if let Some(RefOr::T(queued)) = operation.responses.responses.get_mut("202") {
        queued.headers.insert("Location".to_owned(), location.into());
    }
}

/// Adds entity tags to a call.
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
