// The plot of paths as a file: PNG and SVG with a legend inside, and the drawn points as CSV. Loaded when a file is asked for.

import { curveNames, keyRows, namedWords } from "./path-legend.js";
import { EXACT, fromSheet } from "./plot-style.js";
import { named } from "./points.js";
import { nameOf, verbatim } from "./words.js";

const SIZE = { width: 1000, height: 640 };
/** Pixels of a PNG for each of the drawing. */
const SCALE = 2;
/** The most points that the legend of a picture lists. */
const LISTED = 20;

/** A picture of `{place, curves, runs}` as `[blob, name]`; `format`: png or svg. */
export async function pictureFile(plot, format) {
  const address = await Plotly.toImage(figure(plot), { format, ...SIZE, scale: format === "png" ? SCALE : 1 });
  return [blobOf(address), `${fileName(plot)}.${format}`];
}

/** The drawn points as `[blob, name]`. */
export function pointsFile(plot) {
  return [new Blob([pointsTable(plot)], { type: "text/csv" }), `${fileName(plot)}.csv`];
}

const fileName = ({ curves }) => `path-${curves[0].path.id}`;

/** The content of an address with `data:`, which the page may not fetch. */
function blobOf(address) {
  const comma = address.indexOf(",");
  const [type, encoding] = address.slice("data:".length, comma).split(";");
  const text = address.slice(comma + 1);
  const content = encoding === "base64" ? Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)) : decodeURIComponent(text);
  return new Blob([content], { type });
}

/** The plot on an opaque ground, with a title and a legend of its own. */
function figure({ place, curves, runs }) {
  const ground = fromSheet("--panel");
  const title = [...new Set(curves.map(({ path }) => nameOf(path.job)))].join(", ");
  const drawn = place.data.filter(({ name }) => name !== "chosen increment");
  return {
    data: [...drawn, ...legendTraces(curves, runs, drawn.some(({ name }) => name === "exact"))],
    layout: {
      ...place.layout, ...SIZE, autosize: false, paper_bgcolor: ground, plot_bgcolor: ground, showlegend: true,
      title: { text: verbatim(title), x: 0.02 }, margin: { l: 70, r: 20, t: runs?.isScale ? 110 : 60, b: 60 },
      legend: { x: 1.02, xanchor: "left", y: 1, font: { size: 12 }, ...(place.layout.yaxis2 ? { x: 1.12 } : {}) },
    },
  };
}

/** Traces without points, for the legend alone. */
function legendTraces(curves, runs, hasExact) {
  const row = (name, more) => ({ x: [null], y: [null], type: "scatter", name: verbatim(name), showlegend: true, ...more });
  const names = curves.length > 1 ? curveNames(curves, runs) : [];
  const band = { mode: "lines", opacity: EXACT.opacity, line: { color: fromSheet("--text"), width: EXACT.width } };
  const exact = hasExact ? [row("exact", band)] : [];
  const lines = names.map((name, which) => {
    const { colour, dash } = curves[which];
    return row(name, { mode: "lines", line: { color: colour, dash, width: 2 } });
  });
  const key = keyRows(curves).map(({ words, colour, filling, dash, symbol }) => row(words.split(":")[0], symbol
    ? { mode: "markers", marker: { color: filling, symbol, size: 9, line: { color: colour, width: 1.5 } } }
    : { mode: "lines", line: { color: colour, dash, width: 2 } }));
  const { path } = curves[0];
  const events = curves.length > 1 ? [] : named(path).filter(({ name }) => name).slice(0, LISTED)
    .map((point) => row(`${point.name}: ${namedWords(path, point)}`, { mode: "markers", marker: { color: "rgba(0, 0, 0, 0)" } }));
  return [...lines, ...exact, ...key, ...events];
}

/** A row for each point of each path: the job, its increment and stage, and the drawn quantities. */
function pointsTable({ curves }) {
  const paths = [...new Set(curves.map(({ path }) => path))];
  const columns = [...new Set([curves[0].abscissa, ...curves.map(({ ordinate }) => ordinate)])];
  const rows = [["job", "increment", "stage", ...columns]];
  for (const path of paths) {
    const stages = path.columns.get("stage");
    path.index.forEach((index, place) => {
      rows.push([path.id, index, stages[place], ...columns.map((name) => path.columns.get(name)?.[place] ?? "")]);
    });
  }
  return `${rows.map((row) => row.map(cell).join(",")).join("\n")}\n`;
}

/** A text with commas, quotes or line ends stands in quotes; one that a spreadsheet takes for a formula begins with an apostrophe. */
function cell(value) {
  if (typeof value === "number") return String(value);
  const text = /^[=+@\t\r-]/.test(value) ? `'${value}` : value;
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
