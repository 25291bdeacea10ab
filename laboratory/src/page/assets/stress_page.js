"use strict";
(function () {
  const { data, h, show } = lumivox;
  const distinct = values => [...new Set(values.filter(value => value !== ""))].sort();
  const devices = distinct(data.cells.map(cell => cell.device)), dates = distinct(data.cells.map(cell => cell.created.slice(0, 10)));
  const period = dates.length < 2 ? dates.join("") : dates[0] + " to " + dates[dates.length - 1];
  document.body.className = "battery";
  show(
    h("header", null, h("h1", null, "Lumivox stress battery"),
      h("p", { class: "soft" }, data.cells.length + " cells on " + devices.join("; ") + ", " + period,
        data.command && [", by ", h("code", null, data.command)], ". The same numbers are in index.json beside this page.")),
    h("main", null, h("h2", { id: "stress" }, "Where each technique breaks"), stressSection(data.cells, "images")));
})();
