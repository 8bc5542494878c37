//! The sum of the friction cones of a node's obstacles.
//!
//! A force `R` lies in the sum of the cones `K_i` if and only if its scalar product with every direction in the
//! intersection of the dual cones is nonnegative (the bipolar theorem: R. T. Rockafellar, *Convex Analysis*, Princeton
//! 1970, §14):
//!
//! ```text
//! R in Σ K_i   <=>   min { y·R : |y| = 1, y·n_i >= sin φ_i } >= 0,      tan φ_i = μ_i
//! ```
//!
//! The set of the directions `y` is bounded by circles on the sphere, so that the minimum is at `-R/|R|`, at the point
//! of a circle nearest to `-R/|R|`, or where two circles intersect. Where no such `y` exists, the node is jammed. At
//! the minimum
//!
//! ```text
//! R = (y·R) y + Σ a_i (n_i - μ_i d_i),      a_i >= 0,  d_i along the part of y across n_i
//! ```
//!
//! with the obstacles on whose circles `y` lies: on the bound of the sum these alone carry the force.

use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::vector::{Vector, add, cross, dot, scaled, size, unit};
use crate::mechanics::multi_contact::spatial::tolerances::{BOUND_TOLERANCE, CONE_TOLERANCE, SHARED_BOUND_DISTANCE};
use crate::mechanics::multi_contact::spatial::{ContactGroup, along};

/// Whether the sum of the friction cones is all of space: no direction lies in all dual cones.
pub fn is_jammed(group: &ContactGroup) -> bool {
    let sines = sines(group);
    let normals = group.normals.iter().map(unit).collect();
    // The intersection of the dual cones has a corner, or is one cap.
    let bounds = match group.free.len() {
        3 => meetings(group, &sines),
        2 => bounds_in_a_plane(group, &sines),
        _ => Vec::new(),
    };
    ![normals, bounds].concat().iter().any(|direction| keeps_off(group, direction, &sines))
}

/// The distance of a force from the bound of the sum of the cones: negative outside, infinite where there is no
/// bound.
pub fn distance_from_bound(group: &ContactGroup, force: &Vector) -> f64 {
    bounds_seen_from(group, force).iter().map(|inward| dot(inward, force)).fold(f64::INFINITY, f64::min)
}

/// The derivative of [`distance_from_bound`] along a rate of the force.
pub fn distance_slope(group: &ContactGroup, force: &Vector, rate: &Vector) -> f64 {
    nearest_bound(group, force).map_or(0.0, |inward| dot(&inward, rate))
}

/// Whether a force is on the bound of the sum of the cones.
pub fn is_at_bound(group: &ContactGroup, force: &Vector, zero: f64) -> bool {
    distance_from_bound(group, force) <= zero
}

/// The smallest derivative along the rate of a force on the bound of the sum of the cones; infinite where the force
/// is not on the bound.
pub(super) fn slope_at_bound(group: &ContactGroup, force: &Vector, zero: f64, rate: &Vector) -> f64 {
    let bounds = bounds_seen_from(group, force);
    let at_bound = bounds.iter().filter(|inward| dot(inward, force) <= zero);
    at_bound.map(|inward| dot(inward, rate)).fold(f64::INFINITY, f64::min)
}

fn nearest_bound(group: &ContactGroup, force: &Vector) -> Option<Vector> {
    bounds_seen_from(group, force).into_iter().min_by(|a, b| dot(a, force).total_cmp(&dot(b, force)))
}

/// The sines of the friction angles, with the cones restricted to the free directions of the node.
fn sines(group: &ContactGroup) -> Vec<f64> {
    let sine = |(normal, friction): (&Vector, &CoulombFriction)| {
        friction.coefficient / friction.coefficient.hypot(size(normal))
    };
    group.normals.iter().zip(&group.frictions).map(sine).collect()
}

fn keeps_off(group: &ContactGroup, direction: &Vector, sines: &[f64]) -> bool {
    let fits = |(normal, sine): (&Vector, &f64)| dot(&unit(normal), direction) >= sine - CONE_TOLERANCE;
    group.normals.iter().zip(sines).all(fits)
}

