//! Branch and bound over the entities.
//!
//! A node has some entities decided; what is left is the cone of their options' forms and of what the options of every
//! other entity have in common. The node is done where that cone holds nothing but zero, where it is one line (whatever
//! fits that line is examined), or where the open entities are certified to have one ray for each sign of the load rate.
//! Otherwise the entity that fits the cone's present point worst is decided, best option first. The first branching is
//! on the sign of the load rate. Every ray comes from the exact equations of its combination, so that the search decides
//! only where to look.

use super::certificate::{Certified, is_monotone, options_of, reduce};
use super::dictionary::{Dictionary, Feasibility};
use super::line::Line;
use super::problem::{Choice, Entity, RateProblem, Signed};
use crate::cancel::CancelFlag;
use crate::path::combinations::{combinations, count};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeSet;
use std::rc::Rc;

/// A feasible direction under one combination of options.
#[derive(Debug, Clone)]
pub struct Ray {
    /// Of unit arc length.
    pub weights: DVector<f64>,
    /// The options of each entity that hold; under every combination of them the ray is feasible.
    pub fitting: Vec<Vec<usize>>,
    /// Those and the ones that nearly hold.
    pub in_doubt: Vec<Vec<usize>>,
    /// Some inequality holds with equality.
    pub weak: bool,
}

impl Ray {
    /// The first combination under which it is feasible: held where it can be.
    pub fn chosen(&self) -> Vec<usize> {
        self.fitting.iter().map(|options| options[0]).collect()
    }

    pub(super) fn is_under(&self, chosen: &[usize]) -> bool {
        self.fitting.iter().zip(chosen).all(|(options, choice)| options.contains(choice))
    }
}

/// What was found.
#[derive(Debug, Clone, Default)]
pub struct Findings {
    /// Each motion once, in the order of their first combinations, the first entity counting fastest.
    pub rays: Vec<Ray>,
    /// Combinations that were not examined, saturating; an upper bound.
    pub unexplored: u64,
    /// Some combination has more than one independent vector, or one along which nothing moves.
    pub degenerate: bool,
    /// Bases of such sets, one vector a column.
    pub planes: Vec<DMatrix<f64>>,
    /// One ray for each sign of the load rate, by the certificate, without any branching.
    pub certified: bool,
    /// Nodes and combinations looked at, large ones counted as several.
    pub examined: u64,
}

/// Combinations of options in doubt that are tried on one line, beside those that violations lead to.
const MOST_LABELS: u64 = 64;
/// Entries of a dictionary that make a node count as one; a larger node counts as several.
const UNIT_OF_WORK: u64 = 4096;
/// Nodes spent inside sets of solutions of more than one dimension, whose edges are rays like any other.
const MOST_IN_SETS: u64 = 512;
/// Bases kept of such sets.
const MOST_PLANES: usize = 256;
/// Rays closer than this, relative to their largest weight, are one.
const SAME: f64 = 1e-9;
/// A form this small at a node's point is zero as far as the search is concerned.
const FITS: f64 = 1e-7;

/// All rays, after at most so many nodes and combinations; `first` are combinations to examine before the others.
pub fn explore(problem: &RateProblem, first: &[Vec<usize>], most: u64, cancel: &CancelFlag) -> Findings {
    let mut search = Search {
        problem,
        findings: Findings::default(),
        seen: BTreeSet::new(),
        most,
        common: problem.entities.iter().map(Entity::common).collect(),
        coupling: problem.coupling(),
        cost: 1 + (problem.forms.nrows() * problem.weights()) as u64 / UNIT_OF_WORK,
    };
    if !search.certified_at_once() {
        for chosen in first {
            search.examine(chosen);
        }
        search.branch(cancel);
    }
    let mut findings = search.findings;
    findings.unexplored = findings.unexplored.min(problem.combinations());
    findings.rays.sort_by_cached_key(|ray| ray.chosen().into_iter().rev().collect::<Vec<_>>());
    findings
}

/// Decided entities and the cone that is left.
struct Node {
    chosen: Vec<Option<usize>>,
    dictionary: Dictionary,
    /// Sign of the load rate.
    sign: f64,
    /// Inside a set of solutions.
    in_set: bool,
    /// The entity decided last.
    last: Option<usize>,
}

