//! The beam against difference quotients, closed forms and the differential equations of the elastica.

use super::*;
use nalgebra::{DMatrix, DVector};

const SECTION: SectionStiffness = SectionStiffness { axial: 30.0, bending: 0.7, shear: Some(11.0) };

fn beams() -> Vec<Beam> {
    let stiff = SectionStiffness { shear: None, ..SECTION };
    vec![
        Beam::straight([0, 1], [0.6, -0.3], SECTION),
        Beam::straight([0, 1], [0.6, -0.3], stiff),
        Beam::curved([0, 1, 2], [[0.5, 0.1], [0.3, 0.4]], SECTION),
        Beam::curved([0, 1, 2], [[0.5, 0.1], [0.3, 0.4]], stiff),
    ]
}

fn displacement(size: usize, factor: f64) -> Vec<f64> {
    let of = [0.1, -0.2, 0.7, 0.25, -0.05, -0.4, -0.15, 0.3, 1.1];
    of[..size].iter().map(|value| factor * value).collect()
}

fn forces(beam: &Beam, displacement: &[f64]) -> Vec<f64> {
    let mut force = vec![0.0; displacement.len()];
    beam.write_force(displacement, &mut force);
    force
}

fn stiffness(beam: &Beam, displacement: &[f64]) -> DMatrix<f64> {
    let size = displacement.len();
    let mut values = vec![0.0; size * size];
    beam.write_stiffness(displacement, &mut values);
    DMatrix::from_row_slice(size, size, &values)
}

#[test]
fn forces_and_tangent_are_the_derivatives_of_the_energy() {
    for beam in beams() {
        let size = OF_NODE * beam.nodes.len();
        for factor in [0.0, 1.0, -3.0] {
            let at = displacement(size, factor);
            let tangent = stiffness(&beam, &at);
            let force = forces(&beam, &at);
            let scale = tangent.amax();
            assert!((&tangent - tangent.transpose()).amax() <= 1e-13 * scale);
            for freedom in 0..size {
                // Central differences of fourth order.
                let step = 1e-3;
                let moved = |times: f64| {
                    let mut moved = at.clone();
                    moved[freedom] += times * step;
                    moved
                };
                let energy = |times| beam.energy(&moved(times));
                let quotient = (8.0 * (energy(1.0) - energy(-1.0)) - energy(2.0) + energy(-2.0)) / (12.0 * step);
                assert!((quotient - force[freedom]).abs() <= 1e-7 * scale, "{factor} {freedom}: {quotient}");
                let of = |times| DVector::from(forces(&beam, &moved(times)));
                let quotient = ((of(1.0) - of(-1.0)) * 8.0 - of(2.0) + of(-2.0)) / (12.0 * step);
                let error = (quotient - tangent.column(freedom)).amax();
                assert!(error <= 1e-7 * scale, "{factor} {freedom}: {error:e} of {scale}");
            }
        }
    }
}

#[test]
fn a_common_motion_changes_nothing() {
    for beam in beams() {
        let size = OF_NODE * beam.nodes.len();
        let at = displacement(size, 1.0);
        let mut places = vec![[0.0, 0.0]];
        for segment in &beam.segments {
            let [x, y] = places[places.len() - 1];
            let chord = segment.chord();
            places.push([x + chord[0], y + chord[1]]);
        }
        let (sin, cos) = 2.4_f64.sin_cos();
        let mut moved = at.clone();
        for (node, [x, y]) in places.iter().enumerate() {
            let now = [x + at[3 * node], y + at[3 * node + 1]];
            moved[3 * node] = cos * now[0] - sin * now[1] - x + 5.0;
            moved[3 * node + 1] = sin * now[0] + cos * now[1] - y - 3.0;
            moved[3 * node + 2] += 2.4;
        }
        assert!((beam.energy(&moved) - beam.energy(&at)).abs() <= 1e-13 * beam.energy(&at));
        let (before, after) = (forces(&beam, &at), forces(&beam, &moved));
        for node in 0..places.len() {
            let [x, y, moment] = [0, 1, 2].map(|k| before[3 * node + k]);
            let turned = [cos * x - sin * y, sin * x + cos * y, moment];
            (0..3).for_each(|k| assert!((turned[k] - after[3 * node + k]).abs() <= 1e-12));
        }
        // Forces and moments balance.
        let sum = |k: usize| (0..places.len()).map(|node| before[3 * node + k]).sum::<f64>();
        let moments: f64 = (0..places.len())
            .map(|node| {
                let now = [places[node][0] + at[3 * node], places[node][1] + at[3 * node + 1]];
                before[3 * node + 2] + now[0] * before[3 * node + 1] - now[1] * before[3 * node]
            })
            .sum();
        assert!(sum(0).abs() <= 1e-13 && sum(1).abs() <= 1e-13 && moments.abs() <= 1e-13);
    }
}

