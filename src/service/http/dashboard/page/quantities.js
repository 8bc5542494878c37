// The quantities that are recorded at each increment: the names of their columns, their words and units, and whether a job
// records them.

const COMPONENTS = "xyz";
/** Of these many parts the service records all unless told otherwise. */
const USUAL = { contacts: 100, elements: 200, supports: 200 };

/** Quantities that every job records: name to words. */
export const PLAIN = {
  load_factor: "load factor", arc_length: "arc length", step: "step", index: "increment",
  "/energy/dissipated": "dissipated energy", "/energy/strain": "strain energy", "/energy/external_work": "external work",
};
/** Of jobs whose structure may jump. */
export const OF_JUMPS = { "/energy/released": "energy given off by jumps" };

/** Of jobs that record the stability of their increments. */
export const OF_STABILITY = { "/stability/negative_eigenvalues": "negative eigenvalues" };

/** Whether a structure jumps where its path cannot go on. */
export const mayJump = ({ model, analysis }) =>
  analysis?.on_path_end === "jump" || (model.stages ?? []).some(({ control }) => control === "load");

/** Words of the members of contacts and elements, with the power of units that each has. */
const MEMBERS = {
  gap: ["gap", "length"], normal_reaction: ["normal reaction", "force"], tangential_reaction: ["tangential reaction", "force"],
  reaction: ["reaction", "force"], slip: ["slip of the increment", "length"], slip_total: ["slip in total", "length"],
  axial_force: ["axial force", "force"], force: ["force", "force"], moment: ["moment", ["force", "length"]],
  stress: ["stress", []], von_mises: ["von Mises stress", []],
};

/** The same of a beam's ends. */
const AT_ENDS = {
  axial_force: MEMBERS.axial_force, shear_force: ["shear force", "force"], bending_moment: ["bending moment", ["force", "length"]],
  shear_forces: ["shear force", "force"], torsional_moment: ["torsional moment", ["force", "length"]],
  bending_moments: ["bending moment", ["force", "length"]],
};
const ABOUT_AXES = ["shear_forces", "bending_moments"];
const ENDS = ["first", "last"];
export const STRESSES = ["xx", "yy", "zz", "xy", "yz", "xz"];

/** The nodes that have rotations, last among their displacements: those of beams and rotational springs. */
export function rotatingNodes(model) {
  const turned = (model.elements ?? []).filter(({ kind }) => kind === "beam" || kind === "rotational_spring");
  return new Set(turned.flatMap(({ nodes }) => nodes));
}

/** The rotations that a node may have: the place among its displacements, and the name. */
export const rotations = (model) => (model.dimension === 2 ? [[2, "rz"]] : [[3, "rx"], [4, "ry"], [5, "rz"]]);

export const escaped = (name) => name.replaceAll("~", "~0").replaceAll("/", "~1").replaceAll(",", "~2");
export const unescaped = (step) => step.replaceAll("~2", ",").replaceAll("~1", "/").replaceAll("~0", "~");

/** The names in the state's `ordinate`, which has commas between them. */
export const ordinatesIn = (text) => [...new Set((text ?? "").split(",").filter(Boolean))];

/** The column of a displacement of a node. */
export const displacement = (node, component) => `/displacements/${escaped(node)}/${component}`;

/** The parts of a column's name: what it is of, the key there, and the steps below. */
function partsOf(name) {
  const [, of, key, ...steps] = (name ?? "").split("/");
  return { of, key: key === undefined ? undefined : unescaped(key), steps };
}

/** The node and the component of a column; null for other columns. */
export function ofDisplacement(name) {
  const { of, key, steps } = partsOf(name);
  return of === "displacements" && steps.length === 1 && /^[0-5]$/.test(steps[0])
    ? { node: key, component: Number(steps[0]) } : null;
}

/** The name of what a contact of a model touches: an obstacle, or the surface of another body. */
export const counterpart = ({ obstacle, against }) => against ?? obstacle;

/** What a job records of each kind: nodes and supports by name, elements and contacts as their places in the model, in the
 *  order in which they stand in an increment; null where that order is not the same in each. */
export function recordedParts({ model, analysis }) {
  const record = analysis?.record ?? {};
  const chosen = (kind, all, placeOf) => {
    const asked = record[kind] ?? (all.length > USUAL[kind] ? (kind === "contacts" ? "in_reach" : "none") : "all");
    if (asked === "in_reach") return null;
    if (Array.isArray(asked)) return asked.map(placeOf).filter((found) => found !== -1).sort((a, b) => a - b);
    return asked === "none" ? [] : all.map((_, place) => place);
  };
  const supported = Object.keys(model.supports ?? {});
  const elements = model.elements ?? [];
  const contacts = model.contacts ?? [];
  return {
    displacements: Array.isArray(record.nodes) ? record.nodes : Object.keys(model.nodes),
    supports: chosen("supports", supported, (name) => supported.indexOf(name))?.map((place) => supported[place]) ?? [],
    elements: chosen("elements", elements, (one) =>
      (typeof one === "number" ? one : elements.findIndex(({ name }) => name === one))),
    contacts: chosen("contacts", contacts, (one) =>
      contacts.findIndex((item) => item.node === one.node && counterpart(item) === one.obstacle)),
  };
}

