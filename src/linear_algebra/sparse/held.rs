//! Nodes that border rows hold, eliminated where they are.
//!
//! A closed contact adds rows `C u_i + d L = g` at its node `i` and reactions `r` in the node's own equations, so that its
//! saddle point needs no border: with `Q` orthogonal, `y = Qᵀ u_i = (y_H, y_T)` and `C Q = [M, 0]`,
//!
//! ```text
//! y_H = M⁻¹ (g - d L),      R r = f_H - (K y)_H - ...,      QᵀB = [R; F]
//! ```
//!
//! Rows and columns `H` leave the matrix (a one stays on the diagonal), whose pattern remains. Without friction `F = 0`
//! and `r` follows in the end. With friction (`F != 0`) there are two ways: `r` stays a border, and the equations `H` are
//! its rows, so that the matrix stays symmetric; or the equations `H` times `F R⁻¹` are taken from the equations `T`, which
//! makes it unsymmetric, and `r` follows in the end, too.

use super::Entries;
use super::bordered::Bordered;
use nalgebra::{Matrix3, Vector3};
use smallvec::SmallVec;
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Border rows that hold unknowns of one node, and the border columns with its reactions, one for each row.
#[derive(Debug, Clone, PartialEq)]
pub struct Holding {
    /// Unknowns of the node: at most three.
    pub unknowns: Places,
    pub rows: Places,
    pub columns: Places,
}

/// Some numbers of rows, columns or unknowns.
pub type Places = SmallVec<[usize; 3]>;

impl Holding {
    /// Of a node that nothing holds yet.
    pub fn new(unknowns: impl IntoIterator<Item = usize>) -> Self {
        Self { unknowns: unknowns.into_iter().collect(), rows: Places::new(), columns: Places::new() }
    }
}

/// All holdings of a matrix.
#[derive(Default)]
pub struct Holdings {
    list: Vec<Holding>,
}

impl Holdings {
    pub fn new(list: Vec<Holding>) -> Self {
        Self { list }
    }

    pub fn iter(&self) -> std::slice::Iter<'_, Holding> {
        self.list.iter()
    }
}

/// The nodes of the matrices of one pattern that were factorised last: as long as the holdings and the entries of their
/// border rows and columns are the same, so are the nodes.
#[derive(Default)]
pub(super) struct LastNodes(Mutex<VecDeque<Arc<Nodes>>>);

/// So many sets of nodes are kept: of the modes on trial at an event and of those before it.
const KEPT: usize = 4;

impl LastNodes {
    fn of(&self, matrix: &Bordered, holdings: &[Holding], friction: Friction) -> Arc<Nodes> {
        // It is whole at every point where its holder could panic.
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let enters = enters(matrix);
        match last.iter().position(|nodes| nodes.fit(matrix, holdings, friction, &enters)) {
            Some(0) => {}
            Some(place) => last.swap(0, place),
            None => {
                last.truncate(KEPT - 1);
                last.push_front(Arc::new(Nodes::new(matrix, holdings, friction, enters)));
            }
        }
        Arc::clone(&last[0])
    }
}

impl std::fmt::Debug for LastNodes {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str("LastNodes")
    }
}

/// What becomes of the reactions of contacts with friction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Friction {
    /// They stay borders.
    Bordered,
    /// They are eliminated, and the matrix is unsymmetric.
    Folded,
}

/// One node; matrices have ones on the diagonal where the node has less.
pub(super) struct HeldNode {
    unknowns: [usize; 3],
    count: usize,
    /// So many of the rotated unknowns are held.
    held: usize,
    /// Whether `Q` is not the identity.
    turns: bool,
    /// `Q`
    rotation: Matrix3<f64>,
    /// `M⁻¹`
    pub constraint: Matrix3<f64>,
    /// `R⁻¹`
    pub reaction: Matrix3<f64>,
    /// `F R⁻¹`, rows of `T` after those of `H`; where it is folded.
    friction: Option<Matrix3<f64>>,
    rows: [usize; 3],
    columns: [usize; 3],
    /// Its reactions stay borders.
    pub keeps: bool,
    /// Sign of the part of the determinant that is eliminated, its place apart.
    pub sign: f64,
    /// `d`: for each row, other borders and values.
    pub couplings: [Vec<(usize, f64)>; 3],
    /// Its place among the others.
    place: usize,
}

