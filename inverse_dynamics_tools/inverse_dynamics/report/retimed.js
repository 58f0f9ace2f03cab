// SPDX-License-Identifier: Apache-2.0
//
// The page of a timed path: one player moves two robots along it, beside plots of speed and torques.
"use strict";

class Race {
  constructor({links, joints, motions, plots}) {
    const canvases = document.querySelectorAll(".robot canvas");
    this.motions = motions.map((motion) => ({time: decode(motion.time), q: rows(motion.q, joints)}));
    const {time, q} = this.motions[0];  // the path of both
    const seen = Array.from({length: 60}, (_, i) => positionsAt(time, q, i / 59 * time.at(-1)));
    this.motions.forEach((motion, k) => {
      motion.scene = links.length ? createScene(canvases[k], links, seen) : null;
      document.querySelectorAll(".no-webgl")[k].hidden = motion.scene !== null;
    });
    this.end = Math.max(...this.motions.map((motion) => motion.time.at(-1)));
    this.plots = createPlotGroup([0, this.end], {onCursor: (t) => this.seek(t)});
    const elements = document.querySelectorAll(".plot");
    plots.forEach((plot, k) => this.plots.add(elements[k], {...plot, series: plot.series.map(
        (series) => ({...series, time: decode(series.time), values: decode(series.values)}))}));
    this.connectControls();
    this.plots.drawAll();
    this.seek(0);
  }

  connectControls() {
    [this.button, this.slider, this.clock, this.speed] =
        ["play", "scrub", "clock", "speed"].map((name) => document.querySelector(`.${name}`));
    this.slider.min = 0;
    this.slider.max = this.end;
    this.button.addEventListener("click", () => this.play(this.button.textContent === "Play"));
    this.slider.addEventListener("input", () => this.seek(Number(this.slider.value)));
    document.querySelector(".show-all").addEventListener("click", () => this.plots.showAll());
  }

  // Each robot stands at its own end.
  seek(t) {
    this.now = Math.min(Math.max(t, 0), this.end);
    this.slider.value = this.now;
    this.clock.textContent = `${this.now.toFixed(2)} s of ${this.end.toFixed(2)} s`;
    this.slider.setAttribute("aria-valuetext", this.clock.textContent);
    this.plots.setCursor(this.now);
    for (const {scene, time, q} of this.motions) scene?.draw(positionsAt(time, q, this.now));
  }

  play(playing) {
    if (playing && this.now >= this.end) this.seek(0);
    this.button.textContent = playing ? "Pause" : "Play";
    this.button.setAttribute("aria-pressed", playing);
    cancelAnimationFrame(this.frame);
    let before = null;
    const step = (stamp) => {
      if (before !== null) this.seek(this.now + Number(this.speed.value) * (stamp - before) / 1000);
      before = stamp;
      if (this.now >= this.end) this.play(false);
      else this.frame = requestAnimationFrame(step);
    };
    if (playing) this.frame = requestAnimationFrame(step);
  }

  redraw() {
    this.plots.drawAll();
    this.seek(this.now);
  }
}

const race = new Race(JSON.parse(document.getElementById("data").textContent));
new ResizeObserver(() => race.redraw()).observe(document.body);
const dark = window.matchMedia("screen and (prefers-color-scheme: dark)");
dark.addEventListener("change", () => {
  if (window.matchMedia("print").matches) return;
  theme.clear();
  document.documentElement.dataset.drawn = dark.matches ? "dark" : "light";
  race.redraw();
});
document.documentElement.dataset.drawn = dark.matches ? "dark" : "light";
