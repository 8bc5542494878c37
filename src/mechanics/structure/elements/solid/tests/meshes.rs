//! Meshes of a block, mapped, of each kind of element.

use crate::mechanics::structure::elements::FiniteElement;
use crate::mechanics::structure::elements::materials::linear_elastic::LinearElastic;
use crate::mechanics::structure::elements::materials::mooney_rivlin::MooneyRivlin;
use crate::mechanics::structure::elements::materials::neo_hookean::NeoHookean;
use crate::mechanics::structure::elements::materials::saint_venant_kirchhoff::SaintVenantKirchhoff;
use crate::mechanics::structure::elements::materials::{ElasticMaterial, ElasticModuli};
use crate::mechanics::structure::elements::solid::shapes::kind::{Idealisation, LockingMend, SolidKind};
use crate::mechanics::structure::elements::solid::{SolidElement, SolidElementError};
use std::collections::BTreeMap;
use std::sync::Arc;

pub const STRAIN: Idealisation = Idealisation::PlaneStrain { thickness: 0.8 };
pub const STRESS: Idealisation = Idealisation::PlaneStress { thickness: 0.8 };

pub const KINDS: [SolidKind; 8] = [
    SolidKind::Triangle3,
    SolidKind::Triangle6,
    SolidKind::Quadrilateral4,
    SolidKind::Quadrilateral8,
    SolidKind::Tetrahedron4,
    SolidKind::Tetrahedron10,
    SolidKind::Hexahedron8,
    SolidKind::Hexahedron20,
];

/// Each kind with each idealisation and each mend there is.
pub fn variants() -> Vec<(SolidKind, Idealisation, LockingMend)> {
    let mut variants = Vec::new();
    for kind in KINDS {
        for idealisation in [STRAIN, STRESS, Idealisation::Axisymmetric, Idealisation::Space] {
            for mend in [LockingMend::None, LockingMend::MeanGradient, LockingMend::MeanDilatation] {
                if idealisation.dimension() == kind.dimension() && mend.suits(kind, idealisation) {
                    variants.push((kind, idealisation, mend));
                }
            }
        }
    }
    variants
}

pub fn moduli(young: f64, poisson: f64) -> ElasticModuli {
    ElasticModuli::from_young(young, poisson).unwrap()
}

pub fn neo_hookean(poisson: f64) -> Arc<dyn ElasticMaterial> {
    Arc::new(NeoHookean { moduli: moduli(2.0, poisson) })
}

pub fn linear(young: f64, poisson: f64) -> Arc<dyn ElasticMaterial> {
    Arc::new(LinearElastic { moduli: moduli(young, poisson) })
}

pub fn materials() -> Vec<Arc<dyn ElasticMaterial>> {
    vec![
        linear(2.0, 0.3),
        Arc::new(SaintVenantKirchhoff { moduli: moduli(2.0, 0.3) }),
        neo_hookean(0.3),
        Arc::new(MooneyRivlin::new(0.3, 0.15, 2.0).unwrap()),
    ]
}

/// An element of a kind that is known only when the program runs.
pub fn element(
    kind: SolidKind,
    nodes: &[usize],
    positions: &[[f64; 3]],
    idealisation: Idealisation,
    material: &Arc<dyn ElasticMaterial>,
    mend: Option<LockingMend>,
) -> Result<Box<dyn FiniteElement>, SolidElementError> {
    macro_rules! of {
        ($count:literal, $dimension:literal) => {{
            let nodes: [usize; $count] = nodes.try_into().unwrap();
            let own = nodes.map(|node| std::array::from_fn(|axis| positions[node][axis]));
            let mend = mend.unwrap_or_else(|| LockingMend::usual(kind, idealisation, &material.moduli()));
            let element =
                SolidElement::<$count, $dimension>::with_mend(nodes, &own, idealisation, material.clone(), mend)?;
            assert_eq!(element.kind(), kind);
            Ok(Box::new(element))
        }};
    }
    match kind {
        SolidKind::Triangle3 => of!(3, 2),
        SolidKind::Triangle6 => of!(6, 2),
        SolidKind::Quadrilateral4 => of!(4, 2),
        SolidKind::Quadrilateral8 => of!(8, 2),
        SolidKind::Tetrahedron4 => of!(4, 3),
        SolidKind::Tetrahedron10 => of!(10, 3),
        SolidKind::Hexahedron8 => of!(8, 3),
        SolidKind::Hexahedron20 => of!(20, 3),
    }
}

