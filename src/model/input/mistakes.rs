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

/// Collects mistakes, each once: of those that are alike the first [`MOST_REPEATS`], and up to [`MAX_LISTED_MISTAKES`] in all; the
/// others are counted.
#[derive(Debug, Default)]
pub(crate) struct Mistakes {
    listed: Vec<InputError>,
    kinds: HashMap<MistakeKind, Repeats>,
    unlisted: usize,
    /// How often a listed one was found again.
    found_again: usize,
}

/// What mistakes share that repeat one another: what is wrong, but for names and numbers, how deep in the document, and at
/// which member.
type MistakeKind = (String, usize, String);

#[derive(Debug, Default)]
struct Repeats {
    count: usize,
    /// Place in the list of the last one that is listed.
    last: usize,
}

impl Mistakes {
    pub fn add<Text: Into<String>>(&mut self, at: &DocumentPlace, detail: impl FnOnce() -> Text) {
        let error = InputError::new(at.pointer(), detail());
        // A contact that stands for many has the same mistake many times.
        if self.listed.contains(&error) {
            self.found_again += 1;
            return;
        }
        let kind = kind_of(&error);
        let is_full = self.listed.len() >= MAX_LISTED_MISTAKES;
        if is_full && !self.kinds.contains_key(&kind) {
            self.unlisted += 1;
            return;
        }
        let repeats = self.kinds.entry(kind).or_default();
        repeats.count += 1;
        if !is_full && repeats.count <= MOST_REPEATS {
            repeats.last = self.listed.len();
            self.listed.push(error);
        }
    }

    pub fn count(&self) -> usize {
        self.kinds.values().map(|repeats| repeats.count).sum::<usize>() + self.unlisted + self.found_again
    }

    /// The mistakes as an error, if there are any.
    pub fn into_result(mut self) -> Result<(), InputErrors> {
        let mut left: Vec<usize> = vec![0; self.listed.len()];
        for (place, error) in self.listed.iter().enumerate() {
            // Each listed one takes itself off the count at the last one of its kind.
            if let Some(repeats) = self.kinds.get_mut(&kind_of(error)) {
                repeats.count = repeats.count.saturating_sub(1);
                if repeats.last == place {
                    left[place] = repeats.count;
                }
            }
        }
        for (error, left) in self.listed.iter_mut().zip(left) {
            match left {
                0 => {}
                1 => error.detail.push_str("; 1 more place has such a mistake"),
                more => error.detail.push_str(&format!("; {more} more places have such a mistake")),
            }
        }
        if self.unlisted > 0 {
            let more = format!("{} more mistakes are not listed", self.unlisted);
            self.listed.push(InputError::new("", more));
        }
        if self.listed.is_empty() { Ok(()) } else { Err(InputErrors(self.listed)) }
    }
}

fn kind_of(error: &InputError) -> MistakeKind {
    let last = error.pointer.rsplit('/').next().unwrap_or_default();
    (without_names(&error.detail), error.pointer.matches('/').count(), without_names(last))
}

/// A text without digits and without what stands between backquotes.
fn without_names(text: &str) -> String {
    let outside = text.split('`').step_by(2);
    outside.flat_map(str::chars).filter(|letter| !letter.is_ascii_digit()).collect()
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
            let letters = format!("wrong: {}{}", char::from(b'a' + (index % 26) as u8), "!".repeat(index / 26));
            mistakes.add(&DocumentPlace::ROOT.index(index), || letters);
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
        assert_eq!(mistakes.count(), 44);
        let errors = mistakes.into_result().unwrap_err().0;
        assert_eq!(errors.len(), MOST_REPEATS + 4);
        let last = errors.iter().rfind(|error| error.pointer.ends_with("/mu")).unwrap();
        assert_eq!(
            (last.pointer.as_str(), &*last.detail),
            ("/contacts/4/mu", "no such member; 35 more places have such a mistake")
        );
    }
    #[test]
    fn mistakes_that_differ_in_names_and_numbers_alone_are_of_one_kind() {
        let mut mistakes = Mistakes::default();
        let elements = DocumentPlace::ROOT.member("elements");
        for index in 0..243 {
            let (element, detail) = (elements.index(index), format!("there is no node `m{index}`"));
            mistakes.add(&element.member("nodes").index(index % 2), || detail);
        }
        let errors = mistakes.into_result().unwrap_err().0;
        assert_eq!(errors.len(), MOST_REPEATS);
        assert!(errors[4].detail.ends_with("`m4`; 238 more places have such a mistake"), "{}", errors[4].detail);
    }
}
