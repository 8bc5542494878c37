//! Lists of node numbers of different lengths, in one block of memory.

/// Lists of node numbers, such as the nodes of each element.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct NodeLists {
    /// Where each list ends in `nodes`.
    ends: Vec<usize>,
    nodes: Vec<u32>,
}

impl NodeLists {
    /// Number of lists.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is no list.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Makes room for lists with a number of nodes altogether.
    pub fn reserve(&mut self, lists: usize, nodes: usize) {
        self.ends.reserve(lists);
        self.nodes.reserve(nodes);
    }

    /// Appends a list.
    pub fn push(&mut self, list: impl IntoIterator<Item = u32>) {
        self.nodes.extend(list);
        self.ends.push(self.nodes.len());
    }

    fn range(&self, list: usize) -> std::ops::Range<usize> {
        let Some(&end) = self.ends.get(list) else { return 0..0 };
        let start = list.checked_sub(1).and_then(|before| self.ends.get(before)).copied().unwrap_or(0);
        start..end
    }

    /// A list by its place; empty past the end.
    pub fn get(&self, list: usize) -> &[u32] {
        self.nodes.get(self.range(list)).unwrap_or_default()
    }

    /// A list by its place, to be changed in place.
    pub fn get_mut(&mut self, list: usize) -> &mut [u32] {
        let range = self.range(list);
        self.nodes.get_mut(range).unwrap_or_default()
    }

    /// The lists in their order.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.len()).map(|list| self.get(list))
    }
}
