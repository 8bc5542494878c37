//! On whose behalf a request is carried out: whose jobs it makes, and which it can see.
//!
//! What somebody cannot see is answered as if it were not there. Made by `http` from a request's token.

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Caller {
    /// Nobody has to say who they are: jobs belong to no one, and everyone sees all.
    Anyone,
    /// Somebody who has said so; `sees_all`: other owners' jobs, too.
    Named { owner: String, sees_all: bool },
}

impl Caller {
    /// Whose the jobs are that this caller makes.
    pub fn owner(&self) -> Option<&str> {
        match self {
            Self::Anyone => None,
            Self::Named { owner, .. } => Some(owner),
        }
    }

    /// Whether jobs of that owner are seen.
    pub fn sees(&self, owner: Option<&str>) -> bool {
        self.seen_owner().is_none_or(|seen| owner == Some(seen))
    }

    /// Whose jobs alone are seen; `None`: everyone's.
    pub fn seen_owner(&self) -> Option<&str> {
        match self {
            Self::Anyone | Self::Named { sees_all: true, .. } => None,
            Self::Named { owner, sees_all: false } => Some(owner),
        }
    }
}
