// The abscissa and ordinate of the plot of paths: names, labels, and the controls that choose them.

import { choice, element, fill } from "./dom.js";

/** The ordinates: [name, label]. */
export const ORDINATES = [
  ["load_factor", "load factor"], ["/energy/dissipated", "dissipated energy"], ["/energy/strain", "strain energy"],
  ["/energy/external_work", "external work"],
];
const ARC_LENGTH = "arc_length";
const LETTERS = "xyz";
/** With at most this many nodes all components are listed as choices; with more, a node is typed. */
const LISTED = 100;
/** The number of nodes that are proposed for a typed text. */
const PROPOSED = 40;

const escaped = (name) => name.replaceAll("~", "~0").replaceAll("/", "~1").replaceAll(",", "~2");
export const unescaped = (step) => step.replaceAll("~2", ",").replaceAll("~1", "/").replaceAll("~0", "~");

/** The column of a displacement of a node. */
export const displacement = (node, component) => `/displacements/${escaped(node)}/${component}`;

/** The node and the component of a column; null for other columns. */
export function ofDisplacement(name) {
  const found = /^\/displacements\/([^/]+)\/([012])$/.exec(name);
  return found ? { node: unescaped(found[1]), component: Number(found[2]) } : null;
}

export const isOrdinate = (name) => ORDINATES.some(([known]) => known === name);

/** Whether the path of a request has a column that can be the abscissa. */
export function isAbscissa(name, request) {
  const of = ofDisplacement(name ?? "");
  if (!of) return name === ARC_LENGTH;
  const { model, analysis } = request;
  const nodes = analysis?.record?.nodes;
  const isRecorded = Array.isArray(nodes) ? nodes.includes(of.node) : Object.hasOwn(model.nodes, of.node);
  return isRecorded && of.component < model.dimension;
}

/** What of the labels of units in the model stands behind a quantity, in brackets. */
const unitOf = (request, ...powers) => {
  const labels = powers.map((of) => request?.model?.units?.[of]);
  return labels.length > 0 && labels.every(Boolean) ? ` [${labels.join(" ")}]` : "";
};

export const ordinateWords = (name, request = null) => (ORDINATES.find(([known]) => known === name)?.[1] ?? name)
  + (name.startsWith("/energy/") ? unitOf(request, "force", "length") : "");

export function abscissaWords(name, request = null) {
  const of = ofDisplacement(name);
  if (of && request) return abscissaWords(name) + unitOf(request, "length");
  return of ? `displacement ${LETTERS[of.component]} of ${of.node}` : name === ARC_LENGTH ? "arc length" : name;
}

/** The axes for these paths: the chosen ones, if any path has them, or else those of the first path, in which case `refused` is
 *  set. */
export function axesOf(paths, { abscissa, ordinate }) {
  const refused = [];
  const taken = (chosen, isKnown, usual, words) => {
    if (chosen === null || isKnown) return chosen ?? usual;
    refused.push(`There is no “${chosen}” here; ${words(usual)} is drawn in its place.`);
    return usual;
  };
  return {
    abscissa: taken(abscissa, paths.some((path) => path.knows(abscissa)), paths[0].ownAbscissa(), abscissaWords),
    ordinate: taken(ordinate, isOrdinate(ordinate), ORDINATES[0][0], ordinateWords),
    refused: refused.join(" "),
  };
}

function recorded({ model, analysis }) {
  const nodes = analysis?.record?.nodes;
  return Array.isArray(nodes) ? nodes : Object.keys(model.nodes);
}

/** The controls; `chosen({abscissa} or {ordinate})` is told of a change. */
export function axesControls(place, request, { abscissa, ordinate }, chosen) {
  const nodes = recorded(request);
  fill(place,
    element("label", {}, "Plot ", choice({
      id: "ordinate", "data-key": "ordinate", onchange: (event) => chosen({ ordinate: event.target.value }),
    }, ORDINATES, ordinate)),
    nodes.length > LISTED ? ofManyNodes(nodes, request, abscissa, chosen) : ofFewNodes(nodes, request, abscissa, chosen));
}

function ofFewNodes(nodes, { model }, abscissa, chosen) {
  const components = [...LETTERS.slice(0, model.dimension)];
  const options = nodes.flatMap((node) => components.map((letter, place) => [displacement(node, place), `${letter} of ${node}`]));
  return element("label", {}, "against ", choice({
    id: "abscissa", "data-key": "abscissa", onchange: (event) => chosen({ abscissa: event.target.value }),
  }, [[ARC_LENGTH, "arc length"], ...options], abscissa));
}

/** A list of thousands of choices would be slow and of no use: the node is typed, with proposals. */
function ofManyNodes(nodes, { model }, abscissa, chosen) {
  const known = new Set(nodes);
  const of = ofDisplacement(abscissa);
  const proposals = element("datalist", { id: "nodes" });
  const propose = () => {
    const found = [];
    for (const node of nodes) {
      if (node.includes(input.value)) found.push(node);
      if (found.length === PROPOSED) break;
    }
    fill(proposals, found.map((value) => element("option", { value })));
  };
  const input = element("input", {
    type: "text", id: "abscissa-node", "data-key": "abscissa-node", list: "nodes", size: 10, value: of?.node ?? nodes[0],
    autocomplete: "off", "aria-label": `node, one of ${nodes.length}`, oninput: () => { input.setCustomValidity(""); propose(); },
    onchange: () => choose(),
  });
  const component = choice({ id: "abscissa", "data-key": "abscissa", onchange: () => choose() }, [
    [ARC_LENGTH, "arc length"],
    ...[...LETTERS.slice(0, model.dimension)].map((letter, place) => [String(place), `${letter} of node`]),
  ], of ? String(of.component) : ARC_LENGTH);
  const choose = () => {
    const isOfNode = component.value !== ARC_LENGTH;
    input.disabled = !isOfNode;
    if (isOfNode && !known.has(input.value)) {
      input.setCustomValidity(`No node of that name is recorded; there are ${nodes.length}, such as ${nodes[0]}.`);
      input.reportValidity();
      return;
    }
    chosen({ abscissa: isOfNode ? displacement(input.value, component.value) : ARC_LENGTH });
  };
  input.disabled = of === null;
  propose();
  return [element("label", {}, "against ", component), input, proposals];
}