/// Inward unit normals of the sum of the cones, among them the normal of the bound nearest to a force.
fn bounds_seen_from(group: &ContactGroup, force: &Vector) -> Vec<Vector> {
    let sines = sines(group);
    let away = scaled(&unit(force), -1.0);
    let mut bounds = vec![away];
    match group.free.len() {
        3 => {
            let nearest = |(normal, sine): (&Vector, &f64)| {
                let across = unit(&add(&away, -dot(&away, normal), normal));
                add(&scaled(normal, *sine), (1.0 - sine * sine).max(0.0).sqrt(), &across)
            };
            bounds.extend(group.normals.iter().zip(&sines).map(nearest));
            bounds.extend(meetings(group, &sines));
        }
        2 => bounds.extend(bounds_in_a_plane(group, &sines)),
        _ => bounds.extend(group.normals.iter().map(unit)),
    }
    bounds.retain(|direction| size(direction) > 0.0 && keeps_off(group, direction, &sines));
    bounds
}

/// The directions in which the bounds of two dual cones intersect, in space.
fn meetings(group: &ContactGroup, sines: &[f64]) -> Vec<Vector> {
    let of = |[first, second]: [usize; 2]| {
        let (a, b) = (unit(&group.normals[first]), unit(&group.normals[second]));
        let cosine = dot(&a, &b);
        let determinant = 1.0 - cosine * cosine;
        let (x, y) = (sines[first] - cosine * sines[second], sines[second] - cosine * sines[first]);
        let inside = add(&scaled(&a, x / determinant), y / determinant, &b);
        let rest = 1.0 - dot(&inside, &inside);
        let across = unit(&cross(&a, &b));
        let height = rest.max(0.0).sqrt();
        let heights = if rest >= -CONE_TOLERANCE { [height, -height].to_vec() } else { Vec::new() };
        heights.into_iter().map(move |height| add(&inside, height, &across))
    };
    group.pairs().flat_map(of).collect()
}

/// The bounds of the dual cones, in a plane.
fn bounds_in_a_plane(group: &ContactGroup, sines: &[f64]) -> Vec<Vector> {
    let [first, second] = group.free[..] else { return Vec::new() };
    let axis = cross(&first, &second);
    let of = |(normal, sine): (&Vector, &f64)| {
        let (along, across) = (unit(normal), cross(&axis, &unit(normal)));
        let cosine = (1.0 - sine * sine).max(0.0).sqrt();
        [cosine, -cosine].map(|cosine| add(&scaled(&along, *sine), cosine, &across))
    };
    group.normals.iter().zip(sines).flat_map(of).collect()
}

