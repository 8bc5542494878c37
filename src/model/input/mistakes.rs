//! Places in a document and the mistakes found there; shared by [`crate::model::decode`] and [`crate::model::check`].

use crate::model::input::limits::{MAX_LISTED_MISTAKES, MAX_NAME_BYTES};
use crate::model::{InputError, InputErrors};
use std::collections::HashMap;

/// A place in the document as a chain of steps from the root, which is only written out for a mistake.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DocumentPlace<'a> {
    parent: Option<&'a DocumentPlace<'a>>,
    step: DocumentStep<'a>,
}

#[derive(Debug, Clone, Copy)]
enum DocumentStep<'a> {
    Root,
    Member(&'a str),
    Index(usize),
}

impl<'a> DocumentPlace<'a> {
    pub const ROOT: DocumentPlace<'static> = DocumentPlace { parent: None, step: DocumentStep::Root };

    pub fn member(&'a self, name: &'a str) -> DocumentPlace<'a> {
        DocumentPlace { parent: Some(self), step: DocumentStep::Member(name) }
    }

    pub fn index(&'a self, index: usize) -> DocumentPlace<'a> {
        DocumentPlace { parent: Some(self), step: DocumentStep::Index(index) }
    }

    /// The JSON pointer (RFC 6901). It ends before a name longer than [`MAX_NAME_BYTES`], so that a hostile document
    /// does not come back in its own error message; the pointer then is to the object that holds the name.
    pub fn pointer(&self) -> String {
        let mut steps = Vec::new();
        let mut place = Some(self);
        while let Some(current) = place {
            steps.push(current.step);
            place = current.parent;
        }
        let mut pointer = String::new();
        for step in steps.into_iter().rev() {
            match step {
                DocumentStep::Root => {}
                DocumentStep::Index(index) => pointer.push_str(&format!("/{index}")),
                DocumentStep::Member(name) if name.len() > MAX_NAME_BYTES => break,
                DocumentStep::Member(name) => {
                    pointer.push('/');
                    pointer.push_str(&name.replace('~', "~0").replace('/', "~1"));
                }
            }
        }
        pointer
    }
}

/// Places at which a repeated mistake is listed.
const MOST_REPEATS: usize = 5;

/// Collects mistakes up to [`MAX_LISTED_MISTAKES`] and counts the rest.
#[derive(Debug, Default)]
pub(crate) struct Mistakes {
    listed: Vec<InputError>,
    unlisted: usize,
}

impl Mistakes {
    /// `detail` is only made where the mistake is listed: a document can hold a million of them.
    pub fn add<Text: Into<String>>(&mut self, at: &DocumentPlace, detail: impl FnOnce() -> Text) {
        if self.listed.len() < MAX_LISTED_MISTAKES {
            self.listed.push(InputError::new(at.pointer(), detail()));
        } else {
            self.unlisted += 1;
        }
    }

    pub fn count(&self) -> usize {
        self.listed.len() + self.unlisted
    }

    /// The mistakes as an error, if there are any. Of a mistake that many places share the first few are listed, and the
    /// others counted.
    pub fn into_result(mut self) -> Result<(), InputErrors> {
        self.listed = grouped(self.listed);
        if self.unlisted > 0 {
            let more = format!("{} more mistakes are not listed", self.unlisted);
            self.listed.push(InputError::new("", more));
        }
        if self.listed.is_empty() { Ok(()) } else { Err(InputErrors(self.listed)) }
    }
}

/// The mistakes in their order, with one in place of those that repeat others at places of the same kind.
fn grouped(listed: Vec<InputError>) -> Vec<InputError> {
    let mut counts: HashMap<(String, usize, String), usize> = HashMap::new();
    for error in &listed {
        *counts.entry(kind_of(error)).or_default() += 1;
    }
    let mut seen: HashMap<(String, usize, String), usize> = HashMap::new();
    let mut kept = Vec::new();
    for mut error in listed {
        let kind = kind_of(&error);
        let count = counts.get(&kind).copied().unwrap_or_default();
        let seen = seen.entry(kind).or_default();
        *seen += 1;
        if count <= MOST_REPEATS || *seen < MOST_REPEATS {
            kept.push(error);
        } else if *seen == MOST_REPEATS {
            error.detail = format!("{}; {} more places have the same mistake", error.detail, count - MOST_REPEATS);
            kept.push(error);
        }
    }
    kept
}

/// What mistakes share that repeat one another: what is wrong, how deep in the document, and at which member.
fn kind_of(error: &InputError) -> (String, usize, String) {
    let last = error.pointer.rsplit('/').next().unwrap_or_default();
    let last = if last.bytes().all(|byte| byte.is_ascii_digit()) { "" } else { last };
    (error.detail.clone(), error.pointer.matches('/').count(), last.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pointers_escape_names_and_end_before_long_ones() {
        let model = DocumentPlace::ROOT.member("model");
        let nodes = model.member("nodes");
        assert_eq!(DocumentPlace::ROOT.pointer(), "");
        assert_eq!(nodes.member("a/b~c").index(1).pointer(), "/model/nodes/a~1b~0c/1");
        let long = "n".repeat(MAX_NAME_BYTES + 1);
        assert_eq!(nodes.member(&long).index(1).pointer(), "/model/nodes");
    }

    #[test]
    fn mistakes_past_the_bound_are_counted() {
        let mut mistakes = Mistakes::default();
        for index in 0..MAX_LISTED_MISTAKES + 7 {
            mistakes.add(&DocumentPlace::ROOT.index(index), || format!("wrong: {index}"));
        }
        assert_eq!(mistakes.count(), MAX_LISTED_MISTAKES + 7);
        let errors = mistakes.into_result().unwrap_err().0;
        assert_eq!(errors.len(), MAX_LISTED_MISTAKES + 1);
        assert_eq!(errors.last().unwrap().detail, "7 more mistakes are not listed");
    }

    #[test]
    fn a_mistake_that_many_places_share_is_listed_a_few_times() {
        let mut mistakes = Mistakes::default();
        let contacts = DocumentPlace::ROOT.member("contacts");
        for index in 0..40 {
            mistakes.add(&contacts.index(index).member("mu"), || "no such member");
            if index % 10 == 0 {
                mistakes.add(&contacts.index(index).member("node"), || "no such node");
            }
        }
        let errors = mistakes.into_result().unwrap_err().0;
        assert_eq!(errors.len(), MOST_REPEATS + 4);
        let last = errors.iter().rfind(|error| error.pointer.ends_with("/mu")).unwrap();
        assert_eq!(
            (last.pointer.as_str(), &*last.detail),
            ("/contacts/4/mu", "no such member; 35 more places have the same mistake")
        );
    }
}
