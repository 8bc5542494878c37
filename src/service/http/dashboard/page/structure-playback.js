// Goes along the increments of a path: a slider, and a button that plays them at a chosen speed.

import { choice, element } from "./dom.js";

/** Milliseconds between increments at speed 1. */
const PACE = 60;
/** The most increments of a path that are played; of longer paths every so many. */
const PLAYED = 300;
const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
/** Milliseconds between increments where the reader's system asks for less motion. */
const CALM = 1000;

const reduced = matchMedia("(prefers-reduced-motion: reduce)");

export class Playback {
  /** Tells `chosen(place)` of the place on the path; `isBusy()`: the last one is not drawn yet. */
  constructor({ chosen, isBusy }) {
    this.told = { chosen, isBusy };
    this.timer = null;
    this.speed = 1;
    this.count = 0;
    this.slider = element("input", {
      type: "range", min: 0, max: 0, value: 0, id: "increment", "aria-label": "increment", oninput: () => this.slid(),
    });
    this.button = element("button", { type: "button", id: "play", onclick: () => this.toggle(), "aria-label": "play" }, "▶");
    this.place = element("div", { class: "slider" }, this.button, this.slider, choice({
      id: "speed", "aria-label": "speed", onchange: (event) => this.setSpeed(Number(event.target.value)),
    }, SPEEDS.map((speed) => [String(speed), `${speed} ×`]), "1"));
    reduced.addEventListener("change", () => this.again());
  }

  get isPlaying() {
    return this.timer !== null;
  }

  /** Every so many increments are played. */
  get stride() {
    return Math.max(1, Math.round(this.count / PLAYED));
  }

  get pause() {
    return reduced.matches ? CALM : PACE / this.speed;
  }

  /** What is particular about how the path is played. */
  get words() {
    return [
      this.stride > 1 ? `Playing shows every ${this.stride}th of the ${this.count} increments.` : null,
      reduced.matches ? "Playing shows one increment a second, as your system asks for less motion." : null,
    ].filter(Boolean).join(" ");
  }

  /** The path has so many increments, of which this one is shown. */
  show(count, place, index) {
    this.count = count;
    this.slider.max = Math.max(0, count - 1);
    this.slider.value = place;
    this.slider.setAttribute("aria-valuetext", `increment ${index}`);
  }

  setSpeed(speed) {
    this.speed = speed;
    this.again();
  }

  again() {
    if (!this.isPlaying) return;
    this.stop();
    this.start();
  }

  slid() {
    this.told.chosen(Number(this.slider.value));
  }

  toggle() {
    if (this.isPlaying) this.stop();
    else if (this.count > 1) {
      if (Number(this.slider.value) >= Number(this.slider.max)) this.slider.value = 0;
      this.start();
    }
  }

  start() {
    this.timer = setInterval(() => this.step(), this.pause);
    this.say();
  }

  stop() {
    clearInterval(this.timer);
    this.timer = null;
    this.say();
  }

  step() {
    if (this.told.isBusy()) return;
    const next = Math.min(Number(this.slider.value) + this.stride, Number(this.slider.max));
    this.slider.value = next;
    this.slid();
    if (next >= Number(this.slider.max)) this.stop();
  }

  say() {
    this.button.textContent = this.isPlaying ? "⏸" : "▶";
    this.button.setAttribute("aria-label", this.isPlaying ? "pause" : "play");
  }
}
