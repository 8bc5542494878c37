//! Why a path ended. Stopping is a result, not an error.

use serde::{Deserialize, Serialize};

/// How a path ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum StopReason {
    /// Every stage reached its end.
    StagesCompleted,
    /// `max_increments` was reached.
    MaxIncrements,
    /// The way on is a motion that no element resists.
    Mechanism,
    /// No quasi-static continuation exists.
    NoDirection,
    /// The structure jumps and comes to rest nowhere.
    NoEquilibrium,
    /// The path is back at a state it has been in.
    Cycle,
    /// No step of at least `arc_length.min` converges, or steps are so short that the path gets nowhere.
    StepUnderflow,
    /// A bar has shrunk to a point, where its direction is lost.
    CollapsedBar,
    /// The directions form a set of more than one dimension, so that none can be named.
    Degenerate,
    /// A node is closed against several obstacles in a way that is not available: with friction, or with more reactions
    /// than its equilibrium tells apart, where it is driven against them or they move against each other (two planes in the
    /// plane apart), or three or more meet in one edge with friction.
    CornerNotAvailable,
    /// No step of at least `arc_length.min` leads to a point that keeps to the laws of contact and friction.
    ContactViolated,
    /// A node in contact with another body has slid to the end of the surface that it touches.
    SurfaceEnd,
    /// More contact modes than `max_modes` would have to be examined to go on.
    ModeLimit,
    /// Several nodes that touch in space without reaction may begin to slip at once, and no such direction was found.
    SlipsNotFound,
    /// More memory would be held at a time than a solve may hold, or a factorisation would be too large.
    MemoryLimit,
    /// The caller asked for it.
    Cancelled,
}

/// The three ways in which a path may end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The path went as far as it was asked to.
    Completed,
    /// The path ended before.
    Stopped,
    /// The caller ended it.
    Cancelled,
}

impl StopReason {
    /// Which of the three ways in which a path may end this is.
    pub fn outcome(self) -> Outcome {
        match self {
            Self::StagesCompleted | Self::MaxIncrements => Outcome::Completed,
            Self::Cancelled => Outcome::Cancelled,
            Self::Mechanism
            | Self::NoDirection
            | Self::NoEquilibrium
            | Self::Cycle
            | Self::StepUnderflow
            | Self::CollapsedBar
            | Self::Degenerate
            | Self::CornerNotAvailable
            | Self::ContactViolated
            | Self::SurfaceEnd
            | Self::ModeLimit
            | Self::SlipsNotFound
            | Self::MemoryLimit => Outcome::Stopped,
        }
    }

    /// A sentence for a person.
    pub fn sentence(self) -> &'static str {
        match self {
            Self::StagesCompleted => "every stage reached its end",
            Self::MaxIncrements => "the number of increments asked for was reached",
            Self::Mechanism => {
                "what follows is a mechanism: a motion that no element, support or closed contact resists (open contacts \
                 hold nothing)"
            }
            Self::NoDirection => {
                "no quasi-static continuation exists: from here the structure can only move dynamically"
            }
            Self::NoEquilibrium => "the structure jumps and comes to rest in no stable state",
            Self::Cycle => "the path is back at a state it has been in",
            Self::StepUnderflow => "no step of at least arc_length.min converges, or gets anywhere",
            Self::CollapsedBar => "a bar has shrunk to a point, where its direction is lost",
            Self::Degenerate => "the possible directions form a set of more than one dimension: none can be named",
            Self::CornerNotAvailable => {
                "a node is closed against several obstacles at once, with friction or with more reactions than its \
                 equilibrium tells apart, while it is driven against them, they move against each other or one of them turns, or \
                 where three meet in one edge, which is not available"
            }
            Self::ContactViolated => {
                "no step of at least arc_length.min leads to a point that keeps to the laws of contact and friction; where a \
                 node meets a corner or the edge of an obstacle, a finer mesh or a rounded corner may help"
            }
            Self::SurfaceEnd => "a node in contact has slid to the end of the surface that it touches",
            Self::ModeLimit => "more contact modes than max_modes would have to be examined to go on",
            Self::SlipsNotFound => {
                "several nodes that touch in space without reaction may begin to slip at once, and no direction in which \
                 they do was found; where the load lifts them off, check the signs of forces and normals"
            }
            Self::MemoryLimit => "going on would take more memory than a solve may hold",
            Self::Cancelled => "cancelled",
        }
    }
}
