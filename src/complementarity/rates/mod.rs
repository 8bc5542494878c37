//! The rate problem: linear forms, entities that take one of several options each, and the rays of given combinations.
//!
//! | file | what it does |
//! |---|---|
//! | `rate_problem` | forms, entities, options |
//! | `ray` | the exact ray of one combination of options, and whether its inequalities hold |
//! | `simplex_dictionary` | whether anything but zero is left when some entities are decided (linear programming) |
//! | `p_matrix` | a sufficient test that each sign of the load rate has exactly one ray, and those rays |
//! | `parametric_lcp` | all rays where one pair stands in the way of that test |
//! | `lemke` | complementary pivoting |
//! | `gauss_seidel` | a likely combination for each sign of the load rate |
//! | `warm_start` | combinations that a known vector of weights points to |
//! | `combinations` | one of each of several lists, in one order |

pub(crate) mod combinations;
pub(crate) mod gauss_seidel;
pub(crate) mod lemke;
pub(crate) mod p_matrix;
pub(crate) mod parametric_lcp;
pub(crate) mod rate_problem;
pub(crate) mod ray;
pub(crate) mod simplex_dictionary;
pub(crate) mod warm_start;
