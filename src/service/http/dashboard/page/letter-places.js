// Places the letters of points in a plot: each beside its point, away from other letters, points and edges.

/** Half the size of a letter and of a mark, and how far a letter's middle is from its point, in pixels. */
const LETTER = 8;
const MARK = 6;
const APART = 14;
/** The size of a plot that has not been drawn yet, in pixels. */
const USUAL = { width: 600, height: 400 };
/** With more letters than these all stand above their points: they are too close to be kept apart. */
const MOST = 200;
/** What lies under a letter costs so much: another letter, a mark, a place past the edge. */
const ON_LETTER = 8;
const ON_MARK = 3;
const OUTSIDE = 4;

/** The places around a point, the preferred one first: the name that the plot has for it, and where the letter's middle is. */
const AROUND = [
  ["top center", 0, -1], ["top right", 0.9, -1], ["top left", -0.9, -1], ["middle right", 1.1, 0], ["middle left", -1.1, 0],
  ["bottom center", 0, 1], ["bottom right", 0.9, 1], ["bottom left", -0.9, 1],
];

/**
 * Sets `textposition` of each trace of `lettered`; `lines` are all curves, `place` where they are drawn. Traces of one axis on the
 * left and one on the right have ranges of their own.
 */
export function placeLetters(lines, lettered, place) {
  if (lettered.reduce((sum, { text }) => sum + text.length, 0) > MOST) return;
  const { width, height } = place?.clientWidth > 0 ? { width: place.clientWidth, height: place.clientHeight } : USUAL;
  const across = scale(lines.map(({ x }) => x), width, false);
  const up = Object.fromEntries(["y", "y2"].map((axis) =>
    [axis, scale(lines.filter(({ yaxis }) => yaxis === axis).map(({ y }) => y), height, true)]));
  const pixels = (trace, number) => [across(trace.x[number]), up[trace.yaxis](trace.y[number])];
  const marks = lettered.flatMap((trace) => trace.x.map((_, number) => pixels(trace, number)));
  const letters = [];
  for (const trace of lettered) {
    trace.textposition = trace.text.map((letter, number) => {
      if (!letter) return AROUND[0][0];
      const [x, y] = pixels(trace, number);
      const cost = ([, right, down]) => {
        const at = [x + right * APART, y + down * APART];
        const near = (others, reach) => others.filter((other) => Math.abs(other[0] - at[0]) < reach && Math.abs(other[1] - at[1]) < reach).length;
        const isOutside = at[0] < LETTER || at[0] > width - LETTER || at[1] < LETTER || at[1] > height - LETTER;
        return ON_LETTER * near(letters, 2 * LETTER) + ON_MARK * near(marks, LETTER + MARK) + (isOutside ? OUTSIDE : 0);
      };
      const costs = AROUND.map(cost);
      const [name, right, down] = AROUND[costs.indexOf(Math.min(...costs))];
      letters.push([x + right * APART, y + down * APART]);
      return name;
    });
  }
}

/** From values to pixels, as the plot does when all of it is seen. */
function scale(series, size, isUpwards) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of series) {
    for (const value of values) {
      if (typeof value !== "number") continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  const span = high - low > 0 ? high - low : 1;
  const part = (value) => (value - low) / span;
  return (value) => size * (isUpwards ? 1 - part(value) : part(value));
}
