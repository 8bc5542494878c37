//! Successive increments in space with several contacts: a chain of blocks on the floor `z >= 0`, tied by isotropic
//! springs, each block pressed, the first one pulled along the floor. The exact solution is known: block m + 1 starts
//! to slip at the load `(m + 1) μ W`, and all blocks move along the pull.

use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::kinematics::Kinematics;
use crate::mechanics::contact::obstacle::RigidSurface;
use crate::mechanics::contact::{ContactPair, Reaction, Sliding};
use crate::mechanics::problem::loading::LoadPattern;
use crate::mechanics::structure::Structure;
use crate::mechanics::structure::elements::spring::Spring;
use crate::step::increment_mpec::tests_in_space::{forces, in_plane, on_floor};
use crate::step::increment_mpec::*;

struct Chain {
    structure: Structure,
    contacts: Vec<ContactPair>,
    pattern: LoadPattern,
    held: LoadPattern,
    pull: [f64; 2],
    friction: f64,
    weight: f64,
    stiffness: f64,
    blocks: usize,
}

impl Chain {
    fn new(blocks: usize, friction: f64, angle: f64) -> Self {
        let (weight, stiffness) = (1.0, 2.0);
        let pull = [angle.cos(), angle.sin()];
        let mut matrix = [[0.0; 3]; 3];
        (0..3).for_each(|k| matrix[k][k] = stiffness);
        let tie = |block: usize| Spring::between([block, block + 1], matrix);
        let structure = Structure::new(3, blocks, &[], (0..blocks - 1).map(tie).collect());
        let floor = RigidSurface::Plane { normal: [0.0, 0.0, 1.0] };
        let contact = |node| ContactPair {
            kinematics: Kinematics::Node(node),
            obstacle: floor.clone(),
            initial_gap: 0.0,
            friction: CoulombFriction::new(friction),
            sliding: Sliding::Plane,
        };
        let mut pattern = vec![0.0; 3 * blocks];
        pattern[..2].copy_from_slice(&pull);
        let held = (0..blocks).flat_map(|_| [0.0, 0.0, -weight]).collect();
        let contacts = (0..blocks).map(contact).collect();
        let (pattern, held) = (forces(pattern, blocks), forces(held, blocks));
        Self { structure, contacts, pattern, held, pull, friction, weight, stiffness, blocks }
    }

    fn loading(&self) -> Loading<'_> {
        Loading {
            structure: &self.structure,
            contacts: &self.contacts,
            corners: &[],
            pattern: &self.pattern,
            held: &self.held,
        }
    }

    /// Pressed, and not yet pulled.
    fn pressed(&self) -> State {
        let mut state = State::at_rest(&self.structure, self.blocks);
        state.reactions.fill(Reaction { normal: self.weight, ..Reaction::default() });
        state
    }

    /// The exact motion of each block under a load that never fell.
    fn exact(&self, load: f64) -> Vec<f64> {
        // Block m takes μ W of the force that reaches it; the spring behind it transmits the rest.
        let carried: Vec<f64> =
            (1..=self.blocks).map(|blocks| (load - blocks as f64 * self.friction * self.weight).max(0.0)).collect();
        (0..self.blocks)
            .map(|block| carried[block..].iter().take(self.blocks - 1 - block).sum::<f64>() / self.stiffness)
            .collect()
    }
}

/// Runs increments until the load has passed `until`; returns the work and the largest distance from the exact
/// solution.
fn run(chain: &Chain, step: f64, until: f64) -> (ProgramCounts, u64, f64) {
    let mut base = chain.pressed();
    let mut forward = Rate {
        displacement: vec![0.0; 3 * chain.blocks],
        load: 1.0,
        reactions: vec![Reaction::default(); chain.blocks],
    };
    let mut modes = vec![Mode::Stick; chain.blocks];
    let (mut work, mut increments, mut worst) = (ProgramCounts::default(), 0, 0.0_f64);
    while base.load < until {
        let mut program = IncrementProgram::new(chain.loading(), &base, &forward, step, chain.weight);
        let start = program.variables_at(&forward);
        let (named, counts) = program.name(&start, &modes, &CancelFlag::default());
        work.qp_solves += counts.qp_solves;
        work.mpec_solves += counts.mpec_solves;
        let named = named.unwrap_or_else(|| panic!("no name at load {}", base.load));
        let end = named.end.unwrap_or_else(|| panic!("no exact end at load {}", base.load));
        let exact = chain.exact(end.load);
        for (block, exact) in exact.into_iter().enumerate() {
            for k in 0..2 {
                worst = worst.max((end.displacement[3 * block + k] - exact * chain.pull[k]).abs());
            }
            worst = worst.max((end.reactions[block].normal - chain.weight).abs());
            let slips = end.load > (block + 1) as f64 * chain.friction * chain.weight + 1e-9;
            assert_eq!(matches!(named.modes[block], Mode::Slip { .. }), slips, "block {block} at {}", end.load);
            assert!(named.modes[block].is_active());
        }
        forward = Rate {
            displacement: end.displacement.iter().zip(&base.displacement).map(|(to, from)| to - from).collect(),
            load: end.load - base.load,
            reactions: end
                .reactions
                .iter()
                .zip(&base.reactions)
                .map(|(to, from)| {
                    let (a, b) = (in_plane(to), in_plane(from));
                    on_floor(to.normal - from.normal, [a[0] - b[0], a[1] - b[1]])
                })
                .collect(),
        };
        let size = forward.size();
        forward.scale(1.0 / size);
        (base, modes) = (end, named.modes);
        increments += 1;
        assert!(increments < 2000, "the load rises");
    }
    (work, increments, worst)
}

#[test]
fn blocks_start_to_slip_one_after_another() {
    for (blocks, friction, angle) in
        [(1, 0.4, 0.3), (2, 0.4, 2.0), (3, 0.3, -0.7), (4, 1.5, 0.0), (3, 1e-3, 1.0), (2, 1e-5, 0.5), (2, 1e3, 0.5)]
    {
        let chain = Chain::new(blocks, friction, angle);
        // Below the load at which the last block slips, too, and nothing holds the chain.
        let strength = blocks as f64 * friction;
        let (work, increments, worst) = run(&chain, 0.07 * strength, 0.9 * strength);
        println!(
            "{blocks} blocks, μ = {friction}: {increments} increments, {:.2} QPs each, {:.2} programs, off by {worst:.1e}",
            work.qp_solves as f64 / increments as f64,
            work.mpec_solves as f64 / increments as f64,
        );
        assert!(worst < 1e-11 * friction.max(1.0), "{worst:e}");
    }
}
