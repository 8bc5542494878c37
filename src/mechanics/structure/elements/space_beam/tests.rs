//! The beam in space against difference quotients, the plane's beam, closed forms and the differential equations of a
//! rod.

use super::*;
use crate::mechanics::rotation::vector_near;
use crate::mechanics::structure::elements::beam::Beam;
use crate::mechanics::structure::elements::beam::segment::SectionStiffness;
use nalgebra::{DMatrix, DVector, Matrix3};

const SECTION: SpaceSectionStiffness =
    SpaceSectionStiffness { axial: 30.0, bending: [0.7, 1.9], torsional: 0.4, shear: Some(11.0) };

fn beams() -> Vec<SpaceBeam> {
    let stiff = SpaceSectionStiffness { shear: None, ..SECTION };
    let across = [0.1, 0.2, 1.0];
    let mut beams = Vec::new();
    for section in [SECTION, stiff] {
        beams.push(SpaceBeam::straight([0, 1], [0.6, -0.3, 0.2], across, section));
        beams.push(SpaceBeam::curved([0, 1, 2], [[0.5, 0.1, 0.1], [0.3, 0.4, -0.1]], across, section));
    }
    // Measured from rotations of their own, too.
    let mut referred = beams.clone();
    for beam in &mut referred {
        let mut references = vec![0.0; OF_NODE * beam.nodes.len()];
        for (node, values) in references.chunks_mut(OF_NODE).enumerate() {
            values[3..].copy_from_slice(&[0.4 - 0.1 * node as f64, 7.0, -0.3]);
        }
        beam.refer(&references);
    }
    beams.append(&mut referred);
    beams
}

fn displacement(beam: &SpaceBeam, factor: f64) -> Vec<f64> {
    let of =
        [[0.1, -0.2, 0.15, 0.7, 0.2, -0.3], [0.25, -0.05, 0.1, -0.1, 0.5, -0.4], [-0.15, 0.1, -0.2, 0.3, 0.6, -0.7]];
    let nodes = of.iter().zip(&beam.references);
    nodes
        .flat_map(|(of, (reference, _))| {
            (0..OF_NODE).map(|k| factor * of[k] + if k < 3 { 0.0 } else { reference[k - 3] }).collect::<Vec<_>>()
        })
        .collect()
}

fn forces(beam: &SpaceBeam, displacement: &[f64]) -> Vec<f64> {
    let mut force = vec![0.0; displacement.len()];
    beam.write_force(displacement, &mut force);
    force
}

fn stiffness(beam: &SpaceBeam, displacement: &[f64]) -> DMatrix<f64> {
    let size = displacement.len();
    let mut values = vec![0.0; size * size];
    beam.write_stiffness(displacement, &mut values);
    DMatrix::from_row_slice(size, size, &values)
}

#[test]
fn forces_and_tangent_are_the_derivatives_of_the_energy() {
    for beam in beams() {
        for factor in [0.0, 1.0, -1.3] {
            let at = displacement(&beam, factor);
            let (tangent, force) = (stiffness(&beam, &at), forces(&beam, &at));
            let scale = tangent.amax();
            assert_eq!(tangent, tangent.transpose());
            for freedom in 0..at.len() {
                // Central differences of fourth order.
                let step = 1e-3;
                let moved = |times: f64| {
                    let mut moved = at.clone();
                    moved[freedom] += times * step;
                    moved
                };
                let energy = |times| beam.energy(&moved(times));
                let quotient = (8.0 * (energy(1.0) - energy(-1.0)) - energy(2.0) + energy(-2.0)) / (12.0 * step);
                assert!((quotient - force[freedom]).abs() <= 1e-8 * scale, "{factor} {freedom}: {quotient} {force:?}");
                let of = |times| DVector::from(forces(&beam, &moved(times)));
                let quotient = ((of(1.0) - of(-1.0)) * 8.0 - of(2.0) + of(-2.0)) / (12.0 * step);
                let error = (quotient - tangent.column(freedom)).amax();
                assert!(error <= 1e-8 * scale, "{factor} {freedom}: {error:e} of {scale}");
            }
        }
    }
}

