//! The structure: positions, unknowns and elements; internal forces, tangent and strain energy.
//!
//! ```text
//! f_int(u) = Σ_e ∂W_e/∂u,   K(u) = Σ_e ∂²W_e/∂u²
//! ```
//!
//! Dimensionless throughout (`scene` divides by the scales). Knows nothing of contacts, loads or paths. Each kind of
//! element is a file of its own behind [`elements::Element`].

pub mod elements;
pub mod sparsity;

use crate::mechanics::structure::elements::Stretching;
use elements::Element;
use nalgebra::DMatrix;
use sparsity::Layout;
use std::sync::Arc;

/// Unknowns up to which matrices are dense.
pub const MOST_DENSE: usize = 16;

/// Unknowns up to which null spaces and eigenvalues are sought, in dense matrices: smooth bifurcation points and
/// directions at singular points are not looked for beyond.
pub const MOST_ANALYSED: usize = 3_000;

/// A checked structure. Degrees of freedom are numbered node by node: `node * dimension + component`.
#[derive(Debug, Clone)]
pub struct Structure {
    pub dimension: usize,
    /// The unknown of each degree of freedom; `None` where it is supported.
    pub unknown_of: Vec<Option<usize>>,
    /// The degree of freedom of each unknown.
    pub freedom_of: Vec<usize>,
    pub elements: Vec<Element>,
    /// The elements at the nodes, node by node, and where those of each begin.
    elements_at: Vec<usize>,
    first_at: Vec<usize>,
    layout: Option<Arc<Layout>>,
}

impl Structure {
    pub fn new(dimension: usize, supported: &[bool], elements: Vec<Element>) -> Self {
        Self::like(None, dimension, supported, elements)
    }

    /// As [`new`](Self::new); the places of the tangent's entries are those of another structure with the same unknowns and
    /// elements between the same nodes, if that is one.
    pub fn like(other: Option<&Self>, dimension: usize, supported: &[bool], elements: Vec<Element>) -> Self {
        let mut unknown_of = vec![None; supported.len()];
        let mut freedom_of = Vec::new();
        for (freedom, held) in supported.iter().enumerate() {
            if !held {
                unknown_of[freedom] = Some(freedom_of.len());
                freedom_of.push(freedom);
            }
        }
        let mut first_at = vec![0; supported.len() / dimension.max(1) + 1];
        elements.iter().flat_map(Element::nodes).for_each(|node| first_at[node + 1] += 1);
        (1..first_at.len()).for_each(|node| first_at[node] += first_at[node - 1]);
        let mut next = first_at.clone();
        let mut elements_at = vec![0; first_at.last().copied().unwrap_or(0)];
        for (index, element) in elements.iter().enumerate() {
            for node in element.nodes() {
                elements_at[next[node]] = index;
                next[node] += 1;
            }
        }
        let mut structure = Self { dimension, unknown_of, freedom_of, elements, elements_at, first_at, layout: None };
        match other.filter(|other| other.layout.is_some() && other.has_places_of(&structure)) {
            Some(other) => structure.layout.clone_from(&other.layout),
            None => structure.set_sparse(structure.unknowns() > MOST_DENSE),
        }
        structure
    }

    /// Whether the entries of both tangents are at the same places and come in the same order.
    fn has_places_of(&self, other: &Self) -> bool {
        let is_like = |(one, other): (&Element, &Element)| {
            std::mem::discriminant(one) == std::mem::discriminant(other) && one.nodes().eq(other.nodes())
        };
        self.dimension == other.dimension
            && self.unknown_of == other.unknown_of
            && self.elements.len() == other.elements.len()
            && self.elements.iter().zip(&other.elements).all(is_like)
    }

    /// Whether matrices are to be sparse; they stay dense where there is not the memory to find their layout.
    pub fn set_sparse(&mut self, sparse: bool) {
        self.layout = if sparse { Layout::new(self).map(Arc::new) } else { None };
        if self.layout.is_none() {
            // Whether there is room for a dense matrix is not left to the moment when it is formed.
            drop(crate::resources::budget::take::<f64>(self.unknowns().saturating_mul(self.unknowns())));
        }
    }

    /// Whether dense matrices of this size may be formed.
    pub fn allows_dense(&self) -> bool {
        self.unknowns() <= MOST_ANALYSED
    }

    /// Where the tangent has its entries; `None` where matrices are dense.
    pub fn layout(&self) -> Option<&Layout> {
        self.layout.as_deref()
    }

    /// Number of unknown displacements.
    pub fn unknowns(&self) -> usize {
        self.freedom_of.len()
    }

    /// Number of degrees of freedom, supported ones included.
    pub fn freedoms(&self) -> usize {
        self.unknown_of.len()
    }

    /// Writes `f_int(u)` over all degrees of freedom and returns the largest force any element carries.
    pub fn internal_force(&self, displacement: &[f64], force: &mut [f64]) -> f64 {
        force.fill(0.0);
        let mut largest = 0.0_f64;
        for element in &self.elements {
            largest = largest.max(element.add_force(self.dimension, displacement, force));
        }
        largest
    }

