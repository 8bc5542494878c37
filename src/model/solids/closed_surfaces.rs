//! Where a closed surface in the plane begins if it may touch itself.
//!
//! Of two parts that touch, the later one along the surface carries the multipliers. Where a closed surface begins, the two
//! change parts: this has to be where nothing touches.

use crate::mechanics::contact::bodies::PlaneVector;
use std::collections::HashMap;

/// Heights and distances that differ by less than this part of the extent are equal.
const EQUAL: f64 = 1e-9;

/// Lists the faces of each closed chain (by the numbers of their nodes, free to the left) so that the first listed, at
/// whose end the chain begins, is where it touches itself least. Of a skin around a body this is the middle of the longest
/// stretch that faces nothing; of the boundary of a hole, one of the two nodes that are farthest from each other, as a hole
/// folds there. Where several are equal, the first listed is taken. Faces of open chains stay.
pub(crate) fn begin_away_from_contact(lines: &[[usize; 2]], place: impl Fn(usize) -> PlaneVector) -> Vec<[usize; 2]> {
    let following: HashMap<usize, usize> = lines.iter().enumerate().map(|(index, line)| (line[0], index)).collect();
    let mut taken = vec![false; lines.len()];
    let mut listed = Vec::with_capacity(lines.len());
    for given in 0..lines.len() {
        if taken[given] {
            continue;
        }
        let mut chain = vec![given];
        let mut at = given;
        let is_closed = loop {
            match following.get(&lines[at][1]) {
                Some(next) if *next == given => break true,
                // A surface that branches is refused elsewhere.
                Some(next) if chain.len() <= lines.len() => at = *next,
                _ => break false,
            }
            chain.push(at);
        };
        if is_closed {
            let points: Vec<PlaneVector> = chain.iter().map(|face| place(lines[*face][0])).collect();
            chain.rotate_left(last_face(&points));
            chain.iter().for_each(|face| taken[*face] = true);
            listed.extend(chain.into_iter().map(|face| lines[face]));
        } else {
            taken[given] = true;
            listed.push(lines[given]);
        }
    }
    listed
}

/// The face of a closed polygon, from the point of the same index to the next, at whose end it should begin.
fn last_face(points: &[PlaneVector]) -> usize {
    let count = points.len();
    let next = |index: usize| points[(index + 1) % count];
    let length = |index: usize| distance(points[index], next(index));
    let extent = (0..count).map(|index| distance(points[0], points[index])).fold(0.0, f64::max);
    let faces_nothing = |index: &usize| {
        let ([x, y], [to_x, to_y]) = (points[*index], next(*index));
        let height = |point: &PlaneVector| ((to_x - x) * (point[1] - y) - (to_y - y) * (point[0] - x)) / length(*index);
        points.iter().all(|point| height(point) <= EQUAL * extent)
    };
    let blind: Vec<bool> = (0..count).map(|index| faces_nothing(&index)).collect();
    if blind.iter().all(|blind| *blind) {
        return 0;
    }
    let mut best: Option<(f64, usize)> = None;
    for first in (0..count).filter(|index| blind[*index] && !blind[(index + count - 1) % count]) {
        let run: Vec<usize> = (first..first + count).map(|at| at % count).take_while(|at| blind[*at]).collect();
        let whole: f64 = run.iter().map(|face| length(*face)).sum();
        let mut passed = 0.0;
        let middle = run.iter().find(|face| {
            passed += length(**face);
            passed >= 0.5 * whole - EQUAL * extent
        });
        if best.is_none_or(|(most, _)| whole > most + EQUAL * extent) {
            best = Some((whole, middle.copied().unwrap_or(first)));
        }
    }
    best.map_or_else(|| farthest(points, extent), |(_, middle)| middle)
}

/// The first of the points that are farthest from another one.
fn farthest(points: &[PlaneVector], extent: f64) -> usize {
    let away = |point: &PlaneVector| points.iter().map(|other| distance(*point, *other)).fold(0.0, f64::max);
    let all: Vec<f64> = points.iter().map(away).collect();
    let most = all.iter().copied().fold(0.0, f64::max);
    // The face before this point ends at it.
    let at = all.iter().position(|away| *away >= most - EQUAL * extent).unwrap_or(0);
    (at + points.len() - 1) % points.len()
}

fn distance(one: PlaneVector, other: PlaneVector) -> f64 {
    (one[0] - other[0]).hypot(one[1] - other[1])
}

#[cfg(test)]
mod tests {
    use super::{PlaneVector, begin_away_from_contact};

    /// A ring of twelve nodes, an oval or a bent strip around it.
    fn oval(number: usize) -> PlaneVector {
        let angle = std::f64::consts::TAU * number as f64 / 12.0;
        [(1.0 + 0.1 * (2.0 * angle).cos()) * angle.cos(), angle.sin()]
    }

    #[test]
    fn a_hole_begins_at_an_end_and_a_skin_where_it_faces_nothing() {
        let counter_clockwise =
            |from: usize| -> Vec<[usize; 2]> { (from..from + 12).map(|k| [k % 12, (k + 1) % 12]).collect() };
        // The ends of the oval are nodes 0 and 6; the first met is taken.
        assert_eq!(begin_away_from_contact(&counter_clockwise(2), oval)[0], [5, 6]);
        assert_eq!(begin_away_from_contact(&counter_clockwise(8), oval)[0], [11, 0]);
        // A skin with a notch between its nodes 2 and 4, clockwise: what is opposite to the notch.
        let notched = |number: usize| if number == 3 { [0.0, 0.2] } else { oval(number) };
        let clockwise: Vec<[usize; 2]> = (0..12).map(|k| [(15 - k) % 12, (14 - k) % 12]).collect();
        let listed = begin_away_from_contact(&clockwise, notched);
        assert_eq!((listed.len(), listed[0]), (12, [10, 9]));
        // Open chains stay.
        let open = [[1, 2], [0, 1], [2, 3]];
        assert_eq!(begin_away_from_contact(&open, oval), open);
    }
}
