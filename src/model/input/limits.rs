//! Limits on the sizes and magnitudes of a request; an error names the limit that is exceeded.

/// Bytes of one JSON document: the mesh of a million unknowns takes some 90 million.
pub const MAX_TEXT_BYTES: usize = 256 * 1024 * 1024;
/// Bytes of one JSON document that a service accepts unless it is told otherwise.
pub const USUAL_TEXT_BYTES: usize = 16 * 1024 * 1024;
/// Values (numbers, strings, arrays, objects) in a JSON document of the usual size, which bounds the memory for reading.
pub const MAX_VALUES: usize = 4_000_000;
/// Values in a JSON document of so many bytes.
pub const fn max_values(bytes: usize) -> usize {
    if bytes > USUAL_TEXT_BYTES { bytes / 4 } else { MAX_VALUES }
}
/// Mistakes listed for one document; a last entry says how many more there are.
pub const MAX_LISTED_MISTAKES: usize = 100;
/// Bytes of the name of a model, node, obstacle or stage.
pub const MAX_NAME_BYTES: usize = 200;

/// Nodes of a model; as many may be named in `supports`.
pub const MAX_NODES: usize = 1_000_000;
/// Elements of a model.
pub const MAX_ELEMENTS: usize = 2_500_000;
/// Obstacles of a model.
pub const MAX_OBSTACLES: usize = 20_000;
/// Points of one polyline.
pub const MAX_POLYLINE_POINTS: usize = 2_000;
/// Points of all polylines of a model.
pub const MAX_POINTS_OF_POLYLINES: usize = 20_000;
/// Triangles of one triangle mesh.
pub const MAX_MESH_TRIANGLES: usize = 20_000;
/// Triangles of all triangle meshes of a model.
pub const MAX_TRIANGLES_OF_MESHES: usize = 100_000;
/// Contacts of a model.
pub const MAX_CONTACTS: usize = 20_000;
/// Pairs of nodes that contacts of bodies may couple: each takes some 100 bytes while the layout of the tangent is made.
pub const MAX_COUPLED_PAIRS: usize = 2_000_000;
/// Number of nodes that names of sets and surfaces stand for in a request, counted as often as they are named.
pub const MAX_NAMED_NODES: usize = 1_000_000;
/// Up to this number of contacts an increment has a row for each. With more contacts, those out of reach have none unless
/// requested.
pub const MAX_ROWS_UNASKED: usize = 100;
/// Stages of a model.
pub const MAX_STAGES: usize = 1_000;
/// Turns of the load in a stage's `history`, over all its `cycles`.
pub const MAX_TURNS: u64 = 10_000;
/// Lower bound of `analysis.jump_motion.tolerance`: the number of time steps of a jump grows with the inverse of its
/// root.
pub const MIN_JUMP_TOLERANCE: f64 = 1e-8;
/// Upper bound of `analysis.jump_motion.max_steps`.
pub const MAX_JUMP_STEPS: u64 = 10_000_000;
/// Free displacement components. From some hundred on matrices are sparse.
pub const MAX_UNKNOWNS: usize = 1_500_000;
/// Free displacement components for the methods `mpec` and `regularised`, whose matrices are dense: memory goes with the
/// square and time with the cube.
pub const MAX_DENSE_UNKNOWNS: usize = crate::mechanics::structure::MOST_ANALYSED;
/// Upper bound of `analysis.max_increments`.
pub const MAX_INCREMENTS: u64 = 10_000_000;
/// Upper bound of `analysis.max_modes`.
pub const MAX_MODES: u64 = 10_000_000;
/// Upper bound of `analysis.explore.depth`.
pub const MAX_EXPLORE_DEPTH: u64 = 100;
/// Upper bound of `analysis.explore.max_jobs`: all of them may be queued at one time.
pub const MAX_EXPLORE_JOBS: u64 = 10_000;
/// Upper bound of `analysis.regularised.desired_iterations`.
pub const MAX_DESIRED_ITERATIONS: u64 = 1_000;

/// Values that a study varies its parameter over.
pub const MAX_STUDY_RUNGS: usize = 20;
/// Upper bound of `study.repeats`.
pub const MAX_STUDY_REPEATS: u64 = 101;
/// Upper bound of `study.refinement`.
pub const MAX_STUDY_REFINEMENT: u64 = 16;
/// Displacement components of all points of one path of a study: they are held in memory to be compared.
pub const MAX_STUDY_VALUES: f64 = 5e7;

/// Runs of a sweep.
pub const MAX_SWEEP_RUNS: u64 = 100_000;
/// Points of a curve of limit points at its longest step, without the points where it changes.
pub const MAX_CURVE_POINTS: u64 = 10_000;
/// Places of a document into which a sweep puts values, those that a step `*` stands for among them.
pub const MAX_SWEEP_PLACES: usize = 250_000;
/// Responses of a sweep.
pub const MAX_SWEEP_RESPONSES: usize = 64;

/// Numbers of a request are zero or lie between this and [`MAX_MAGNITUDE`] in absolute value, so that neither a ratio
/// of two of them nor its square can overflow or vanish.
pub const MIN_MAGNITUDE: f64 = 1e-75;
/// See [`MIN_MAGNITUDE`].
pub const MAX_MAGNITUDE: f64 = 1e75;

/// Largest penetration of an obstacle at the start, relative to the size of the model, that counts as rounding error.
pub const PENETRATION_TOLERANCE: f64 = 1e-12;
/// Two nodes closer than this, in units of their coordinates, are at the same place.
pub const COINCIDENCE_TOLERANCE: f64 = 1e-12;
/// A stiffness matrix may be this unsymmetric, in units of its largest entry.
pub const SYMMETRY_TOLERANCE: f64 = 1e-12;
