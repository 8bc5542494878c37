//! The rate equations of the contacts that can change, by their entries.

use crate::algebra::sparse::factors::cholesky::Triangle;
use crate::mechanics::contact::vector::{Vector, scaled};
use crate::mechanics::contact::{Frame, Mode};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use smallvec::SmallVec;
use std::cell::OnceCell;

/// A contact that can change.
pub(super) struct ChangingContact {
    pub contact: usize,
    /// Direction of incipient slip; `None` where the contact touches without reaction.
    pub direction: Option<Vector>,
    pub frame: Frame,
    /// Its column in `A`: that of its slip if it is on the cone; if it touches, that of its tangential velocity,
    /// followed by that of its normal velocity.
    pub column: usize,
}

/// Entries of a degree of freedom in a column of `A` and in the corresponding row.
#[derive(Debug, Clone, Copy)]
pub(super) struct ColumnEntry {
    pub column: usize,
    pub motion: f64,
    pub test: f64,
}

/// Expected number of entries in a column of `A` in the plane.
const ENTRIES: usize = 6;

/// The rate equations at a state; see the module.
pub(super) struct Equations<'a> {
    pub loading: Loading<'a>,
    pub state: &'a State,
    /// Modes with all contacts that can change stuck.
    pub held: Vec<Mode>,
    pub changing: Vec<ChangingContact>,
    /// Column entries of each degree of freedom.
    pub parts: Vec<SmallVec<[ColumnEntry; 2]>>,
    /// Number of columns of `A`.
    pub size: usize,
    /// Diagonal entries of `A` due to the rotation of reactions with the motion.
    turning: Vec<(usize, f64)>,
    diagonal: OnceCell<Vec<f64>>,
}

impl<'a> Equations<'a> {
    /// Sets up the equations; `None` where they are not of the kind described.
    pub fn new(loading: Loading<'a>, state: &'a State, standings: &[Standing]) -> Option<Self> {
        let structure = loading.structure;
        let shares = loading.corners.iter().any(|corner| {
            corner.contacts.iter().filter(|contact| standings[**contact] != Standing::Settled(Mode::Free)).count() > 1
        });
        if structure.dimension != 2 || shares {
            return None;
        }
        let mut equations = Self {
            loading,
            state,
            held: Vec::with_capacity(standings.len()),
            changing: Vec::with_capacity(standings.len()),
            parts: vec![SmallVec::new(); structure.freedoms()],
            size: 0,
            turning: Vec::new(),
            diagonal: OnceCell::new(),
        };
        let mut is_closed = vec![false; structure.freedoms()];
        for (contact, (standing, data)) in standings.iter().zip(loading.contacts).enumerate() {
            if *standing == Standing::Settled(Mode::Free) {
                equations.held.push(Mode::Free);
                continue;
            }
            let freedoms = structure.translations_of(data.kinematics.node()?);
            let is_free = structure.unknown_of[freedoms.clone()].iter().all(Option::is_some);
            if *standing != Standing::Settled(Mode::Stick) && !is_free {
                return None;
            }
            is_closed[freedoms].fill(true);
            equations.add_closed(contact, standing)?;
            equations.held.push(match standing {
                Standing::Settled(mode) => *mode,
                _ if data.tangents() > 0 => Mode::Stick,
                _ => Mode::Slip { direction: [0.0; 3] },
            });
        }
        for freedom in &structure.freedom_of {
            if !is_closed[*freedom] {
                equations.parts[*freedom].push(ColumnEntry { column: equations.size, motion: 1.0, test: 1.0 });
                equations.size += 1;
            }
        }
        Some(equations)
    }

