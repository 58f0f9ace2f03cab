// SPDX-License-Identifier: Apache-2.0
//
// Time series on a canvas: zoom and pan in time shared by a group of plots, a cursor on a canvas of its own.
//
//   const group = createPlotGroup(time, {onCursor: (t) => ...});
//   group.add(element, {label: "elbow_joint", unit: "N m", series: [{name, time, values, style: "measured"}]});
//   group.setCursor(1.5);
//   group.setHidden("URDF", true);
//
// time: s, increasing, of a series as many as its values. A series may be hidden at first. band: [{from, to, half}], half
// the width of a band about the first series, or about zero where there is `error`. Dragging zooms, shift and dragging pans, a click sets
// the cursor, a double click shows everything.
"use strict";

// Told apart by colour-blind readers and in print: dashes and lightness differ, not only hue (Okabe and Ito's palette).
const kStyles = {
  measured: {color: "#111111", width: 1.3, dash: [5, 3]},
  computed: {color: "#D55E00", width: 1.5, dash: []},
  error: {color: "#0072B2", width: 1.2, dash: []},
  other0: {color: "#CC79A7", width: 1.2, dash: []},
  other1: {color: "#56B4E9", width: 1.2, dash: []},
  other2: {color: "#009E73", width: 1.2, dash: [2, 2]},
};
const kBand = "rgba(213, 94, 0, 0.18)";
const kMargin = {left: 54, right: 10, top: 18, bottom: 20};

// Round numbers between low and high, about `count` of them.
function ticks(low, high, count) {
  const raw = (high - low) / Math.max(1, count);
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((candidate) => candidate >= raw);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  const values = [];
  for (let i = first; i <= last; ++i) values.push(i === 0 ? 0 : i * step);
  return {values, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9))};
}

// A number short enough for an axis or a readout, with the given digits where they say something.
function short(value, digits) {
  if (value === 0 && digits > 4) return "0";
  if (value === 0 || Math.abs(value) >= 1e-3) return value.toFixed(digits);
  return value.toExponential(1);
}

// Index of the last sample at or before t.
function indexAt(time, t) {
  let low = 0, high = time.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (time[middle] <= t) low = middle;
    else high = middle - 1;
  }
  return low;
}

// Magnitude beyond which an error is a spike that would flatten the rest: 1.5 times the 99.5 % quantile.
function spikeLimit(all_series) {
  const magnitudes = all_series.flatMap((series) => Array.from(series.values, Math.abs)).sort((a, b) => a - b);
  return 1.5 * magnitudes[Math.floor(0.995 * (magnitudes.length - 1))] || Infinity;
}