/// All of them, for some entries of the borders.
struct Nodes {
    nodes: Vec<HeldNode>,
    /// Node and place in it of each unknown.
    place_of: Vec<Option<(u32, u32)>>,
    friction: Friction,
    holdings: Vec<Holding>,
    /// Border columns that enter border rows.
    enters: Vec<bool>,
    /// Entries of the rows and columns of the holdings, one after the other.
    borders: Vec<(usize, f64)>,
}

/// What is left of a matrix, and what was taken.
pub(super) struct Elimination {
    nodes: Arc<Nodes>,
    /// Of each node, where its columns and its rows `H` of the matrix begin and end.
    columns_at: Vec<[Range<usize>; 3]>,
    rows_at: Vec<[Range<usize>; 3]>,
    /// Entries of all rows and columns `H`.
    entries: Vec<(usize, f64)>,
}

/// Relative size of what counts as nothing.
const NOTHING: f64 = 1e-14;
/// A node whose held directions are nearer than this to each other is left to the borders.
const DEPENDENT: f64 = 1e-6;

impl Nodes {
    fn new(matrix: &Bordered, holdings: &[Holding], friction: Friction, enters: Vec<bool>) -> Self {
        let n = matrix.pattern.size();
        let mut is_reaction = vec![false; matrix.lower.len()];
        holdings.iter().flat_map(|holding| &holding.columns).for_each(|column| is_reaction[*column] = true);
        let mut place_of = vec![None; n];
        let mut nodes: Vec<HeldNode> = Vec::with_capacity(holdings.len());
        for holding in holdings {
            let free = holding.unknowns.iter().all(|unknown| place_of[*unknown].is_none());
            // Reactions that enter border equations stay.
            if !free || holding.columns.iter().any(|column| enters[*column]) {
                continue;
            }
            let Some(mut node) = HeldNode::new(matrix, holding, &is_reaction, friction) else { continue };
            for (local, unknown) in node.unknowns().iter().enumerate() {
                place_of[*unknown] = Some((nodes.len() as u32, local as u32));
            }
            node.place = nodes.len();
            nodes.push(node);
        }
        let borders = borders(matrix, holdings).collect();
        Self { nodes, place_of, friction, holdings: holdings.to_vec(), enters, borders }
    }

    /// Whether they are those of a matrix with this pattern, too.
    fn fit(&self, matrix: &Bordered, holdings: &[Holding], friction: Friction, enters: &[bool]) -> bool {
        self.friction == friction
            && self.holdings == holdings
            && self.enters == enters
            && borders(matrix, holdings).eq(self.borders.iter().copied())
    }
}

/// Which border columns have entries in border rows.
fn enters(matrix: &Bordered) -> Vec<bool> {
    let n = matrix.pattern.size();
    let mut enters = vec![false; matrix.lower.len()];
    for (column, _) in matrix.lower.iter().flatten() {
        if *column >= n {
            enters[*column - n] = true;
        }
    }
    enters
}

/// The entries of the rows and columns of holdings, each row and column closed by its length.
fn borders<'a>(matrix: &'a Bordered, holdings: &'a [Holding]) -> impl Iterator<Item = (usize, f64)> + 'a {
    let closed = |entries: &'a Entries| entries.iter().copied().chain(std::iter::once((entries.len(), 0.0)));
    holdings.iter().flat_map(move |holding| {
        let rows = holding.rows.iter().flat_map(move |row| closed(&matrix.lower[*row]));
        rows.chain(holding.columns.iter().flat_map(move |column| closed(&matrix.right[*column])))
    })
}

impl Elimination {
    /// Eliminates; with the matrix that is left. A holding that cannot be eliminated so stays in the borders.
    pub fn new(matrix: &Bordered, holdings: &Holdings, friction: Friction) -> (Self, Vec<f64>) {
        let all = matrix.pattern.last_nodes.of(matrix, &holdings.list, friction);
        let nodes = &all.nodes;
        let mut values = matrix.values.clone();
        let mut entries = Vec::with_capacity(4 * nodes.iter().map(|node| node.count * node.held).sum::<usize>());
        nodes.iter().for_each(|node| node.rotate_matrix(matrix, &mut values));
        // All rows and columns are taken before any is cleared: those of neighbours have entries in each other's.
        let rows_at = nodes.iter().map(|node| node.take_rows(matrix, &values, &mut entries)).collect();
        nodes.iter().for_each(|node| node.fold(matrix, &mut values));
        let columns_at = nodes.iter().map(|node| node.take_columns(matrix, &values, &mut entries)).collect();
        nodes.iter().for_each(|node| node.clear(matrix, &mut values));
        (Self { nodes: all, columns_at, rows_at, entries }, values)
    }