    fn add_closed(&mut self, contact: usize, standing: &Standing) -> Option<()> {
        let data = &self.loading.contacts[contact];
        let frame = self.loading.frame(contact, self.state);
        let first = self.loading.structure.translations_of(data.kinematics.node()?).start;
        let column = self.size;
        let mut add_column = |motion: &Vector, test: &Vector| {
            let column = self.size;
            (0..2).for_each(|k| self.parts[first + k].push(ColumnEntry { column, motion: motion[k], test: test[k] }));
            self.size += 1;
        };
        let along = match standing {
            Standing::Settled(Mode::Slip { .. }) => frame.tangents[0],
            Standing::OnCone { direction } => *direction,
            Standing::Settled(Mode::Stick | Mode::Free) => return Some(()),
            Standing::Touching => {
                add_column(&frame.tangents[0], &frame.tangents[0]);
                add_column(&frame.normal, &frame.normal);
                self.changing.push(ChangingContact { contact, direction: None, frame, column });
                return Some(());
            }
            Standing::Cornered { .. } => return None,
        };
        add_column(&along, &data.friction.slack_form(&frame.normal, &along));
        let turning = -frame.curvature_along(&along) * self.state.reactions[contact].normal;
        if turning != 0.0 {
            self.turning.push((column, turning * data.friction.force_direction_squared()));
        }
        if matches!(standing, Standing::OnCone { .. }) {
            self.changing.push(ChangingContact { contact, direction: Some(along), frame, column });
        }
        Some(())
    }

    /// Calls `each` for every entry of `A`; several at one place add up.
    pub fn each_entry(&self, each: &mut impl FnMut(usize, usize, f64)) {
        self.loading.structure.each_stiffness(&self.state.displacement, &mut |row, column, value| {
            for test in &self.parts[row] {
                let value = test.test * value;
                if value != 0.0 {
                    self.parts[column]
                        .iter()
                        .filter(|part| part.motion != 0.0)
                        .for_each(|part| each(test.column, part.column, value * part.motion));
                }
            }
        });
        self.turning.iter().for_each(|(column, value)| each(*column, *column, *value));
    }

    /// The stiffness of a column by itself: its diagonal entry in `A`.
    pub fn stiffness(&self, column: usize) -> f64 {
        let sum = || {
            let mut diagonal = vec![0.0; self.size];
            self.each_entry(&mut |row, column, value| {
                if row == column {
                    diagonal[row] += value;
                }
            });
            diagonal
        };
        self.diagonal.get_or_init(sum)[column].abs()
    }

    /// The lower triangle of `(A + Aᵀ)/2`.
    pub fn symmetric_part(&self) -> Triangle {
        let mut lower = Triangle::with_capacity(ENTRIES * self.size);
        self.each_entry(&mut |row, column, value| {
            let half = if row == column { value } else { 0.5 * value };
            lower.push((row.max(column), row.min(column), half));
        });
        lower
    }

    /// Velocities of all degrees of freedom from the velocities of the columns.
    pub fn velocities(&self, columns: &[f64]) -> Vec<f64> {
        let velocity =
            |parts: &SmallVec<[ColumnEntry; 2]>| parts.iter().map(|part| part.motion * columns[part.column]).sum();
        self.parts.iter().map(velocity).collect()
    }

    /// Velocities of the columns from the velocities of all degrees of freedom.
    pub fn columns_of(&self, rate: &Rate) -> Vec<f64> {
        let mut columns = vec![0.0; self.size];
        for (parts, velocity) in self.parts.iter().zip(&rate.displacement) {
            // The motions of one node are orthonormal.
            parts.iter().for_each(|part| columns[part.column] += part.motion * velocity);
        }
        columns
    }

    /// `q`: the load on the rows.
    pub fn load(&self) -> Vec<f64> {
        let mut load = vec![0.0; self.size];
        for (parts, force) in self.parts.iter().zip(&self.loading.pattern.forces) {
            parts.iter().for_each(|part| load[part.column] += part.test * force);
        }
        load
    }

    pub fn largest_load(&self) -> f64 {
        self.loading.pattern.forces.iter().fold(0.0, |largest, force| largest.max(force.abs()))
    }

    /// The power of the load on velocities of the columns.
    pub fn power(&self, columns: &[f64]) -> f64 {
        self.load().iter().zip(columns).map(|(load, velocity)| load * velocity).sum()
    }

    /// The mode of a touching contact, or of one on its cone, in a motion without any force.
    pub fn mode_of_motion(&self, one: &ChangingContact, columns: &[f64], still: f64) -> Mode {
        let along = columns[one.column];
        match one.direction {
            Some(direction) => Mode::Slip { direction },
            None if columns[one.column + 1] > still => Mode::Free,
            None if self.loading.contacts[one.contact].tangents() == 0 => Mode::Slip { direction: [0.0; 3] },
            None if along.abs() > still => Mode::Slip { direction: scaled(&one.frame.tangents[0], along.signum()) },
            None => Mode::Stick,
        }
    }
}
