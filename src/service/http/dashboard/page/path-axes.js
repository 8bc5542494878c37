// What the plot of paths draws against what: one abscissa, one or several ordinates, and the controls that choose them.

import { button, element, fill } from "./dom.js";
import { quantityChoice } from "./quantity-choice.js";
import { quantityGroups } from "./quantity-groups.js";
import { ordinatesIn, quantityWords, scaleOf } from "./quantities.js";

const USUAL = "load_factor";
/** The most quantities that are drawn together. */
export const MOST_ORDINATES = 6;
/** Characters of a label in one line. */
const LINE = 40;

/** The axes for these paths: the chosen ones, if any path has them, or else those of the first path, in which case `refused` is
 *  set. */
export function axesOf(paths, { abscissa, ordinate }) {
  const isKnown = (name) => paths.some((path) => path.knows(name));
  const own = paths[0].ownAbscissa();
  const isOwn = abscissa !== null && !isKnown(abscissa);
  const asked = ordinatesIn(ordinate);
  const known = asked.filter(isKnown);
  const unknown = asked.filter((name) => !isKnown(name));
  const ordinates = (known.length ? known : [USUAL]).slice(0, MOST_ORDINATES);
  const refused = [
    isOwn ? `There is no “${abscissa}” here; ${quantityWords(own)} is drawn in its place.` : null,
    ...unknown.map((name) => `There is no “${name}” here; ${quantityWords(ordinates[0])} is drawn in its place.`),
    known.length > MOST_ORDINATES ? `At most ${MOST_ORDINATES} quantities are drawn together.` : null,
  ];
  return { abscissa: isOwn || abscissa === null ? own : abscissa, ordinates, refused: refused.filter(Boolean).join(" ") };
}

/** Whether a quantity has the scale of the first one, and so its axis; others have the axis on the right. */
export const isOnFirstAxis = (name, ordinates) => scaleOf(name) === scaleOf(ordinates[0]);

/** The label of an axis with these quantities. */
export function axisWords(names, request) {
  if (names.length > 2) return `${quantityWords(names[0], request)} and ${names.length - 1} more`;
  const words = names.map((name) => quantityWords(name, request));
  const line = words.join(", ");
  return line.length > LINE ? words.join(",\n") : line;
}

/** The controls; `chosen({abscissa} or {ordinate})` is told of a change. */
export function axesControls(place, request, { abscissa, ordinates }, chosen) {
  const groups = quantityGroups(request);
  const draw = (names) => chosen({ ordinate: [...new Set(names)].join(",") });
  const without = (name) => ordinates.filter((other) => other !== name);
  const first = quantityChoice({ id: "ordinate", label: "quantity to plot", groups, value: ordinates[0] },
    (name) => draw([name, ...ordinates.slice(1)]));
  const further = ordinates.slice(1).map((name) => element("span", { class: "chip" }, quantityWords(name, request),
    button("×", () => draw(without(name)), { class: "plain", "aria-label": `leave out ${quantityWords(name, request)}` })));
  const more = ordinates.length < MOST_ORDINATES
    ? quantityChoice({ id: "ordinate-more", label: "another quantity to plot as well", groups, value: null, empty: "+ another" },
      (name) => draw([...ordinates, name]))
    : element("span", { class: "quiet" }, `${MOST_ORDINATES} quantities are the most`);
  const against = quantityChoice({ id: "abscissa", label: "quantity to plot against", groups, value: abscissa },
    (name) => chosen({ abscissa: name }));
  fill(place, element("span", {}, "Plot ", first), further, element("span", {}, more), element("span", {}, "against ", against));
}
