//! A root in a bracket, by inverse quadratic interpolation guarded by bisection
//! (T. R. Chandrupatla, Adv. Eng. Softw. 28 (1997) 145, doi:10.1016/S0965-9978(96)00051-8).

/// Number of evaluations after which the current bracket is accepted.
const MOST_EVALUATIONS: usize = 120;

/// A root of `evaluate` in a bracket, to round-off.
///
/// `positive` and `negative` are pairs `(argument, value)` with values of these signs. A value of magnitude up to
/// `zero` counts as zero. `None` when `evaluate` fails or its value is not finite.
pub fn find_root(
    mut evaluate: impl FnMut(f64) -> Option<f64>,
    positive: (f64, f64),
    negative: (f64, f64),
    zero: f64,
) -> Option<f64> {
    let (mut newest, mut opposite) = (negative, positive);
    let mut fraction = 0.5;
    for _ in 0..MOST_EVALUATIONS {
        let place = newest.0 + fraction * (opposite.0 - newest.0);
        let value = evaluate(place)?;
        if !value.is_finite() {
            return None;
        }
        let oldest;
        if (value > 0.0) == (newest.1 > 0.0) {
            oldest = newest;
        } else {
            oldest = opposite;
            opposite = newest;
        }
        newest = (place, value);
        let best = if newest.1.abs() < opposite.1.abs() { newest } else { opposite };
        let width = (opposite.0 - newest.0).abs();
        let tolerance = 2.0 * f64::EPSILON * best.0.abs();
        if width <= 2.0 * tolerance || best.1.abs() <= zero {
            return Some(best.0);
        }
        let xi = (newest.0 - opposite.0) / (oldest.0 - opposite.0);
        let phi = (newest.1 - opposite.1) / (oldest.1 - opposite.1);
        fraction = if 1.0 - (1.0 - xi).sqrt() < phi && phi < xi.sqrt() {
            (newest.1 / (opposite.1 - newest.1)) * (oldest.1 / (opposite.1 - oldest.1))
                + ((oldest.0 - newest.0) / (opposite.0 - newest.0))
                    * (newest.1 / (oldest.1 - newest.1))
                    * (opposite.1 / (oldest.1 - opposite.1))
        } else {
            0.5
        };
        let least = 0.5 * tolerance / width;
        fraction = fraction.clamp(least, 1.0 - least);
    }
    Some(if newest.1.abs() < opposite.1.abs() { newest.0 } else { opposite.0 })
}

#[cfg(test)]
mod tests {
    use super::find_root;

    #[test]
    fn roots_are_found_to_round_off() {
        let cubic = |x: f64| 2.0 - x * x * x;
        let root = find_root(|x| Some(cubic(x)), (0.0, 2.0), (3.0, -25.0), 0.0).unwrap();
        assert!((root - 2f64.powf(1.0 / 3.0)).abs() < 1e-15);
    }

    #[test]
    fn a_failure_is_passed_on() {
        assert!(find_root(|_| None, (0.0, 1.0), (1.0, -1.0), 0.0).is_none());
    }
}
