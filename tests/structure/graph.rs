//! Circles in a graph of imports.

use std::collections::{BTreeMap, BTreeSet};

/// Each node's successors, with the weight of the edge.
pub type Graph = Vec<BTreeMap<usize, usize>>;

/// Nodes each of which reaches every other.
#[derive(Debug, PartialEq, Eq)]
pub struct Circle {
    /// In an order in which few edges lead back.
    pub members: Vec<usize>,
    /// The edges that lead back in that order: without them there is no circle.
    pub closing: Vec<(usize, usize)>,
}

/// The circles of two or more nodes, the largest first.
pub fn circles(graph: &Graph) -> Vec<Circle> {
    let mut circles: Vec<Circle> = components(graph)
        .into_iter()
        .filter(|members| members.len() > 1)
        .map(|members| circle(graph, members))
        .collect();
    circles.sort_by(|one, other| (other.members.len(), &one.members).cmp(&(one.members.len(), &other.members)));
    circles
}

/// Strongly connected components, by Tarjan's algorithm.
fn components(graph: &Graph) -> Vec<Vec<usize>> {
    let mut search = Search {
        graph,
        count: 0,
        index: vec![None; graph.len()],
        low: vec![0; graph.len()],
        stack: Vec::new(),
        found: Vec::new(),
    };
    for node in 0..graph.len() {
        if search.index[node].is_none() {
            search.visit(node);
        }
    }
    search.found
}

struct Search<'a> {
    graph: &'a Graph,
    count: usize,
    /// In which order a node was reached.
    index: Vec<Option<usize>>,
    /// The earliest node on the stack that is reached from here.
    low: Vec<usize>,
    stack: Vec<usize>,
    found: Vec<Vec<usize>>,
}

impl Search<'_> {
    fn visit(&mut self, node: usize) -> usize {
        let index = self.count;
        self.count += 1;
        self.index[node] = Some(index);
        self.low[node] = index;
        self.stack.push(node);
        for &next in self.graph[node].keys() {
            match self.index[next] {
                None => self.low[node] = self.low[node].min(self.visit(next)),
                Some(earlier) if self.stack.contains(&next) => self.low[node] = self.low[node].min(earlier),
                Some(_) => {}
            }
        }
        if self.low[node] == index {
            let begin = self.stack.iter().position(|&other| other == node).expect("the node itself");
            let mut members = self.stack.split_off(begin);
            members.sort_unstable();
            self.found.push(members);
        }
        self.low[node]
    }
}

/// Orders the members of a circle so that little leads back: nodes are moved, one at a time, as long as that helps.
fn circle(graph: &Graph, members: Vec<usize>) -> Circle {
    let inside: BTreeSet<usize> = members.iter().copied().collect();
    let weight = |from: usize, to: usize| graph[from].get(&to).map_or(0, |&weight| weight.cast_signed());
    // What imports much and is imported little begins.
    let surplus =
        |node: usize| -> isize { inside.iter().map(|&other| weight(node, other) - weight(other, node)).sum() };
    let mut order = members;
    order.sort_by_key(|&node| (-surplus(node), node));
    let mut moved = true;
    while moved {
        moved = false;
        for at in 0..order.len() {
            let node = order[at];
            let mut best = (0, at);
            for aim in (0..at).rev().scan(0, |gain, earlier| {
                *gain += weight(node, order[earlier]) - weight(order[earlier], node);
                Some((*gain, earlier))
            }) {
                best = if aim.0 > best.0 { aim } else { best };
            }
            for aim in (at + 1..order.len()).scan(0, |gain, later| {
                *gain += weight(order[later], node) - weight(node, order[later]);
                Some((*gain, later))
            }) {
                best = if aim.0 > best.0 { aim } else { best };
            }
            if best.0 > 0 {
                let node = order.remove(at);
                order.insert(best.1, node);
                moved = true;
            }
        }
    }
    let place: BTreeMap<usize, usize> = order.iter().enumerate().map(|(place, &node)| (node, place)).collect();
    let closing = order
        .iter()
        .flat_map(|&from| graph[from].keys().map(move |&to| (from, to)))
        .filter(|(from, to)| place.get(to).is_some_and(|to| *to < place[from]))
        .collect();
    Circle { members: order, closing }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(nodes: usize, edges: &[(usize, usize, usize)]) -> Graph {
        let mut graph = vec![BTreeMap::new(); nodes];
        for &(from, to, weight) in edges {
            graph[from].insert(to, weight);
        }
        graph
    }

    #[test]
    fn no_circle_where_all_leads_one_way() {
        assert_eq!(circles(&graph(4, &[(0, 1, 1), (0, 2, 1), (1, 3, 1), (2, 3, 1)])), []);
    }

    #[test]
    fn circles_apart_from_each_other() {
        let found = circles(&graph(6, &[(0, 1, 1), (1, 0, 3), (1, 2, 1), (2, 3, 2), (3, 4, 2), (4, 2, 1), (4, 5, 1)]));
        assert_eq!(
            found,
            [
                Circle { members: vec![2, 3, 4], closing: vec![(4, 2)] },
                Circle { members: vec![1, 0], closing: vec![(0, 1)] },
            ]
        );
    }

    #[test]
    fn what_closes_a_circle_is_the_light_edge() {
        // 3 -> 2 -> 1 -> 0 is the chain; one thin edge leads back.
        let found = circles(&graph(4, &[(3, 2, 5), (2, 1, 5), (1, 0, 5), (3, 0, 5), (0, 3, 1)]));
        assert_eq!(found, [Circle { members: vec![3, 2, 1, 0], closing: vec![(0, 3)] }]);
    }
}
