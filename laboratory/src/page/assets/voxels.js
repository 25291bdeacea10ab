"use strict";
// How voxelizers do: charts, the table of all records, and how times grow beside what papers say. `scaling`: exponents of each.
const voxelSection = (function () {
  const { h, caption, longList, table, sortedBy, number, percent, bytes, quartiles, shortName, style, chart } = lumivox;

  // Published times between the first and the last row of a table, of which only the growth is shown.
  // Mavridis & Papaioannou 2011, Table 1: 64^3 voxels, from the scene with the fewest triangles whose time is lowest (arena) to the one
  // with the most (sponza). Thiedemann et al. 2011: grids of N^2 x 128 voxels; the vertices grow with them, from 15 000 on.
  const mavridis = "Mavridis & Papaioannou 2011, Table 1", thiedemann = "Thiedemann et al. 2011";
  const published = [
    { source: mavridis, method: "3 points a triangle", over: "triangles", x: [10219, 262267], ms: [2, 22] },
    { source: mavridis, method: "7 points a triangle", over: "triangles", x: [10219, 262267], ms: [4, 52] },
    { source: mavridis, method: "12 points a triangle", over: "triangles", x: [10219, 262267], ms: [5, 86] },
    { source: mavridis, method: "19 points a triangle", over: "triangles", x: [10219, 262267], ms: [7, 125] },
    { source: mavridis, method: "sponza, 3 to 19 points a triangle", over: "points", x: [3, 19], ms: [22, 125] },
    { source: thiedemann, method: "atlas, binary", over: "voxels along a side", x: [64, 512], ms: [0.52, 3.37] },
    { source: thiedemann, method: "atlas, binary", over: "vertices", x: [15e3, 791e3], ms: [0.52, 3.37] },
    { source: thiedemann, method: "atlas, multi-valued", over: "voxels along a side", x: [64, 256], ms: [1.23, 4.29] },
    { source: thiedemann, method: "atlas, multi-valued", over: "vertices", x: [15e3, 285e3], ms: [1.23, 4.29] }];
  const exponent = ({ x, ms }) => Math.log(ms[1] / ms[0]) / Math.log(x[1] / x[0]);

  // Mavridis & Papaioannou 2011, Table 1: ms with 3, 7, 12 and 19 points a triangle; and that of the reprojection of 512^2 points.
  const pointTimes = [
    { scene: "sponza", triangles: 262267, ms: [22, 52, 86, 125], reprojection: 0.7 },
    { scene: "knossos", triangles: 109168, ms: [11, 22, 35, 55], reprojection: 0.7 },
    { scene: "arena", triangles: 10219, ms: [2, 4, 5, 7], reprojection: 0.7 },
    { scene: "room", triangles: 8760, ms: [4, 5.4, 8, 10], reprojection: 0.7 }];

  const axes = {
    recall: { of: record => record.frame_ms.median, value: record => record.recall, title: "time, ms", other: "recall" },
    resolution: { of: record => record.resolution, value: record => record.frame_ms.median, title: "voxels along a side", other: "time, ms" },
    triangles: { of: record => record.triangles, value: record => record.frame_ms.median, title: "triangles", other: "time, ms" } };

  function configuration(records, kind) {
    const axis = axes[kind], first = records.length ? records[0].resolution : 0;
    const series = new Map();
    for (const record of records) {
      if (kind !== "triangles" && record.subdivisions > 0) continue;
      if (kind === "triangles" && record.resolution !== first) continue;
      if (kind !== "recall" && !record.default) continue;
      const key = kind === "recall" ? shortName(record.pipeline) : record.label;
      if (!series.has(key)) series.set(key, { record, label: key, data: [] });
      series.get(key).data.push({ x: axis.of(record), y: axis.value(record),
        text: record.label + ", resolution " + record.resolution + ", " + record.triangles + " triangles" });
    }
    const datasets = [...series.values()].map(one => {
      const { colour, shape } = style(one.record.pipeline);
      return { label: one.label, data: one.data.sort((a, b) => a.x - b.x), showLine: kind !== "recall", borderWidth: 1.5,
               pointRadius: 5, pointStyle: shape, borderColor: colour, backgroundColor: colour };
    });
    return {
      type: "scatter", data: { datasets },
      options: {
        animation: false, maintainAspectRatio: false,
        scales: {
          x: { type: "logarithmic", title: { display: true, text: axis.title } },
          y: kind === "recall" ? { min: 0, max: 1.02, title: { display: true, text: axis.other } }
                               : { type: "logarithmic", title: { display: true, text: axis.other } } },
        plugins: {
          legend: { position: "bottom", labels: { boxWidth: 14, font: { size: 11 }, usePointStyle: true } },
          tooltip: { callbacks: { label: item => item.raw.text + ": " + number(item.raw.x) + ", " + lumivox.significant(item.raw.y, 4) } } } } };
  }

  function results(records) {
    const less = ["Triangles", "Fragments", "Bytes per fragment", "Bytes per voxel"];
    const titles = [["Scene"], ["Voxelizer", "wide"], ...["Resolution", "Triangles", "Time, ms", "Occupied", "Recall", "Precision",
      "Holes, axis rays", "Holes, oblique rays", "Fragments", "Output", "Bytes per fragment", "Bytes per voxel", "All memory"]
      .map(title => [title, "number", less.includes(title)])];
    const missing = records.filter(record => record.why_not);
    return [
      table(titles.map(([title, kind, hidden]) => ({ title, kind, hidden })), records.filter(record => !record.why_not).map(record => ({
        kind: record.default ? "default" : "", pipeline: record.pipeline, isDefault: record.default, cells: [
          shortName(record.scene), record.label, record.resolution, record.triangles, sortedBy(record.frame_ms.median, quartiles(record.frame_ms)), record.occupied,
          record.recall.toFixed(4), record.precision.toFixed(4), percent(record.axis_share), percent(record.oblique_share),
          record.fragments || "-", sortedBy(record.bytes, bytes(record.bytes)), record.fragments ? number(record.bytes_per_fragment) : "-",
          number(record.bytes_per_voxel), sortedBy(record.allocated_bytes, bytes(record.allocated_bytes))] }))),
      missing.length > 0 && longList("Not measured", missing.map(record =>
        record.label + ", resolution " + record.resolution + ", " + record.triangles + " triangles: " + record.why_not), "record")];
  }

  function growth(scaling) {
    const here = scaling.flatMap(one => [["voxels along a side", one.with_resolution], ["triangles", one.with_triangles]]
      .filter(([, value]) => value !== undefined)
      .map(([over, value]) => ({ kind: "default", cells: ["here, " + shortName(one.scene), one.label, over, number(value)] })));
    return [
      h("h3", null, "Growth, published and here"),
      caption("The exponent p of a power law, time ~ x^p: 1 is proportional; for a surface in a grid, voxels along a side have the exponent 2 "
        + "where the time is that of the voxels it fills. Published: between the first and last row of a table. Here: least squares through "
        + "the medians; triangles by splitting each into four, which leaves the surface and its voxels as they are."),
      table([{ title: "Source" }, { title: "Voxelizer", kind: "wide" }, { title: "Time grows with" }, { title: "Exponent", kind: "number" }],
            [...published.map(one => [one.source, one.method, one.over, number(exponent(one))]), ...here]),
      caption("Mavridis & Papaioannou 2011, Table 1, as ratios to the time with 19 points a triangle. Ours with other numbers of points are rows "
        + "of the table above."),
      table([{ title: "Scene" }, ...["Triangles", "3 points", "7 points", "12 points", "19 points", "Reprojection"]
               .map(title => ({ title, kind: "number" }))],
            pointTimes.map(row => [row.scene, row.triangles, ...row.ms.map(ms => number(ms / row.ms[3])), number(row.reprojection / row.ms[3])]))];
  }

  return function (records, scaling) {
    const scenes = [...new Set(records.map(record => record.scene))].sort();
    const figure = (scene, kind, title) => {
      const own = records.filter(record => !record.why_not && record.scene === scene);
      const places = new Set(configuration(own, kind).data.datasets.flatMap(set => set.data).map(point => point.x));
      if (places.size === 1)
        return h("p", null, title + ": not drawn, since all points have the same " + axes[kind].title + ", " + [...places][0] + ".");
      return h("figure", null, h("h4", null, title),
               chart(() => configuration(own, kind), { "data-voxels": kind, "data-scene": scene }, title + ": " + axes[kind].other + " against " + axes[kind].title).frame);
    };
    return [
      caption("Every voxelizer against the exact test of triangles and boxes. Recall: share of the touched voxels that are occupied. Precision: "
        + "share of the occupied voxels that are touched. Holes: share of the crossings of straight rays with the surface at which the ray "
        + "meets no occupied voxel within a voxel and a half. Time: a frame in which everything that the output needs is made anew, median "
        + "[quartiles]."),
      h("h3", null, "Recall against time"),
      h("div", { class: "charts" }, scenes.map(scene => figure(scene, "recall", shortName(scene)))),
      scaling.length > 0 && [
        h("h3", null, "Time against resolution and triangles"),
        h("div", { class: "charts" }, scenes.map(scene => ["resolution", "triangles"].map(kind => figure(scene, kind, shortName(scene) + ", " + kind))))],
      results(records), growth(scaling)];
  };
})();
