//! A jump with friction, which remembers the way: beside the equations of motion, integrated by a program of its own.

use super::jump;
use super::truss_in_motion::Motion;
use crate::common::paths::{close, scene_file, trace};
use arcslip::model::request::{JumpMotion, StageControl};
use arcslip::result::increment::{Increment, Status};

const FRICTION: f64 = 0.4;

/// The arch-type truss as it moves against damping: its foot slides outwards, its crown is free or stays where it has landed.
struct MovingTruss<'a> {
    truss: Motion<'a>,
    has_landed: bool,
    /// Energy that friction has taken.
    dissipated: f64,
}

impl MovingTruss<'_> {
    /// Velocities of the nodes, and the power of friction.
    fn velocities(&self) -> (Vec<[f64; 2]>, f64) {
        let mut forces = self.truss.forces();
        let [held, foot, crown] = ["b0", "b4", "b2"].map(|name| self.truss.node(name));
        let pressure = -forces[foot][1];
        forces[held] = [0.0, 0.0];
        forces[foot] = [forces[foot][0] - FRICTION * pressure, 0.0];
        if self.has_landed {
            let [drag, pressure] = [forces[crown][0].abs(), -forces[crown][1]];
            assert!(drag < FRICTION * pressure, "the crown sticks");
            forces[crown] = [0.0, 0.0];
        }
        let power = FRICTION * pressure * forces[foot][0];
        (forces, power)
    }

    /// A step of the classical Runge-Kutta method; returns the largest velocity at its beginning.
    fn step(&mut self, length: f64) -> f64 {
        let start = self.truss.places.clone();
        let (mut change, mut work, mut speed) = (vec![[0.0; 2]; start.len()], 0.0, 0.0_f64);
        let mut slopes: Vec<[f64; 2]> = change.clone();
        for (stage, weight) in [1.0, 2.0, 2.0, 1.0].into_iter().enumerate() {
            let part = [0.0, 0.5, 0.5, 1.0][stage] * length;
            let places = self.truss.places.iter_mut().zip(&start).zip(&slopes);
            places
                .for_each(|((place, start), slope)| *place = [start[0] + part * slope[0], start[1] + part * slope[1]]);
            let (velocities, power) = self.velocities();
            work += weight * length / 6.0 * power;
            for (change, velocity) in change.iter_mut().zip(&velocities) {
                (0..2).for_each(|k| change[k] += weight * length / 6.0 * velocity[k]);
            }
            if stage == 0 {
                speed = velocities.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()));
            }
            slopes = velocities;
        }
        let places = self.truss.places.iter_mut().zip(&start).zip(&change);
        places.for_each(|((place, start), change)| *place = [start[0] + change[0], start[1] + change[1]]);
        self.dissipated += work;
        speed
    }

    /// The height of the crown above the floor.
    fn height(&self) -> f64 {
        self.truss.places[self.truss.node("b2")][1]
    }

    /// Moves until the crown lands: the last step is shortened until it ends there.
    fn fall(&mut self, load: f64) {
        let start = self.truss.places.clone();
        loop {
            let (places, dissipated) = (self.truss.places.clone(), self.dissipated);
            self.step(STEP);
            let way = self.truss.places.iter().zip(&start).map(|(now, then)| (now[1] - then[1]).abs());
            if way.fold(0.0, f64::max) > 0.05 {
                // It moves by itself.
                self.truss.load = load;
            }
            if self.height() > 0.0 {
                continue;
            }
            let (mut low, mut high) = (0.0, STEP);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                (self.truss.places, self.dissipated) = (places.clone(), dissipated);
                self.step(middle);
                if self.height() > 0.0 { low = middle } else { high = middle }
            }
            let crown = self.truss.node("b2");
            self.truss.places[crown][1] = 0.0;
            self.has_landed = true;
            return;
        }
    }
}

/// Time step of the reference; the stiffest motions decay as `exp(-4 t)`.
const STEP: f64 = 0.25;

/// The state at rest after the jump from a row, and what friction takes on the way.
fn by_time_stepping<'a>(truss: Motion<'a>) -> MovingTruss<'a> {
    let load = truss.load;
    let mut moving = MovingTruss { truss, has_landed: false, dissipated: 0.0 };
    // A load above the limit by a part of 1e-4 sets the truss in motion; with a hundredth of it the state at rest is the same to 1e-14.
    moving.truss.load *= 1.0001;
    moving.fall(load);
    while moving.step(STEP) > 1e-14 {}
    moving
}

#[test]
fn the_arch_type_truss_remembers_the_way_of_its_foot() {
    let mut request = scene_file("arch-type-truss");
    request.model.stages[0].control = StageControl::Load;
    let at_rest = |tolerance: f64| {
        let mut request = request.clone();
        request.analysis.jump_motion = Some(JumpMotion { tolerance, max_steps: 100_000, ..JumpMotion::default() });
        let (increments, _) = trace(&request);
        let (before, after) = jump(&increments);
        (before.clone(), after.clone())
    };
    let (before, _) = at_rest(1e-2);
    assert_eq!(before.contacts[0].status, Status::Slip);
    let end = by_time_stepping(Motion::from(&request, &before));
    let exact = |name: &str| {
        let node = end.truss.node(name);
        [0, 1].map(|k| end.truss.places[node][k] - request.model.nodes[name][k])
    };
    println!("the foot at {:.15}, {:.12e} dissipated", exact("b4")[0], end.dissipated);
    let off = |row: &Increment| {
        let names = request.model.nodes.keys();
        let errors = names.flat_map(|name| {
            let (found, exact) = (&row.displacements[name.as_str()], exact(name));
            [0, 1].map(|k| (found[k] - exact[k]).abs())
        });
        errors.fold(0.0, f64::max)
    };
    for (tolerance, bar) in [(1e-2, 1e-5), (1e-4, 1e-6), (1e-6, 1e-7), (1e-7, 1e-8)] {
        let (before, after) = at_rest(tolerance);
        let dissipated = after.energy.dissipated - before.energy.dissipated;
        let (off, energy) = (off(&after), (dissipated - end.dissipated).abs());
        println!("tolerance {tolerance:e}: {off:.1e} off, energy {energy:.1e}");
        assert!(off <= bar, "tolerance {tolerance}: {off}");
        close(dissipated, end.dissipated, 1e-9, "energy dissipated");
    }
}
