// SPDX-License-Identifier: Apache-2.0
//
// Time series on a canvas: zoom and pan in time shared by a group of plots; a cursor and its values on a canvas of their own.
//
//   const group = createPlotGroup(time, {onCursor: (t) => ...});
//   group.add(element, {label: "elbow_joint", unit: "N m", series: [{name, time, values, style: "measured"}]});
//   group.setCursor(1.5);
//   group.setHidden("URDF", true);
//
// time: s, increasing, of a series as many as its values. A series may be hidden at first. limit: of a series, that of its
// axis, symmetric about zero; else all values are shown. band: [{from, to, half}]: half the width of a band about the
// computed series, or about zero. left_out, contacts: [[from, to]], shaded. Colours are those of the page's CSS variables.
// With a mouse, pointing shows values, a click sets the cursor, dragging zooms, shift and dragging pans, a double click
// shows everything; a finger sets the cursor.
"use strict";

// Measured is wide and below the computed line, so that both are visible where many samples share a pixel.
const kWidths = {measured: 2.2, computed: 1.3, error: 1.1};
const kOtherWidth = 1.2;

// A colour of the page, light or dark (figures/palette.py).
const theme = new Map();  // empty it where the scheme changes

function themeColor(name) {
  if (!theme.has(name)) {
    theme.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  }
  return theme.get(name);
}

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