    pub fn nodes(&self) -> &[HeldNode] {
        &self.nodes.nodes
    }

    /// A column `H` of a node.
    pub fn stiffness(&self, node: &HeldNode, index: usize) -> &[(usize, f64)] {
        &self.entries[self.columns_at[node.place][index].clone()]
    }

    /// A row `H` of a node.
    pub fn equilibrium(&self, node: &HeldNode, index: usize) -> &[(usize, f64)] {
        &self.entries[self.rows_at[node.place][index].clone()]
    }

    /// Whether an unknown of the rotated system is held.
    pub fn is_held(&self, unknown: usize) -> bool {
        self.nodes.place_of[unknown].is_some_and(|(node, local)| (local as usize) < self.nodes()[node as usize].held)
    }

    /// Entries of a row or a column over the rotated unknowns: those that are not held, and those that are.
    pub fn rotated(&self, entries: &[(usize, f64)]) -> (Entries, Entries) {
        let (mut free, mut held) = (Entries::with_capacity(entries.len()), Entries::new());
        let mut at_nodes: SmallVec<[(u32, u32, f64); 8]> = SmallVec::new();
        for (unknown, value) in entries {
            match self.nodes.place_of[*unknown] {
                None => free.push((*unknown, *value)),
                Some((node, local)) => at_nodes.push((node, local, *value)),
            }
        }
        at_nodes.sort_by_key(|(node, local, _)| (*node, *local));
        for group in at_nodes.chunk_by(|a, b| a.0 == b.0) {
            let node = &self.nodes()[group[0].0 as usize];
            for (place, unknown) in node.unknowns().iter().enumerate() {
                let part = |(_, local, value): &(u32, u32, f64)| node.rotation[(*local as usize, place)] * value;
                let value: f64 = group.iter().map(part).sum();
                if value != 0.0 {
                    if place < node.held { &mut held } else { &mut free }.push((*unknown, value));
                }
            }
        }
        (free, held)
    }

    /// Splits a column of the rotated matrix.
    pub fn split(&self, entries: &[(usize, f64)]) -> (Entries, Entries) {
        entries.iter().copied().partition(|(unknown, _)| !self.is_held(*unknown))
    }

    /// What entries of a column at held unknowns become in the other equations of their nodes, where friction is folded.
    pub fn folded(&self, held: &[(usize, f64)]) -> Entries {
        let mut free = Entries::new();
        for (unknown, value) in held {
            let Some((node, local)) = self.nodes.place_of[*unknown] else { continue };
            let node = &self.nodes()[node as usize];
            if let Some(friction) = &node.friction {
                for other in node.held..node.count {
                    free.push((node.unknowns[other], -friction[(other, local as usize)] * value));
                }
            }
        }
        free
    }

    /// `Qᵀ x` or `Q x` at every node.
    pub fn rotate(&self, x: &mut [f64], back: bool) {
        for node in self.nodes().iter().filter(|node| node.turns) {
            let here = node.gather(x);
            let turned = if back { node.rotation * here } else { node.rotation.tr_mul(&here) };
            node.unknowns().iter().zip(turned.iter()).for_each(|(unknown, value)| x[*unknown] = *value);
        }
    }

    /// Folds a right-hand side that was rotated.
    pub fn fold(&self, x: &mut [f64]) {
        for node in self.nodes() {
            if let Some(friction) = &node.friction {
                let here = node.gather(x);
                for other in node.held..node.count {
                    x[node.unknowns[other]] -=
                        (0..node.held).map(|held| friction[(other, held)] * here[held]).sum::<f64>();
                }
            }
        }
    }
}