const HEXAHEDRON: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// The elements of a cell by corners of the cell, and the edges of an element with a node in their middle.
fn cell(kind: SolidKind) -> (Vec<Vec<usize>>, Vec<[usize; 2]>) {
    let round = vec![[0, 1], [1, 2], [2, 3], [3, 0]];
    let of_tetrahedron = vec![[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
    // The tetrahedra between the corners 0 and 6 of a cube, one for each order of the axes.
    let kuhn = || {
        let paths = [[1, 2, 0], [3, 7, 0], [4, 5, 0], [2, 3, 0], [7, 4, 0], [5, 1, 0]];
        paths.iter().map(|path| vec![0, path[0], path[1], 6]).collect()
    };
    let of_cube = || {
        let mut edges = round.clone();
        edges.extend(round.iter().map(|edge| edge.map(|corner| corner + 4)));
        edges.extend((0..4).map(|corner| [corner, corner + 4]));
        edges
    };
    match kind {
        SolidKind::Triangle3 => (vec![vec![0, 1, 2], vec![0, 2, 3]], vec![]),
        SolidKind::Triangle6 => (vec![vec![0, 1, 2], vec![0, 2, 3]], vec![[0, 1], [1, 2], [2, 0]]),
        SolidKind::Quadrilateral4 => (vec![vec![0, 1, 2, 3]], vec![]),
        SolidKind::Quadrilateral8 => (vec![vec![0, 1, 2, 3]], round),
        SolidKind::Tetrahedron4 => (kuhn(), vec![]),
        SolidKind::Tetrahedron10 => (kuhn(), of_tetrahedron),
        SolidKind::Hexahedron8 => (vec![(0..8).collect()], vec![]),
        SolidKind::Hexahedron20 => (vec![(0..8).collect()], of_cube()),
    }
}

/// A mesh of the unit square or cube, mapped. `lattice`: the place of each node before it is mapped, in half cells.
pub struct Mesh {
    pub kind: SolidKind,
    pub lattice: Vec<[usize; 3]>,
    pub positions: Vec<[f64; 3]>,
    pub elements: Vec<Vec<usize>>,
    /// Number of cells along each axis.
    pub cells: [usize; 3],
}

impl Mesh {
    /// `is_straight`: nodes in the middle of edges lie on the straight line, not on the mapped one.
    pub fn new(kind: SolidKind, cells: [usize; 3], is_straight: bool, map: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let cells = if kind.dimension() == 2 { [cells[0], cells[1], 1] } else { cells };
        let mut found: BTreeMap<[usize; 3], Option<[[usize; 3]; 2]>> = BTreeMap::new();
        let mut places: Vec<Vec<[usize; 3]>> = Vec::new();
        let (elements, edges) = cell(kind);
        let depth = if kind.dimension() == 2 { 1 } else { cells[2] };
        for (i, j, k) in (0..cells[0]).flat_map(|i| (0..cells[1]).flat_map(move |j| (0..depth).map(move |k| (i, j, k))))
        {
            for corners in &elements {
                let at = |corner: usize| {
                    let [a, b, c] = HEXAHEDRON[corner];
                    [2 * (i + a), 2 * (j + b), 2 * (k + c)]
                };
                let mut nodes: Vec<[usize; 3]> = corners.iter().map(|corner| at(*corner)).collect();
                nodes.iter().for_each(|node| {
                    found.insert(*node, None);
                });
                for edge in &edges {
                    let ends = edge.map(|end| nodes[end]);
                    let middle = std::array::from_fn(|axis| (ends[0][axis] + ends[1][axis]) / 2);
                    found.insert(middle, Some(ends));
                    nodes.push(middle);
                }
                places.push(nodes);
            }
        }
        let place = |node: &[usize; 3]| map(std::array::from_fn(|axis| node[axis] as f64 / (2 * cells[axis]) as f64));
        let position = |(node, ends): (&[usize; 3], &Option<[[usize; 3]; 2]>)| match ends {
            Some(ends) if is_straight => {
                let [one, other] = [place(&ends[0]), place(&ends[1])];
                std::array::from_fn(|axis| 0.5 * (one[axis] + other[axis]))
            }
            _ => place(node),
        };
        let positions = found.iter().map(position).collect();
        let lattice: Vec<[usize; 3]> = found.keys().copied().collect();
        let number = |node: &[usize; 3]| lattice.binary_search(node).unwrap();
        let elements = places.iter().map(|nodes| nodes.iter().map(number).collect()).collect();
        Self { kind, lattice, positions, elements, cells }
    }

    /// The nodes on a side of the block.
    pub fn side(&self, axis: usize, is_last: bool) -> Vec<usize> {
        let at = if is_last { 2 * self.cells[axis] } else { 0 };
        (0..self.lattice.len()).filter(|node| self.lattice[*node][axis] == at).collect()
    }

    /// Whether a node lies on the boundary.
    pub fn is_outside(&self, node: usize) -> bool {
        (0..self.kind.dimension())
            .any(|axis| self.lattice[node][axis] == 0 || self.lattice[node][axis] == 2 * self.cells[axis])
    }
}

/// A distorted block, two cells along each axis, of one distorted element if `cells` are 1; right of the axis.
pub fn distorted(kind: SolidKind, cells: usize) -> Mesh {
    Mesh::new(kind, [cells; 3], true, |[x, y, z]| {
        let [s, c] = [(2.3 * x + 1.1 * y + 0.7 * z).sin(), (1.7 * y - 0.9 * x + 1.3 * z).cos()];
        let depth = if kind.dimension() == 2 { 0.0 } else { 0.9 * z + 0.1 * c + 0.08 * x * y };
        [1.5 + 1.1 * x + 0.12 * c + 0.1 * y * z, 0.9 * y + 0.13 * s - 0.1 * x, depth]
    })
}

/// The only element of a mesh of one cell, or the first; nodes numbered from 0.
pub fn single(
    kind: SolidKind,
    idealisation: Idealisation,
    material: &Arc<dyn ElasticMaterial>,
    mend: LockingMend,
) -> (Box<dyn FiniteElement>, Vec<[f64; 3]>) {
    let mesh = distorted(kind, 1);
    let positions: Vec<[f64; 3]> = mesh.elements[0].iter().map(|node| mesh.positions[*node]).collect();
    let nodes: Vec<usize> = (0..positions.len()).collect();
    (element(kind, &nodes, &positions, idealisation, material, Some(mend)).unwrap(), positions)
}
