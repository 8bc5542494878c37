// All quantities that a job records, in groups, to choose from.

import { contactWords, displacement, elementWords, escaped, mayJump, OF_JUMPS, OF_STABILITY, PLAIN, quantityWords, recordedParts, rotatingNodes, rotations, STRESSES } from "./quantities.js";
import { SOLIDS } from "./structure-solids.js";

const LETTERS = "xyz";
const ENERGIES = Object.keys(PLAIN).filter((name) => name.startsWith("/energy/"));
const ACCURACY = [
  "/diagnostics/residual", "/diagnostics/complementarity", "/diagnostics/energy_error", "/diagnostics/error_estimate",
  "/measure/equilibrium", "/measure/global_equilibrium", "/measure/support", "/measure/contact", "/measure/cone",
  "/measure/friction", "/measure/slip_direction", "/measure/reported", "/measure/arc_length", "/measure/energy",
  "/measure/strain_energy", "/diagnostics/elapsed_s", "/diagnostics/factorisations", "/diagnostics/newton_iterations",
  "/diagnostics/qp_solves", "/diagnostics/mpec_solves", "/diagnostics/sqp_iterations", "/diagnostics/certificates",
  "/diagnostics/mpec_fallbacks", "/diagnostics/bifurcation_factorisations",
];

/**
 * `[{title, parts, keys, names}]`: `keys` are nodes, elements or contacts and `names` what these are called; `parts` is
 * `[[steps below, words]]`. A group without keys has the names of its columns as parts.
 */
export function quantityGroups(request) {
  const { model } = request;
  const recorded = recordedParts(request);
  const rotating = rotatingNodes(model);
  const components = [...LETTERS.slice(0, model.dimension)];
  const axes = (before, words) => components.map((letter, place) => [`${before}${place}`, `${words}${letter}`]);
  const turns = (word) => rotations(model).map(([place, name]) => [String(place), model.dimension === 2 ? word : `${word} ${name}`]);
  const plain = (names) => names.map((name) => [name, quantityWords(name)]);
  return [
    { title: "Path", parts: plain(["load_factor", "arc_length", "step", "index"]) },
    { title: "Energies", parts: plain([...ENERGIES, ...(mayJump(request) ? Object.keys(OF_JUMPS) : [])]) },
    ...(request.analysis?.record?.stability ? [{ title: "Stability", parts: plain(Object.keys(OF_STABILITY)) }] : []),
    { title: "Displacements", of: "displacements", parts: axes("", ""), ...namedBy(recorded.displacements) },
    { title: "Rotations", of: "displacements", parts: turns("rotation"), ...namedBy(recorded.displacements.filter((name) => rotating.has(name))) },
    { title: "Moments of supports", of: "supports", parts: turns("moment"), ...namedBy(recorded.supports.filter((name) => rotating.has(name))) },
    { title: "Reactions of supports", of: "supports", parts: axes("", "reaction "), ...namedBy(recorded.supports) },
    ...elementGroups(recorded.elements ?? [], model, axes),
    ...contactGroups(recorded.contacts ?? [], model, axes),
    { title: "Applied forces, sum", parts: plain(components.map((_, place) => `/applied_forces/${place}`)) },
    { title: "Accuracy and work", parts: plain(ACCURACY) },
  ].filter(({ keys }) => keys === undefined || keys.length > 0);
}

const namedBy = (names) => ({ keys: names, names });

function elementGroups(places, model, axes) {
  const of = (kind) => places.map((place, row) => [place, row]).filter(([place]) => model.elements?.[place]?.kind === kind);
  const group = (title, kind, parts) => {
    const found = of(kind);
    return {
      title, of: "elements", parts, keys: found.map(([, row]) => String(row)),
      names: found.map(([place]) => elementWords(model, place)),
    };
  };
  return [
    group("Forces of bars", "bar", [["axial_force", "axial force"]]),
    group("Forces of springs", "spring", axes("force/", "force ")),
    group("Forces of beams", "beam", [["first", 0], ["last", 1]].flatMap(([end, place]) => [
      [`ends/${place}/axial_force`, `axial force at the ${end} node`],
      ...(model.dimension === 2 ? [
        [`ends/${place}/shear_force`, `shear force at the ${end} node`],
        [`ends/${place}/bending_moment`, `bending moment at the ${end} node`],
      ] : [
        ...[0, 1].map((axis) => [`ends/${place}/shear_forces/${axis}`, `shear force ${axis + 1} at the ${end} node`]),
        [`ends/${place}/torsional_moment`, `torsional moment at the ${end} node`],
        ...[0, 1].map((axis) => [`ends/${place}/bending_moments/${axis}`, `bending moment ${axis + 1} at the ${end} node`]),
      ]),
    ])),
    group("Moments of rotational springs", "rotational_spring", [["moment", "moment"]]),
    ...Object.keys(SOLIDS).map((kind) => group(`Stresses of ${kind}`, kind, [
      ["von_mises", "von Mises stress"],
      ...STRESSES.slice(0, model.dimension === 2 ? 4 : 6).map((name, place) => [`stress/${place}`, `stress ${name}`]),
    ])),
  ];
}

function contactGroups(places, model, axes) {
  const tangents = (member, words) => Array.from({ length: model.dimension - 1 },
    (_, place) => [`${member}/${place}`, model.dimension === 2 ? words : `${words} (tangent ${place + 1})`]);
  const parts = [
    ["gap", "gap"], ["normal_reaction", "normal reaction"], ...tangents("tangential_reaction", "tangential reaction"),
    ...axes("reaction/", "reaction "), ...tangents("slip", "slip of the increment"), ...tangents("slip_total", "slip in total"),
  ];
  return [{
    title: "Contacts", of: "contacts", parts, keys: places.map((_, row) => String(row)),
    names: places.map((place) => contactWords(model, place)),
  }];
}

/** The column of a part of a key of a group. */
export const columnOf = ({ of }, key, part) => (of === "displacements" ? displacement(key, part) : `/${of}/${escaped(key)}/${part}`);

/** What of the model is not recorded, or cannot be drawn over the path, in sentences. */
export function notRecordedWords(request) {
  const { model, analysis } = request;
  const recorded = recordedParts(request);
  const part = (few, all, words) => (few < all ? `${few} of ${all} ${words}` : null);
  const parts = [
    part(recorded.displacements.length, Object.keys(model.nodes).length, "nodes"),
    part(recorded.supports.length, Object.keys(model.supports ?? {}).length, "supports"),
    part(recorded.elements?.length ?? 0, model.elements?.length ?? 0, "elements"),
    recorded.contacts ? part(recorded.contacts.length, model.contacts?.length ?? 0, "contacts") : null,
  ].filter(Boolean);
  const every = analysis?.record?.every ?? 1;
  return [
    parts.length ? `Recorded, and so to be chosen: ${parts.join(", ")}.` : null,
    recorded.contacts === null ? "Contacts are recorded where they are in reach of the path; they cannot be drawn over it." : null,
    every > 1 ? `Of the regular increments one in ${every} is recorded.` : null,
  ].filter(Boolean).join(" ");
}
