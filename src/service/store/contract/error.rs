//! Errors of the store, distinguished by what a caller can do about them.

pub(crate) type Source = Box<dyn std::error::Error + Send + Sync>;

#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// Transient: locked, closed, or no free connection. The call may be repeated.
    #[error("the database is not available")]
    Unavailable(#[source] Source),
    /// The disk is full: nothing can be written until there is space.
    #[error("the disk that holds the database is full")]
    Full(#[source] Source),
    /// The database is damaged.
    #[error("the database is damaged")]
    Damaged(#[source] Source),
    /// The database cannot be opened, or has other tables.
    #[error("the database cannot be opened: {0}")]
    Open(#[source] Source),
    /// A statement was refused, which is a defect.
    #[error("the database refused a statement")]
    Refused(#[source] Source),
}

impl StoreError {
    /// A copy for another caller that waited for the same result.
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

    /// Whether the same call may succeed when it is repeated.
    pub fn is_passing(&self) -> bool {
        match self {
            Self::Unavailable(_) => true,
            Self::Full(_) | Self::Damaged(_) | Self::Open(_) | Self::Refused(_) => false,
        }
    }
}

pub type Result<T> = std::result::Result<T, StoreError>;