// Range of an axis. Where each series has a limit, spikes may lie beyond it.
function range(all_series, band = []) {
  let [low, high] = extremes(all_series);
  if (all_series.every((series) => series.limit > 0)) {
    high = Math.max(...[...all_series, ...band].map((part) => part.half || part.limit));
    low = -high;
  } else if (!(high > low)) {
    const middle = Number.isFinite(low) ? low : 0;
    [low, high] = [middle - 1, middle + 1];
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

// Sizes a canvas to its element, in device pixels or finer.
function sized(canvas, least_ratio) {
  const ratio = Math.max(window.devicePixelRatio || 1, least_ratio);
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  return {ratio, width, height};
}

// The same; drawing then goes in CSS pixels.
function prepare(canvas, least_ratio) {
  const {ratio, width, height} = sized(canvas, least_ratio);
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return {context, width, height};
}

function strokeLine(context, x0, y0, x1, y1) {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
}

// The least and the greatest of the values of some series.
function extremes(all_series) {
  let low = Infinity, high = -Infinity;
  for (const {values} of all_series) {
    for (const value of values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return [low, high];
}

class Plot {
  constructor(element, options) {
    this.options = options;
    this.setRange();
    this.base = makeCanvas(element, "plot-base");
    this.overlay = makeCanvas(element, "plot-overlay");
    this.base.setAttribute("aria-hidden", "true");
    this.overlay.setAttribute("role", "img");
    this.describe();
  }

  shown() {
    return this.options.series.filter((series) => !series.hidden);
  }

  setRange() {
    this.range = range(this.shown(), this.options.band);
    const [low, high] = extremes(this.shown());
    const cut = low < this.range[0] || high > this.range[1];
    this.cut = cut ? `, cut: peak ${Number(Math.max(-low, high).toPrecision(3))}` : "";
  }

  // The plot in words, for those who don't see it.
  describe() {
    const texts = this.shown().map((series) => {
      const [low, high] = extremes([series]);
      return `${series.name} from ${low.toPrecision(3)} to ${high.toPrecision(3)} ${this.options.unit}`;
    });
    this.overlay.setAttribute("aria-label", `${this.options.label} over time: ${texts.join(", ")}`);
  }

  // Whoever draws measures first: asking the page for a size takes longer than drawing a sample.
  measure() {
    this.width = this.base.clientWidth;
    this.height = this.base.clientHeight;
  }

  x(t, view) {
    const width = this.width - kMargin.left - kMargin.right;
    return kMargin.left + width * (t - view.low) / (view.high - view.low);
  }

  t(x, view) {
    this.measure();
    const width = this.width - kMargin.left - kMargin.right;
    return view.low + (view.high - view.low) * (x - kMargin.left) / width;
  }

  y(value) {
    const height = this.height - kMargin.top - kMargin.bottom;
    return kMargin.top + height * (this.range[1] - value) / (this.range[1] - this.range[0]);
  }

  draw(view) {
    const {context, width, height} = prepare(this.base, 2);  // fine enough for paper
    if (width === 0) return;
    this.measure();
    const {left_out = [], contacts = []} = this.options;
    for (const span of left_out) this.fillSpan(context, span, view, "left-out", 1, 3);
    for (const span of contacts) this.fillSpan(context, span, view, "contact", 0.35, 2);
    this.drawAxes(context, width, height, view);
    context.save();
    context.beginPath();
    context.rect(kMargin.left, kMargin.top, width - kMargin.left - kMargin.right, height - kMargin.top - kMargin.bottom);
    context.clip();
    this.drawBand(context, view);
    for (const series of this.shown()) this.drawSeries(context, series, view);
    context.restore();
  }

  drawAxes(context, width, height, view) {
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = themeColor("soft");
    context.strokeStyle = themeColor("grid");
    context.lineWidth = 1;
    const vertical = ticks(this.range[0], this.range[1], height / 26);
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const value of vertical.values) {
      const y = Math.round(this.y(value)) + 0.5;
      strokeLine(context, kMargin.left, y, width - kMargin.right, y);
      context.fillText(short(value, vertical.digits), kMargin.left - 5, y);
    }
    const horizontal = ticks(view.low, view.high, width / 80);
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const value of horizontal.values) {
      const x = Math.round(this.x(value, view)) + 0.5;
      strokeLine(context, x, kMargin.top, x, height - kMargin.bottom);
      context.fillText(`${value.toFixed(horizontal.digits)} s`, x, height - kMargin.bottom + 4);
    }
    context.textAlign = "left";
    context.textBaseline = "alphabetic";
    context.font = "600 12px system-ui, sans-serif";
    context.fillStyle = themeColor("ink");
    context.fillText(`${this.options.label} [${this.options.unit}]${this.cut}`, kMargin.left, 12, width - kMargin.left);
  }

  // Fills the plot between two times, at least `least` pixels wide.
  fillSpan(context, [from, to], view, name, alpha, least = 0) {
    if (to < view.low || from > view.high) return;
    const left = Math.max(this.x(from, view), kMargin.left), bottom = this.height - kMargin.bottom;
    const right = Math.min(Math.max(this.x(to, view), left + least), this.width - kMargin.right);
    // A few samples that were left out are a mark on the axis: many of them would look like a grid.
    const top = name === "left-out" && right - left <= least ? bottom - 7 : kMargin.top;
    context.fillStyle = themeColor(name);
    context.globalAlpha = alpha;
    context.fillRect(left, top, right - left, bottom - top);
    context.globalAlpha = 1;
  }

  drawBand(context, view) {
    const about = this.options.series.find((series) => series.style === "computed");
    context.fillStyle = themeColor("computed");
    context.globalAlpha = 0.18;
    for (const {from, to, half} of this.options.band || []) {
      if (to < view.low || from > view.high) continue;
      const edge = [[from, 0], [to, 0]];  // of errors; else about the computed curve
      if (about) {
        const first = indexAt(about.time, Math.max(from, view.low));
        const last = indexAt(about.time, Math.min(to, view.high)) + 1;
        edge.splice(0, 2, ...Array.from(about.time.slice(first, last + 1), (t, i) => [t, about.values[first + i]]));
      }
      context.beginPath();
      for (const [t, value] of edge) context.lineTo(this.x(t, view), this.y(value + half));
      for (const [t, value] of edge.reverse()) context.lineTo(this.x(t, view), this.y(value - half));
      context.fill();
    }
    context.globalAlpha = 1;
  }

  drawSeries(context, series, view) {
    context.strokeStyle = themeColor(series.style);
    context.lineWidth = kWidths[series.style] || kOtherWidth;
    context.lineJoin = "round";
    context.beginPath();
    const {time, values} = series;
    const first = indexAt(time, view.low);
    const last = Math.min(time.length - 1, indexAt(time, view.high) + 1);
    for (let i = first; i <= last; ++i) context.lineTo(this.x(time[i], view), this.y(values[i]));
    context.stroke();
  }

  // The cursor; the values at the place that is pointed at, or else at the cursor.
  drawOverlay(view, cursor, pointed, selection) {
    const {context, width, height} = prepare(this.overlay, 1);
    if (width === 0) return;
    this.measure();
    if (selection) this.fillSpan(context, selection, view, "error", 0.15);
    context.lineWidth = 1.5;
    for (const [t, name] of [[cursor, "cursor"], [pointed, "soft"]]) {
      const x = this.x(t, view);
      if (t === null || x < kMargin.left || x > width - kMargin.right) continue;
      context.strokeStyle = themeColor(name);
      strokeLine(context, x, kMargin.top, x, height - kMargin.bottom);
    }
    this.drawValues(context, view, pointed === null ? cursor : pointed);
  }

  // A box beside the place: the time, and the value of each series beside a piece of its line.
  drawValues(context, view, t) {
    const x = this.x(t, view);
    if (t === view.low || x < kMargin.left || x > this.width - kMargin.right) return;
    context.font = "11px system-ui, sans-serif";
    const rows = [{text: `${t.toFixed(2)} s`}, ...this.shown().reverse().map((series) => ({
      style: series.style, text: short(series.values[indexAt(series.time, t)], 3)}))];
    const width = Math.max(...rows.map((row) => context.measureText(row.text).width)) + 27;
    const height = 14 * rows.length + 4;
    const left = Math.round(x + 6 + width < this.width - kMargin.right ? x + 6 : x - 6 - width) + 0.5;
    context.fillStyle = themeColor("paper");
    context.strokeStyle = themeColor("line");
    context.lineWidth = 1;
    context.fillRect(left, kMargin.top + 0.5, width, height);
    context.strokeRect(left, kMargin.top + 0.5, width, height);
    rows.forEach(({style, text}, i) => {
      const y = kMargin.top + 13 + 14 * i, thick = kWidths[style] || kOtherWidth;
      context.fillStyle = themeColor("ink");
      context.fillText(text, left + (style ? 20 : 5), y);
      if (!style) return;
      context.fillStyle = themeColor(style);
      context.fillRect(left + 5, y - 4 - thick / 2, 10, thick);
    });
  }
}

function createPlotGroup(time, {onCursor}) {
  const everything = {low: time[0], high: time[time.length - 1]};
  if (!(everything.high > everything.low)) everything.high = everything.low + 1;
  const view = {...everything};
  const plots = [];
  let cursor = time[0];
  let pointed = null, selection = null;

  const drawOverlays = () => plots.forEach((plot) => plot.drawOverlay(view, cursor, pointed, selection));
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
    const point = (t) => {
      pointed = t;
      drawOverlays();
    };
    plot.overlay.addEventListener("pointerdown", (event) => {
      if (event.pointerType === "touch") return onCursor(at(event));
      start = at(event);
      start_view = event.shiftKey ? {...view} : null;
      plot.overlay.setPointerCapture(event.pointerId);
    });
    plot.overlay.addEventListener("pointermove", (event) => {
      if (event.pointerType === "touch") onCursor(at(event));
      else if (start_view) {
        const shift = plot.t(event.offsetX, start_view) - start;
        setView(start_view.low - shift, start_view.high - shift);
      } else {
        if (start !== null) selection = [start, at(event)].sort((a, b) => a - b);
        point(at(event));
      }
    });
    plot.overlay.addEventListener("pointerleave", () => point(null));
    plot.overlay.addEventListener("pointerup", (event) => {
      if (start === null) return;
      const chosen = selection, panned = start_view;
      start = start_view = selection = null;
      if (panned) return;
      if (chosen && plot.x(chosen[1], view) - plot.x(chosen[0], view) > 4) setView(...chosen);
      else onCursor(at(event));
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
        plot.describe();
      }
      drawAll();
    },
    showAll: () => setView(everything.low, everything.high),
    pan: (share) => setView(view.low + share * (view.high - view.low), view.high + share * (view.high - view.low)),
  };
}
