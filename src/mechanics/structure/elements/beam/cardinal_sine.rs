//! The cardinal sine `S(a) = sin(a)/a`, its derivatives and differences, with all digits at small arguments.

/// Arguments below which the series in powers of `a²` is used; its twelve terms then reach beyond round-off.
const SERIES_BELOW: f64 = 1.0;
const TERMS: usize = 12;

/// `S`, `S'` and `S''`.
pub(super) fn with_derivatives(a: f64) -> [f64; 3] {
    if a.abs() >= SERIES_BELOW {
        let (sin, cos) = a.sin_cos();
        let value = sin / a;
        let first = (cos - value) / a;
        return [value, first, -value - 2.0 * first / a];
    }
    // Σ c_k a^(2k) with c_k = (-1)^k/(2k+1)!, by Horner's rule from the last term.
    let square = a * a;
    let (mut value, mut first, mut second) = (0.0, 0.0, 0.0);
    for k in (1..TERMS).rev() {
        let order = 2.0 * k as f64;
        let coefficient = COEFFICIENTS[k];
        value = value * square + coefficient;
        first = first * square + order * coefficient;
        second = second * square + order * (order - 1.0) * coefficient;
    }
    [1.0 + square * value, a * first, second]
}

/// `c_k`
const COEFFICIENTS: [f64; TERMS] = {
    let mut coefficients = [1.0; TERMS];
    let (mut factorial, mut k) = (1.0, 1);
    while k < TERMS {
        factorial *= (2 * k) as f64;
        factorial *= (2 * k + 1) as f64;
        coefficients[k] = if k.is_multiple_of(2) { 1.0 / factorial } else { -1.0 / factorial };
        k += 1;
    }
    coefficients
};

/// `S(a) - S(b)`; `change` is `a - b`, which the caller knows with more digits.
pub(super) fn difference(a: f64, b: f64, change: f64) -> f64 {
    if a.abs().max(b.abs()) >= SERIES_BELOW {
        return with_derivatives(a)[0] - with_derivatives(b)[0];
    }
    // a^(2k+2) - b^(2k+2) = a² (a^(2k) - b^(2k)) + b^(2k) (a² - b²).
    let of_squares = change * (a + b);
    let (mut sum, mut of_powers, mut power) = (0.0, of_squares, b * b);
    for coefficient in &COEFFICIENTS[1..] {
        sum += coefficient * of_powers;
        of_powers = a * a * of_powers + power * of_squares;
        power *= b * b;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_formulas_agree() {
        for a in [-1.0 + 1e-12, 0.3, 0.999_999_999_999, 1e-9, 0.0] {
            let series = with_derivatives(a);
            if a.abs() > 0.2 {
                let (sin, cos) = a.sin_cos();
                let closed = [sin / a, (cos - sin / a) / a, -sin / a - 2.0 * (cos - sin / a) / (a * a)];
                for (one, other) in series.iter().zip(closed) {
                    assert!((one - other).abs() <= 1e-14, "{a}: {one:?} {other:?}");
                }
            }
        }
        assert_eq!(with_derivatives(0.0), [1.0, 0.0, -1.0 / 3.0]);
        let small = difference(0.5 + 1e-9, 0.5, 1e-9) / (1e-9 * with_derivatives(0.5)[1]);
        assert!((small - 1.0).abs() < 1e-8, "{small}");
        assert!((difference(1e-8, 0.0, 1e-8) / 1e-16 + 1.0 / 6.0).abs() < 1e-15);
        let large = difference(2.0, 0.3, 1.7);
        assert!((large - (2.0_f64.sin() / 2.0 - 0.3_f64.sin() / 0.3)).abs() < 1e-15);
    }
}
