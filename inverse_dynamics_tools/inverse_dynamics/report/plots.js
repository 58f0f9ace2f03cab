// SPDX-License-Identifier: Apache-2.0
//
// Time series on a canvas: zoom and pan in time shared by a group of plots, a cursor on a canvas of its own.
//
//   const group = createPlotGroup(time, {onCursor: (t) => ...});
//   group.add(element, {label: "elbow_joint", unit: "N m", series: [{name, time, values, style: "measured"}]});
//   group.setCursor(1.5);
//   group.setHidden("URDF", true);
//
// time: s, increasing, of a series as many as its values. A series may be hidden at first. band: [{about, from, to, half}]:
// half the width of a band about the series of that name, or about zero where there is `error`. left_out: [[from, to]],
// shaded. Colours are those of the page's CSS variables. Dragging zooms, shift and dragging pans, a click sets
// the cursor, a double click shows everything.
"use strict";

// Measured is wide and below the computed line, so that both are visible where many samples share a pixel.
const kWidths = {measured: 2.2, computed: 1.3, error: 1.1, other0: 1.2, other1: 1.2, other2: 1.2};

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

// Magnitude beyond which an error is a spike that would flatten the rest: 1.5 times the 99.5 % quantile.
function spikeLimit(all_series) {
  const magnitudes = all_series.flatMap((series) => Array.from(series.values, Math.abs)).sort((a, b) => a - b);
  return 1.5 * magnitudes[Math.floor(0.995 * (magnitudes.length - 1))] || Infinity;
}

function range(all_series, {error = all_series.every((series) => series.style === "error"), band} = {}) {
  let [low, high] = extremes(all_series);
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
    this.range = range(this.shown(), this.options);
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
    this.drawAxes(context, width, height, view);
    context.save();
    context.beginPath();
    context.rect(kMargin.left, kMargin.top, width - kMargin.left - kMargin.right, height - kMargin.top - kMargin.bottom);
    context.clip();
    for (const span of this.options.left_out || []) this.fillSpan(context, span, view, "measured", 0.28, 1);
    this.drawBand(context, view);
    for (const series of this.shown()) this.drawSeries(context, series, width, view);
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
    const title = `${this.options.label} [${this.options.unit}]`;
    context.fillText(title, kMargin.left, 12);
    this.title_end = kMargin.left + context.measureText(title).width;
  }

  // Fills the plot between two times, at least `least` pixels wide.
  fillSpan(context, [from, to], view, name, alpha, least = 0) {
    const x = this.x(from, view), height = this.height - kMargin.top - kMargin.bottom;
    context.fillStyle = themeColor(name);
    context.globalAlpha = alpha;
    context.fillRect(x, kMargin.top, Math.max(least, this.x(to, view) - x), height);
    context.globalAlpha = 1;
  }

  drawBand(context, view) {
    const about = this.options.series.find((series) => series.name === "computed");
    context.fillStyle = themeColor("computed");
    context.globalAlpha = 0.18;
    for (const {from, to, half} of this.options.band || []) {
      if (to < view.low || from > view.high) continue;
      const edge = [[from, 0], [to, 0]];  // of errors; else about the computed curve
      if (!this.options.error) {
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

  drawSeries(context, series, width, view) {
    context.strokeStyle = themeColor(series.style);
    context.lineWidth = kWidths[series.style];
    context.lineJoin = "round";
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
  }

  // More samples than pixels: from each column of pixels its first, least, greatest and last value in the order of
  // time. That covers the pixels that a line through all samples covers.
  traceColumns(context, {time, values}, first, last, view) {
    let begin = first;
    while (begin <= last) {
      const column = Math.round(this.x(time[begin], view));
      let low = begin, high = begin, end = begin;
      for (; end <= last && Math.round(this.x(time[end], view)) === column; ++end) {
        if (values[end] < values[low]) low = end;
        if (values[end] > values[high]) high = end;
      }
      for (const i of [begin, Math.min(low, high), Math.max(low, high), end - 1]) context.lineTo(column, this.y(values[i]));
      begin = end;
    }
  }

  drawOverlay(view, cursor, selection) {
    const {context, width, height} = prepare(this.overlay, 1);
    if (width === 0) return;
    this.measure();
    if (selection) this.fillSpan(context, selection, view, "error", 0.15);
    const x = this.x(cursor, view);
    if (x >= kMargin.left && x <= width - kMargin.right) {
      context.strokeStyle = themeColor("cursor");
      context.lineWidth = 1.5;
      strokeLine(context, x, kMargin.top, x, height - kMargin.bottom);
    }
    this.drawReadout(context, width, cursor);
  }

  // Values at the cursor, each beside a piece of its line: with their names, without them where these would touch the
  // title, or none.
  drawReadout(context, width, cursor) {
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "right";
    const all = this.shown().reverse();
    const values = all.map((series) => short(series.values[indexAt(series.time, cursor)], 3));
    const named = values.map((value, i) => `${all[i].name} ${value}`);
    const length = (texts) => texts.reduce((sum, text) => sum + context.measureText(text).width + 26, 0);
    const room = width - kMargin.right - this.title_end;
    const texts = [named, values, []].find((candidate) => length(candidate) <= room) || [];
    let x = width - kMargin.right;
    texts.forEach((text, i) => {
      context.fillStyle = themeColor("ink");
      context.fillText(text, x, 12);
      x -= context.measureText(text).width;
      context.fillStyle = themeColor(all[i].style);
      context.fillRect(x - 13, 8.5 - kWidths[all[i].style] / 2, 9, kWidths[all[i].style]);
      x -= 26;
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
        plot.describe();
      }
      drawAll();
    },
    showAll: () => setView(everything.low, everything.high),
    pan: (share) => setView(view.low + share * (view.high - view.low), view.high + share * (view.high - view.low)),
  };
}