/// Displacements after a common rotation about the origin, at which the first node lies, and a shift.
fn turned_too(beam: &SpaceBeam, at: &[f64], about: [f64; 3]) -> Vec<f64> {
    let turn = quaternion(&about);
    let matrix = nalgebra::UnitQuaternion::new_normalize(turn).to_rotation_matrix();
    let mut place = Vector3::zeros();
    let mut moved = at.to_vec();
    for (node, values) in moved.chunks_mut(OF_NODE).enumerate() {
        if node > 0 {
            place += beam.segments[node - 1].undeformed();
        }
        let now = matrix * (place + Vector3::new(values[0], values[1], values[2])) - place;
        let reference = beam.references[node].0;
        let total: [f64; 3] = std::array::from_fn(|k| values[3 + k] - reference[k]);
        let vector = vector_near(&(turn * quaternion(&total)), &total);
        (0..3).for_each(|k| values[k] = now[k] + [5.0, -3.0, 2.0][k]);
        (0..3).for_each(|k| values[3 + k] = reference[k] + vector[k]);
    }
    moved
}

#[test]
fn a_common_motion_changes_nothing() {
    for beam in beams() {
        let at = displacement(&beam, 1.0);
        let moved = turned_too(&beam, &at, [0.9, -1.1, 0.4]);
        assert!((beam.energy(&moved) - beam.energy(&at)).abs() <= 1e-13 * beam.energy(&at).max(1.0));
        let (Some(Resultants::SpaceEnds(before)), Some(Resultants::SpaceEnds(after))) =
            (beam.resultants(&at), beam.resultants(&moved))
        else {
            panic!("no resultants")
        };
        for (one, other) in before.iter().zip(&after) {
            let all = |end: &SpaceBeamEnd| {
                let ([a, b], [c, d]) = (end.shear_forces, end.bending_moments);
                [end.axial_force, a, b, end.torsional_moment, c, d]
            };
            all(one).iter().zip(all(other)).for_each(|(one, other)| assert!((one - other).abs() < 1e-11));
        }
    }
}

/// A frame in an oblique plane has the energy, the forces and the moments of the plane's beam.
#[test]
fn in_a_plane_it_is_the_beam_of_the_plane() {
    let turn = nalgebra::Rotation3::new(Vector3::new(0.7, -0.4, 1.3));
    let space = |x: f64, y: f64| -> [f64; 3] { (turn * Vector3::new(x, y, 0.0)).into() };
    for shear in [None, Some(11.0)] {
        let section = SpaceSectionStiffness { shear, ..SECTION };
        let of_plane = SectionStiffness { axial: section.axial, bending: section.bending[0], shear };
        let normal = space_normal(&turn);
        let chords = [[0.5, 0.1], [0.3, 0.4]];
        let pairs = [
            (
                Beam::straight([0, 1], chords[0], of_plane),
                SpaceBeam::straight([0, 1], space(0.5, 0.1), normal, section),
            ),
            (
                Beam::curved([0, 1, 2], chords, of_plane),
                SpaceBeam::curved([0, 1, 2], chords.map(|[x, y]| space(x, y)), normal, section),
            ),
        ];
        for (plane, beam) in pairs {
            let at = [0.1, -0.2, 0.7, 0.25, -0.05, -0.4, -0.15, 0.3, 1.1];
            let at = &at[..3 * plane.nodes().len()];
            let in_space: Vec<f64> = at
                .chunks(3)
                .flat_map(|node| [space(node[0], node[1]), normal.map(|part| part * node[2])].concat())
                .collect();
            let mut force = vec![0.0; at.len()];
            plane.write_force(at, &mut force);
            assert!((plane.energy(at) - beam.energy(&in_space)).abs() <= 1e-13);
            for (own, other) in forces(&beam, &in_space).chunks(OF_NODE).zip(force.chunks(3)) {
                let expected = [space(other[0], other[1]), normal.map(|part| part * other[2])].concat();
                own.iter().zip(&expected).for_each(|(own, other)| assert!((own - other).abs() < 1e-12));
            }
            let (Some(Resultants::Ends(one)), Some(Resultants::SpaceEnds(other))) =
                (plane.resultants(at), beam.resultants(&in_space))
            else {
                panic!("no resultants")
            };
            for (one, other) in one.iter().zip(&other) {
                assert!((one.axial_force - other.axial_force).abs() < 1e-12);
                // Axis 1 is the plane's normal, axis 2 points against the plane's `n`.
                assert!((one.shear_force + other.shear_forces[1]).abs() < 1e-12, "{one:?} {other:?}");
                assert!((one.bending_moment - other.bending_moments[0]).abs() < 1e-12);
                assert!(other.torsional_moment.abs() < 1e-12 && other.shear_forces[0].abs() < 1e-12);
            }
        }
    }
}

