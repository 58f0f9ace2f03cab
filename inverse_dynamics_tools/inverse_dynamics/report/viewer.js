// SPDX-License-Identifier: Apache-2.0
//
// The page's behaviour: one player per run couples the robot in 3D with the plots of its joints.
// Data of the page: <script type="application/json" id="runs">; arrays are base64 of little-endian float32.
"use strict";

class Player {
  constructor(section, run) {
    this.section = section;
    this.time = decode(run.time);
    this.q = rows(run.q, run.joints.length);
    this.now = this.time[0];
    this.end = this.time[this.time.length - 1];
    this.playing = false;
    const canvas = section.querySelector(".robot canvas");
    const motion = Array.from({length: 60}, (_, k) => positionsAt(this.time, this.q, this.now + k / 59 * (this.end - this.now)));
    this.scene = run.links.length ? createScene(canvas, run.links, motion) : null;
    section.querySelector(".no-webgl").hidden = this.scene !== null;
    this.plots = createPlotGroup(this.time, {onCursor: (t) => this.seek(t)});
    this.addPlots(run);
    this.connectControls();
    this.seek(this.now);
  }

  addPlots(run) {
    // A series has times of its own where the page holds only its peaks.
    const series = (name, data, style = name, hidden = false) => ({
      ...data, name, style, hidden, values: decode(data.values), time: data.time ? decode(data.time) : this.time});
    const {left_out, contacts, error_name, others_shown} = run;
    run.joints.forEach((joint, j) => {
      const [torque_element, error_element] = this.section.querySelectorAll(`[data-joint="${j}"] .plot`);
      const others = (what) => joint.others.map(
          (other, i) => series(other.name, other[what], `run${i % 4 + 1}`, !others_shown));
      const common = {unit: joint.unit, left_out, contacts};
      const band = run.band_is_of_errors ? [] : joint.band;
      this.plots.add(torque_element, {...common, label: joint.name, band, series: [
        series("measured", joint.measured), ...others("computed"), series(run.name, joint.computed, "computed")]});
      this.plots.add(error_element, {...common, label: error_name, band: joint.band, series: [
        ...others("error"), series(error_name, joint.error, "error")]});
    });
  }

  connectControls() {
    this.button = this.section.querySelector(".play");
    this.slider = this.section.querySelector(".scrub");
    this.clock = this.section.querySelector(".clock");
    this.speed = this.section.querySelector(".speed");
    for (const box of this.section.querySelectorAll(".legend input")) {
      box.addEventListener("change", () => this.plots.setHidden(box.value, !box.checked));
    }
    this.slider.min = this.time[0];
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
    this.section.querySelector(".reset-view").addEventListener("click", () => this.scene?.reset());
  }

  seek(t) {
    this.now = Math.min(Math.max(t, this.time[0]), this.end);
    this.slider.value = this.now;
    this.clock.textContent = `${this.now.toFixed(2)} s of ${this.end.toFixed(2)} s`;
    this.slider.setAttribute("aria-valuetext", this.clock.textContent);
    this.section.dataset.time = this.now.toFixed(4);
    this.plots.setCursor(this.now);
    this.scene?.draw(positionsAt(this.time, this.q, this.now));
  }

  toggle() {
    this.playing ? this.pause() : this.play();
  }

  play() {
    if (this.now >= this.end) this.seek(this.time[0]);
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
      Home: () => this.seek(this.time[0]),
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
