//! What is kept of the increments.

#![warn(missing_docs)]

use serde::{Deserialize, Serialize};

/// What is kept of the increments: printed, streamed and stored. Every increment is traced and judged in full before
/// anything of it is left out, and the report is that of all of them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct Record {
    /// Nodes whose displacements are kept; absent: all.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes: Option<Vec<String>>,
    /// Contacts whose rows are kept, in the increments and in their directions, in the order of the model; absent: all,
    /// but in models of more than 100 contacts those within reach.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contacts: Option<RecordedContacts>,
    /// Elements whose forces are kept, by place or name; absent: all in models of up to 200 elements, else none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elements: Option<RecordedElements>,
    /// Supported nodes whose reactions are kept; absent: all where there are up to 200, else none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub supports: Option<RecordedSupports>,
    /// Of the regular increments, those whose index is a multiple of this are kept; 1 or more. Kept in any case: starts
    /// and ends of the path and of its stages, contact changes, limit and bifurcation points at which something happens,
    /// increments at which another direction first appears, and those off the measure.
    #[cfg_attr(feature = "server", schema(minimum = 1))]
    pub every: u64,
    /// Whether directions are listed. Without them none can be followed.
    pub directions: bool,
    /// Whether the stability of each increment is found. It costs the eigenvalues of a matrix of as many rows as there are
    /// free displacement components, once for each combination of statuses that the contacts about to change can take.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub stability: bool,
}

/// Which contacts have rows: `all`, those `in_reach` of the path, or the ones that are named.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(untagged)]
pub enum RecordedContacts {
    /// All, or those in reach.
    Range(ContactRange),
    /// Those that are named.
    Named(Vec<RecordedContact>),
}

/// Contacts by whether they are in reach.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum ContactRange {
    /// Every contact of the model.
    All,
    /// Those that take part in the equations. Before the path comes near a contact it has no row; from then on it has one.
    InReach,
}

/// Which elements have forces in the increments: `all`, `none`, or the ones that are listed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(untagged)]
pub enum RecordedElements {
    /// All or none.
    Range(ForceRange),
    /// Those that are listed, each once.
    Listed(Vec<ElementReference>),
}

/// Which supported nodes have reactions in the increments: `all`, `none`, or the ones that are named.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(untagged)]
pub enum RecordedSupports {
    /// All or none.
    Range(ForceRange),
    /// Supported nodes, each once.
    Named(Vec<String>),
}

/// All elements or supports of the model, or none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum ForceRange {
    /// Every one.
    All,
    /// None of them.
    None,
}

/// An element, by its place in the model's `elements`, from 0, or by its name.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(untagged)]
pub enum ElementReference {
    /// Place in the model's `elements`, from 0.
    Place(u64),
    /// Name of the element.
    Name(String),
}

/// A contact, by the names in the model; contacts listed twice there are meant together.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct RecordedContact {
    /// Name of the node.
    pub node: String,
    /// Name of the obstacle.
    pub obstacle: String,
}

impl Record {
    /// The contacts that are named, where some are.
    pub fn named_contacts(&self) -> Option<&[RecordedContact]> {
        match &self.contacts {
            Some(RecordedContacts::Named(named)) => Some(named),
            None | Some(RecordedContacts::Range(_)) => None,
        }
    }
}

impl Default for Record {
    fn default() -> Self {
        Self {
            nodes: None,
            contacts: None,
            elements: None,
            supports: None,
            every: 1,
            directions: true,
            stability: false,
        }
    }
}
