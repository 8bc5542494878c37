//! The built-in scenes: models as JSON, ready to post.
//!
//! The folder `pictures` contains pictures of some scenes, drawn by `arcslip solve`, `study`, `sweep` and `verify` with
//! `--plot`; tests compare the pictures of the first three commands. [`exact`] contains the paths that are known in
//! closed form. [`beams`], [`lattice`] and [`of_any_size`] generate scenes of given sizes.

pub mod beams;
pub mod exact;
pub mod lattice;
pub mod of_any_size;

/// A model ready to post.
#[derive(Debug, Clone, Copy)]
pub struct BuiltIn {
    /// Short name, as in `/v1/scenes/{name}`.
    pub name: &'static str,
    /// A description in one line.
    pub shows: &'static str,
    /// The job request as JSON text.
    pub request: &'static str,
}

macro_rules! scene {
    ($name:literal, $shows:literal) => {
        BuiltIn { name: $name, shows: $shows, request: include_str!(concat!($name, ".json")) }
    };
}

/// Every built-in scene.
pub const ALL: &[BuiltIn] = &[
    scene!("one-bar-truss", "smooth limit points, a falling stretch of bifurcation points, a mechanism (friction 0.3)"),
    scene!("one-bar-truss-rough", "the same with friction 1.0"),
    scene!("klarbring", "two nonsmooth limit points between straight branches"),
    scene!("arch-type-truss", "smooth limit point, bifurcation points, and a crown that lands on the floor"),
    scene!("two-snapping-bars", "bars that snap one after another (row of two)"),
    scene!("three-snapping-bars", "bars that snap one after another (row of three)"),
    scene!(
        "four-snapping-bars",
        "a bar that snaps alone and a path that ends with no direction to go on (row of four)"
    ),
    scene!(
        "slider-chain",
        "blocks that begin to slip one after another, each at an exact load, until all of them slide"
    ),
    scene!("closed-loop", "a path that is a closed curve and ends as a cycle, without contact"),
    scene!("curving-slip", "slip that turns in space: a tip that draws a tractrix on the floor"),
    scene!("turning-drag", "a floor that moves and then turns drags a block around: slip that turns at a given load"),
    scene!("capstan", "a chain over a drum, pulled until all of it slides: tensions grow as exp(friction x angle)"),
    scene!("hump", "the one-bar truss over a round hump: two smooth limit points on a curved obstacle"),
    scene!("bowl", "a node pushed up the inside of a bowl"),
    scene!("groove", "a node between two flanks at once, whose reactions are not unique, until it leaves one of them"),
    scene!("doubled-floor", "the one-bar truss on two coincident floors that share the reaction"),
    scene!("dragged-block", "a moving floor that takes a block along until the block's spring holds it back"),
    scene!("rising-floor", "the one-bar truss on a floor that rises, then pushed"),
    scene!("lowered-pin", "the same with the pin lowered in place of the floor raised: the same reactions"),
    scene!("von-mises-truss", "snap-through without contact"),
];

/// The scene with a given name.
pub fn find(name: &str) -> Option<&'static BuiltIn> {
    ALL.iter().find(|scene| scene.name == name)
}