/** Whether the increments of a job with that request have such a member. */
export function isRecorded(name, request) {
  if (name in PLAIN) return true;
  if (name in OF_JUMPS) return mayJump(request);
  if (name in OF_STABILITY) return Boolean(request.analysis?.record?.stability);
  const { of, key, steps } = partsOf(name);
  const { model } = request;
  const isComponent = (step, many = model.dimension) => /^[012]$/.test(step ?? "") && Number(step) < many;
  if (of === "applied_forces") return isComponent(key) && steps.length === 0;
  if (of === "diagnostics" || of === "measure") return /^[a-z_]+$/.test(key ?? "") && steps.length === 0;
  const parts = recordedParts(request)[of] ?? [];
  if (of === "displacements" || of === "supports") {
    const many = model.dimension + (rotatingNodes(model).has(key) ? rotations(model).length : 0);
    return parts.includes(key) && steps.length === 1 && isComponent(steps[0], many);
  }
  if (!(of === "elements" || of === "contacts") || !(Number(key) < parts.length)) return false;
  if (steps[0] === "ends") {
    const both = ABOUT_AXES.includes(steps[2]);
    return steps.length === (both ? 4 : 3) && steps[1] in ENDS && steps[2] in AT_ENDS && (!both || /^[01]$/.test(steps[3]));
  }
  return steps[0] in MEMBERS && (steps.length === 1 || (steps.length === 2 && isComponent(steps[1])));
}

export function elementWords(model, place) {
  const one = model.elements?.[place];
  if (!one) return `element ${place}`;
  return one.name ?? `${one.kind} ${place} (${(one.nodes ?? []).join("–")})`;
}

export function contactWords(model, place) {
  const one = model.contacts?.[place];
  return one ? `${one.node} on ${one.obstacle}` : `contact ${place}`;
}

/** A quantity in words; with a request, its unit in brackets where the model has labels of units. */
export function quantityWords(name, request = null) {
  const units = request?.model?.units;
  const labels = powersOf(name, request).map((power) => units?.[power]);
  return wordsOf(name, request) + (labels.length && labels.every(Boolean) ? ` [${labels.join(" ")}]` : "");
}

function wordsOf(name, request) {
  if (name in PLAIN) return PLAIN[name];
  if (name in OF_JUMPS) return OF_JUMPS[name];
  if (name in OF_STABILITY) return OF_STABILITY[name];
  const { of, key, steps } = partsOf(name);
  const component = COMPONENTS[steps.at(-1)] ?? "";
  const turn = request ? rotations(request.model).find(([place]) => String(place) === steps.at(-1))?.[1] : undefined;
  const about = turn && request.model.dimension === 3 ? ` ${turn}` : "";
  if (of === "displacements" && turn) return `rotation${about} of ${key}`;
  if (of === "supports" && turn) return `moment${about} of the support of ${key}`;
  if (of === "displacements") return `displacement ${component} of ${key}`;
  if (of === "supports") return `reaction ${component} of the support of ${key}`;
  if (of === "applied_forces") return `applied force ${COMPONENTS[key]}, sum`;
  if (of === "diagnostics" || of === "measure") return `${of}: ${key.replaceAll("_", " ")}`;
  if (of !== "elements" && of !== "contacts") return name;
  const place = request ? recordedParts(request)[of]?.[Number(key)] ?? Number(key) : Number(key);
  const model = request?.model ?? {};
  const whose = of === "elements" ? elementWords(model, place) : contactWords(model, place);
  if (steps[0] === "ends") return `${AT_ENDS[steps[2]]?.[0] ?? steps[2]}${steps[3] === undefined ? "" : ` ${Number(steps[3]) + 1}`} at the ${ENDS[steps[1]]} node of ${whose}`;
  return `${MEMBERS[steps[0]]?.[0] ?? steps[0]}${along(steps)} of ${whose}`;
}

/** Tangents have numbers, axes have letters. */
function along([member, component]) {
  if (component === undefined) return "";
  if (member === "stress") return ` ${STRESSES[component]}`;
  const isTangential = member !== "reaction" && member !== "force";
  return isTangential ? ` (tangent ${Number(component) + 1})` : ` ${COMPONENTS[component]}`;
}

/** The powers of units that a quantity has. */
function powersOf(name, request) {
  const { of, steps } = partsOf(name);
  const isRotation = request && rotations(request.model).some(([place]) => String(place) === steps.at(-1));
  if (of === "displacements" && isRotation) return [];
  if (of === "supports" && isRotation) return ["force", "length"];
  if (of === "energy") return ["force", "length"];
  if (of === "displacements") return ["length"];
  if (of === "supports" || of === "applied_forces") return ["force"];
  return of === "elements" || of === "contacts" ? [(AT_ENDS[steps[2]] ?? MEMBERS[steps[0]])?.[1]].flat().filter(Boolean) : [];
}

/** What two quantities have to share to be drawn along one axis. */
export const scaleOf = (name) => powersOf(name).join(" ") || (partsOf(name).of ?? name);