function range(all_series, {error = all_series.every((series) => series.style === "error"), band} = {}) {
  let low = Infinity, high = -Infinity;
  for (const series of all_series) {
    for (const value of series.values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (error) {
    const limit = Math.max(spikeLimit(all_series), ...(band || []).map((part) => part.half));
    low = Math.max(low, -limit);
    high = Math.min(high, limit);
  }
  if (!(high > low)) {
    const middle = Number.isFinite(low) ? low : 0;
    return [middle - 1, middle + 1];
  }
  const margin = 0.06 * (high - low);
  return [low - margin, high + margin];
}

function makeCanvas(parent, name) {
  const canvas = document.createElement("canvas");
  canvas.className = name;
  parent.appendChild(canvas);
  return canvas;
}

// Sizes a canvas to its element, in device pixels or finer; drawing then goes in CSS pixels.
function prepare(canvas, least_ratio) {
  const ratio = Math.max(window.devicePixelRatio || 1, least_ratio);
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return {context, width, height};
}

class Plot {
  constructor(element, options) {
    this.options = options;
    this.setRange();
    this.base = makeCanvas(element, "plot-base");
    this.overlay = makeCanvas(element, "plot-overlay");
    this.overlay.setAttribute("role", "img");
    this.overlay.setAttribute("aria-label", `${options.label} over time, ${options.unit}`);
  }

  shown() {
    return this.options.series.filter((series) => !series.hidden);
  }

  setRange() {
    this.range = range(this.shown(), this.options);
  }

  x(t, view) {
    const width = this.base.clientWidth - kMargin.left - kMargin.right;
    return kMargin.left + width * (t - view.low) / (view.high - view.low);
  }

  t(x, view) {
    const width = this.base.clientWidth - kMargin.left - kMargin.right;
    return view.low + (view.high - view.low) * (x - kMargin.left) / width;
  }

  y(value) {
    const height = this.base.clientHeight - kMargin.top - kMargin.bottom;
    return kMargin.top + height * (this.range[1] - value) / (this.range[1] - this.range[0]);
  }

  draw(view) {
    const {context, width, height} = prepare(this.base, 2);  // fine enough for paper
    if (width === 0) return;
    this.drawAxes(context, width, height, view);
    context.save();
    context.beginPath();
    context.rect(kMargin.left, kMargin.top, width - kMargin.left - kMargin.right, height - kMargin.top - kMargin.bottom);
    context.clip();
    this.drawBand(context, view);
    for (const series of this.shown()) this.drawSeries(context, series, width, view);
    context.restore();
  }

  drawAxes(context, width, height, view) {
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = "#333";
    context.strokeStyle = "#e3e6ea";
    context.lineWidth = 1;
    const vertical = ticks(this.range[0], this.range[1], height / 26);
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const value of vertical.values) {
      const y = Math.round(this.y(value)) + 0.5;
      context.beginPath();
      context.moveTo(kMargin.left, y);
      context.lineTo(width - kMargin.right, y);
      context.stroke();
      context.fillText(short(value, vertical.digits), kMargin.left - 5, y);
    }
    const horizontal = ticks(view.low, view.high, width / 80);
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const value of horizontal.values) {
      const x = Math.round(this.x(value, view)) + 0.5;
      context.beginPath();
      context.moveTo(x, kMargin.top);
      context.lineTo(x, height - kMargin.bottom);
      context.stroke();
      context.fillText(`${value.toFixed(horizontal.digits)} s`, x, height - kMargin.bottom + 4);
    }
    context.textAlign = "left";
    context.textBaseline = "alphabetic";
    context.font = "600 12px system-ui, sans-serif";
    const title = `${this.options.label} [${this.options.unit}]`;
    context.fillText(title, kMargin.left, 12);
    this.title_end = kMargin.left + context.measureText(title).width;
  }

  drawBand(context, view) {
    context.fillStyle = kBand;
    const about = this.options.series[0];
    for (const {from, to, half} of this.options.band || []) {
      if (to < view.low || from > view.high) continue;
      const first = this.options.error ? 0 : indexAt(about.time, Math.max(from, view.low));
      const last = this.options.error ? 1 : Math.min(about.time.length - 1, indexAt(about.time, Math.min(to, view.high)) + 1);
      const point = this.options.error ? (i) => [[from, to][i], 0] : (i) => [about.time[i], about.values[i]];
      context.beginPath();
      for (let i = first; i <= last; ++i) context.lineTo(this.x(point(i)[0], view), this.y(point(i)[1] + half));
      for (let i = last; i >= first; --i) context.lineTo(this.x(point(i)[0], view), this.y(point(i)[1] - half));
      context.fill();
    }
  }

  drawSeries(context, series, width, view) {
    const style = kStyles[series.style];
    context.strokeStyle = style.color;
    context.lineWidth = style.width;
    context.setLineDash(style.dash);
    context.beginPath();
    const {time, values} = series;
    const first = indexAt(time, view.low);
    const last = Math.min(time.length - 1, indexAt(time, view.high) + 1);
    const pixels = width - kMargin.left - kMargin.right;
    if (last - first > 4 * pixels) this.traceColumns(context, series, first, last, view);
    else {
      for (let i = first; i <= last; ++i) context.lineTo(this.x(time[i], view), this.y(values[i]));
    }
    context.stroke();
    context.setLineDash([]);
  }

  // More samples than pixels: from each column of pixels its least and greatest value, so that no peak is lost.
  traceColumns(context, {time, values}, first, last, view) {
    let column = -1, low = 0, high = 0;
    for (let i = first; i <= last; ++i) {
      const x = Math.round(this.x(time[i], view));
      if (x !== column) {
        if (column >= 0) {
          context.lineTo(column, this.y(low));
          context.lineTo(column, this.y(high));
        }
        column = x;
        low = high = values[i];
      }
      low = Math.min(low, values[i]);
      high = Math.max(high, values[i]);
    }
    context.lineTo(column, this.y(low));
    context.lineTo(column, this.y(high));
  }

  drawOverlay(view, cursor, selection) {
    const {context, width, height} = prepare(this.overlay, 1);
    if (width === 0) return;
    if (selection) {
      context.fillStyle = "rgba(0, 114, 178, 0.15)";
      const [low, high] = selection.map((t) => this.x(t, view));
      context.fillRect(low, kMargin.top, high - low, height - kMargin.top - kMargin.bottom);
    }
    const x = this.x(cursor, view);
    if (x >= kMargin.left && x <= width - kMargin.right) {
      context.strokeStyle = "#009E73";
      context.lineWidth = 1.5;
      context.beginPath();
      context.moveTo(x, kMargin.top);
      context.lineTo(x, height - kMargin.bottom);
      context.stroke();
    }
    this.drawReadout(context, width, cursor);
  }

  // Values at the cursor: with their names; where these would touch the title, in their colours alone; else none.
  drawReadout(context, width, cursor) {
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "right";
    const all = this.shown().reverse();
    const values = all.map((series) => short(series.values[indexAt(series.time, cursor)], 3));
    const named = values.map((value, i) => `${all[i].name} ${value}`);
    const length = (texts) => texts.reduce((sum, text) => sum + context.measureText(text).width + 12, 0);
    const room = width - kMargin.right - this.title_end;
    const texts = [named, values, []].find((candidate) => length(candidate) <= room) || [];
    let x = width - kMargin.right;
    texts.forEach((text, i) => {
      context.fillStyle = kStyles[all[i].style].color;
      context.fillText(text, x, 12);
      x -= context.measureText(text).width + 12;
    });
  }
}

