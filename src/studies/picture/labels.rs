//! Places the letters of a picture: each near its point, where it covers least.

use crate::studies::picture::shapes::Place;

/// Side of a cell of the map, in fine units.
const CELL: i32 = 30;
/// The cost of covering an occupied cell.
const CURVE: u32 = 14;
const MARKER: u32 = 20;
const LETTER: u32 = 60;
/// Markers that a letter is kept from, the first ones: a path has letters at its first events alone.
const MOST_MARKERS: usize = 300;
/// The cost of standing nearer to another marker than to the letter's own.
const STRAY: u32 = 50;
/// The cost of leaving the map.
const OUTSIDE: u32 = 400;
/// Distances of the centre of a letter from its point, in fine units, and their costs.
const DISTANCES: [(i32, u32); 7] = [(140, 0), (190, 6), (250, 14), (330, 26), (430, 42), (560, 64), (720, 92)];
/// The number of directions that are tried, beginning at the upper right.
const DIRECTIONS: i32 = 16;

/// The occupied cells of the picture.
#[derive(Debug)]
pub struct Map {
    corner: Place,
    columns: i32,
    cells: Vec<u32>,
    markers: Vec<Place>,
}

impl Map {
    /// An empty map of a rectangle.
    pub fn new(corner: Place, opposite: Place) -> Self {
        let columns = (opposite.0 - corner.0) / CELL + 1;
        let rows = (opposite.1 - corner.1) / CELL + 1;
        Self {
            corner,
            columns,
            cells: vec![0; usize::try_from(columns * rows).unwrap_or_default()],
            markers: Vec::new(),
        }
    }

    pub fn add_line(&mut self, from: Place, to: Place) {
        let longest = (to.0 - from.0).abs().max((to.1 - from.1).abs());
        let parts = longest / CELL + 1;
        for part in 0..=parts {
            let along = |start: i32, end: i32| start + (end - start) * part / parts;
            if let Some(cell) = self.cell((along(from.0, to.0), along(from.1, to.1))) {
                self.cells[cell] = self.cells[cell].max(CURVE);
            }
        }
    }

    pub fn add_marker(&mut self, middle: Place, size: i32) {
        self.add_box(middle, (size, size), MARKER);
        if self.markers.len() < MOST_MARKERS {
            self.markers.push(middle);
        }
    }

    /// Finds the best place for a letter, given half its size, and occupies it.
    pub fn take_room(&mut self, point: Place, half: Place) -> Place {
        let mut best = (u32::MAX, point);
        for (distance, far) in DISTANCES {
            for direction in 0..DIRECTIONS {
                let angle = std::f64::consts::TAU * (f64::from(direction) + 2.0) / f64::from(DIRECTIONS);
                let offset = |part: f64| (f64::from(distance) * part).round() as i32;
                let middle = (point.0 + offset(angle.cos()), point.1 - offset(angle.sin()));
                let stray = if self.is_stray(middle, point) { STRAY } else { 0 };
                let cost = far + stray + self.cost(middle, half);
                if cost < best.0 {
                    best = (cost, middle);
                }
            }
        }
        self.add_box(best.1, half, LETTER);
        best.1
    }

    /// Whether a letter there would be taken for that of another marker.
    fn is_stray(&self, middle: Place, point: Place) -> bool {
        let square = |from: &Place| {
            let [x, y] = [i64::from(middle.0 - from.0), i64::from(middle.1 - from.1)];
            x * x + y * y
        };
        self.markers.iter().any(|marker| square(marker) < square(&point))
    }

    fn add_box(&mut self, middle: Place, half: Place, cost: u32) {
        for place in places(middle, half) {
            if let Some(cell) = self.cell(place) {
                self.cells[cell] += cost;
            }
        }
    }

    fn cost(&self, middle: Place, half: Place) -> u32 {
        places(middle, half).map(|place| self.cell(place).map_or(OUTSIDE, |cell| self.cells[cell])).sum()
    }

    fn cell(&self, place: Place) -> Option<usize> {
        let column = (place.0 - self.corner.0).div_euclid(CELL);
        let row = (place.1 - self.corner.1).div_euclid(CELL);
        let cell = usize::try_from(row * self.columns + column).ok()?;
        ((0..self.columns).contains(&column) && row >= 0 && cell < self.cells.len()).then_some(cell)
    }
}

/// One place in each cell of a box.
fn places(middle: Place, half: Place) -> impl Iterator<Item = Place> {
    let along = |middle: i32, half: i32| (middle - half..=middle + half).step_by(CELL as usize);
    along(middle.0, half.0).flat_map(move |x| along(middle.1, half.1).map(move |y| (x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_avoid_lines_edges_and_each_other() {
        let mut map = Map::new((0, 0), (6000, 6000));
        map.add_line((0, 3000), (6000, 3000));
        map.add_marker((3000, 3000), 60);
        let first = map.take_room((3000, 3000), (60, 80));
        assert!((first.1 - 3000).abs() > 80, "{first:?}");
        let second = map.take_room((3000, 3000), (60, 80));
        assert!((first.0 - second.0).abs() > 120 || (first.1 - second.1).abs() > 160, "{first:?} {second:?}");
        let corner = map.take_room((0, 0), (60, 80));
        assert!(corner.0 >= 60 && corner.1 >= 80, "{corner:?}");
    }

    #[test]
    fn a_letter_stands_nearest_to_its_own_marker() {
        let mut map = Map::new((0, 0), (6000, 6000));
        let markers = [(3000, 3000), (3040, 2760), (2980, 3240)];
        markers.iter().for_each(|marker| map.add_marker(*marker, 60));
        for own in markers {
            let (x, y) = map.take_room(own, (60, 80));
            let square = |marker: &Place| (marker.0 - x).pow(2) + (marker.1 - y).pow(2);
            assert_eq!(markers.iter().min_by_key(|marker| square(marker)), Some(&own), "{x} {y}");
        }
    }
}
