// Makes files of pictures of the structure: one as PNG or SVG, or those along a path as an animation.

import { animatedPng } from "./animated-png.js";
import { save } from "./downloads.js";
import { fromSheet } from "./plot-style.js";
import { StructureScene } from "./structure-scene.js";
import { short } from "./words.js";

/** Pixels of a picture, and how many there are to each in a PNG. */
const SIZE = { width: 900, height: 620 };
const FINE = 2;
/** The most pictures of an animation, and the milliseconds for which each is shown. */
const FRAMES = 90;
const PACE = 100;

function captionOf(model, shown) {
  const where = !shown ? "no load yet"
    : `increment ${shown.index}, stage “${shown.stage}”, load factor ${short(shown.load_factor)}`;
  return [model.name, where].filter(Boolean).join(" · ");
}

/** The picture of an increment, with what it shows in words and on the ground of the page. */
function imageOf(scene, view, shown, options) {
  const { traces, layout } = scene.picture(shown, { ...view, caption: captionOf(scene.model, shown) });
  const margin = { ...layout.margin, t: 48 };
  return Plotly.toImage({ data: traces, layout: { ...layout, ...SIZE, margin, paper_bgcolor: fromSheet("--panel") } },
    { ...SIZE, ...options });
}

/** The bytes of an image as Plotly gives it. The page's policy lets nothing be fetched but from the service, not even this. */
const bytesOf = (image) => Uint8Array.from(atob(image.slice(image.indexOf(",") + 1)), (letter) => letter.charCodeAt(0));

const nameOf = (scene, shown, ending) => `structure-${scene.path.id}${shown ? `-${shown.index}` : ""}.${ending}`;

export async function savePicture({ scene, view, shown }, format) {
  const image = await imageOf(scene, view, shown, { format, scale: format === "png" ? FINE : 1 });
  const content = format === "svg" ? decodeURIComponent(image.slice(image.indexOf(",") + 1)) : bytesOf(image);
  const type = format === "svg" ? "image/svg+xml" : "image/png";
  save(new Blob([content], { type }), nameOf(scene, shown, format));
  return `The picture has been saved as ${nameOf(scene, shown, format)}.`;
}

/** The path from its first to its last increment; of long paths every so many. `say(words)`: how far it is. */
export async function saveAnimation({ scene: { path }, view }, signal, say) {
  const stride = Math.max(1, Math.ceil((path.index.length - 1) / (FRAMES - 1)));
  const wanted = path.index.filter((_, place) => place % stride === 0 || place === path.index.length - 1);
  if (wanted.length < 2) throw new Error("the path has fewer than two increments");
  // A scene of its own: the extent and the colours are those of the whole path.
  const scene = new StructureScene(path, view.exaggeration);
  const shown = [];
  for (const index of wanted) {
    signal.throwIfAborted();
    say(`Reading increment ${index} …`);
    const increment = await path.increment(index);
    if (!increment) throw new Error(`the service does not give increment ${index}`);
    scene.picture(increment, view);
    shown.push(increment);
  }
  const pictures = [];
  for (const increment of shown) {
    signal.throwIfAborted();
    pictures.push(bytesOf(await imageOf(scene, view, increment, { format: "png", scale: 1 })));
    say(`Picture ${pictures.length} of ${shown.length} …`);
  }
  const name = nameOf(scene, null, "png");
  save(new Blob([animatedPng(pictures, PACE)], { type: "image/apng" }), name);
  const leftOut = stride > 1 ? `, of every ${stride}th of the ${path.index.length} increments` : "";
  return `The animation has been saved as ${name}: ${pictures.length} pictures${leftOut}. `
    + "Browsers play it; other programs may show its first picture.";
}
