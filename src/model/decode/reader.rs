//! Reads typed values from a [`Json`] value and keeps track of their places; reading continues after a mistake.
//!
//! A reader returns `None` only after it has noted a mistake.

use indexmap::IndexMap;

use crate::model::input::json::Json;
use crate::model::input::limits::MAX_NAME_BYTES;
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::{listed, quoted, suggestion};

/// A value and its place in the document.
#[derive(Debug, Clone, Copy)]
pub(super) struct Input<'a> {
    value: &'a Json,
    at: DocumentPlace<'a>,
}

/// The known fields of a type of object.
#[derive(Debug)]
pub(super) struct Fields {
    /// With its article: `a contact`.
    pub what: &'static str,
    pub known: &'static [&'static str],
    /// Fields of the contract that this version does not support, each with an alternative.
    pub later: &'static [(&'static str, &'static str)],
}

/// The values of an enumeration.
#[derive(Debug)]
pub(super) struct Choices<T: 'static> {
    /// With its article: `a method`.
    pub what: &'static str,
    pub known: &'static [(&'static str, T)],
    /// Values of the contract that this version does not support.
    pub later: &'static [&'static str],
}

impl<'a> Input<'a> {
    pub fn root(value: &'a Json) -> Self {
        Self { value, at: DocumentPlace::ROOT }
    }

    /// Notes what is wrong with the value.
    pub fn note<T>(&self, detail: &str, mistakes: &mut Mistakes) -> Option<T> {
        mistakes.add(&self.at, || detail);
        None
    }

    /// Notes what is expected in place of the value.
    pub fn refuse<T>(&self, expected: &str, mistakes: &mut Mistakes) -> Option<T> {
        mistakes.add(&self.at, || format!("found {}; {expected} is expected", self.value.describe()));
        None
    }

    pub fn is_text(&self) -> bool {
        matches!(self.value, Json::Text(_))
    }

    pub fn is_object(&self) -> bool {
        matches!(self.value, Json::Object(_))
    }

    pub fn is_list(&self) -> bool {
        matches!(self.value, Json::Array(_))
    }

    pub fn has(&self, name: &str) -> bool {
        matches!(self.value, Json::Object(members) if members.iter().any(|(member, _)| member == name))
    }

    pub fn list<T>(
        &self,
        mistakes: &mut Mistakes,
        read: impl Fn(&Input, &mut Mistakes) -> Option<T>,
    ) -> Option<Vec<T>> {
        let Json::Array(items) = self.value else {
            return self.refuse("an array, `[...]`,", mistakes);
        };
        let mut list = Vec::with_capacity(items.len());
        for (index, value) in items.iter().enumerate() {
            list.extend(read(&Input { value, at: self.at.index(index) }, mistakes));
        }
        (list.len() == items.len()).then_some(list)
    }

    /// An object whose member names are chosen by the user. Of duplicate members, which are reported elsewhere, the first counts.
    pub fn map<T>(
        &self,
        mistakes: &mut Mistakes,
        read: impl Fn(&Input, &mut Mistakes) -> Option<T>,
    ) -> Option<IndexMap<String, T>> {
        let Json::Object(members) = self.value else {
            return self.refuse("an object, `{...}`,", mistakes);
        };
        let before = mistakes.count();
        let mut map = IndexMap::with_capacity(members.len());
        for (name, value) in members {
            if name.len() > MAX_NAME_BYTES {
                mistakes.add(&self.at, || name_too_long(name));
            } else if let Some(value) = read(&Input { value, at: self.at.member(name) }, mistakes) {
                map.entry(name.clone()).or_insert(value);
            }
        }
        (mistakes.count() == before).then_some(map)
    }

    /// One of the known strings.
    pub fn choice<T: Copy>(&self, choices: &Choices<T>, mistakes: &mut Mistakes) -> Option<T> {
        let names = choices.known.iter().map(|&(name, _)| name);
        let Json::Text(found) = self.value else {
            return self.refuse(&format!("{} ({})", choices.what, listed(names)), mistakes);
        };
        if let Some((_, value)) = choices.known.iter().find(|(name, _)| name == found) {
            return Some(*value);
        }
        mistakes.add(&self.at, || {
            if choices.later.contains(&found.as_str()) {
                format!("{} is not available in this version; {} would do", quoted(found), listed(names))
            } else {
                format!("{} is not {}{}", quoted(found), choices.what, suggestion(found, names))
            }
        });
        None
    }

    /// The value of the member `kind`, which determines the other members of an object.
    pub fn kind<T: Copy>(&self, choices: &Choices<T>, mistakes: &mut Mistakes) -> Option<T> {
        let Json::Object(members) = self.value else {
            return self.refuse("an object, `{...}`,", mistakes);
        };
        match members.iter().find(|(name, _)| name == "kind") {
            Some((name, value)) => Input { value, at: self.at.member(name) }.choice(choices, mistakes),
            None => {
                let names = choices.known.iter().map(|&(name, _)| name);
                let is_type = members.iter().any(|(name, _)| name == "type");
                let found = if is_type { "`kind` is missing, where `type` stands" } else { "`kind` is missing" };
                mistakes.add(&self.at, || format!("{found}; it is {} ({})", choices.what, listed(names)));
                None
            }
        }
    }

