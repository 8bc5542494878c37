//! The elements of a structure in the order of the input, kept in runs of one kind.
//!
//! Forces and tangents are computed for several elements of a run together: one dynamic call serves all of them, and the
//! compiler can inline the formulas of the kind.

use crate::mechanics::structure::elements::FiniteElement;
use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

/// Elements of one kind that follow one another and have as many degrees of freedom each.
///
/// `displacements`, `forces`, `sizes` and `stiffnesses` hold the numbers of the elements from `first` on, one element
/// after the other, in the order of [`FiniteElement`]; as many elements are meant as there are displacements for.
pub trait ElementRun: Any + Debug + Send + Sync {
    fn count(&self) -> usize;

    fn element(&self, index: usize) -> &dyn FiniteElement;

    /// The run with other references of its elements' rotations: see [`FiniteElement::refer`].
    fn referred(&self, freedoms: usize, references: &[f64]) -> Arc<dyn ElementRun>;

    /// Writes strain energies. `freedoms`: the number of an element's degrees of freedom, here and below.
    fn write_energies(&self, first: usize, freedoms: usize, displacements: &[f64], energies: &mut [f64]);

    /// Writes nodal forces; returns the largest force that one of the elements carries.
    fn write_forces(&self, first: usize, freedoms: usize, displacements: &[f64], forces: &mut [f64]) -> f64;

    /// Writes the size of the terms that make up the nodal forces.
    fn write_force_sizes(&self, first: usize, freedoms: usize, displacements: &[f64], least: f64, sizes: &mut [f64]);

    /// Writes tangents.
    fn write_stiffnesses(&self, first: usize, freedoms: usize, displacements: &[f64], stiffnesses: &mut [f64]);

    /// Writes tangents without the summands that `stretching` lists.
    fn write_stiffnesses_across(&self, first: usize, freedoms: usize, displacements: &[f64], stiffnesses: &mut [f64]);
}

impl<E: FiniteElement + Clone + 'static> ElementRun for Vec<E> {
    fn count(&self) -> usize {
        self.len()
    }

    fn element(&self, index: usize) -> &dyn FiniteElement {
        &self[index]
    }

    fn referred(&self, freedoms: usize, references: &[f64]) -> Arc<dyn ElementRun> {
        let mut run = self.clone();
        run.iter_mut().zip(references.chunks_exact(freedoms)).for_each(|(element, own)| element.refer(own));
        Arc::new(run)
    }

    fn write_energies(&self, first: usize, freedoms: usize, displacements: &[f64], energies: &mut [f64]) {
        each::<0, E>(&self[first..], freedoms, displacements, energies, |element, displacement, energy| {
            energy.fill(element.energy(displacement));
        });
    }

    fn write_forces(&self, first: usize, freedoms: usize, displacements: &[f64], forces: &mut [f64]) -> f64 {
        let mut largest = 0.0_f64;
        each::<1, E>(&self[first..], freedoms, displacements, forces, |element, displacement, force| {
            largest = largest.max(element.write_force(displacement, force));
        });
        largest
    }

    fn write_force_sizes(&self, first: usize, freedoms: usize, displacements: &[f64], least: f64, sizes: &mut [f64]) {
        each::<1, E>(&self[first..], freedoms, displacements, sizes, |element, displacement, sizes| {
            element.write_force_sizes(displacement, least, sizes);
        });
    }

    fn write_stiffnesses(&self, first: usize, freedoms: usize, displacements: &[f64], stiffnesses: &mut [f64]) {
        each::<2, E>(&self[first..], freedoms, displacements, stiffnesses, E::write_stiffness);
    }

    fn write_stiffnesses_across(&self, first: usize, freedoms: usize, displacements: &[f64], stiffnesses: &mut [f64]) {
        each::<2, E>(&self[first..], freedoms, displacements, stiffnesses, E::write_stiffness_across);
    }
}

