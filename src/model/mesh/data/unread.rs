//! What a mesh file holds beside the mesh, and is not read.

use crate::model::mesh::data::error::MeshPlace;
use indexmap::IndexMap;

/// Entries of the list at most; what goes beyond them is counted.
const MOST_ENTRIES: usize = 100;

/// Letters of a description at most.
const MOST_LETTERS: usize = 200;

/// A part of a file that is not read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnreadEntry {
    /// Where it is the first time.
    pub place: MeshPlace,
    /// How often it occurs.
    pub count: u64,
}

/// The list of what is not read, each kind once, in the order of the file.
#[derive(Debug, Clone, Default)]
pub struct Unread {
    entries: IndexMap<String, UnreadEntry>,
    unlisted: u64,
}

impl Unread {
    /// Adds a part of the file. Parts of the same description are counted.
    pub fn add(&mut self, place: MeshPlace, description: impl Into<String>) {
        let mut description = description.into();
        if let Some((end, _)) = description.char_indices().nth(MOST_LETTERS) {
            description.truncate(end);
        }
        if let Some(entry) = self.entries.get_mut(&description) {
            entry.count += 1;
        } else if self.entries.len() < MOST_ENTRIES {
            self.entries.insert(description, UnreadEntry { place, count: 1 });
        } else {
            self.unlisted += 1;
        }
    }

    /// The descriptions with place and count.
    pub fn entries(&self) -> impl Iterator<Item = (&str, UnreadEntry)> {
        self.entries.iter().map(|(description, entry)| (description.as_str(), *entry))
    }

    /// Parts that found no room in the list.
    pub fn unlisted(&self) -> u64 {
        self.unlisted
    }

    /// The list as lines of text.
    pub fn lines(&self) -> Vec<String> {
        let mut lines: Vec<String> = self
            .entries()
            .map(|(description, entry)| match entry.count {
                1 => format!("{}: not read: {description}", entry.place),
                count => format!("{}: not read: {description} ({count} times)", entry.place),
            })
            .collect();
        if self.unlisted > 0 {
            lines.push(format!("{} more parts are not read and not listed", self.unlisted));
        }
        lines
    }
}
