//! An axis: its range and the texts of its ticks.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::Ranged;
use std::ops::Range;

/// Margin at either end of an axis, relative to the range of the values.
const MARGIN: f64 = 0.07;
/// Powers of ten that are written out; beyond them the title of the axis has the power.
const WRITTEN_OUT: std::ops::RangeInclusive<i32> = -3..=4;
/// Values this small relative to the largest count as zero.
const ROUNDING: f64 = 1e-12;
/// Values that differ by less than this part of the largest are the same.
const SAME: f64 = 1e-9;
/// Significant digits of a load in the legend.
const DIGITS: usize = 6;

/// One of the two axes. Values are divided by a power of ten, as the library needs numbers near 1 for its ticks.
#[derive(Debug, Clone)]
pub struct Axis {
    exponent: i32,
    pub range: Range<f64>,
    decimals: usize,
}

impl Axis {
    /// The axis for these values and 0, where every path starts; in this way proportions of loads are visible.
    pub fn showing(values: impl Iterator<Item = f64>, ticks: usize) -> Self {
        Self::between(values.fold((0.0, 0.0), |(low, high), value| (low.min(value), high.max(value))), ticks)
    }

    /// The axis for these values alone, for what is compared from value to value.
    pub fn spanning(values: impl Iterator<Item = f64>, ticks: usize) -> Self {
        let wide = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
        let found = values.fold((f64::INFINITY, f64::NEG_INFINITY), wide);
        Self::between(if found.0 <= found.1 { found } else { (0.0, 0.0) }, ticks)
    }

    fn between((low, high): (f64, f64), ticks: usize) -> Self {
        let largest = high.max(-low);
        // An axis with a single value still has a length, and does not show round-off.
        let (low, high) = match (high - low > SAME * largest, largest > 0.0) {
            (true, _) => (low, high),
            (false, true) => (low - 0.5 * low.abs(), high + 0.5 * high.abs()),
            (false, false) => (-1.0, 1.0),
        };
        let largest = high.max(-low);
        let power = if largest > 0.0 { largest.log10().floor() as i32 } else { 0 };
        let exponent = if WRITTEN_OUT.contains(&power) { 0 } else { power };
        let margin = MARGIN * (high - low);
        let mut axis = Self { exponent, range: 0.0..0.0, decimals: 0 };
        axis.range = axis.drawn(low - margin)..axis.drawn(high + margin);
        axis.decimals = RangedCoordf64::from(axis.range.clone())
            .key_points(ticks)
            .iter()
            .filter(|tick| tick.abs() > ROUNDING * (axis.range.end - axis.range.start))
            .map(|tick| plain(*tick, DIGITS).split_once('.').map_or(0, |(_, decimals)| decimals.len()))
            .max()
            .unwrap_or_default();
        axis
    }

    /// The position of a value on the axis.
    pub fn drawn(&self, value: f64) -> f64 {
        value / 10_f64.powi(self.exponent)
    }

    /// The text of a tick.
    pub fn tick(&self, drawn: f64) -> String {
        let text = format!("{drawn:.*}", self.decimals);
        // A value that rounds to zero has no sign.
        if text.trim_start_matches(['-', '0', '.']).is_empty() { text.trim_start_matches('-').to_owned() } else { text }
    }

    /// The name of the axis with its power of ten.
    pub fn named(&self, name: &str) -> String {
        if self.exponent == 0 { name.to_owned() } else { format!("{name} / 1e{}", self.exponent) }
    }

    /// A value as text, for the legend.
    pub fn number(&self, value: f64) -> String {
        let largest = self.range.start.abs().max(self.range.end.abs());
        if self.drawn(value).abs() <= ROUNDING * largest {
            return "0".to_owned();
        }
        let power = value.abs().log10().floor() as i32;
        if WRITTEN_OUT.contains(&power) {
            return plain(value, DIGITS);
        }
        // Rounded first, so that the shortest text is short.
        let text = format!("{value:.*e}", DIGITS - 1);
        text.parse::<f64>().map_or(text, |rounded| format!("{rounded:e}"))
    }
}

/// A number with the given number of significant digits, without trailing zeros.
fn plain(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let before_point = value.abs().log10().floor() as i32 + 1;
    let decimals = usize::try_from(digits as i32 - before_point).unwrap_or_default();
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::Axis;

    #[test]
    fn numbers_are_short() {
        let axis = Axis::showing([0.3, -0.1].into_iter(), 10);
        assert_eq!(axis.number(0.273_315_28), "0.273315");
        assert_eq!(axis.number(8e-19), "0");
        assert_eq!(axis.number(-0.1), "-0.1");
        // As the library rounds them: 0.05, and 0 is 1e-17.
        assert_eq!(axis.tick(0.05), "0.05");
        assert_eq!(axis.tick(-1e-17), "0.00");
        assert_eq!(axis.named("load factor"), "load factor");
    }

    #[test]
    fn values_that_are_compared_fill_their_axis() {
        let axis = Axis::spanning([0.22, 0.26].into_iter(), 10);
        assert!(axis.range.start > 0.2 && axis.range.end < 0.28, "{:?}", axis.range);
        for value in [3.0, -3.0, 0.0, 3.0 + 1e-12] {
            let axis = Axis::spanning([value, 3.0_f64.copysign(value) * value.abs().signum()].into_iter(), 10);
            assert!(axis.range.end - axis.range.start > 1.0, "{value}: {:?}", axis.range);
        }
        assert!(Axis::spanning(std::iter::empty(), 10).range.start < 0.0);
    }

    #[test]
    fn large_and_small_values_carry_their_power() {
        let axis = Axis::showing([2.5e9].into_iter(), 10);
        assert_eq!(axis.named("load factor"), "load factor / 1e9");
        assert_eq!(axis.number(2.5e9), "2.5e9");
        assert!(axis.range.end < 10.0);
        let axis = Axis::showing([3e-20].into_iter(), 10);
        assert!(axis.range.end > 1.0);
        let still = Axis::showing([0.0].into_iter(), 10);
        assert!(still.range.start < 0.0 && still.range.end > 0.0);
    }
}