fn space_normal(turn: &nalgebra::Rotation3<f64>) -> [f64; 3] {
    (turn * Vector3::z()).into()
}

#[test]
fn small_motions_meet_the_exact_stiffness_of_a_beam() {
    let (length, [first, second]) = (0.4, SECTION.bending);
    let beam = SpaceBeam::straight([0, 1], [length, 0.0, 0.0], [0.0, 1.0, 0.0], SECTION);
    let tangent = stiffness(&beam, &[0.0; 12]);
    let near = |one: f64, other: f64| assert!((one - other).abs() <= 1e-12 * other.abs(), "{one} {other}");
    near(tangent[(0, 0)], SECTION.axial / length);
    near(tangent[(3, 3)], SECTION.torsional / length);
    // Bending about axis 1 (y) moves along z, about axis 2 (z) along y.
    for (bending, along, about) in [(first, 2, 4), (second, 1, 5)] {
        let shear = 12.0 * bending / (11.0 * length * length);
        near(tangent[(along, along)], 12.0 * bending / (length.powi(3) * (1.0 + shear)));
        near(tangent[(about, about)], (4.0 + shear) * bending / (length * (1.0 + shear)));
    }
}

#[test]
fn a_segment_turns_by_almost_a_full_turn() {
    let beam = SpaceBeam::straight([0, 1], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0], SECTION);
    for turn in [0.5, 3.0, 3.2, 6.0] {
        // Twisted, and rolled up to an arc.
        let twisted = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, turn, 0.0, 0.0];
        assert!((beam.energy(&twisted) - 0.5 * SECTION.torsional * turn * turn / 2.0).abs() < 1e-12, "{turn}");
        let radius = 2.0 / turn;
        let (x, y) = (radius * turn.sin() - 2.0, radius * (1.0 - turn.cos()));
        let rolled = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, x, y, 0.0, 0.0, 0.0, turn];
        let energy = 0.5 * SECTION.bending[0] * turn * turn / 2.0;
        assert!((beam.energy(&rolled) - energy).abs() < 1e-11, "{turn}: {} {energy}", beam.energy(&rolled));
    }
}

