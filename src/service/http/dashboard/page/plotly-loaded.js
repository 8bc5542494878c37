// Loads Plotly's script, which is large: the page requests it first, so that it is loaded before the data to be drawn.

import { byId, element } from "./dom.js";

let asked = null;

/** Resolves once `Plotly` is loaded; after a failure the script is requested again. */
export function plotlyLoaded() {
  asked ??= new Promise((resolve, refuse) => {
    if (window.Plotly) {
      resolve();
      return;
    }
    const hasCome = document.readyState === "complete";
    const script = hasCome ? element("script", { src: "/assets/plotly.js" }) : byId("plotly");
    script.addEventListener("load", resolve);
    script.addEventListener("error", () => {
      asked = null;
      refuse(new Error("Plotly could not be loaded from the service."));
    });
    if (hasCome) document.head.append(script);
  });
  return asked;
}

/** Draws a hidden plot while the page is idle, as the first plot takes longest. */
export async function warmPlotlyUp() {
  await plotlyLoaded();
  const idle = window.requestIdleCallback ?? setTimeout;
  idle(async () => {
    const place = element("div", { class: "plot unseen", "aria-hidden": "true" });
    document.body.append(place);
    await Plotly.newPlot(place, [
      { type: "scatter", mode: "lines", x: [0, 1], y: [0, 1] },
      { type: "scatter", mode: "markers+text", x: [0, 1], y: [0, 1], text: ["A", "B"] },
    ], {}, {});
    Plotly.purge(place);
    place.remove();
  });
}
