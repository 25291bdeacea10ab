"use strict";
// Plots as SVG, for papers: pure functions from a configuration of Chart.js to a text, on white, with the names of axes and, at points on
// the front, those of the points.
const plots = (function () {
  const width = 760, height = 480, left = 70, right = 24, top = 20, letter = 12, radius = 5;
  const ink = "#1d2430", grid = "#dfe4ea";

  /** The shapes of points within a square of 14. */
  const outlines = { circle: "M7 2a5 5 0 1 0 .01 0z", triangle: "M7 2l5.5 9.5h-11z", rect: "M2.5 2.5h9v9h-9z", rectRot: "M7 1l6 6-6 6-6-6z",
                     star: "M6 1h2v5h5v2h-5v5h-2v-5h-5v-2h5z" };
  const escaped = text => String(text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;").replace(/"/g, "&quot;");
  const rounded = value => String(Math.round(10 * value) / 10);
  /** About as wide as a text is in a sans serif of that size. */
  const widthOf = (text, size) => 0.56 * size * text.length;
  const element = (tag, attributes, content) => "<" + tag + Object.entries(attributes).map(([name, value]) =>
    " " + name + "=\"" + escaped(typeof value === "number" ? rounded(value) : value) + "\"").join("")
    + (content === undefined ? "/>" : ">" + content + "</" + tag + ">");
  const line = (x1, y1, x2, y2, colour, wide) => element("line", { x1, y1, x2, y2, stroke: colour, "stroke-width": wide || 1 });
  const text = (x, y, words, attributes) => element("text", { x, y, ...attributes }, escaped(words));

  /** Where an axis begins and ends: as it says, else a little beyond the values. */
  function endsOf(axis, values) {
    const isLog = axis.type === "logarithmic", shown = values.filter(value => Number.isFinite(value) && (!isLog || value > 0));
    const low = Math.min(...shown), high = Math.max(...shown), space = isLog ? Math.pow(high / low, 0.05) || 1 : 0.05 * (high - low);
    const ends = [axis.min ?? (isLog ? low / space : low - space), axis.max ?? (isLog ? high * space : high + space)];
    if (ends[0] < ends[1]) return ends;
    return isLog ? [ends[0] / 2, ends[1] * 2] : [ends[0] - 1, ends[1] + 1];
  }

  /** The numbers at an axis: 1, 2 and 5 times powers of ten within its ends. */
  function ticksOf(isLog, [low, high]) {
    const ticks = [];
    if (isLog && high >= 3 * low) {
      const parts = high > 1e3 * low ? [1] : [1, 2, 5];
      for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); ++power)
        for (const part of parts) ticks.push(Number((part * Math.pow(10, power)).toPrecision(1)));
    } else {
      const least = (high - low) / 7, power = Math.pow(10, Math.floor(Math.log10(least)));
      const step = [1, 2, 5, 10].map(part => part * power).find(one => one >= least);
      for (let index = Math.ceil(low / step); index * step <= high; ++index) ticks.push(Number((index * step).toPrecision(10)));
    }
    return ticks.filter(tick => tick >= low && tick <= high);
  }

  /** From values of an axis to places in the picture. */
  function placesOf(isLog, ends, from, to) {
    const of = isLog ? Math.log : value => value;
    return value => from + (to - from) * (of(value) - of(ends[0])) / (of(ends[1]) - of(ends[0]));
  }

  /** Where the names of points stand: one after the other each takes the first of eight places around its point at which it meets no
   *  point, no earlier name and no border, or the place where it meets least. `points`: { x, y, name }, without a name where a point only
   *  takes room; gives { x, y, name }, the left end of each base line. `wideOf`: the width of a name; `onlyClear`: a name that would meet
   *  something stands nowhere. */
  function placeNames(points, area, size, { wideOf = name => widthOf(name, size), onlyClear = false } = {}) {
    const boxes = points.map(({ x, y }) => ({ left: x - radius, right: x + radius, top: y - radius, bottom: y + radius }));
    const common = (a, b) => Math.max(0, Math.min(a.right, b.right) - Math.max(a.left, b.left))
      * Math.max(0, Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));
    return points.filter(point => point.name).flatMap(({ x, y, name }) => {
      const wide = wideOf(name), gap = radius + 3;
      // To the upper right first: fronts fall, so that their lines are seldom there.
      const beside = [[gap, -gap], [-gap - wide, gap + size], [gap, size / 3], [-gap - wide, size / 3], [-wide / 2, -gap], [-wide / 2, gap + size],
                      [gap, gap + size], [-gap - wide, -gap]];
      let best = null;
      for (const [dx, dy] of beside) {
        const box = { left: x + dx, right: x + dx + wide, top: y + dy - size, bottom: y + dy + 2 };
        const beyond = wide * (size + 2) - common(box, area);
        const met = boxes.reduce((sum, other) => sum + common(box, other), 0) + Math.max(0, beyond);
        if (best === null || met < best.met - 0.5) best = { box, met };
      }
      if (onlyClear && best.met > 0.5) return [];
      boxes.push(best.box);
      return [{ x: best.box.left, y: best.box.bottom - 2, name }];
    });
  }

  /** Lines of keys, each with its place from the left and its line. */
  function legendOf(datasets) {
    let x = left, row = 0;
    return datasets.map(set => {
      const wide = widthOf(set.label, letter) + 34;
      if (x > left && x + wide > width - right) { x = left; ++row; }
      const key = { set, x, row };
      x += wide;
      return key;
    });
  }

  const shape = (kind, name, x, y, colour, fill) => element("path", {
    d: outlines[name] || outlines.circle, transform: "translate(" + rounded(x - 7) + " " + rounded(y - 7) + ")", class: kind, stroke: colour,
    "stroke-width": "1.5", fill });

  /** The SVG of a configuration of a scatter chart; null: it has no points. */
  function svgOf({ data: { datasets }, options: { scales } }) {
    const points = datasets.flatMap(set => set.data), keys = legendOf(datasets);
    if (points.length === 0) return null;
    const legendHeight = 18 * (1 + keys[keys.length - 1].row), bottom = height - 48, isLog = axis => axis.type === "logarithmic";
    const ends = { x: endsOf(scales.x, points.map(point => point.x)), y: endsOf(scales.y, points.map(point => point.y)) };
    const at = { x: placesOf(isLog(scales.x), ends.x, left, width - right), y: placesOf(isLog(scales.y), ends.y, bottom, top) };
    const area = { left, right: width - right, top, bottom }, parts = [], within = [], named = [];

    for (const tick of ticksOf(isLog(scales.x), ends.x))
      parts.push(line(at.x(tick), top, at.x(tick), bottom, grid), text(at.x(tick), bottom + 16, tick, { "text-anchor": "middle" }));
    for (const tick of ticksOf(isLog(scales.y), ends.y))
      parts.push(line(left, at.y(tick), width - right, at.y(tick), grid), text(left - 6, at.y(tick) + 4, tick, { "text-anchor": "end" }));
    parts.push(line(left, bottom, width - right, bottom, ink), line(left, top, left, bottom, ink));
    parts.push(text((left + width - right) / 2, bottom + 36, scales.x.title.text, { class: "axis", "text-anchor": "middle" }));
    parts.push(text(0, 0, scales.y.title.text, { class: "axis", "text-anchor": "middle",
                                                 transform: "translate(16 " + rounded((top + bottom) / 2) + ") rotate(-90)" }));

    // What is broad and has no points lies below everything.
    for (const set of [...datasets].sort((a, b) => (b.borderWidth || 0) - (a.borderWidth || 0))) {
      set.data.forEach((point, index) => {
        const x = at.x(point.x), y = at.y(point.y), before = index > 0 && set.showLine ? set.data[index - 1] : null;
        const joined = before && !(set.segment && set.segment.borderColor({ p1DataIndex: index }) === "transparent");
        const path = joined && "M" + rounded(at.x(before.x)) + " " + rounded(at.y(before.y)) + (set.stepped ? "H" : "L") + rounded(x)
          + (set.stepped ? "V" : " ") + rounded(y);
        if (path) within.push(element("path", { d: path, fill: "none", stroke: set.borderColor, "stroke-width": String(set.borderWidth || 1) }));
        if (set.bars && point.low < point.high) within.push(line(at.x(point.low), y, at.x(point.high), y, set.borderColor));
        if (set.bars && point.uncertainty > 0)
          within.push(line(x, at.y(point.y + point.uncertainty), x,
                           point.y > point.uncertainty ? at.y(point.y - point.uncertainty) : bottom, set.borderColor));
      });
      if (set.pointRadius === 0) continue;
      set.data.forEach((point, index) => {
        const x = at.x(point.x), y = at.y(point.y), fill = (set.pointBackgroundColor || [])[index] || set.backgroundColor;
        within.push(shape("point", set.pointStyle, x, y, set.borderColor, fill));
        named.push({ x, y, name: point.name });
      });
    }
    const names = placeNames(named, area, 11).map(one => text(one.x, one.y, one.name, { class: "name", "font-size": "11" }));
    const legend = keys.map(({ set, x, row }) => {
      const y = height + 6 + 18 * row;
      return (set.pointRadius === 0 ? line(x, y, x + 14, y, set.borderColor, set.borderWidth)
                                    : shape("key", set.pointStyle, x + 7, y, set.borderColor, set.backgroundColor))
        + text(x + 20, y + 4, set.label, { class: "legend" });
    });
    const whole = height + legendHeight;
    return element("svg", { xmlns: "http://www.w3.org/2000/svg", viewBox: "0 0 " + width + " " + whole, width: String(width), height: String(whole),
                            "font-family": "Helvetica, Arial, sans-serif", "font-size": String(letter), fill: ink },
      element("rect", { width: String(width), height: String(whole), fill: "#ffffff" }) + parts.join("")
        + element("clipPath", { id: "area" }, element("rect", { x: left, y: top, width: width - right - left, height: bottom - top }))
        + element("g", { "clip-path": "url(#area)" }, within.join("")) + names.join("") + legend.join(""));
  }

  return { outlines, ticksOf, placeNames, svgOf };
})();
