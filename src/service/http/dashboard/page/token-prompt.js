// Asks for the token if the service requires one.

import { keepToken, onTokenAsked } from "./api.js";
import { button, element, fill } from "./dom.js";

/** The characters that a header may have. */
const WRITTEN = /^[!-~]+$/;

export function tokenPrompt(place) {
  onTokenAsked((told) => {
    if (!place.hidden) return;
    place.hidden = false;
    const given = element("input", {
      type: "password", id: "given-token", autocomplete: "off", size: 40, required: true,
      onkeydown: (event) => { if (event.key === "Enter") take(); },
    });
    const wrong = element("p", { class: "bad", role: "alert" });
    const take = () => {
      const token = given.value.trim();
      if (!token) return;
      if (!WRITTEN.test(token)) {
        wrong.textContent = "That is no token of this service: they have letters, digits and plain signs alone.";
        return;
      }
      keepToken(token);
      location.reload();
    };
    const label = element("label", { for: "given-token" }, "This service asks for a token");
    fill(place, element("p", {}, label, told ? `: ${told}` : "."),
      element("div", { class: "actions" }, given, button("Use it", take, { class: "main", id: "use-token" })),
      wrong, element("p", { class: "quiet" }, "It is kept as long as this tab is open."));
    given.focus();
  });
}
