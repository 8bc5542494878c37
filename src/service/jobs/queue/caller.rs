//! The caller of a request: who owns the jobs that it creates, and which jobs it sees.
//!
//! A job that a caller does not see is answered as absent. `http` makes the caller from the token of a request.

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Caller {
    /// An anonymous caller: the service asks for no tokens, jobs have no owner, and everyone sees all jobs.
    Anyone,
    /// A caller with a token; `sees_all`: sees the jobs of other owners, too.
    Named { owner: String, sees_all: bool },
}

impl Caller {
    /// The owner of the jobs that this caller creates.
    pub fn owner(&self) -> Option<&str> {
        match self {
            Self::Anyone => None,
            Self::Named { owner, .. } => Some(owner),
        }
    }

    /// Whether the caller sees jobs of that owner.
    pub fn sees(&self, owner: Option<&str>) -> bool {
        self.seen_owner().is_none_or(|seen| owner == Some(seen))
    }

    /// The only owner whose jobs the caller sees; `None`: the caller sees all jobs.
    pub fn seen_owner(&self) -> Option<&str> {
        match self {
            Self::Anyone | Self::Named { sees_all: true, .. } => None,
            Self::Named { owner, sees_all: false } => Some(owner),
        }
    }
}
