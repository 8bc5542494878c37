//! Solids: patches, homogeneous states, exact solutions and contact with rigid obstacles.

mod arch;
mod blocks;
mod homogeneous;
mod known_contacts;
mod meshes;
mod rivlin;

fn trace(request: &arcslip::JobRequest) -> (Vec<arcslip::Increment>, arcslip::Report) {
    let traced = crate::common::paths::judged(request);
    (traced.increments, traced.report)
}
