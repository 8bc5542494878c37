//! The rate problem: linear forms, entities that take one of several options each, and the rays of given combinations.
//!
//! | file | what it does |
//! |---|---|
//! | `rate_problem` | forms, entities, options |
//! | `ray_of_combination` | the exact ray of one combination of options, and whether its inequalities hold |
//! | `simplex_dictionary` | whether the remaining cone contains a nonzero vector when some entities are decided (linear programming) |
//! | `p_matrix` | a sufficient test that each sign of the load rate has exactly one ray, and these rays |
//! | `parametric_lcp` | all rays where one pair makes this test fail |
//! | `lemke` | complementary pivoting |
//! | `pressed_contacts` | guesses: the contacts that are pressed where there is no friction |
//! | `gauss_seidel` | a likely combination for each sign of the load rate |
//! | `combinations_near_vector` | combinations suggested by a known vector of weights |
//! | `block_pivoting` | complementarity by changing all violated conditions at once |
//! | `cartesian_product` | combinations of one item from each of several lists, in a fixed order |

pub(crate) mod block_pivoting;
pub(crate) mod cartesian_product;
pub(crate) mod combinations_near_vector;
pub(crate) mod gauss_seidel;
pub(crate) mod lemke;
pub(crate) mod p_matrix;
pub(crate) mod parametric_lcp;
pub(crate) mod pressed_contacts;
pub(crate) mod rate_problem;
pub(crate) mod ray_of_combination;
pub(crate) mod simplex_dictionary;
pub(crate) mod tolerances;
