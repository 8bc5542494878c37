//! JSON Schemas of judged increments and reports, with the measure as another member of the same object.

use crate::check::judged::increment::JudgedIncrement;
use crate::check::judged::report::{JudgedReport, MeasureReport};
use crate::check::measure::Errors;
use crate::result::increment::Increment;
use crate::result::report::Report;
use std::borrow::Cow;
use utoipa::openapi::schema::Schema;
use utoipa::openapi::{Ref, RefOr};
use utoipa::{PartialSchema, ToSchema};

type Schemas = Vec<(String, RefOr<Schema>)>;

/// The schema of an object with the additional required member `measure`.
fn with_measure<Whole: PartialSchema, Measure: ToSchema>() -> RefOr<Schema> {
    let mut schema = Whole::schema();
    if let RefOr::T(Schema::Object(object)) = &mut schema {
        object.properties.insert("measure".to_owned(), Ref::from_schema_name(Measure::name()).into());
        object.required.push("measure".to_owned());
    }
    schema
}

/// The schemas to which the members of the object refer, and that of the measure.
fn referred<Whole: ToSchema, Measure: ToSchema>(schemas: &mut Schemas) {
    Whole::schemas(schemas);
    schemas.push((Measure::name().into_owned(), Measure::schema()));
    Measure::schemas(schemas);
}

impl PartialSchema for JudgedIncrement {
    fn schema() -> RefOr<Schema> {
        with_measure::<Increment, Errors>()
    }
}

impl ToSchema for JudgedIncrement {
    fn name() -> Cow<'static, str> {
        Increment::name()
    }

    fn schemas(schemas: &mut Schemas) {
        referred::<Increment, Errors>(schemas);
    }
}

impl PartialSchema for JudgedReport {
    fn schema() -> RefOr<Schema> {
        with_measure::<Report, MeasureReport>()
    }
}

impl ToSchema for JudgedReport {
    fn name() -> Cow<'static, str> {
        Report::name()
    }

    fn schemas(schemas: &mut Schemas) {
        referred::<Report, MeasureReport>(schemas);
    }
}