    /// What the rounding of the displacements puts into `f_int(u)`, one bound a degree of freedom: stiffness times unit
    /// round-off times the displacements that meet there. No state can be closer to equilibrium than this.
    pub fn rounding(&self, displacement: &[f64]) -> Vec<f64> {
        let mut rounding = vec![0.0; self.freedoms()];
        self.force_sizes(displacement, 0.0, &mut rounding);
        rounding.iter_mut().for_each(|size| *size *= f64::EPSILON);
        rounding
    }

    /// Writes the size of the numbers of which `f_int(u)` is made, one a degree of freedom: `|K| |u|` and the forces that
    /// the elements carry, with displacements taken as `least` at least. Against it a residual is small or not, whatever the
    /// forces elsewhere (W. Oettli, W. Prager, Numer. Math. 6 (1964) 405, doi:10.1007/BF01386090).
    pub fn force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        sizes.fill(0.0);
        for element in &self.elements {
            element.each_size(self.dimension, displacement, least, &mut |freedom, size| sizes[freedom] += size);
        }
    }

    /// The largest of them at a node.
    pub fn force_size_at(&self, node: usize, displacement: &[f64], least: f64) -> f64 {
        let first = node * self.dimension;
        let mut sizes = [0.0; 3];
        for element in &self.elements_at[self.first_at[node]..self.first_at[node + 1]] {
            self.elements[*element].each_size(self.dimension, displacement, least, &mut |freedom, size| {
                if let Some(sum) = freedom.checked_sub(first).and_then(|component| sizes.get_mut(component)) {
                    *sum += size;
                }
            });
        }
        sizes[..self.dimension].iter().fold(0.0, |largest, size| size.max(largest))
    }

    /// Calls `add(row, column, value)` for every entry of every element's tangent; rows and columns are degrees of
    /// freedom, supported ones included.
    pub fn each_stiffness(&self, displacement: &[f64], add: &mut impl FnMut(usize, usize, f64)) {
        for element in &self.elements {
            element.add_stiffness(self.dimension, displacement, add);
        }
    }

    /// Adds `K(u)` into the leading `unknowns x unknowns` block.
    pub fn add_tangent(&self, displacement: &[f64], matrix: &mut DMatrix<f64>) {
        self.each_stiffness(displacement, &mut |row, column, value| {
            if let (Some(row), Some(column)) = (self.unknown_of[row], self.unknown_of[column]) {
                matrix[(row, column)] += value;
            }
        });
    }

    /// Calls `add` for every entry of every element's tangent without the parts that [`Self::stretching`] lists.
    pub fn each_stiffness_across(&self, displacement: &[f64], add: &mut impl FnMut(usize, usize, f64)) {
        for element in &self.elements {
            element.add_stiffness_across(self.dimension, displacement, add);
        }
    }

    /// The summands `k c cᵀ` of the tangent by which elements resist being stretched, `c` over degrees of freedom.
    pub fn stretching(&self, displacement: &[f64]) -> Vec<Stretching> {
        self.elements.iter().flat_map(|element| element.stretching(self.dimension, displacement)).collect()
    }

    /// The smallest stretch `L/L0` of any bar; infinite without bars.
    pub fn smallest_stretch(&self, displacement: &[f64]) -> f64 {
        self.elements.iter().fold(f64::INFINITY, |smallest, element| match element {
            Element::Bar(bar) => smallest.min(bar.stretch(self.dimension, displacement)),
            Element::Spring(_) => smallest,
        })
    }

    /// `W(u)`.
    pub fn strain_energy(&self, displacement: &[f64]) -> f64 {
        self.elements.iter().map(|element| element.energy(self.dimension, displacement)).sum()
    }

    /// The largest change of any element's nodal forces under a displacement rate, over its stiffness times the rate's
    /// size: zero for a motion that no element resists. The stiffness is a bar's largest; of a spring that of the row, since
    /// its rows are as the user gives them, and a soft one beside a stiff one is no round-off.
    pub fn resistance(&self, displacement: &[f64], rate: &[f64]) -> f64 {
        let size = rate.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
        if size == 0.0 {
            return 0.0;
        }
        let mut largest = 0.0_f64;
        for element in &self.elements {
            // Row, force and stiffness.
            let mut changes: Vec<(usize, f64, f64)> = Vec::new();
            element.add_stiffness(self.dimension, displacement, &mut |row, column, value| match changes
                .iter_mut()
                .find(|(freedom, _, _)| *freedom == row)
            {
                Some((_, sum, stiffness)) => {
                    *sum += value * rate[column];
                    *stiffness = stiffness.max(value.abs());
                }
                None => changes.push((row, value * rate[column], value.abs())),
            });
            let stiffest = changes.iter().fold(0.0_f64, |most, (_, _, stiffness)| most.max(*stiffness));
            for (_, force, of_row) in changes {
                let stiffness = if element.is_linear() { of_row } else { stiffest };
                if stiffness > 0.0 {
                    largest = largest.max(force.abs() / (stiffness * size));
                }
            }
        }
        largest
    }
}