#[test]
fn small_motions_meet_the_exact_stiffness_of_a_beam_with_shear() {
    let (length, axial, bending, shearing) = (0.4, SECTION.axial, SECTION.bending, 11.0);
    let beam = Beam::straight([0, 1], [length, 0.0], SECTION);
    let tangent = stiffness(&beam, &[0.0; 6]);
    let shear = 12.0 * bending / (shearing * length * length);
    let lateral = 12.0 * bending / (length.powi(3) * (1.0 + shear));
    let near = |one: f64, other: f64| assert!((one - other).abs() <= 1e-12 * other.abs(), "{one} {other}");
    near(tangent[(0, 0)], axial / length);
    near(tangent[(1, 1)], lateral);
    near(tangent[(1, 2)], 0.5 * length * lateral);
    near(tangent[(2, 2)], (4.0 + shear) * bending / (length * (1.0 + shear)));
    near(tangent[(2, 5)], (2.0 - shear) * bending / (length * (1.0 + shear)));
}

#[test]
fn tiny_strains_keep_their_digits() {
    let section = SectionStiffness { axial: 1.0, bending: 1e-14, shear: None };
    let beam = Beam::straight([0, 1], [3.0, 4.0], section);
    // Stretched by 1e-13 and bent by as much.
    let at = [0.0, 0.0, -1e-13, 3e-13, 4e-13, 1e-13];
    let Some(Resultants::Ends([first, second])) = beam.resultants(&at) else { panic!("no resultants") };
    assert!((first.axial_force - 1e-13).abs() < 1e-25 && (second.axial_force - 1e-13).abs() < 1e-25);
    let Some(Resultants::Ends([first, second])) = beam.resultants(&[0.0, 0.0, -1e-13, 0.0, 0.0, 1e-13]) else {
        panic!("no resultants")
    };
    let moment = 1e-14 * 2e-13 / 5.0;
    assert!([first, second].iter().all(|end| (end.bending_moment - moment).abs() < 1e-12 * moment));
}

#[test]
fn a_beam_of_three_nodes_is_an_arc() {
    // Nodes on a circle of radius 2, not evenly spaced.
    let place = |angle: f64| [2.0 * angle.sin(), 2.0 - 2.0 * angle.cos()];
    let (middle, end) = (place(0.5), place(1.4));
    let chords = [middle, [end[0] - middle[0], end[1] - middle[1]]];
    let beam = Beam::curved([0, 1, 2], chords, SECTION);
    assert!((beam.length() - 2.8).abs() < 1e-14);
    assert_eq!(beam.energy(&[0.0; 9]), 0.0);
    assert!((beam.segments[0].half_turn() - 0.25).abs() < 1e-15);
}

/// A chain of elements clamped at its first node.
struct Cantilever {
    beams: Vec<Beam>,
    nodes: usize,
}

impl Cantilever {
    /// A straight cantilever of unit length along x; three-node elements have their middle nodes off the middle.
    fn straight(lengths: &[f64], section: SectionStiffness) -> Self {
        let beams = lengths.iter().enumerate().map(|(k, length)| Beam::straight([k, k + 1], [*length, 0.0], section));
        Self { beams: beams.collect(), nodes: lengths.len() + 1 }
    }

