//! Which contacts of the model an increment has rows of: all of them, or those within reach and those that are asked for.

use crate::model::JobRequest;
use crate::path::increment::ContactState;

/// The contacts of the last increment's rows.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    /// Node and obstacle of every contact of the model.
    names: Vec<(String, String)>,
    /// For each row its contact.
    contacts: Vec<usize>,
}

/// What is different from the rows of the increment before.
pub(super) enum Change {
    None,
    /// They are of other contacts.
    Others,
    /// They are not of the model, or not in its order.
    Unknown,
}

impl Rows {
    pub fn new(request: &JobRequest) -> Self {
        let contacts = request.model.contacts.iter();
        let names = contacts.map(|contact| (contact.node.clone(), contact.obstacle.clone())).collect();
        Self { names, contacts: Vec::new() }
    }

    pub fn contacts(&self) -> &[usize] {
        &self.contacts
    }

    /// Goes to the rows of the next increment.
    pub fn read(&mut self, rows: &[ContactState]) -> Change {
        let is_of = |(row, contact): (&ContactState, &usize)| {
            let (node, obstacle) = &self.names[*contact];
            **node == *row.node && **obstacle == *row.obstacle
        };
        if rows.len() == self.contacts.len() && rows.iter().zip(&self.contacts).all(is_of) {
            return Change::None;
        }
        let mut contacts = 0..self.names.len();
        let found = rows.iter().map(|row| contacts.find(|contact| is_of((row, contact))));
        let found: Option<Vec<usize>> = found.collect();
        match found {
            Some(found) => {
                self.contacts = found;
                Change::Others
            }
            None => Change::Unknown,
        }
    }
}