/// A child that has not been looked at.
struct Task {
    parent: Rc<Node>,
    decision: Option<(usize, usize)>,
}

/// What one combination turned out to be.
enum Examined {
    /// Feasible in one sense or both.
    Rays,
    /// One line, and the entities that it violates in the sense that violates fewer.
    Violated(Vec<usize>),
    /// No line, or more than one.
    Nothing,
    /// Known already.
    Before,
}

struct Search<'a> {
    problem: &'a RateProblem,
    findings: Findings,
    /// Combinations whose equations were solved.
    seen: BTreeSet<Vec<usize>>,
    most: u64,
    /// What all options of each entity have in common.
    common: Vec<Vec<Signed>>,
    coupling: DMatrix<f64>,
    /// What a node counts: large problems take longer over each.
    cost: u64,
}

impl Search<'_> {
    fn examine(&mut self, chosen: &[usize]) -> Examined {
        if !self.seen.insert(chosen.to_vec()) {
            return Examined::Before;
        }
        self.findings.examined += self.cost;
        match self.problem.line(chosen) {
            Line::Nothing => Examined::Nothing,
            Line::Along(weights) => {
                let senses = [-&weights, weights];
                let [first, second] = senses.each_ref().map(|weights| self.problem.violated(chosen, weights));
                let is_ray = first.is_empty() || second.is_empty();
                for (weights, violated) in senses.into_iter().zip([&first, &second]) {
                    if violated.is_empty() {
                        self.keep(chosen, weights);
                    }
                }
                match is_ray {
                    true => Examined::Rays,
                    false if first.len() < second.len() => Examined::Violated(first),
                    false => Examined::Violated(second),
                }
            }
            Line::Plane(basis) => {
                self.findings.degenerate = true;
                for weights in self.problem.edges(chosen, &basis) {
                    self.keep(chosen, weights);
                }
                if self.findings.planes.len() < MOST_PLANES {
                    self.findings.planes.push(basis);
                }
                Examined::Nothing
            }
            Line::Still | Line::NotFinite => {
                self.findings.degenerate = true;
                Examined::Nothing
            }
        }
    }

    fn keep(&mut self, chosen: &[usize], weights: DVector<f64>) {
        let size = weights.amax();
        if !self.findings.rays.iter().any(|ray| (&ray.weights - &weights).amax() <= SAME * size) {
            let fitting = self.problem.fitting(chosen, &weights);
            let weak = self.problem.is_weak(&fitting, &weights);
            let in_doubt = self.problem.in_doubt(chosen, &weights);
            self.findings.rays.push(Ray { weights, fitting, in_doubt, weak });
        }
    }

    /// Examines the combinations of the options given for each entity, which all fit one line, hold first.
    ///
    /// Where many options are in doubt there are too many combinations to try: what the first one violates is changed,
    /// and so on until a combination holds.
    fn examine_all(&mut self, options: &[Vec<usize>]) {
        let mut places = vec![0; options.len()];
        let mut settled = false;
        for _ in 0..MOST_LABELS as usize + options.len() {
            let chosen: Vec<usize> = options.iter().zip(&places).map(|(options, &place)| options[place]).collect();
            settled |= self.findings.rays.iter().any(|ray| ray.is_under(&chosen));
            match self.examine(&chosen) {
                Examined::Violated(violated) => {
                    // One that has no other option refutes them all.
                    settled |= violated.iter().any(|&entity| options[entity].len() == 1);
                    if settled {
                        break;
                    }
                    violated.iter().for_each(|&entity| places[entity] = (places[entity] + 1) % options[entity].len());
                }
                Examined::Rays => {
                    settled = true;
                    break;
                }
                Examined::Nothing | Examined::Before => break,
            }
        }
        let total = count(options);
        for chosen in combinations(options, MOST_LABELS) {
            let known = self.findings.rays.iter().find(|ray| ray.is_under(&chosen));
            match known.map(|ray| -&ray.weights) {
                None => settled |= matches!(self.examine(&chosen), Examined::Rays),
                // Its line is the known one; the other sense may be feasible under this combination only.
                Some(reversed) if self.problem.violated(&chosen, &reversed).is_empty() => self.keep(&chosen, reversed),
                Some(_) => {}
            }
        }
        if total > MOST_LABELS && !settled {
            self.findings.unexplored = self.findings.unexplored.saturating_add(total - MOST_LABELS);
        }
    }

    /// The certificate on the whole problem.
    fn certified_at_once(&mut self) -> bool {
        let Some(pairs) = self.problem.entities.iter().map(Entity::pair).collect::<Option<Vec<_>>>() else {
            return false;
        };
        let (a, b, load) = self.coordinates(&pairs);
        let open: Vec<usize> = (0..pairs.len()).collect();
        let chosen = vec![None; pairs.len()];
        let done = self.examine_certified(a, b, &load, &open, &chosen, &[1.0, -1.0]);
        self.findings.certified = done;
        done
    }

    /// Forces, velocities and load rate over weights that each move by one.
    fn coordinates(&self, pairs: &[[Signed; 2]]) -> (DMatrix<f64>, DMatrix<f64>, Vec<f64>) {
        let motion = &self.problem.motion;
        let scales = DVector::from_iterator(motion.ncols(), motion.column_iter().map(|column| 1.0 / column.norm()));
        let rows = |side: usize| {
            DMatrix::from_fn(pairs.len(), scales.len(), |row, column| {
                pairs[row][side].sign * self.problem.forms[(pairs[row][side].form, column)] * scales[column]
            })
        };
        let load = motion.row(motion.nrows() - 1).iter().zip(scales.iter()).map(|(a, b)| a * b).collect();
        (rows(0), rows(1), load)
    }

    /// Signs of the load rate for which the problem is monotone and a ray is known that must then be the only one.
    fn settled_signs(&self) -> Vec<f64> {
        let conjugates: Option<Vec<_>> = self.problem.entities.iter().map(Entity::conjugates).collect();
        let Some(conjugates) = conjugates else { return Vec::new() };
        let mut bounds = Vec::new();
        let mut next = 0;
        for (entity, pairs) in self.problem.entities.iter().zip(&conjugates) {
            bounds.extend(entity.touching.map(|_| next));
            next += pairs.len();
        }
        let (a, b, load) = self.coordinates(&conjugates.concat());
        let Some((matrix, _)) = reduce(&a, &b, &load) else { return Vec::new() };
        if !is_monotone(&matrix, &bounds) {
            return Vec::new();
        }
        let motion = &self.problem.motion;
        let load_of = |ray: &Ray| (motion.row(motion.nrows() - 1) * &ray.weights)[0];
        let strict = |sign: f64| self.findings.rays.iter().any(|ray| !ray.weak && sign * load_of(ray) > FITS);
        [1.0, -1.0].into_iter().filter(|sign| strict(*sign)).collect()
    }

    /// Examines the one combination for each load rate given, if there is a certificate that it is the only one.
    fn examine_certified(
        &mut self,
        a: DMatrix<f64>,
        b: DMatrix<f64>,
        load: &[f64],
        open: &[usize],
        chosen: &[Option<usize>],
        signs: &[f64],
    ) -> bool {
        let Some((matrix, constant)) = reduce(&a, &b, load) else { return false };
        let Some(certified) = Certified::new(matrix, constant) else { return false };
        let Some(solutions) = signs.iter().map(|sign| certified.solve(*sign)).collect::<Option<Vec<_>>>() else {
            return false;
        };
        for pairs in solutions {
            let mut options: Vec<Vec<usize>> = chosen.iter().map(|choice| choice.iter().copied().collect()).collect();
            for (&entity, fitting) in open.iter().zip(options_of(&pairs)) {
                options[entity] = fitting;
            }
            self.examine_all(&options);
        }
        true
    }

    fn branch(&mut self, cancel: &CancelFlag) {
        let Some(dictionary) = Dictionary::new(self.problem) else {
            self.findings.degenerate = true;
            return;
        };
        let root = |sign: f64| {
            let mut dictionary = dictionary.clone();
            dictionary.require(None, sign);
            let chosen = vec![None; self.problem.entities.len()];
            Task { parent: Rc::new(Node { chosen, dictionary, sign, in_set: false, last: None }), decision: None }
        };
        let settled = self.settled_signs();
        let mut tasks: Vec<Task> = [-1.0, 1.0].into_iter().filter(|sign| !settled.contains(sign)).map(root).collect();
        if tasks.is_empty() {
            // Rays along which the load rests are left.
            let mut dictionary = dictionary.clone();
            if dictionary.rest_load() {
                let chosen = vec![None; self.problem.entities.len()];
                let node = Node { chosen, dictionary, sign: 1.0, in_set: false, last: None };
                tasks.push(Task { parent: Rc::new(node), decision: None });
            }
        }
        let mut in_sets = Vec::new();
        let mut left_in_sets = MOST_IN_SETS;
        loop {
            let task = match tasks.pop() {
                Some(task) => task,
                None if left_in_sets > 0 => match in_sets.pop() {
                    Some(task) => {
                        left_in_sets = left_in_sets.saturating_sub(self.cost);
                        task
                    }
                    None => return,
                },
                None => break,
            };
            if cancel.is_cancelled() || self.findings.examined >= self.most {
                tasks.push(task);
                break;
            }
            self.findings.examined += self.cost;
            for child in self.look_at(task) {
                if child.parent.in_set { in_sets.push(child) } else { tasks.push(child) }
            }
        }
        for task in tasks.iter().chain(&in_sets) {
            let left = self.combinations_of(task);
            self.findings.unexplored = self.findings.unexplored.saturating_add(left);
        }
    }

    /// Combinations under a task.
    fn combinations_of(&self, task: &Task) -> u64 {
        let decided = task.decision.map(|(entity, _)| entity);
        self.problem
            .entities
            .iter()
            .enumerate()
            .filter(|(index, _)| task.parent.chosen[*index].is_none() && decided != Some(*index))
            .fold(1, |total, (_, entity)| total.saturating_mul(entity.options.len() as u64))
    }

    /// Closes a node or gives its children, the most promising last.
    fn look_at(&mut self, task: Task) -> Vec<Task> {
        let Some(mut node) = decide(self.problem, task) else { return Vec::new() };
        if node.dictionary.feasibility() == Feasibility::OnlyLines
            && !node.dictionary.is_lines_only()
            && !node.dictionary.leave_lines()
        {
            return Vec::new();
        }
        let open: Vec<usize> = (0..node.chosen.len()).filter(|&index| node.chosen[index].is_none()).collect();
        if open.is_empty() {
            let chosen: Vec<usize> = node.chosen.iter().flatten().copied().collect();
            self.examine(&chosen);
            return Vec::new();
        }
        node.dictionary.drop_forced();
        let dictionary = &node.dictionary;
        let dimension = dictionary.dimension() + usize::from(!dictionary.is_lines_only());
        if dimension == 0 {
            return Vec::new();
        }
        if dimension == 1 {
            let mut options: Vec<Vec<usize>> =
                node.chosen.iter().map(|choice| choice.iter().copied().collect()).collect();
            for &entity in &open {
                let choices = &self.problem.entities[entity].options;
                options[entity] = (0..choices.len()).filter(|&index| fits(dictionary, &choices[index])).collect();
            }
            if options.iter().all(|options| !options.is_empty()) {
                self.examine_all(&options);
            }
            return Vec::new();
        }
        if self.certified_below(&node, &open) {
            return Vec::new();
        }
        if !node.in_set
            && let Some(filled) = self.filled(&node)
        {
            // Whatever is left solves the problem: a set of more than one dimension.
            self.examine(&filled);
            node.in_set = true;
        }
        let entity = self.next(&node, &open);
        let choices = &self.problem.entities[entity].options;
        let mut order: Vec<(f64, usize)> =
            choices.iter().enumerate().map(|(index, choice)| (misfit(dictionary, choice), index)).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
        let parent = Rc::new(node);
        order
            .into_iter()
            .map(|(_, choice)| Task { parent: Rc::clone(&parent), decision: Some((entity, choice)) })
            .collect()
    }

    /// The entity to decide next. Of those that do not fit the node's point, the one that feels the last decision most:
    /// a decision that cannot be is then refuted near by, in a few nodes. Where all fit, the first that still decides
    /// something.
    fn next(&self, node: &Node, open: &[usize]) -> usize {
        let mut next: Option<((f64, f64), usize)> = None;
        for &entity in open {
            let fit = self.problem.entities[entity]
                .options
                .iter()
                .map(|choice| misfit(&node.dictionary, choice))
                .fold(f64::INFINITY, f64::min);
            if fit <= FITS {
                continue;
            }
            let score = (node.last.map_or(0.0, |last| self.coupling[(last, entity)]), fit);
            if next.is_none_or(|(best, _)| score > best) {
                next = Some((score, entity));
            }
        }
        let decides = |entity: &&usize| {
            let choices = &self.problem.entities[**entity].options;
            choices.iter().any(|choice| choice.zero.iter().any(|form| !node.dictionary.vanishes(*form)))
        };
        next.map(|(_, entity)| entity).or_else(|| open.iter().find(decides).copied()).unwrap_or(open[0])
    }

    /// A combination under which everything left is a solution, if there is one.
    fn filled(&self, node: &Node) -> Option<Vec<usize>> {
        node.chosen
            .iter()
            .zip(self.problem.entities.iter().zip(&self.common))
            .map(|(chosen, (entity, common))| {
                chosen.or_else(|| {
                    entity.options.iter().position(|choice| {
                        choice.zero.iter().all(|form| node.dictionary.vanishes(*form))
                            && choice.nonnegative.iter().all(|signed| common.contains(signed))
                    })
                })
            })
            .collect()
    }

    /// The certificate on what is left at a node.
    fn certified_below(&mut self, node: &Node, open: &[usize]) -> bool {
        let dictionary = &node.dictionary;
        if dictionary.is_lines_only() || dictionary.lines() > 0 || dictionary.dimension() != open.len() || node.in_set {
            return false;
        }
        let pairs = open.iter().map(|&entity| self.problem.entities[entity].pair());
        let Some(pairs) = pairs.collect::<Option<Vec<_>>>() else { return false };
        let rows = |side: usize| {
            let mut rows = DMatrix::zeros(pairs.len(), pairs.len() + 1);
            for (row, pair) in pairs.iter().enumerate() {
                rows.row_mut(row).copy_from_slice(&dictionary.coefficients(Some(pair[side].form), pair[side].sign));
            }
            rows
        };
        let load = dictionary.coefficients(None, 1.0);
        self.examine_certified(rows(0), rows(1), &load, open, &node.chosen, &[node.sign])
    }
}

