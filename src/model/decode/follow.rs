//! Reads a request to follow a direction of another job.

use crate::model::decode::reader::{Fields, Input, count};
use crate::model::input::limits::MAX_INCREMENTS;
use crate::model::input::mistakes::Mistakes;
use crate::model::request::FollowRequest;

pub(super) const FOLLOW: Fields = Fields {
    what: "a request to follow a direction",
    known: &["increment", "direction", "max_increments"],
    later: &[],
};

pub(super) fn follow(input: &Input, mistakes: &mut Mistakes) -> Option<FollowRequest> {
    let object = input.object(&FOLLOW, mistakes)?;
    let increment = object.required("increment", mistakes, count);
    let direction = object.required("direction", mistakes, count);
    let max_increments = object.optional("max_increments", mistakes, bounded);
    Some(FollowRequest { increment: increment?, direction: direction?, max_increments: max_increments? })
}

fn bounded(input: &Input, mistakes: &mut Mistakes) -> Option<u64> {
    let found = count(input, mistakes)?;
    if (1..=MAX_INCREMENTS).contains(&found) {
        Some(found)
    } else {
        input.refuse(&format!("1 to {MAX_INCREMENTS}"), mistakes)
    }
}