impl HeldNode {
    fn new(matrix: &Bordered, holding: &Holding, is_reaction: &[bool], friction: Friction) -> Option<Self> {
        let n = matrix.pattern.size();
        let (count, held) = (holding.unknowns.len(), holding.rows.len());
        if held == 0 || held > count || holding.columns.len() != held || !same_columns(matrix, &holding.unknowns) {
            return None;
        }
        let unknowns = held_first(matrix, holding);
        let local = |unknown: usize| unknowns.iter().position(|own| *own == unknown);
        let (mut rows, mut columns) = (Matrix3::zeros(), Matrix3::zeros());
        let mut couplings = [const { Vec::new() }; 3];
        for (index, row) in holding.rows.iter().enumerate() {
            for (column, value) in &matrix.lower[*row] {
                if *column < n {
                    rows[(index, local(*column)?)] += value;
                } else if is_reaction[*column - n] {
                    return None;
                } else {
                    couplings[index].push((*column - n, *value));
                }
            }
        }
        for (index, column) in holding.columns.iter().enumerate() {
            for (row, value) in &matrix.right[*column] {
                columns[(local(*row)?, index)] += value;
            }
        }
        let is_first = held == count || rows.columns(held, count - held).iter().all(|value| *value == 0.0);
        let rotation = if is_first { Matrix3::identity() } else { completed(&rows, held, count)? };
        let largest = columns.amax();
        let constraint = leading(&(rows * rotation), held);
        let turned = rotation.tr_mul(&columns);
        let reaction = leading(&turned, held);
        let mut rest = turned;
        rest.rows_mut(0, held).fill(0.0);
        let rubs = rest.amax() > NOTHING * largest;
        let keeps = rubs && friction == Friction::Bordered;
        let sign_of = |block: &Matrix3<f64>| if held == 1 { block[(0, 0)] } else { block.determinant() }.signum();
        let sign = sign_of(&constraint) * if held % 2 == 1 { -1.0 } else { 1.0 };
        let sign = if keeps { sign } else { sign * sign_of(&reaction) };
        let reaction = inverse(&reaction, held)?;
        let mut own = [[usize::MAX; 3]; 3];
        for (own, given) in own.iter_mut().zip([&unknowns, &holding.rows, &holding.columns]) {
            own[..given.len()].copy_from_slice(given);
        }
        Some(Self {
            unknowns: own[0],
            count,
            held,
            turns: !is_first,
            rotation,
            constraint: inverse(&constraint, held)?,
            reaction,
            friction: (rubs && !keeps).then(|| rest * reaction),
            rows: own[1],
            columns: own[2],
            keeps,
            sign,
            couplings,
            place: 0,
        })
    }

    fn unknowns(&self) -> &[usize] {
        &self.unknowns[..self.count]
    }

    /// Its rotated unknowns that are held.
    pub fn held(&self) -> &[usize] {
        &self.unknowns[..self.held]
    }

    pub fn rows(&self) -> &[usize] {
        &self.rows[..self.held]
    }

    pub fn columns(&self) -> &[usize] {
        &self.columns[..self.held]
    }

    fn gather(&self, x: &[f64]) -> Vector3<f64> {
        let mut here = Vector3::zeros();
        self.unknowns().iter().enumerate().for_each(|(local, unknown)| here[local] = x[*unknown]);
        here
    }

    /// `Qᵀ K Q`; columns of one node have one pattern.
    fn rotate_matrix(&self, matrix: &Bordered, values: &mut [f64]) {
        if !self.turns {
            return;
        }
        let count = self.count;
        for by_row in [false, true] {
            self.each_place(matrix, by_row, |places| {
                let mut before = [0.0; 3];
                (0..count).for_each(|local| before[local] = values[places[local]]);
                for local in 0..count {
                    values[places[local]] = (0..count).map(|other| self.rotation[(other, local)] * before[other]).sum();
                }
            });
        }
    }

    /// Calls with the places of the entries that the node's columns (or rows) have in each row (or column).
    fn each_place(&self, matrix: &Bordered, by_row: bool, mut each: impl FnMut([usize; 3])) {
        let pattern = &matrix.pattern;
        let mut starts = [0; 3];
        self.unknowns().iter().enumerate().for_each(|(local, unknown)| starts[local] = pattern.starts[*unknown]);
        for entry in 0..pattern.column(self.unknowns[0]).len() {
            let mut places = [0; 3];
            for local in 0..self.count {
                let place = starts[local] + entry;
                places[local] = if by_row { pattern.mirrors[place] } else { place };
            }
            each(places);
        }
    }

    fn take_rows(&self, matrix: &Bordered, values: &[f64], taken: &mut Vec<(usize, f64)>) -> [Range<usize>; 3] {
        let pattern = &matrix.pattern;
        let mut rows_at = [const { 0..0 }; 3];
        for (range, row) in rows_at.iter_mut().zip(self.held()) {
            let entry = |place: usize| (pattern.rows[place], values[pattern.mirrors[place]]);
            let start = taken.len();
            taken.extend(pattern.column(*row).map(entry).filter(|(_, value)| *value != 0.0));
            *range = start..taken.len();
        }
        rows_at
    }

