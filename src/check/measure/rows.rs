//! The contacts of the model with a row in an increment: all contacts, or the contacts within reach and the requested
//! contacts.

use crate::model::JobRequest;
use crate::result::increment::ContactState;
use std::collections::HashMap;

/// The contacts of the rows in the last increment.
#[derive(Debug, Clone)]
pub(super) struct ContactRows {
    /// Node and obstacle of every contact of the model.
    names: Vec<(String, String)>,
    /// The contacts by the names of node and obstacle, in order.
    named: HashMap<String, HashMap<String, Vec<usize>>>,
    /// The contact of each row.
    contacts: Vec<usize>,
}

/// The difference from the rows of the previous increment.
pub(super) enum RowChange {
    None,
    /// The rows belong to other contacts than before.
    Others,
    /// The rows do not belong to the model, or are not in the order of the model.
    Unknown,
}

impl ContactRows {
    pub fn new(request: &JobRequest) -> Self {
        let mut named: HashMap<String, HashMap<String, Vec<usize>>> = HashMap::new();
        let mut names = Vec::with_capacity(request.model.contacts.len());
        for (index, contact) in request.model.contacts.iter().enumerate() {
            let (node, obstacle) = (contact.node.clone(), contact.counterpart().to_owned());
            named.entry(node.clone()).or_default().entry(obstacle.clone()).or_default().push(index);
            names.push((node, obstacle));
        }
        Self { names, named, contacts: Vec::new() }
    }

    pub fn contacts(&self) -> &[usize] {
        &self.contacts
    }

    /// Sets the rows of the next increment.
    pub fn read(&mut self, rows: &[ContactState]) -> RowChange {
        let is_of = |(row, contact): (&ContactState, &usize)| {
            let (node, obstacle) = &self.names[*contact];
            **node == *row.node && **obstacle == *row.obstacle
        };
        if rows.len() == self.contacts.len() && rows.iter().zip(&self.contacts).all(is_of) {
            return RowChange::None;
        }
        let mut next = 0;
        let found = rows.iter().map(|row| {
            let of_names = self.named.get(&*row.node)?.get(&*row.obstacle)?;
            let contact = *of_names.iter().find(|contact| **contact >= next)?;
            next = contact + 1;
            Some(contact)
        });
        let found: Option<Vec<usize>> = found.collect();
        match found {
            Some(found) => {
                self.contacts = found;
                RowChange::Others
            }
            None => RowChange::Unknown,
        }
    }
}