/// A clamped rod of `count` elements under a dead force at its free end, found by Newton's method with references that
/// follow.
fn tip(beams: &mut [SpaceBeam], force: [f64; 3], steps: usize) -> Vec<f64> {
    let nodes = beams.last().map_or(0, |beam| beam.nodes[beam.nodes.len() - 1] + 1);
    let size = OF_NODE * nodes;
    let mut at = vec![0.0; size];
    for step in 1..=steps {
        let share = step as f64 / steps as f64;
        for _ in 0..30 {
            let (mut residual, mut matrix) = (DVector::zeros(size), DMatrix::zeros(size, size));
            for beam in beams.iter() {
                let (first, count) = (OF_NODE * beam.nodes[0], OF_NODE * beam.nodes.len());
                let own = &at[first..first + count];
                forces(beam, own).iter().enumerate().for_each(|(k, force)| residual[first + k] += force);
                let mut block = matrix.view_mut((first, first), (count, count));
                block += stiffness(beam, own);
            }
            let (free, loaded) = (size - OF_NODE, size - OF_NODE);
            (0..3).for_each(|k| residual[loaded + k] -= share * force[k]);
            let matrix = matrix.view((OF_NODE, OF_NODE), (free, free)).into_owned();
            let change = matrix.lu().solve(&residual.rows(OF_NODE, free).into_owned()).expect("a regular matrix");
            (0..free).for_each(|k| at[OF_NODE + k] -= change[k]);
            for node in 0..nodes {
                let own = OF_NODE * node + 3;
                let reference = beams.iter().find_map(|beam| {
                    beam.nodes.iter().position(|other| *other == node).map(|place| beam.references[place])
                });
                let Some((reference, turned)) = reference else { continue };
                let moved: [f64; 3] = std::array::from_fn(|k| at[own + k] - reference[k]);
                let total = vector_near(&(quaternion(&moved) * turned), &[at[own], at[own + 1], at[own + 2]]);
                at[own..own + 3].copy_from_slice(&total);
            }
            for beam in beams.iter_mut() {
                let (first, count) = (OF_NODE * beam.nodes[0], OF_NODE * beam.nodes.len());
                beam.refer(&at[first..first + count]);
            }
            if change.amax() < 1e-13 * (1.0 + at.iter().fold(0.0_f64, |most, value| most.max(value.abs()))) {
                break;
            }
        }
    }
    at[size - OF_NODE..].to_vec()
}

/// The place of the free end of a rod clamped at the origin that is an arc of curvature `curved` about axis `z`, along
/// `x` there, of length 1, under a dead force: Kirchhoff's and Reissner's equations
///
/// ```text
/// x' = Λ (1 + N_1/EA, N_2/GA, N_3/GA),   Λ' = Λ [κ],   κ = κ_0 + B⁻¹ M,   M' = -κ × M - Γ × N,   N = Λᵀ f
/// ```
///
/// by shooting from the clamp, with the method of Runge and Kutta extrapolated.
fn exact(section: SpaceSectionStiffness, axes: Matrix3<f64>, curved: [f64; 3], force: Vector3<f64>) -> Vector3<f64> {
    let soft = Vector3::new(section.torsional.recip(), section.bending[0].recip(), section.bending[1].recip());
    let shear = section.shear.map_or(0.0, f64::recip);
    let stretch = Vector3::new(section.axial.recip(), shear, shear);
    // Place, frame and moment in the frame.
    type Rod = (Vector3<f64>, Matrix3<f64>, Vector3<f64>);
    let rates = |(_, frame, moment): &Rod, force: &Vector3<f64>| -> Rod {
        let normal = frame.tr_mul(force);
        let strain = Vector3::x() + stretch.component_mul(&normal);
        let bent = Vector3::from(curved) + soft.component_mul(moment);
        (frame * strain, frame * bent.cross_matrix(), -bent.cross(moment) - strain.cross(&normal))
    };
    let shoot = |moment: Vector3<f64>, force: &Vector3<f64>, steps: usize| -> Rod {
        let h = 1.0 / steps as f64;
        let mut at: Rod = (Vector3::zeros(), axes, moment);
        for _ in 0..steps {
            let plus = |f: f64, k: &Rod| (at.0 + k.0 * (f * h), at.1 + k.1 * (f * h), at.2 + k.2 * (f * h));
            let k1 = rates(&at, force);
            let k2 = rates(&plus(0.5, &k1), force);
            let k3 = rates(&plus(0.5, &k2), force);
            let k4 = rates(&plus(1.0, &k3), force);
            let sixth = h / 6.0;
            at = (
                at.0 + (k1.0 + (k2.0 + k3.0) * 2.0 + k4.0) * sixth,
                at.1 + (k1.1 + (k2.1 + k3.1) * 2.0 + k4.1) * sixth,
                at.2 + (k1.2 + (k2.2 + k3.2) * 2.0 + k4.2) * sixth,
            );
        }
        at
    };
    let extrapolated = |moment: Vector3<f64>, force: &Vector3<f64>| {
        let [coarse, fine] = [200, 400].map(|steps| shoot(moment, force, steps));
        (fine.0 + (fine.0 - coarse.0) / 15.0, fine.2 + (fine.2 - coarse.2) / 15.0)
    };
    let mut moment = Vector3::zeros();
    for share in 1..=10 {
        let force = force * (f64::from(share) / 10.0);
        for _ in 0..20 {
            let (_, end) = extrapolated(moment, &force);
            let mut slope = Matrix3::zeros();
            for k in 0..3 {
                let step = 1e-5 * (1.0 + moment.norm());
                let mut other = moment;
                other[k] += step;
                slope.set_column(k, &((extrapolated(other, &force).1 - end) / step));
            }
            let change = slope.lu().solve(&end).expect("a regular slope");
            moment -= change;
            if change.norm() < 1e-12 * (1.0 + moment.norm()) {
                break;
            }
        }
    }
    extrapolated(moment, &force).0
}

