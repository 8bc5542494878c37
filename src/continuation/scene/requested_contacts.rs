//! The contacts as the request has them.

use std::sync::Arc;

/// A contact of the request and its share of the contact that is solved for.
#[derive(Debug, Clone)]
pub(crate) struct Reported {
    pub node: Arc<str>,
    pub obstacle: Arc<str>,
    /// Index of the scene's contact.
    pub contact: usize,
    /// Shares of the normal and tangential reaction; 1 unless contacts coincide.
    pub normal_share: f64,
    pub tangential_share: f64,
    /// Whether other contacts of the request share the scene's contact.
    pub shared: bool,
}
