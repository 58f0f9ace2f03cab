// SPDX-License-Identifier: Apache-2.0
//
// The page's behaviour: a player of a section couples robots in 3D with plots, all of which it shows at one time.
// Data of the page: <script type="application/json" id="runs">, for each section {id, links, motions: [{time, q}], plots}.
// A motion has a canvas, a plot an element of the class; plots: see plots.js. A series without times has those of the first motion.
// Arrays are base64 of little-endian float32.
"use strict";

class Player {
  constructor(section, run) {
    this.section = section;
    this.motions = run.motions.map(({time, q}) => ({time: decode(time), q: q.map(decode)}));
    const {time, q} = this.motions[0];
    this.now = this.start = time[0];
    this.end = Math.max(...this.motions.map((motion) => motion.time.at(-1)));
    this.playing = false;
    const seen = Array.from({length: 60}, (_, k) => positionsAt(time, q, this.start + k / 59 * (time.at(-1) - this.start)));
    const canvases = section.querySelectorAll(".robot canvas"), excuses = section.querySelectorAll(".no-webgl");
    this.motions.forEach((motion, k) => {
      motion.scene = run.links.length ? createScene(canvases[k], run.links, seen) : null;
      excuses[k].hidden = motion.scene !== null;
    });
    this.plots = createPlotGroup([this.start, this.end], {onCursor: (t) => this.seek(t)});
    const elements = section.querySelectorAll(".plot"), {left_out, contacts} = run;
    run.plots.forEach((plot, k) => this.plots.add(elements[k], {left_out, contacts, ...plot, series: plot.series.map(
        (series) => ({...series, time: series.time ? decode(series.time) : time, values: decode(series.values)}))}));
    this.connectControls();
    this.seek(this.now);
  }

  connectControls() {
    this.button = this.section.querySelector(".play");
    this.slider = this.section.querySelector(".scrub");
    this.clock = this.section.querySelector(".clock");
    this.speed = this.section.querySelector(".speed");
    for (const box of this.section.querySelectorAll(".legend input")) {
      box.addEventListener("change", () => this.plots.setHidden(box.value, !box.checked));
    }
    this.slider.min = this.start;
    this.slider.max = this.end;
    this.button.addEventListener("click", () => this.toggle());
    this.slider.addEventListener("input", () => this.seek(Number(this.slider.value)));
    this.slider.addEventListener("keydown", (event) => {
      if (event.key.startsWith("Arrow") || event.key === "Home" || event.key === "End") {
        const back = event.key === "ArrowLeft" || event.key === "ArrowDown";
        this.key(event.key.startsWith("Arrow") ? (back ? "ArrowLeft" : "ArrowRight") : event.key, event.shiftKey);
        event.preventDefault();
      }
    });
    this.section.querySelector(".zoom-in").addEventListener("click", () => this.plots.zoom(0.7));
    this.section.querySelector(".show-all").addEventListener("click", () => this.plots.showAll());
    this.section.querySelector(".reset-view").addEventListener("click", () => this.motions.forEach(({scene}) => scene?.reset()));
  }

  seek(t) {
    this.now = Math.min(Math.max(t, this.start), this.end);
    this.slider.value = this.now;
    this.clock.textContent = `${this.now.toFixed(2)} s of ${this.end.toFixed(2)} s`;
    this.slider.setAttribute("aria-valuetext", this.clock.textContent);
    this.section.dataset.time = this.now.toFixed(4);
    this.plots.setCursor(this.now);
    for (const {scene, time, q} of this.motions) scene?.draw(positionsAt(time, q, this.now));
  }

  toggle() {
    this.playing ? this.pause() : this.play();
  }

  play() {
    if (this.end - this.now < 1e-6) this.seek(this.start);  // the slider rounds
    this.playing = true;
    this.button.textContent = "Pause";
    this.button.setAttribute("aria-pressed", "true");
    let before = null;
    const step = (stamp) => {
      if (!this.playing) return;
      if (before !== null) this.seek(this.now + Number(this.speed.value) * (stamp - before) / 1000);
      before = stamp;
      if (this.now >= this.end) this.pause();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  pause() {
    this.playing = false;
    this.button.textContent = "Play";
    this.button.setAttribute("aria-pressed", "false");
  }

  redraw() {
    this.plots.drawAll();
    this.seek(this.now);
  }

  // True when the key meant something.
  key(name, shift) {
    const step = shift ? 1 : 0.1;
    const actions = {
      " ": () => this.toggle(),
      ArrowLeft: () => this.seek(this.now - step),
      ArrowRight: () => this.seek(this.now + step),
      Home: () => this.seek(this.start),
      End: () => this.seek(this.end),
      "+": () => this.plots.zoom(0.7),
      "-": () => this.plots.zoom(1 / 0.7),
      "0": () => this.plots.showAll(),
      "<": () => this.plots.pan(-0.2),
      ">": () => this.plots.pan(0.2),
    };
    if (!(name in actions)) return false;
    actions[name]();
    return true;
  }
}

function start() {
  const runs = JSON.parse(document.getElementById("runs").textContent);
  const players = runs.map((run) => new Player(document.getElementById(run.id), run));
  const redraw = () => players.forEach((player) => player.redraw());

  // Keys act on the run that fills most of the screen.
  const visibleHeight = (player) => {
    const box = player.section.getBoundingClientRect();
    return Math.min(box.bottom, window.innerHeight) - Math.max(box.top, 0);
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.closest("input, select")) return;  // they have keys of their own
    if (event.target.closest("button, a, summary") && (event.key === " " || event.key === "Enter")) return;
    if (event.target.closest(".scroll") && event.key.startsWith("Arrow")) return;
    const player = players.reduce((a, b) => visibleHeight(b) > visibleHeight(a) ? b : a);
    if (player.key(event.key, event.shiftKey)) event.preventDefault();
  });
  new ResizeObserver(redraw).observe(document.body);
  // Lines are drawn in the page's colours. Paper shows them inverted if they were drawn for a dark page (style.css).
  const dark = window.matchMedia("screen and (prefers-color-scheme: dark)");
  const note = () => { document.documentElement.dataset.drawn = dark.matches ? "dark" : "light"; };
  dark.addEventListener("change", () => {
    if (window.matchMedia("print").matches) return;
    note();
    theme.clear();
    redraw();
  });
  note();
  // On paper everything is unfolded. Plots aren't redrawn then: Chromium may print a canvas empty that this event has drawn upon.
  window.addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((part) => { part.open = true; }));
  redraw();
}

start();
