// The common style of all plots: colours, fonts, margins and the configuration of Plotly.

import { verbatim } from "./words.js";

const dark = matchMedia("(prefers-color-scheme: dark)");
/** Orange is that of bifurcation points, and so the last. */
const COLOURS = ["#3486cc", "#2e9a5b", "#a44fb0", "#c23b4e", "#7f7a1f", "#1f9aa3", "#7a6a5d", "#d2691e"];

/** Dashes: the name in Plotly, and the lengths of lines and gaps for a background in CSS. */
const DASHES = [["solid", []], ["dash", [6, 3]], ["dot", [2, 2]], ["dashdot", [6, 2, 2, 2]]];

export const colourOf = (place) => COLOURS[place % COLOURS.length];
/** The dash of a line, which changes when the colours repeat. */
export const dashAt = (place) => DASHES[place % DASHES.length][0];
export const dashOf = (place) => dashAt(Math.floor(place / COLOURS.length));

/** The style of a swatch with that colour and dash. */
export function dashedSwatch(colour, dash) {
  const [, lengths] = DASHES.find(([name]) => name === dash);
  let at = 0;
  const stops = lengths.map((length, place) => {
    const stop = `${place % 2 ? "transparent" : colour} ${at}px ${at + length}px`;
    at += length;
    return stop;
  });
  return `background:${stops.length ? `repeating-linear-gradient(to right, ${stops.join(", ")})` : colour}`;
}

/** The colours and dashes of the stages of a single path are those of the picture of `arcslip solve --plot`, in turn. */
const STAGES = 4;
export const stageColour = (stage) => fromSheet(`--stage-${stage % STAGES}`);
export const stageDash = (stage) => (stage % 2 ? "dash" : "solid");

/** The band under a path that is known in closed form. */
export const EXACT = { width: 7, opacity: 0.2 };

export const isDark = () => dark.matches;
export const onThemeChange = (listener) => dark.addEventListener("change", listener);

/** A colour of the style sheet. */
export const fromSheet = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export const CONFIGURATION = {
  displaylogo: false, responsive: true, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"],
  toImageButtonOptions: { format: "svg" },
};

/** A title may have several lines. */
export function axis(title) {
  return {
    title: { text: verbatim(title).replaceAll("\n", "<br>"), standoff: 8 }, gridcolor: fromSheet("--grid"), zerolinecolor: fromSheet("--zero"),
    linecolor: fromSheet("--zero"), automargin: true, exponentformat: "power",
  };
}

/** The part of the size of values up to which they differ by round-off alone. */
const ROUND_OFF = 1e-9;

/** The range of an axis whose values are all the same up to round-off, which would fill it otherwise. */
export function constantRange(values) {
  const numbers = values.filter(Number.isFinite);
  const [low, high] = [Math.min(...numbers), Math.max(...numbers)];
  const size = Math.max(Math.abs(low), Math.abs(high));
  return numbers.length && high - low <= ROUND_OFF * size && size > 0 ? { range: [low - 0.5 * size, high + 0.5 * size] } : {};
}

export function layout(more) {
  return {
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
    font: { family: "system-ui, sans-serif", size: 13, color: fromSheet("--text") },
    margin: { l: 56, r: 12, t: 30, b: 44 }, hovermode: "closest", showlegend: false, dragmode: "pan",
    modebar: { bgcolor: "rgba(0,0,0,0)", color: fromSheet("--faint"), activecolor: fromSheet("--accent") },
    hoverlabel: { bgcolor: fromSheet("--panel"), bordercolor: fromSheet("--zero"), font: { color: fromSheet("--text") } },
    ...more,
  };
}