    /// The displacement of the tip under a dead force and a moment there, by Newton's method from a state nearby.
    fn tip(&self, start: Vec<f64>, force: [f64; 2], moment: f64) -> [f64; 3] {
        let (size, mut u) = (OF_NODE * self.nodes, start);
        let free = size - OF_NODE;
        for _ in 0..8 {
            let (mut residual, mut matrix) = (DVector::zeros(size), DMatrix::zeros(size, size));
            for beam in &self.beams {
                let (first, count) = (OF_NODE * beam.nodes[0], OF_NODE * beam.nodes.len());
                let own = &u[first..first + count];
                forces(beam, own).iter().enumerate().for_each(|(k, force)| residual[first + k] += force);
                let mut block = matrix.view_mut((first, first), (count, count));
                block += stiffness(beam, own);
            }
            let applied = [force[0], force[1], moment];
            (0..OF_NODE).for_each(|k| residual[free + k] -= applied[k]);
            let matrix = matrix.view((OF_NODE, OF_NODE), (free, free)).into_owned();
            let change = matrix.lu().solve(&residual.rows(OF_NODE, free).into_owned()).expect("a regular matrix");
            (0..free).for_each(|k| u[OF_NODE + k] -= change[k]);
        }
        [u[free], u[free + 1], u[free + 2]]
    }
}

#[test]
fn a_cantilever_rolls_up_on_any_mesh() {
    let meshes: [&[f64]; 4] = [&[1.0], &[0.1, 0.5, 0.4], &[0.25; 4], &[0.02, 0.38, 0.05, 0.3, 0.25]];
    for lengths in meshes {
        for shear in [None, Some(4e3)] {
            let section = SectionStiffness { axial: 1e4, bending: 2.0, shear };
            let moment = 2.0 * std::f64::consts::PI * section.bending;
            // On the circle of radius 1/2π.
            let mut at = 0.0;
            let mut start = vec![0.0; OF_NODE];
            for length in lengths {
                at += length;
                let turn = 2.0 * std::f64::consts::PI * at;
                start.extend([turn.sin() / (2.0 * std::f64::consts::PI) - at, 0.0, turn]);
                let last = start.len() - 2;
                start[last] = (1.0 - turn.cos()) / (2.0 * std::f64::consts::PI);
            }
            let tip = Cantilever::straight(lengths, section).tip(start, [0.0; 2], moment);
            assert!((tip[0] + 1.0).abs() < 1e-12 && tip[1].abs() < 1e-12, "{lengths:?}: {tip:?}");
            assert!((tip[2] - 2.0 * std::f64::consts::PI).abs() < 1e-12);
        }
    }
}