function createPlotGroup(time, {onCursor}) {
  const everything = {low: time[0], high: time[time.length - 1]};
  if (!(everything.high > everything.low)) everything.high = everything.low + 1;
  const view = {...everything};
  const plots = [];
  let cursor = time[0];
  let selection = null;

  const drawOverlays = () => plots.forEach((plot) => plot.drawOverlay(view, cursor, selection));
  const drawAll = () => {
    plots.forEach((plot) => plot.draw(view));
    drawOverlays();
  };

  function setView(low, high) {
    const least = 1e-3 * (everything.high - everything.low);
    const span = Math.min(Math.max(high - low, least), everything.high - everything.low);
    view.low = Math.min(Math.max(low, everything.low), everything.high - span);
    view.high = view.low + span;
    drawAll();
  }

  function zoom(factor, centre = cursor) {
    setView(centre - (centre - view.low) * factor, centre + (view.high - centre) * factor);
  }

  function setCursor(t) {
    cursor = t;
    drawOverlays();
  }

  function attach(plot) {
    let start = null, start_view = null;
    const at = (event) => plot.t(event.offsetX, view);
    plot.overlay.addEventListener("pointerdown", (event) => {
      start = at(event);
      start_view = event.shiftKey ? {...view} : null;
      plot.overlay.setPointerCapture(event.pointerId);
    });
    plot.overlay.addEventListener("pointermove", (event) => {
      if (start === null) return;
      if (start_view) {
        const shift = plot.t(event.offsetX, start_view) - start;
        setView(start_view.low - shift, start_view.high - shift);
      } else {
        selection = [start, at(event)].sort((a, b) => a - b);
        drawOverlays();
      }
    });
    plot.overlay.addEventListener("pointerup", (event) => {
      const chosen = selection, panned = start_view;
      start = start_view = selection = null;
      if (panned) return;
      if (chosen && plot.x(chosen[1], view) - plot.x(chosen[0], view) > 4) setView(...chosen);
      else onCursor(Math.min(Math.max(at(event), everything.low), everything.high));
    });
    plot.overlay.addEventListener("dblclick", () => setView(everything.low, everything.high));
    plot.overlay.addEventListener("wheel", (event) => {
      if (!event.ctrlKey) return;  // without the key the page scrolls
      event.preventDefault();
      zoom(Math.exp(0.002 * event.deltaY), at(event));
    }, {passive: false});
  }

  return {
    add(element, options) {
      const plot = new Plot(element, options);
      plots.push(plot);
      attach(plot);
    },
    setCursor, zoom, drawAll,
    setHidden(name, hidden) {
      for (const plot of plots) {
        for (const series of plot.options.series) if (series.name === name) series.hidden = hidden;
        plot.setRange();
      }
      drawAll();
    },
    showAll: () => setView(everything.low, everything.high),
    pan: (share) => setView(view.low + share * (view.high - view.low), view.high + share * (view.high - view.low)),
  };
}
