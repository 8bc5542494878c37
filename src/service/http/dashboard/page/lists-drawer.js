// On a narrow screen the lists are a drawer, which a button in the head of the page opens; on a wide one they always stand
// beside the view.

import { byId } from "./dom.js";
import { isSameView, onChange, state } from "./state.js";

const OPEN = "lists-open";

export function listsDrawer(button, lists) {
  const open = (yes) => {
    document.body.classList.toggle(OPEN, yes);
    button.setAttribute("aria-expanded", String(yes));
  };
  button.addEventListener("click", () => {
    const isOpened = !document.body.classList.contains(OPEN);
    open(isOpened);
    if (isOpened) lists.querySelector("input, select, a")?.focus();
  });
  lists.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !document.body.classList.contains(OPEN) || button.offsetParent === null) return;
    open(false);
    button.focus();
  });
  onChange((before) => {
    const hadFocus = lists.contains(document.activeElement);
    // A path that is drawn with others leaves the drawer open, for the next one.
    const isAnother = !isSameView(before, state()) && state().jobs.length < 2;
    if (!isAnother || button.offsetParent === null) return;
    open(isNothingShown());
    if (hadFocus && !isNothingShown()) byId("view").focus();
  });
  // Where nothing else is shown, the lists are.
  open(isNothingShown());
}

function isNothingShown() {
  const { jobs, study, sweep, run } = state();
  return jobs.length === 0 && !study && !sweep && !run;
}