/// A rod of `count` two-node (straight) or three-node (curved) elements that starts along `x` and turns about `z`.
fn rod(count: usize, curved: f64, orientation: [f64; 3], section: SpaceSectionStiffness) -> Vec<SpaceBeam> {
    let place = |s: f64| {
        if curved == 0.0 {
            return Vector3::new(s, 0.0, 0.0);
        }
        Vector3::new((curved * s).sin() / curved, (1.0 - (curved * s).cos()) / curved, 0.0)
    };
    let h = 1.0 / count as f64;
    (0..count)
        .map(|k| {
            let s = k as f64 * h;
            if curved == 0.0 {
                let chord = place(s + h) - place(s);
                SpaceBeam::straight([k, k + 1], chord.into(), orientation, section)
            } else {
                let chords = [place(s + 0.5 * h) - place(s), place(s + h) - place(s + 0.5 * h)];
                SpaceBeam::curved([2 * k, 2 * k + 1, 2 * k + 2], chords.map(Into::into), orientation, section)
            }
        })
        .collect()
}

#[test]
fn errors_fall_with_the_fourth_order() {
    let wide = SpaceSectionStiffness { axial: 1e6, bending: [1.0, 3.0], torsional: 0.6, shear: None };
    let shearing = SpaceSectionStiffness { axial: 400.0, bending: [1.0, 0.5], torsional: 0.8, shear: Some(150.0) };
    for (section, curved, force) in [
        (wide, 0.0, [-0.5, 2.0, 3.0]),
        (shearing, 0.0, [-1.0, 2.0, 4.0]),
        (shearing, 0.8, [0.0, 1.0, 5.0]),
        (wide, 0.8, [0.0, 0.0, 5.0]),
    ] {
        let orientation = [0.0, 0.0, 1.0];
        let axes = Matrix3::from_columns(&[Vector3::x(), Vector3::z(), -Vector3::y()]);
        let expected = exact(section, axes, [0.0, curved, 0.0], force.into());
        let end = if curved == 0.0 {
            Vector3::x()
        } else {
            Vector3::new(curved.sin() / curved, (1.0 - curved.cos()) / curved, 0.0)
        };
        let errors = [4, 8, 16].map(|count| {
            let found = tip(&mut rod(count, curved, orientation, section), force, 24);
            (Vector3::new(found[0], found[1], found[2]) + end - expected).amax()
        });
        let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
        println!("{section:?} {curved}: {} {orders:.2?}", errors.map(|e| format!("{e:.2e} ")).concat());
        assert!(errors[2] < 1e-5 && orders.iter().all(|order| *order > 3.6), "{errors:?} {orders:?}");
    }
}
