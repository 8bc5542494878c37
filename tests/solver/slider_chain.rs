//! Sliders in a row (a hundred of them: `many_contacts`): block m+1 starts to slip exactly at `s = (m+1) μ W`, block m then having moved `μ W/k` past block
//! m+1's rest position; when the last one slips nothing resists any more.

use crate::common::paths::{close, scene_file, trace};
use arcslip::result::increment::{Increment, PointKind, Status};
use arcslip::result::stop_reason::StopReason;

fn check(increments: &[Increment], n: usize, friction: f64, weight: f64, stiffness: f64) {
    let force = friction * weight;
    let pull: Vec<&Increment> = increments.iter().filter(|increment| &*increment.stage == "pull").collect();
    let events: Vec<&&Increment> =
        pull.iter().filter(|i| matches!(i.point.kind, PointKind::ContactChange | PointKind::End)).collect();
    assert_eq!(events.len(), n, "one event a block");
    for (m, event) in events.iter().enumerate() {
        close(event.load_factor, (m + 1) as f64 * force, 1e-10, "load at which the next block slips");
        // The spring before block k carries what the blocks from k to m hold back.
        for block in 0..m {
            let here = event.displacements[format!("block{block}").as_str()][0];
            let next = event.displacements[format!("block{}", block + 1).as_str()][0];
            close((here - next) * stiffness, (m - block) as f64 * force, 1e-10 * n as f64, "force of a spring");
        }
        let still = &event.displacements[format!("block{m}").as_str()];
        close(still[0], 0.0, 1e-12, "the block has not moved yet");
    }
    for increment in &pull {
        for (block, contact) in increment.contacts.iter().enumerate() {
            close(contact.normal_reaction, weight, 1e-10, "weight");
            let slips = (block as f64) < increment.load_factor / force - 1.0 - 1e-9;
            assert!(contact.status == Status::Slip || !slips, "block {block} at {}", increment.load_factor);
        }
    }
}

#[test]
fn five_built_in() {
    let (increments, report) = trace(&scene_file("slider-chain"));
    assert_eq!(report.stop_reason, StopReason::Mechanism);
    check(&increments, 5, 0.5, 1.0, 1.0);
}
