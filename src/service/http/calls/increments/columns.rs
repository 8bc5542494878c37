//! Selected members of the increments of a path as arrays, for plots of long paths.

use crate::model::input::names::{quoted, suggestion_of_all};
use crate::result::increment::Point;
use crate::service::http::answer::problem::Problem;
use crate::service::http::answer::tag;
use crate::service::http::document;
use crate::service::http::input::extract::{Parameters, QueryParameters, bounded, index};
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::Job;
use crate::service::store::Page;
use axum::response::Response;
use indexmap::IndexMap;
use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;
use utoipa::ToSchema;

/// The member with the kind of a point.
const POINT: &str = "point";
const ROWS: u32 = 10_000;
const COLUMNS: usize = 32;
/// The members of an increment, as it is stored.
const MEMBERS: [&str; 17] = [
    "index",
    "stage",
    "load_factor",
    "arc_length",
    "step",
    "displacements",
    "contacts",
    "elements",
    "supports",
    "applied_forces",
    "point",
    "directions",
    "stability",
    "other_motion",
    "energy",
    "diagnostics",
    "measure",
];
/// Bytes of the increments that are read from the store at a time.
const PART: usize = 1 << 20;
/// An answer ends early once it has this many bytes.
const LARGEST: usize = 16 << 20;

#[derive(Debug, Deserialize, utoipa::IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub struct ColumnParameters {
    /// Up to 32 members of an increment with commas between: the name of a member, or a JSON Pointer (RFC 6901) such as
    /// `/displacements/tip/0`, in which `~2` stands for a comma.
    #[param(example = "load_factor,arc_length")]
    of: Option<String>,
    /// Only increments with a larger index: `next_after` of the page before.
    after: Option<u64>,
    /// Increments at most; an answer of large members may hold fewer and not be the last.
    #[param(minimum = 1, maximum = 10_000, default = 10_000)]
    limit: Option<u32>,
}

impl QueryParameters for ColumnParameters {
    const EXPECTED: &'static [(&'static str, &'static str)] = &[
        ("of", "names of an increment's members with commas between"),
        ("after", "the index of an increment, 0 or more,"),
        ("limit", "a whole number from 1 to 10000"),
    ];
}

/// Members of increments, one array each, in the order of the increments.
#[derive(Debug, Default, Serialize, ToSchema)]
pub struct Columns {
    /// Of the increments that the arrays are of.
    pub index: Vec<u64>,
    /// By the names that were asked for: each value as it is stored, null where an increment has none.
    #[schema(value_type = std::collections::HashMap<String, Vec<serde_json::Value>>)]
    pub columns: IndexMap<String, Vec<Option<Box<RawValue>>>>,
    /// The points among them that are not `regular`.
    pub points: Vec<PointAt>,
    /// Pass it as `after` for the next page: the last index of this one, or what was asked for when it is empty.
    pub next_after: Option<u64>,
    /// Bytes of the values in the columns.
    #[serde(skip)]
    bytes: usize,
}

/// A point that is not `regular`, with its increment's index.
#[derive(Debug, Serialize, ToSchema)]
pub struct PointAt {
    pub index: u64,
    /// The increment's `point`, as it is stored.
    #[schema(value_type = Point)]
    pub point: Box<RawValue>,
}

/// Chosen members of the stored increments, as arrays.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/columns", tag = document::INCREMENTS, operation_id = "get_columns",
    params(ColumnParameters),
    responses((status = 200, description = "The arrays, empty when there are no more increments for now.", body = Columns))
)]
pub async fn columns(
    target: Target<Job>,
    Parameters(parameters): Parameters<ColumnParameters>,
) -> Result<Response, Problem> {
    let members = members(parameters.of.as_deref().unwrap_or_default())?;
    refuse_unknown(&members)?;
    let members = Arc::new(members);
    let mut after = index("after", parameters.after)?;
    let mut left = bounded("limit", parameters.limit, ROWS, ROWS)?;
    let is_finished = target.standing().await?.status.is_ended();
    let Target { service, id, headers, .. } = target;
    let names = members.iter().map(|member| (member.name.clone(), Vec::new()));
    let mut found = Columns { columns: names.collect(), ..Columns::default() };
    while left > 0 && found.bytes < LARGEST {
        let lines = service.jobs.store().increments(id, after, Page { rows: left, bytes: PART }).await?;
        let Some(last) = lines.last() else { break };
        after = Some(last.index);
        left = left.saturating_sub(u32::try_from(lines.len()).unwrap_or(u32::MAX));
        let bytes = lines.iter().map(|line| line.body.len()).sum();
        let members = Arc::clone(&members);
        let taken = move || {
            for line in &lines {
                found.take(line.index, &line.body, &members)?;
            }
            Ok::<_, Problem>(found)
        };
        found = service.offload.run(bytes, taken).await?;
    }
    found.next_after = after;
    service.offload.run(found.bytes, move || tag::json(&headers, is_finished, &found)).await
}