/// The displacement of a straight cantilever along x of unit length under a dead force at its tip, at so many nodes
/// beside the clamp (the tip to all digits, the others nearly), by the differential equations
///
/// ```text
/// θ' = M/EI,   M' = -(1 + N/EA) Q + (Q/GA) N,   x' = R(θ) (1 + N/EA, Q/GA),   N, Q = R(θ)ᵀ F
/// ```
///
/// with `θ(0) = 0`, `M(1) = 0`: shooting from the clamp, by Runge-Kutta's method of fourth order extrapolated twice.
fn exact(section: SectionStiffness, force: [f64; 2], nodes: usize) -> Vec<f64> {
    let (axial, shear) = (section.axial.recip(), section.shear.map_or(0.0, f64::recip));
    let rates = |[_, _, turn, moment]: [f64; 4]| {
        let (sin, cos) = turn.sin_cos();
        let (normal, across) = (cos * force[0] + sin * force[1], cos * force[1] - sin * force[0]);
        let (stretch, slant) = (1.0 + normal * axial, across * shear);
        [
            cos * stretch - sin * slant,
            sin * stretch + cos * slant,
            moment / section.bending,
            -stretch * across + slant * normal,
        ]
    };
    let shoot = |moment: f64, steps: usize, seen: &mut dyn FnMut(usize, [f64; 4])| {
        let h = 1.0 / steps as f64;
        let mut at = [0.0, 0.0, 0.0, moment];
        for step in 1..=steps {
            let plus = |factor: f64, k: [f64; 4]| std::array::from_fn(|i| at[i] + factor * h * k[i]);
            let k1 = rates(at);
            let k2 = rates(plus(0.5, k1));
            let k3 = rates(plus(0.5, k2));
            let k4 = rates(plus(1.0, k3));
            at = std::array::from_fn(|i| at[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
            seen(step, at);
        }
        at
    };
    let extrapolated = |moment: f64| {
        let [coarse, fine, finest] = [192, 384, 768].map(|steps| shoot(moment, steps, &mut |_, _| ()));
        let next = |fine: [f64; 4], coarse: [f64; 4], factor: f64| -> [f64; 4] {
            std::array::from_fn(|i| fine[i] + (fine[i] - coarse[i]) / (factor - 1.0))
        };
        next(next(finest, fine, 16.0), next(fine, coarse, 16.0), 32.0)
    };
    // The moment at the clamp by the secant method, along the load from the linear solution.
    let (mut one, mut other) = (0.5 * force[1], 0.6 * force[1]);
    let (mut of_one, mut of_other) = (extrapolated(one)[3], extrapolated(other)[3]);
    while (one - other).abs() > 1e-15 * one.abs() && of_one != of_other {
        let next = other - of_other * (other - one) / (of_other - of_one);
        (one, of_one) = (other, of_other);
        (other, of_other) = (next, extrapolated(next)[3]);
    }
    let mut all = vec![0.0; OF_NODE];
    shoot(other, 768, &mut |step, [x, y, turn, _]| {
        if step % (768 / nodes) == 0 {
            all.extend([x - step as f64 / 768.0, y, turn]);
        }
    });
    let [x, y, turn, _] = extrapolated(other);
    let tip = all.len() - OF_NODE;
    all[tip..].copy_from_slice(&[x - 1.0, y, turn]);
    all
}

#[test]
fn the_published_elastica_is_met() {
    let section = SectionStiffness { axial: 1e14, bending: 1.0, shear: None };
    for (load, tip) in
        [(1.0, [0.3017207738, 0.05643323628, 0.4613519497]), (10.0, [0.8106090249, 0.5549955978, 1.430285539])]
    {
        let all = exact(section, [0.0, load], 1);
        let [x, y, turn] = [all[3], all[4], all[5]];
        assert!((y - tip[0]).abs() < 1e-10 && (-x - tip[1]).abs() < 1e-10 && (turn - tip[2]).abs() < 1e-9);
    }
}

#[test]
fn errors_of_a_cantilever_fall_with_the_fourth_order_at_any_slenderness() {
    for exponent in 1..=6 {
        let slenderness = 10.0_f64.powi(exponent);
        let axial = slenderness * slenderness;
        for shear in [None, Some(axial / 3.0)] {
            let section = SectionStiffness { axial, bending: 1.0, shear };
            let force = [0.0, 10.0];
            let errors = [4, 8, 16, 32].map(|count| {
                let exact = exact(section, force, count);
                let at_tip = exact[OF_NODE * count..].to_vec();
                let tip = Cantilever::straight(&vec![1.0 / count as f64; count], section).tip(exact, force, 0.0);
                tip.iter().zip(at_tip).fold(0.0_f64, |most, (one, other)| most.max((one - other).abs()))
            });
            let orders: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
            println!("1e{exponent} {shear:?}: {:?} {orders:.2?}", errors.map(|e| format!("{e:.2e}")));
            assert!(errors[3] < 1e-6 && orders[1] > 3.8 && orders[2] > 3.8, "{errors:?} {orders:?}");
        }
    }
}