    /// Rows `T` less `F R⁻¹` times rows `H`.
    fn fold(&self, matrix: &Bordered, values: &mut [f64]) {
        let Some(friction) = &self.friction else { return };
        self.each_place(matrix, true, |places| {
            for other in self.held..self.count {
                let taken: f64 = (0..self.held).map(|held| friction[(other, held)] * values[places[held]]).sum();
                values[places[other]] -= taken;
            }
        });
    }

    fn take_columns(&self, matrix: &Bordered, values: &[f64], taken: &mut Vec<(usize, f64)>) -> [Range<usize>; 3] {
        let pattern = &matrix.pattern;
        let mut columns_at = [const { 0..0 }; 3];
        for (range, column) in columns_at.iter_mut().zip(self.held()) {
            let entry = |place: usize| (pattern.rows[place], values[place]);
            let start = taken.len();
            taken.extend(pattern.column(*column).map(entry).filter(|(_, value)| *value != 0.0));
            *range = start..taken.len();
        }
        columns_at
    }

    /// Leaves a one on the diagonal in the held rows and columns.
    fn clear(&self, matrix: &Bordered, values: &mut [f64]) {
        let pattern = &matrix.pattern;
        for column in self.held() {
            for place in pattern.column(*column) {
                values[pattern.mirrors[place]] = 0.0;
                values[place] = if pattern.rows[place] == *column { 1.0 } else { 0.0 };
            }
        }
    }
}

/// The node's unknowns, those first that are held where border rows hold as many as they name.
fn held_first(matrix: &Bordered, holding: &Holding) -> Places {
    let is_named = |unknown: &usize| {
        let names = |row: &usize| matrix.lower[*row].iter().any(|(column, value)| column == unknown && *value != 0.0);
        holding.rows.iter().any(names)
    };
    let (named, others): (Places, Places) = holding.unknowns.iter().copied().partition(is_named);
    if named.len() == holding.rows.len() { named.into_iter().chain(others).collect() } else { holding.unknowns.clone() }
}

/// Whether columns have entries in the same rows.
fn same_columns(matrix: &Bordered, unknowns: &[usize]) -> bool {
    let rows = |unknown: usize| &matrix.pattern.rows[matrix.pattern.column(unknown)];
    unknowns.len() <= 3 && unknowns.iter().all(|unknown| rows(*unknown) == rows(unknowns[0]))
}

/// The leading block, with ones on the rest of the diagonal.
fn leading(matrix: &Matrix3<f64>, size: usize) -> Matrix3<f64> {
    Matrix3::from_fn(|row, column| match (row < size, column < size) {
        (true, true) => matrix[(row, column)],
        _ => f64::from(row == column),
    })
}

/// The inverse of a leading block that [`leading`] made.
fn inverse(matrix: &Matrix3<f64>, size: usize) -> Option<Matrix3<f64>> {
    if size == 1 {
        let own = 1.0 / matrix[(0, 0)];
        let mut inverse = Matrix3::identity();
        inverse[(0, 0)] = own;
        return own.is_finite().then_some(inverse);
    }
    let largest = matrix.view((0, 0), (size, size)).amax();
    let inverse = matrix.try_inverse()?;
    let own = inverse.view((0, 0), (size, size)).amax();
    (inverse.iter().all(|value| value.is_finite()) && own * largest * DEPENDENT < 1.0).then_some(inverse)
}

/// An orthogonal matrix whose first columns span the rows.
fn completed(rows: &Matrix3<f64>, held: usize, count: usize) -> Option<Matrix3<f64>> {
    let mut basis = Matrix3::identity();
    let rest = |basis: &Matrix3<f64>, known: usize, vector: Vector3<f64>| {
        let mut rest = vector;
        for _ in 0..2 {
            for column in 0..known {
                let own = basis.column(column);
                rest -= own * own.dot(&rest);
            }
        }
        rest
    };
    for row in 0..held {
        let row_vector: Vector3<f64> = rows.row(row).transpose();
        let (own, size) = (rest(&basis, row, row_vector), row_vector.norm());
        if own.norm() <= DEPENDENT * size || size == 0.0 {
            return None;
        }
        basis.set_column(row, &own.normalize());
    }
    for known in held..count {
        let unit = |place: usize| Vector3::from_fn(|row, _| f64::from(row == place));
        let units = (0..count).map(|place| rest(&basis, known, unit(place)));
        let longest = units.reduce(|best, other| if other.norm() > best.norm() { other } else { best })?;
        basis.set_column(known, &longest.normalize());
    }
    Some(basis)
}