/// A member of an increment, and the keys that lead to it.
struct Member {
    name: String,
    steps: Vec<String>,
}

fn members(of: &str) -> Result<Vec<Member>, Problem> {
    let mut members: Vec<Member> = Vec::new();
    for name in of.split(',').filter(|name| !name.is_empty()) {
        let steps: Vec<String> = name.strip_prefix('/').unwrap_or(name).split('/').map(unescaped).collect();
        if members.iter().any(|known| known.steps == steps) {
            return Err(Problem::parameter("of", format_args!("`{name}` stands twice; once would do")));
        }
        members.push(Member { name: name.to_owned(), steps });
    }
    match members.len() {
        found if found > COLUMNS => {
            Err(Problem::parameter("of", format_args!("{found} names; at most {COLUMNS} are accepted")))
        }
        _ => Ok(members),
    }
}

/// A member that no increment has is rather a name that is spelt otherwise.
fn refuse_unknown(members: &[Member]) -> Result<(), Problem> {
    let unknown = |member: &&Member| member.steps.first().is_none_or(|first| !MEMBERS.contains(&first.as_str()));
    let Some(member) = members.iter().find(unknown) else { return Ok(()) };
    let first = member.steps.first().map(String::as_str).unwrap_or_default();
    let near = suggestion_of_all(first, MEMBERS.into_iter());
    let columns = "a displacement, a column `tip.x` of path.csv, is `/displacements/tip/0` here";
    Err(Problem::not_found(format_args!("member {} of an increment{near}; {columns}", quoted(first))))
}

fn unescaped(step: &str) -> String {
    step.replace("~2", ",").replace("~1", "/").replace("~0", "~")
}

impl Columns {
    fn take(&mut self, index: u64, body: &str, members: &[Member]) -> serde_json::Result<()> {
        let firsts = members.iter().filter_map(|member| member.steps.first().map(String::as_str));
        let mut names = vec![POINT];
        for first in firsts {
            if !names.contains(&first) {
                names.push(first);
            }
        }
        let top = pick(body, &names)?;
        let found = |name: &str| names.iter().position(|known| *known == name).and_then(|place| *top.get(place)?);
        self.index.push(index);
        for (member, column) in members.iter().zip(self.columns.values_mut()) {
            let mut steps = member.steps.iter();
            let mut value = steps.next().and_then(|name| found(name));
            for step in steps {
                let Some(within) = value else { break };
                value = pick(within.get(), &[step])?.pop().flatten();
            }
            let value = value.filter(|value| value.get() != "null");
            self.bytes += value.map_or(0, |value| value.get().len()) + size_of::<Box<RawValue>>();
            column.push(value.map(ToOwned::to_owned));
        }
        if let Some(point) = found(POINT) {
            #[derive(Deserialize)]
            struct Kind<'a> {
                #[serde(borrow)]
                kind: Cow<'a, str>,
                #[serde(default)]
                bifurcation: bool,
            }
            let kind: Kind = serde_json::from_str(point.get())?;
            if kind.kind != "regular" || kind.bifurcation {
                self.points.push(PointAt { index, point: point.to_owned() });
            }
        }
        Ok(())
    }
}

/// The members of an object with the given names, or the elements of an array with the given indices, as they are written;
/// `None` for absent ones. Reading ends after the last of them.
fn pick<'de>(text: &'de str, names: &[&str]) -> serde_json::Result<Vec<Option<&'de RawValue>>> {
    let mut found = vec![None; names.len()];
    let picked = Pick { names, found: &mut found }.deserialize(&mut serde_json::Deserializer::from_str(text));
    if found.iter().any(Option::is_none) {
        picked?;
    }
    Ok(found)
}

/// A visitor that collects the selected members until all have been found.
struct Pick<'a, 'de> {
    names: &'a [&'a str],
    found: &'a mut [Option<&'de RawValue>],
}

