//! Vectors at nodes (displacements, reactions) keyed by the names of the nodes, in one contiguous array: the rows of a path
//! share the names.

use indexmap::IndexMap;
use serde::de::{MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::ops::{Index, IndexMut, Range};
use std::sync::Arc;

/// A vector at each of some nodes, in the model's order: displacements (length) or forces.
#[derive(Debug, Clone, Default)]
pub struct NodalValues {
    places: Arc<Places>,
    values: Vec<f64>,
}

/// Names and where their components are.
type Places = IndexMap<Arc<str>, Range<usize>>;

impl NodalValues {
    /// Of the same nodes, with other components, node by node.
    pub(crate) fn with_components(&self, components: Vec<f64>) -> Self {
        Self { places: Arc::clone(&self.places), values: components }
    }

    /// Nodes.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Components of a node.
    pub fn get(&self, node: &str) -> Option<&[f64]> {
        self.values.get(self.places.get(node)?.clone())
    }

    /// Name and components by place in the order.
    pub fn get_index(&self, place: usize) -> Option<(&Arc<str>, &[f64])> {
        let (name, range) = self.places.get_index(place)?;
        Some((name, self.values.get(range.clone())?))
    }

    /// Names of the nodes, in order.
    pub fn keys(&self) -> impl Iterator<Item = &Arc<str>> {
        self.places.keys()
    }

    /// Components, node by node.
    pub fn values(&self) -> impl Iterator<Item = &[f64]> {
        self.places.values().map(|range| &self.values[range.clone()])
    }

    /// Names and components, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&Arc<str>, &[f64])> {
        self.places.iter().map(|(name, range)| (name, &self.values[range.clone()]))
    }

    /// Keeps the nodes for whose places in the order this is true.
    pub fn keep(&mut self, mut is_kept: impl FnMut(usize) -> bool) {
        let kept = self.iter().enumerate().filter(|(place, _)| is_kept(*place));
        *self = kept.map(|(_, (name, values))| (Arc::clone(name), values)).collect();
    }
}

impl<Values: AsRef<[f64]>> FromIterator<(Arc<str>, Values)> for NodalValues {
    /// Of several entries of one name the last is kept.
    fn from_iter<Entries: IntoIterator<Item = (Arc<str>, Values)>>(entries: Entries) -> Self {
        let (mut places, mut all) = (Places::new(), Vec::new());
        for (name, values) in entries {
            let first = all.len();
            all.extend_from_slice(values.as_ref());
            places.insert(name, first..all.len());
        }
        Self { places: Arc::new(places), values: all }
    }
}

/// # Panics
/// Where no node has the name.
impl Index<&str> for NodalValues {
    type Output = [f64];

    fn index(&self, node: &str) -> &[f64] {
        &self.values[self.places[node].clone()]
    }
}

impl IndexMut<&str> for NodalValues {
    fn index_mut(&mut self, node: &str) -> &mut [f64] {
        &mut self.values[self.places[node].clone()]
    }
}

impl PartialEq for NodalValues {
    fn eq(&self, other: &Self) -> bool {
        self.len() == other.len() && self.iter().all(|(name, values)| other.get(name) == Some(values))
    }
}

impl Serialize for NodalValues {
    fn serialize<To: Serializer>(&self, to: To) -> Result<To::Ok, To::Error> {
        let mut map = to.serialize_map(Some(self.len()))?;
        for (name, values) in self.iter() {
            map.serialize_entry(name, values)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for NodalValues {
    fn deserialize<From: Deserializer<'de>>(from: From) -> Result<Self, From::Error> {
        struct Entries;
        impl<'de> Visitor<'de> for Entries {
            type Value = NodalValues;

            fn expecting(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                out.write_str("an object of arrays of numbers, by node")
            }

            fn visit_map<Map: MapAccess<'de>>(self, mut map: Map) -> Result<NodalValues, Map::Error> {
                let mut entries = Vec::with_capacity(map.size_hint().unwrap_or(0).min(4096));
                while let Some(entry) = map.next_entry::<Arc<str>, Vec<f64>>()? {
                    entries.push(entry);
                }
                Ok(entries.into_iter().collect())
            }
        }
        from.deserialize_map(Entries)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_read_as_they_were_written() {
        let text = r#"{"left":[0.5,-1.0],"tip":[],"right":[2.0]}"#;
        let mut read: NodalValues = serde_json::from_str(text).unwrap();
        assert_eq!(serde_json::to_string(&read).unwrap(), text);
        assert_eq!(
            (read.len(), &read["left"], read.get("tip"), read.get("top")),
            (3, &[0.5, -1.0][..], Some(&[][..]), None)
        );
        assert_eq!(read.get_index(2), Some((&Arc::from("right"), &[2.0][..])));
        let other: NodalValues = serde_json::from_str(r#"{"right":[2.0],"left":[0.5,-1.0],"tip":[]}"#).unwrap();
        assert_eq!(read, other);
        read["right"][0] = 3.0;
        assert_ne!(read, other);
        read.keep(|place| place != 0);
        assert_eq!(serde_json::to_string(&read).unwrap(), r#"{"tip":[],"right":[3.0]}"#);
    }
}
