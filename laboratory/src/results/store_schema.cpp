#include "results/store_schema.h"

#include <fmt/format.h>

#include <vector>

#include "results/fields.h"

namespace lumivox::results {
namespace {

struct Column {
  std::string name, definition;  ///< of a table: type and constraints; of a view: the expression
  std::string about{};           ///< empty: the sentence of the next column is about this one too
};
using Columns = std::vector<Column>;

struct Table {
  const char* name;
  const char* about;
  Columns columns;
  std::string rest;  ///< of a table: further constraints; of a view: what it is read from
  bool isView = false;
  const char* options = "";
};

/// A field of a record within JSON: type and expression.
struct Place {
  std::string name, type, sql, about;
};

template <class M>
const char* typeOf() {
  return std::floating_point<M> ? "REAL" : std::is_arithmetic_v<M> ? "INTEGER" : "TEXT";
}

/// The fields of T that are one value each, from the JSON object at `path` of `json`. Lists are views of
/// their own.
template <class T>
void addPlaces(std::vector<Place>& places, const std::string& json, const std::string& path,
               const char* suffix = "") {
  T record;
  fields(record, [&]<class M>(const Field& field, M&&) {
    using Member = std::remove_cvref_t<M>;
    [[maybe_unused]] const std::string about = field.about == nullptr ? "" : field.about;
    [[maybe_unused]] const auto add = [&](const std::string& name, const std::string& at,
                                          const std::string& told) {
      places.push_back(
          {name, typeOf<Member>(), fmt::format("json_extract({}, '{}.{}')", json, path, at), told});
    };
    if constexpr (std::same_as<Member, RunIdentity> || std::same_as<Member, RayHoles>) {
      addPlaces<Member>(places, json, path + "." + field.name);
    } else if constexpr (std::same_as<Member, glm::ivec3>) {
      add("width", field.name + std::string("[0]"), "");
      add("height", field.name + std::string("[1]"), "");
      add("depth", field.name + std::string("[2]"), about);
    } else if constexpr (std::same_as<Member, double>) {
      add(field.column + std::string(suffix), field.name + std::string(suffix), about);
    } else if constexpr (std::is_arithmetic_v<Member> || std::same_as<Member, std::string> ||
                         std::same_as<Member, StressOutcome> || std::same_as<Member, Against<bool>>) {
      add(field.column, field.name, about);
    }
  });
}

/// Columns of a view.
template <class T>
Columns viewColumns(Columns columns, const std::string& json, const std::string& path = "$",
                    const char* suffix = "") {
  std::vector<Place> places;
  addPlaces<T>(places, json, path, suffix);
  for (const Place& place : places) columns.push_back({place.name, place.sql, place.about});
  return columns;
}

/// A table of records: each column but the first ones is read from the JSON.
template <class T>
Columns recordColumns(const char* key, const char* command) {
  Columns columns{{"id", "INTEGER PRIMARY KEY"}, {"key", "TEXT NOT NULL UNIQUE", key}};
  if (std::same_as<T, StoredRun>)
    columns.push_back(
        {"complete", "INTEGER NOT NULL",
         "0 where an unfinished batch has left errors, images and work of a point, but no times; such a run is no result"});
  std::vector<Place> places;
  addPlaces<T>(places, "record", "$");
  for (const Place& place : places)
    columns.push_back(
        {place.name, fmt::format("{} GENERATED ALWAYS AS ({}) VIRTUAL", place.type, place.sql), place.about});
  columns.push_back(
      {"record", "TEXT NOT NULL", fmt::format("all of it as JSON, as `{}` writes it", command)});
  return columns;
}

Columns timesColumns(Columns columns) {
  for (const char* name : {"median_ms", "lower_quartile_ms", "upper_quartile_ms"})
    columns.push_back({name, "REAL NOT NULL"});
  columns.push_back({"repeats", "INTEGER NOT NULL", "as in `timings`"});
  return columns;
}

std::vector<Table> tables() {
  const Columns run{{"run", "r.id"}};
  const auto with = [](Columns columns, const Columns& more) {
    columns.insert(columns.end(), more.begin(), more.end());
    return columns;
  };
  const auto ofRun = [](const char* list, const char* name) {
    return fmt::format("runs r, json_each(r.record, '$.{}') {}", list, name);
  };
  const Column ownRun{"run", "INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE"};
  const auto process = [](const char* about) {
    return Columns{{"machine", "TEXT NOT NULL"},
                   {"process", "INTEGER NOT NULL"},
                   {"started", "INTEGER NOT NULL"},
                   {"command", "TEXT NOT NULL", about},
                   {"expires", "INTEGER NOT NULL", "until when, s since 1970"}};
  };
  return {
      {"runs", "one row for each measured point",
       recordColumns<StoredRun>("number of the run in this store; what makes it unique, see above",
                                "results export --format json"),
       ""},
      {"parameters", "all parameters of the pipeline, as `--set` reads them",
       with(run, {{"name", "p.key"}, {"value", "p.value", "of which run; as text"}}),
       ofRun("identity.parameters", "p"), true},
      {"provenance",
       "what a run was made from",
       {{"run", "id"},
        {"kind", "'scene'"},
        {"name", "scene"},
        {"hash", "scene_hash",
         "kind: scene, pipeline, technique (library+shaders), framework; without a hash: flicker (over how many pairs of frames), kept (an "
         "output that stayed alive though no image needs it), display (an exposure or tone curve that was asked for), not_counted (why the "
         "work of the passes was not counted)"}},
       "runs UNION ALL SELECT id, 'pipeline', pipeline, pipeline_hash FROM runs UNION ALL SELECT id, 'framework', 'lumivox', framework FROM "
       "runs UNION ALL SELECT id, 'flicker', flicker_pairs || ' pairs', '' FROM runs WHERE flicker_pairs > 0 UNION ALL SELECT id, "
       "'not_counted', not_counted, '' FROM runs WHERE not_counted <> '' UNION ALL SELECT id, 'display', display, '' FROM runs WHERE display "
       "<> '' UNION ALL SELECT r.id, 'kept', k.value, '' FROM runs r, json_each(r.record, '$.identity.kept') k UNION ALL SELECT r.id, "
       "'technique', t.key, t.value FROM runs r, json_each(r.record, '$.identity.techniques') t",
       true},
      {"timings", "times of frames and passes, ms",
       viewColumns<TimingStatistics>(
           with(
               run,
               {{"what", "CASE WHEN t.key IN ('device', 'host') THEN 'pass_' || t.key ELSE t.key END"},
                {"pass", "coalesce(json_extract(r.record, t.path || '.name'), '')",
                 "what: frame (all kept passes), next_frame (1/60 s later), still_frame (nothing moves), moved_frame (camera and lights "
                 "have moved), pass_device, pass_host"}}),
           "t.value", "$", "_ms"),
       "runs r, json_tree(r.record) t WHERE t.type = 'object' AND t.key IN ('frame', 'next_frame', 'still_frame', 'moved_frame', 'device', "
       "'host') AND json_extract(t.value, '$.repeats') > 0",
       true},
      {"passes", "in the order in which they ran",
       with(run,
            {{"position", "p.key"}, {"name", "json_extract(p.value, '$.name')", "of which run; from 0 on"}}),
       ofRun("passes", "p") + " WHERE json_extract(p.value, '$.ran') IS NULL", true},
      {"resources",
       "memory",
       {{"run", "id"},
        {"what", "'peak'"},
        {"pass", "''"},
        {"bytes", "peak_bytes",
         "what: peak (of the whole frame, the scene included, whatever else is on the device), pass (taken by one pass)"}},
       "runs UNION ALL SELECT r.id, 'pass', json_extract(p.value, '$.name'), json_extract(p.value, '$.bytes') FROM " +
           ofRun("passes", "p") + " WHERE json_extract(p.value, '$.bytes') IS NOT NULL",
       true},
      {"work",
       "what a pass does in a frame in which all passes run, by resource of the device (docs/commands.md, `lumivox device`); none where "
       "programs are taken as GLSL",
       with(run, {{"pass", "json_extract(p.value, '$.name')"},
                  {"name", "w.key"},
                  {"amount", "w.value", "samples, loads, stores, atomics, bytes, operations"}}),
       ofRun("passes", "p") + ", json_each(p.value, '$.work') w", true},
      {"errors", "errors of outputs",
       viewColumns<ComponentError>(with(run, {{"position", "e.key"}}), "e.value"), ofRun("errors", "e"),
       true},
      {"metrics", "the numbers of each error",
       viewColumns<NamedMetric>(
           with(
               run,
               {{"position", "e.key"},
                {"name", "m.key",
                 "of that error: rmse, relative_mse, mean_ratio, bias, percentile95, ssim, flip, flip_ldr, rms_bias, rms_noise, flicker, "
                 "exposure_ev (at which SSIM and LDR-FLIP were taken), noise_floor, non_finite_image, non_finite_reference "
                 "(docs/metrics.md)"}}),
           "m.value"),
       ofRun("errors", "e") + ", json_each(e.value, '$.metrics') m", true},
      {"voxels",
       "one row for each run whose indirect light is gathered from voxels ([what they are](metrics.md#voxels-beside-errors))",
       with(viewColumns<GatheredVoxels>(run, "r.record", "$.voxels"),
            {{"recall", "json_extract(r.record, '$.voxels.recall')"},
             {"precision", "json_extract(r.record, '$.voxels.precision')",
              "as in [the metrics](metrics.md#voxels)"}}),
       "runs r WHERE json_type(r.record, '$.voxels') = 'object'", true},
      {"health", "NaN, infinite and negative values",
       with(run, {{"position", "h.key"}, {"finding", "h.value", "one of a run"}}), ofRun("health", "h"),
       true},
      {"notes", "what passes measured about themselves",
       with(run, {{"position", "n.key"}, {"note", "n.value", "one of a run"}}), ofRun("notes", "n"), true},
      {"images",
       "of an unfinished report alone: images of a run",
       {ownRun,
        {"position", "INTEGER NOT NULL"},
        {"output", "TEXT NOT NULL"},
        {"component", "TEXT NOT NULL"},
        {"reference", "TEXT NOT NULL"},
        {"flip", "REAL"},
        {"png", "BLOB NOT NULL",
         "the image of an output; or its FLIP map against a layer of the reference, and the mean of the map"}},
       "PRIMARY KEY (run, position)",
       false,
       "STRICT"},
      {"controls", "the same point timed once more, when",
       timesColumns({ownRun, {"created", "TEXT NOT NULL"}, {"what", "TEXT NOT NULL", "frame or next_frame"}}),
       "PRIMARY KEY (run, created, what)", false, "STRICT, WITHOUT ROWID"},
      {"claims", "points that are being measured",
       with({{"key", "TEXT PRIMARY KEY", "of the run"}},
            process("by which process: start and name space of its machine, number, start, command line")),
       "", false, "STRICT, WITHOUT ROWID"},
      {"reports", "of an unfinished report alone: who keeps points in this store until a page is written",
       with({{"id", "INTEGER PRIMARY KEY"},
             {"points", "TEXT NOT NULL",
              "number; hash of the keys that it wants, by which a report that goes on is known"}},
            process("its command line and its process, as in `claims`; process 0 after it failed")),
       "", false, "STRICT"},
      {"wanted",
       "runs that stay as long as a report is at work or interrupted",
       {{"report", "INTEGER NOT NULL REFERENCES reports ON DELETE CASCADE"},
        {"key", "TEXT NOT NULL", "the report; the key of a run"}},
       "PRIMARY KEY (report, key)",
       false,
       "STRICT, WITHOUT ROWID"},
      {"stress_cells", "cells of the [stress battery](stress.md)",
       recordColumns<StressCell>(
           "number of the cell; hash of all that it depends on: a newer cell with the same key takes the place of the older",
           "results export --stress --format json"),
       ""},
      {"stress_provenance",
       "library+shaders of the techniques that the pipeline names",
       {{"cell", "c.id"}, {"technique", "t.key"}, {"hash", "t.value", "of which cell"}},
       "stress_cells c, json_each(c.record, '$.techniques') t",
       true},
      {"peak_rates", "of devices",
       recordColumns<PeakRate>(
           "hash of device, driver, shaders, host and name: a newer one takes the place of the older",
           "device --json"),
       ""}};
}

std::string sqlOf(const Table& table) {
  std::string columns;
  for (const Column& column : table.columns)
    columns += (columns.empty() ? "  " : ",\n  ") + (table.isView ? column.definition + " AS " + column.name
                                                                  : column.name + " " + column.definition);
  if (table.isView)
    return fmt::format("CREATE VIEW {} AS SELECT\n{}\nFROM {};\n", table.name, columns, table.rest);
  return fmt::format("CREATE TABLE {} (\n{}{}{}\n) {};\n", table.name, columns,
                     table.rest.empty() ? "" : ",\n  ", table.rest, table.options);
}

}  // namespace

std::string schemaSql() {
  std::string sql;
  for (const Table& table : tables()) sql += sqlOf(table);
  return sql +
         "CREATE INDEX runs_by_scene ON runs (scene_name, pipeline_name);\n"
         "CREATE INDEX wanted_by_key ON wanted (key);\n";
}

std::string schemaMarkdown() {
  std::string text;
  for (const Table& table : tables()) {
    text += fmt::format("- `{}`: {}.\n", table.name, table.about);
    std::string names;
    for (const Column& column : table.columns) {
      names += (names.empty() ? "`" : ", `") + column.name + "`";
      if (column.about.empty()) continue;
      text += fmt::format("  - {}: {}.\n", names, column.about);
      names.clear();
    }
    if (!names.empty()) text += "  - " + names + ".\n";
  }
  return text;
}

}  // namespace lumivox::results