impl<'de> DeserializeSeed<'de> for Pick<'_, 'de> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Pick<'_, 'de> {
    type Value = ();

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a value")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(place) = map.next_key_seed(PlaceOf(self.names))? {
            match place.and_then(|place| self.found.get_mut(place)) {
                Some(found) => *found = Some(map.next_value()?),
                None => _ = map.next_value::<IgnoredAny>()?,
            }
            if self.found.iter().all(Option::is_some) {
                break;
            }
        }
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<(), A::Error> {
        let wanted: Vec<Option<usize>> = self.names.iter().map(|name| name.parse().ok()).collect();
        let mut place = 0;
        while let Some(element) = sequence.next_element::<&RawValue>()? {
            for (found, _) in self.found.iter_mut().zip(&wanted).filter(|(_, wanted)| **wanted == Some(place)) {
                *found = Some(element);
            }
            if self.found.iter().all(Option::is_some) {
                break;
            }
            place += 1;
        }
        Ok(())
    }

    fn visit_unit<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_bool<E>(self, _: bool) -> Result<(), E> {
        Ok(())
    }

    fn visit_i64<E>(self, _: i64) -> Result<(), E> {
        Ok(())
    }

    fn visit_u64<E>(self, _: u64) -> Result<(), E> {
        Ok(())
    }

    fn visit_f64<E>(self, _: f64) -> Result<(), E> {
        Ok(())
    }

    fn visit_str<E>(self, _: &str) -> Result<(), E> {
        Ok(())
    }
}

/// A visitor that finds the index of a key among the names; keys are compared without a copy, as there are very many.
struct PlaceOf<'a>(&'a [&'a str]);

impl<'de> DeserializeSeed<'de> for PlaceOf<'_> {
    type Value = Option<usize>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_str(self)
    }
}

impl Visitor<'_> for PlaceOf<'_> {
    type Value = Option<usize>;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a name")
    }

    fn visit_str<E>(self, name: &str) -> Result<Self::Value, E> {
        Ok(self.0.iter().position(|known| *known == name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::increment::Increment;
    use utoipa::PartialSchema;

    #[test]
    fn members_are_taken_as_they_are_written() {
        let body = r#"{"load_factor":-0.10,"displacements":{"a,b":[1.50,2e-3],"c/d":[7]},"stage":"push","point":{"kind":"end","bifurcation":false}}"#;
        let of = "load_factor,/displacements/a~2b/1,/displacements/c~1d/0,/displacements/c~1d/1,/stage/x,step,/stage";
        let members = members(of).unwrap();
        let names = members.iter().map(|member| (member.name.clone(), Vec::new()));
        let mut found = Columns { columns: names.collect(), ..Columns::default() };
        found.take(4, body, &members).unwrap();
        let written = serde_json::to_string(&found).unwrap();
        assert_eq!(
            written,
            r#"{"index":[4],"columns":{"load_factor":[-0.10],"/displacements/a~2b/1":[2e-3],"/displacements/c~1d/0":[7],"/displacements/c~1d/1":[null],"/stage/x":[null],"step":[null],"/stage":["push"]},"points":[{"index":4,"point":{"kind":"end","bifurcation":false}}],"next_after":null}"#
        );
    }

    #[test]
    fn members_of_increments_are_known_and_others_refused() {
        let schema = serde_json::to_value(Increment::schema()).unwrap();
        let mut named: Vec<&str> = schema["properties"].as_object().unwrap().keys().map(String::as_str).collect();
        named.push("measure");
        named.sort_unstable();
        let mut known = MEMBERS;
        known.sort_unstable();
        assert_eq!(named, known);
        assert!(refuse_unknown(&members("load_factor,/displacements/tip/0").unwrap()).is_ok());
        assert!(refuse_unknown(&members("load_factor,loadfactor").unwrap()).is_err());
    }

    #[test]
    fn too_many_names_and_names_that_stand_twice_are_refused() {
        assert!(members("a,b,a").is_err() && members("a/b,/a/b").is_err());
        let many: Vec<String> = (0..=COLUMNS).map(|number| format!("m{number}")).collect();
        assert!(members(&many.join(",")).is_err());
        assert_eq!(members(&many[1..].join(",")).unwrap_or_default().len(), COLUMNS);
        assert!(members("").unwrap_or_default().is_empty());
    }
}