/// How far a node's point is from an option.
fn misfit(dictionary: &Dictionary, choice: &Choice) -> f64 {
    let zero = choice.zero.iter().map(|form| dictionary.value(super::Signed::plus(*form)).abs());
    let negative = choice.nonnegative.iter().map(|signed| -dictionary.value(*signed));
    zero.chain(negative).fold(0.0, f64::max)
}

/// Whether an option holds on the one line or ray that is left.
fn fits(dictionary: &Dictionary, choice: &Choice) -> bool {
    misfit(dictionary, choice) <= FITS
        && (!dictionary.is_lines_only() || choice.zero.iter().all(|form| dictionary.vanishes(*form)))
}

/// The node of a task; `None` where nothing but zero is left.
fn decide(problem: &RateProblem, task: Task) -> Option<Node> {
    let parent = &task.parent;
    let mut node = Node {
        chosen: parent.chosen.clone(),
        dictionary: parent.dictionary.clone(),
        sign: parent.sign,
        in_set: parent.in_set,
        last: task.decision.map(|(entity, _)| entity),
    };
    let Some((entity, choice)) = task.decision else { return Some(node) };
    node.chosen[entity] = Some(choice);
    let choice = &problem.entities[entity].options[choice];
    for form in &choice.zero {
        if !node.dictionary.make_zero(*form) {
            return None;
        }
    }
    for signed in choice.nonnegative.iter().chain(&choice.implied) {
        node.dictionary.require(Some(signed.form), signed.sign);
    }
    Some(node)
}
