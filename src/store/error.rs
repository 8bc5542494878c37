//! What can go wrong with storage, told apart by what a caller can do about it.

type Source = Box<dyn std::error::Error + Send + Sync>;

#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// Passing: locked, closed, or no connection free. Trying again may help.
    #[error("the database is not available")]
    Unavailable(#[source] Source),
    /// Nothing more can be written until there is room.
    #[error("the disk that holds the database is full")]
    Full(#[source] Source),
    /// What is stored cannot be read as what was written.
    #[error("the database is damaged")]
    Damaged(#[source] Source),
    /// The file cannot be opened, or its tables are not ours.
    #[error("the database cannot be opened: {0}")]
    Open(#[source] Source),
    /// A defect: a statement that should have worked was refused.
    #[error("the database refused a statement")]
    Refused(#[source] Source),
}

impl StoreError {
    /// Worth another try of the same call.
    pub fn is_passing(&self) -> bool {
        match self {
            Self::Unavailable(_) => true,
            Self::Full(_) | Self::Damaged(_) | Self::Open(_) | Self::Refused(_) => false,
        }
    }
}
