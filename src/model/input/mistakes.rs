//! Places in a document and the mistakes found there; shared by [`crate::model::decode`] and [`crate::model::check`].

use crate::model::input::limits::{MAX_LISTED_MISTAKES, MAX_NAME_BYTES};
use crate::model::{InputError, InputErrors};

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

    /// The mistakes as an error, if there are any.
    pub fn into_result(mut self) -> Result<(), InputErrors> {
        if self.unlisted > 0 {
            let more = format!("{} more mistakes are not listed", self.unlisted);
            self.listed.push(InputError::new("", more));
        }
        if self.listed.is_empty() { Ok(()) } else { Err(InputErrors(self.listed)) }
    }
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
        for _ in 0..MAX_LISTED_MISTAKES + 7 {
            mistakes.add(&DocumentPlace::ROOT, || "wrong");
        }
        assert_eq!(mistakes.count(), MAX_LISTED_MISTAKES + 7);
        let errors = mistakes.into_result().unwrap_err().0;
        assert_eq!(errors.len(), MAX_LISTED_MISTAKES + 1);
        assert_eq!(errors.last().unwrap().detail, "7 more mistakes are not listed");
    }
}