    /// An object with these fields and no other; every other member is noted.
    pub fn object(&self, fields: &Fields, mistakes: &mut Mistakes) -> Option<Object<'a>> {
        let Json::Object(members) = self.value else {
            return self.refuse(&format!("{}, an object,", fields.what), mistakes);
        };
        let object = Object { members, at: self.at };
        for (name, _) in members.iter().filter(|(name, _)| !fields.known.contains(&name.as_str())) {
            mistakes.add(&object.at.member(name), || unknown_field(name, fields));
        }
        Some(object)
    }
}

pub(super) fn number(input: &Input, mistakes: &mut Mistakes) -> Option<f64> {
    match input.value {
        Json::Number(number) => Some(number.as_f64()),
        _ => input.refuse("a number", mistakes),
    }
}

/// A whole number, 0 or more.
pub(super) fn count(input: &Input, mistakes: &mut Mistakes) -> Option<u64> {
    match input.value {
        Json::Number(number) => number.as_u64().or_else(|| input.refuse("a whole number, not negative,", mistakes)),
        _ => input.refuse("a whole number", mistakes),
    }
}

pub(super) fn text(input: &Input, mistakes: &mut Mistakes) -> Option<String> {
    match input.value {
        Json::Text(text) => Some(text.clone()),
        _ => input.refuse("a string", mistakes),
    }
}

pub(super) fn boolean(input: &Input, mistakes: &mut Mistakes) -> Option<bool> {
    match input.value {
        Json::Bool(value) => Some(*value),
        _ => input.refuse("true or false", mistakes),
    }
}

pub(super) fn numbers(input: &Input, mistakes: &mut Mistakes) -> Option<Vec<f64>> {
    if input.is_list() {
        input.list(mistakes, number)
    } else {
        input.refuse("an array of numbers, as `[0, 1]`,", mistakes)
    }
}

fn unknown_field(name: &str, fields: &Fields) -> String {
    match fields.later.iter().find(|(later, _)| *later == name) {
        Some((_, instead)) => format!("{} is not available in this version; {instead}", quoted(name)),
        None => {
            let known = suggestion(name, fields.known.iter().copied());
            format!("unknown field {} of {}{known}", quoted(name), fields.what)
        }
    }
}

fn name_too_long(name: &str) -> String {
    format!("the name {} has {} bytes; at most {MAX_NAME_BYTES} are taken", quoted(name), name.len())
}

/// The members of an object whose fields are known.
#[derive(Debug)]
pub(super) struct Object<'a> {
    members: &'a [(String, Json)],
    at: DocumentPlace<'a>,
}

impl Object<'_> {
    fn find(&self, name: &'static str) -> Option<Input<'_>> {
        let (_, value) = self.members.iter().find(|(member, _)| member == name)?;
        Some(Input { value, at: self.at.member(name) })
    }

    pub fn required<T>(
        &self,
        name: &'static str,
        mistakes: &mut Mistakes,
        read: impl Fn(&Input, &mut Mistakes) -> Option<T>,
    ) -> Option<T> {
        match self.find(name) {
            Some(input) => read(&input, mistakes),
            None => {
                mistakes.add(&self.at, || format!("the field `{name}` is missing"));
                None
            }
        }
    }

    /// The inner `None` is an absent field, or `null`.
    pub fn optional<T>(
        &self,
        name: &'static str,
        mistakes: &mut Mistakes,
        read: impl Fn(&Input, &mut Mistakes) -> Option<T>,
    ) -> Option<Option<T>> {
        match self.find(name) {
            None | Some(Input { value: Json::Null, .. }) => Some(None),
            Some(input) => read(&input, mistakes).map(Some),
        }
    }

    pub fn with_default<T>(
        &self,
        name: &'static str,
        default: T,
        mistakes: &mut Mistakes,
        read: impl Fn(&Input, &mut Mistakes) -> Option<T>,
    ) -> Option<T> {
        match self.find(name) {
            Some(input) => read(&input, mistakes),
            None => Some(default),
        }
    }
}

/// Notes every member that occurs twice in an object.
pub(super) fn note_duplicates(input: &Input, mistakes: &mut Mistakes) {
    match input.value {
        Json::Array(items) => {
            for (index, value) in items.iter().enumerate() {
                note_duplicates(&Input { value, at: input.at.index(index) }, mistakes);
            }
        }
        Json::Object(members) => {
            let mut seen = std::collections::HashSet::with_capacity(members.len());
            for (name, value) in members {
                let at = input.at.member(name);
                if !seen.insert(name) {
                    mistakes.add(&at, || format!("the member {} stands twice in one object", quoted(name)));
                }
                note_duplicates(&Input { value, at }, mistakes);
            }
        }
        Json::Null | Json::Bool(_) | Json::Number(_) | Json::Text(_) => {}
    }
}