/// Calls `write` for each element with its displacements and its numbers: one (`ORDER` 0), a vector (1) or a matrix (2)
/// over its degrees of freedom.
#[inline(always)]
fn each<const ORDER: u32, E>(
    elements: &[E],
    freedoms: usize,
    displacements: &[f64],
    numbers: &mut [f64],
    mut write: impl FnMut(&E, &[f64], &mut [f64]),
) {
    let mut of_size = |freedoms: usize| {
        let own = displacements.chunks_exact(freedoms).zip(numbers.chunks_exact_mut(freedoms.pow(ORDER)));
        elements.iter().zip(own).for_each(|(element, (displacement, numbers))| write(element, displacement, numbers));
    };
    // The numbers of two nodes in the plane and in space are known to the compiler.
    match freedoms {
        4 => of_size(4),
        6 => of_size(6),
        _ => of_size(freedoms),
    }
}

/// Elements of any kinds in the order in which they were added.
#[derive(Debug, Clone, Default)]
pub struct ElementList {
    runs: Vec<Arc<dyn ElementRun>>,
    /// The run of each element, and its index there.
    places: Vec<(usize, usize)>,
}

impl ElementList {
    /// Adds an element at the end.
    pub fn push<E: FiniteElement + Clone + 'static>(&mut self, element: E) {
        let is_alike =
            |last: &E| last.nodes().len() == element.nodes().len() && last.rotations() == element.rotations();
        let runs = self.runs.len();
        // A run that another list shares stays as it is.
        let last = self.runs.last_mut().and_then(Arc::get_mut);
        let last = last.and_then(|run| (run as &mut dyn Any).downcast_mut::<Vec<E>>());
        if let Some(run) = last.filter(|run| run.last().is_some_and(is_alike)) {
            run.push(element);
            self.places.push((runs - 1, run.len() - 1));
        } else {
            self.places.push((runs, 0));
            self.runs.push(Arc::new(vec![element]));
        }
    }

    /// Adds elements at the end.
    pub fn extend<E: FiniteElement + Clone + 'static>(&mut self, elements: impl IntoIterator<Item = E>) {
        elements.into_iter().for_each(|element| self.push(element));
    }

    /// Adds the elements of another list at the end.
    pub fn append(&mut self, other: &Self) {
        let runs = self.runs.len();
        self.places.extend(other.places.iter().map(|(run, index)| (runs + run, *index)));
        self.runs.extend(other.runs.iter().cloned());
    }

    /// Gives the elements that have three rotations at a node other references of them: see [`FiniteElement::refer`].
    /// `references`: values for the degrees of freedom of all elements, one element after the other; `size_of`: the number
    /// of an element's degrees of freedom.
    pub(super) fn refer(&mut self, references: &[f64], size_of: impl Fn(&dyn FiniteElement) -> usize) {
        let mut left = references;
        for run in &mut self.runs {
            let freedoms = size_of(run.element(0));
            let (own, others) = left.split_at(run.count() * freedoms);
            left = others;
            if run.element(0).rotations() == 3 {
                *run = run.referred(freedoms, own);
            }
        }
    }

    pub fn len(&self) -> usize {
        self.places.len()
    }

    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// An element by its place in the order of the input.
    pub fn get(&self, element: usize) -> &dyn FiniteElement {
        let (run, index) = self.place(element);
        run.element(index)
    }

    /// The run of an element, and its index there.
    pub(super) fn place(&self, element: usize) -> (&dyn ElementRun, usize) {
        let (run, index) = self.places[element];
        (self.runs[run].as_ref(), index)
    }

    /// The elements in the order of the input.
    pub fn iter(&self) -> impl Iterator<Item = &dyn FiniteElement> {
        self.runs.iter().flat_map(|run| (0..run.count()).map(|index| run.element(index)))
    }

    pub(super) fn runs(&self) -> impl Iterator<Item = &dyn ElementRun> {
        self.runs.iter().map(AsRef::as_ref)
    }
}

impl<E: FiniteElement + Clone + 'static> FromIterator<E> for ElementList {
    fn from_iter<I: IntoIterator<Item = E>>(elements: I) -> Self {
        let mut list = Self::default();
        list.extend(elements);
        list
    }
}
