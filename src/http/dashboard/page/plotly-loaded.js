// Plotly's script is large: it is run while what it will draw is already on its way.

import { element } from "./dom.js";

let asked = null;

/** Resolves once `Plotly` is there. */
export function plotlyLoaded() {
  asked ??= new Promise((resolve, refuse) => {
    const failed = () => { asked = null; refuse(new Error("Plotly could not be loaded from the service")); };
    document.head.append(element("script", { src: "/assets/plotly.js", onload: resolve, onerror: failed }));
  });
  return asked;
}
