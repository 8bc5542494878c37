//! What can go wrong with storage, told apart by what a caller can do about it.

pub(crate) type Source = Box<dyn std::error::Error + Send + Sync>;

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
    /// The same for another who waited for the same.
    pub fn told_again(&self) -> Self {
        let why = || std::error::Error::source(self).map_or_else(|| self.to_string(), ToString::to_string).into();
        match self {
            Self::Unavailable(_) => Self::Unavailable(why()),
            Self::Full(_) => Self::Full(why()),
            Self::Damaged(_) => Self::Damaged(why()),
            Self::Open(source) => Self::Open(source.to_string().into()),
            Self::Refused(_) => Self::Refused(why()),
        }
    }

    /// Worth another try of the same call.
    pub fn is_passing(&self) -> bool {
        match self {
            Self::Unavailable(_) => true,
            Self::Full(_) | Self::Damaged(_) | Self::Open(_) | Self::Refused(_) => false,
        }
    }
}

pub type Result<T> = std::result::Result<T, StoreError>;