/// The reactions that carry a force in space on the bound of the sum of the cones.
pub(super) fn at_bound(group: &ContactGroup, force: &Vector) -> Option<Vec<Vector>> {
    let inward = nearest_bound(group, force).filter(|_| group.free.len() == 3)?;
    let margin = dot(&inward, force);
    if margin.abs() > SHARED_BOUND_DISTANCE * size(force) {
        return None;
    }
    let sines = sines(group);
    let bears = |place: &usize| dot(&group.normals[*place], &inward) - sines[*place] <= BOUND_TOLERANCE;
    let ray = |place: usize| {
        let normal = &group.normals[place];
        let direction = unit(&add(&inward, -dot(&inward, normal), normal));
        group.frictions[place].force_direction(normal, &direction)
    };
    let rays: Vec<(usize, Vector)> = (0..group.contacts.len()).filter(bears).map(|place| (place, ray(place))).collect();
    let mut parts = vec![[0.0; 3]; group.contacts.len()];
    let sizes = match &rays[..] {
        [(_, only)] => vec![dot(only, force) / dot(only, only)],
        [(_, a), (_, b)] => {
            let across = [cross(b, &inward), cross(a, &inward)];
            vec![dot(&across[0], force) / dot(&across[0], a), dot(&across[1], force) / dot(&across[1], b)]
        }
        _ => return None,
    };
    if !sizes.iter().all(|part| *part >= -CONE_TOLERANCE * size(force)) {
        return None;
    }
    for ((place, ray), part) in rays.iter().zip(&sizes) {
        parts[*place] = scaled(ray, part.max(0.0));
    }
    // The remainder points into the cones.
    let rest = parts.iter().fold(*force, |rest, part| add(&rest, -1.0, part));
    let bearer = parts.iter_mut().max_by(|a, b| size(a).total_cmp(&size(b)))?;
    *bearer = add(bearer, 1.0, &along(&group.free, &rest));
    Some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::contact::least_norm_projection::least_reactions;
    use crate::mechanics::contact::obstacle::RigidSurface;
    use crate::mechanics::contact::{ContactPair, Frame, Sliding};

    const SPACE: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    fn group(planes: &[(Vector, f64)]) -> ContactGroup {
        let contact = |normal: Vector, friction: f64| ContactPair {
            kinematics: crate::mechanics::contact::kinematics::Kinematics::Node(0),
            obstacle: RigidSurface::Plane { normal },
            initial_gap: 0.0,
            friction: CoulombFriction::new(friction),
            sliding: Sliding::Plane,
        };
        let frame = |(normal, friction): &(Vector, f64)| contact(*normal, *friction).frame(&[0.0; 3]);
        let frames: Vec<Frame> = planes.iter().map(frame).collect();
        ContactGroup {
            contacts: (0..planes.len()).collect(),
            normals: frames.iter().map(|frame| frame.normal).collect(),
            frames,
            frictions: planes.iter().map(|(_, friction)| CoulombFriction::new(*friction)).collect(),
            free: SPACE.to_vec(),
            is_driven: false,
        }
    }

    /// Directions spread over the sphere.
    fn directions(count: u32) -> impl Iterator<Item = Vector> {
        (0..count).map(move |k| {
            let (angle, height) =
                (f64::from(k) * 2.399_963_229_728_653, 1.0 - (2.0 * f64::from(k) + 1.0) / f64::from(count));
            let across = (1.0 - height * height).sqrt();
            [across * angle.cos(), across * angle.sin(), height]
        })
    }

    /// A groove of flanks at the angle β to the vertical holds a pull along it of `μ/√(sin²β - μ² cos²β)` times the
    /// load.
    #[test]
    fn a_groove_holds_more_than_it_slides_at() {
        let (sine, cosine) = 50.0_f64.to_radians().sin_cos();
        let friction = 0.4;
        let groove = group(&[([cosine, 0.0, sine], friction), ([-cosine, 0.0, sine], friction)]);
        let most = friction / (sine * sine - friction * friction * cosine * cosine).sqrt();
        assert!(distance_from_bound(&groove, &[0.0, most, 1.0]).abs() < 1e-15);
        assert!(
            distance_from_bound(&groove, &[0.0, 0.999 * most, 1.0]) > 1e-4
                && distance_from_bound(&groove, &[0.0, 1.001 * most, 1.0]) < -1e-4
        );
        assert!(groove.margin(&[0.0, friction / sine, 1.0]).abs() < 1e-15 && friction / sine < most);
        let parts = at_bound(&groove, &[0.0, most, 1.0]).expect("parts");
        for (part, frame) in parts.iter().zip(&groove.frames) {
            let normal = dot(part, &frame.normal);
            assert!((size(&add(part, -normal, &frame.normal)) - friction * normal).abs() < 1e-14 && normal > 0.0);
        }
    }

    /// A force lies in the sum of the cones exactly where reactions of least norm are found.
    #[test]
    fn what_is_held_has_reactions() {
        let unit = |vector: Vector| unit(&vector);
        let cases = [
            vec![(unit([1.0, 0.2, 0.3]), 0.5), (unit([-0.4, 0.9, 0.1]), 0.2)],
            vec![(unit([1.0, 0.2, 0.3]), 1.5), (unit([-0.9, 0.3, 0.1]), 0.1)],
            vec![(unit([0.0, 0.1, 1.0]), 0.0), (unit([0.3, 0.0, 1.0]), 0.7)],
            vec![(unit([0.0, 0.1, 1.0]), 0.0), (unit([0.3, 0.0, 1.0]), 0.3), (unit([0.3, 1.0, 0.2]), 0.6)],
            vec![(unit([1.0, 0.0, 0.1]), 1.2), (unit([-1.0, 0.3, 0.1]), 0.9)],
        ];
        for planes in cases {
            let group = group(&planes);
            let mut held = 0;
            for force in directions(1000) {
                let margin = distance_from_bound(&group, &force);
                let found = least_reactions(&group.cones(), &group.free, &force).is_some();
                assert!(margin.abs() < 1e-6 || (margin > 0.0) == found, "{planes:?}: {force:?}, {margin}");
                assert!(!is_jammed(&group) || margin == f64::INFINITY);
                held += u32::from(found);
            }
            assert!(held > 0 && (held == 1000) == is_jammed(&group), "{planes:?}: {held}");
        }
    }
}
