#include "results/store_schema.h"

#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "results/record_rows.h"

namespace lumivox::results {
namespace {

using Columns = std::vector<Column>;

/// Parses a text "name definition -- about | name definition".
Columns columns(std::string_view text) {
  constexpr std::string_view kNext = " | ", kAbout = " -- ";
  Columns result;
  for (bool more = true; more;) {
    const std::size_t end = text.find(kNext), space = text.find(' ');
    const std::string_view one = text.substr(0, end), definition = one.substr(space + 1);
    const std::size_t about = definition.find(kAbout);
    result.push_back({std::string(one.substr(0, space)), std::string(definition.substr(0, about)),
                      std::string(about == text.npos ? "" : definition.substr(about + kAbout.size()))});
    more = end != text.npos;
    if (more) text.remove_prefix(end + kNext.size());
  }
  return result;
}

/// A table column for each field of a record, with the record's default.
template <class T>
void addColumns(Columns& columns) {
  T record;
  eachColumn(record, [&]<class M>(const std::string& name, const char* about, M& member) {
    const Json value = jsonOf(member);
    const std::string standard = value.is_string() ? value.get<std::string>() : value.dump();
    const std::string definition = std::floating_point<M>    ? "REAL DEFAULT " + standard
                                   : std::is_arithmetic_v<M> ? "INTEGER NOT NULL DEFAULT " + standard
                                   : IsOptional<M>           ? "TEXT"
                                                             : "TEXT NOT NULL DEFAULT '" + standard + "'";
    columns.push_back({name, definition, about == nullptr ? "" : about});
  });
}

/// A view column for each single value of a record, from the JSON object `json`.
template <class T>
void addFields(Columns& columns, const std::string& json) {
  T record;
  fields(record, [&]<class M>(const Field& field, M&&) {
    using Member = std::remove_cvref_t<M>;
    const auto add = [&](const std::string& name, const std::string& at, const char* about) {
      columns.push_back(
          {name, fmt::format("json_extract({}, '$.{}')", json, at), about == nullptr ? "" : about});
    };
    if constexpr (std::same_as<Member, glm::ivec3>) {
      add("width", field.name + std::string("[0]"), nullptr);
      add("height", field.name + std::string("[1]"), nullptr);
      add("depth", field.name + std::string("[2]"), field.about);
    } else if constexpr (!std::same_as<Member, Metrics<T>>) {
      add(field.column, field.name, field.about);
    }
  });
}

/// The columns of `text`, followed by those of a record in a table or in the JSON of a view.
template <class T>
Columns with(std::string_view text, const char* json = nullptr) {
  Columns result = columns(text);
  if (json == nullptr)
    addColumns<T>(result);
  else
    addFields<T>(result, json);
  return result;
}

template <class T>
Table records(const char* name, const char* about, const std::string& key) {
  return {name, about, with<T>("id INTEGER PRIMARY KEY | key TEXT NOT NULL UNIQUE -- " + key), "", "STRICT"};
}

/// A view with a row for each item of a list of each run.
Table ofRuns(const char* name, const char* about, Columns columns, const char* list,
             const std::string& more = {}) {
  return {name, about, std::move(columns), fmt::format("runs r, json_each(r.{}) l{}", list, more)};
}

/// The rows of view `timings`: times of whole frames are columns of runs, and those of passes are JSON.
std::string allTimings() {
  std::string sql;
  const auto add = [&](const std::string& id, const std::string& what, const std::string& pass,
                       const std::string& number, const std::string& from) {
    sql += sql.empty() ? "(" : "\nUNION ALL ";
    sql += fmt::format("SELECT {} AS run, '{}' AS what, {} AS pass", id, what, pass);
    TimingStatistics time;
    fields(time, [&](const Field& field, auto&&) {
      sql += fmt::format(", {} AS {}", fmt::format(fmt::runtime(number), field.name), field.name);
    });
    sql += fmt::format(" FROM {} WHERE {} > 0", from, fmt::format(fmt::runtime(number), "repeats"));
  };
  StoredRun run;
  fields(run, [&]<class M>(const Field& field, M&&) {
    const std::string name = field.name;
    if constexpr (std::same_as<std::remove_cvref_t<M>, TimingStatistics>)
      add("id", name.substr(0, name.rfind("_ms")), "''", name + "_{}", "runs");
  });
  for (const std::string where : {"device", "host"})
    add("r.id", "pass_" + where, "json_extract(l.value, '$.name')",
        "json_extract(l.value, '$." + where + "_ms.{}')", "runs r, json_each(r.passes) l");
  return sql + ")";
}

const std::string kOfRun = "run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE";
const std::string kProcess =
    "machine TEXT NOT NULL | process INTEGER NOT NULL | started INTEGER NOT NULL | command TEXT NOT NULL";

std::vector<Table> tables() {
  return {
      records<StoredRun>(
          "runs", "one row for each measured point",
          "number of the run in this store; what makes it unique, see above | complete INTEGER NOT NULL -- 0 where an unfinished batch has "
          "left errors, images and work of a point, but no times; such a run is no result"),
      ofRuns("parameters", "all parameters of the pipeline, as `--set` reads them",
             columns("run r.id | name l.key | value l.value -- of which run; as text"), "parameters"),
      {"provenance", "what a run was made from",
       columns(
           "run id | kind 'scene' | name scene | hash scene_hash -- kind: scene, pipeline, technique (library+shaders), framework; "
           "without a hash: flicker (over how many pairs of frames), kept (an output that stayed alive though no image needs it), display "
           "(an exposure or tone curve that was asked for), not_counted (why the work of the passes was not counted)"),
       "runs UNION ALL SELECT id, 'pipeline', pipeline, pipeline_hash FROM runs UNION ALL SELECT id, 'framework', 'lumivox', framework FROM "
       "runs UNION ALL SELECT id, 'flicker', flicker_pairs || ' pairs', '' FROM runs WHERE flicker_pairs > 0 UNION ALL SELECT id, "
       "'not_counted', not_counted, '' FROM runs WHERE not_counted <> '' UNION ALL SELECT id, 'display', display, '' FROM runs WHERE display "
       "<> '' UNION ALL SELECT r.id, 'kept', k.value, '' FROM runs r, json_each(r.kept) k UNION ALL SELECT r.id, 'technique', t.key, "
       "t.value FROM runs r, json_each(r.techniques) t"},
      {"timings", "times of frames and passes, ms",
       columns(
           "run run | what what | pass pass -- what: frame (all kept passes), next_frame (1/60 s later), still_frame (nothing moves), "
           "moved_frame (camera and lights have moved), pass_device, pass_host | median_ms median | lower_quartile_ms lower_quartile | "
           "upper_quartile_ms upper_quartile | smallest_ms smallest | largest_ms largest | repeats repeats -- median of the repeats, its "
           "quartiles, the smallest and the largest, and how many repeats"),
       allTimings()},
      ofRuns(
          "passes", "in the order in which they ran",
          columns(
              "run r.id | position l.key | name json_extract(l.value, '$.name') -- of which run; from 0 on"),
          "passes", " WHERE json_extract(l.value, '$.ran')"),
      {"resources", "memory",
       columns(
           "run id | what 'peak' | pass '' | bytes peak_bytes -- what: peak (of the whole frame, the scene included, whatever else is on "
           "the device), pass (taken by one pass)"),
       "runs UNION ALL SELECT r.id, 'pass', json_extract(l.value, '$.name'), json_extract(l.value, '$.bytes') FROM runs r, "
       "json_each(r.passes) l WHERE json_extract(l.value, '$.bytes') IS NOT NULL"},
      ofRuns(
          "work",
          "what a pass does in a frame in which all passes run, by resource of the device (docs/commands.md, `lumivox device`); none where "
          "programs are taken as GLSL",
          columns(
              "run r.id | pass json_extract(l.value, '$.name') | name w.key | amount w.value -- samples, loads, stores, atomics, bytes, "
              "operations"),
          "passes", ", json_each(l.value, '$.work') w"),
      ofRuns("errors", "errors of outputs", with<ComponentError>("run r.id | position l.key", "l.value"),
             "errors"),
      {"metrics", "the numbers of each error",
       with<NamedMetric>(
           kOfRun +
           " | position INTEGER NOT NULL | name TEXT NOT NULL -- of that error: rmse, relative_mse, mean_ratio, bias, percentile95, ssim, "
           "flip, flip_ldr, rms_bias, rms_noise, flicker, exposure_ev (at which SSIM and LDR-FLIP were taken), noise_floor, "
           "non_finite_image, non_finite_reference (docs/metrics.md)"),
       "PRIMARY KEY (run, position, name)", "STRICT, WITHOUT ROWID"},
      {"voxels",
       "one row for each run whose indirect light is gathered from voxels ([what they are](metrics.md#voxels-beside-errors))",
       with<GatheredVoxels>("run id", "voxels"), "runs WHERE voxels IS NOT NULL"},
      ofRuns("health", "NaN, infinite and negative values",
             columns("run r.id | position l.key | finding l.value -- one of a run"), "health_findings"),
      ofRuns("notes", "what passes measured about themselves",
             columns("run r.id | position l.key | note l.value -- one of a run"), "notes"),
      {"images", "of an unfinished report alone: images of a run",
       columns(
           kOfRun +
           " | position INTEGER NOT NULL | output TEXT NOT NULL | component TEXT NOT NULL | reference TEXT NOT NULL | flip REAL | png "
           "BLOB NOT NULL -- the image of an output; or its FLIP map against a layer of the reference, and the mean of the map"),
       "PRIMARY KEY (run, position)", "STRICT"},
      {"controls", "the same point timed once more, when",
       columns(
           kOfRun +
           " | created TEXT NOT NULL | what TEXT NOT NULL -- frame or next_frame | median_ms REAL NOT NULL | lower_quartile_ms REAL NOT "
           "NULL | upper_quartile_ms REAL NOT NULL | repeats INTEGER NOT NULL -- as in `timings`"),
       "PRIMARY KEY (run, created, what)", "STRICT, WITHOUT ROWID"},
      {"claims", "points that are being measured",
       columns(
           "key TEXT PRIMARY KEY -- of the run | " + kProcess +
           " -- by which process: start and name space of its machine, number, start, command "
           "line | expires INTEGER NOT NULL -- until when, s since 1970. Of a point for a store that is merged "
           "later, the command is that file, and the machine `delivered` once it holds the run"),
       "", "STRICT, WITHOUT ROWID"},
      {"reports", "of an unfinished report alone: who keeps points in this store until a page is written",
       columns(
           "id INTEGER PRIMARY KEY | points TEXT NOT NULL -- number; hash of the keys that it wants, by which a report that goes on is known | " +
           kProcess +
           " | expires INTEGER NOT NULL -- its command line and its process, as in `claims`; process 0 after it failed"),
       "", "STRICT"},
      {"wanted", "runs that stay as long as a report is at work or interrupted",
       columns(
           "report INTEGER NOT NULL REFERENCES reports ON DELETE CASCADE | key TEXT NOT NULL -- the report; the key of a run"),
       "PRIMARY KEY (report, key)", "STRICT, WITHOUT ROWID"},
      records<StressCell>(
          "stress_cells", "cells of the [stress battery](stress.md)",
          "number of the cell; hash of all that it depends on: a newer cell with the same key takes the place of the older"),
      {"stress_provenance", "library+shaders of the techniques that the pipeline names",
       columns("cell c.id | technique t.key | hash t.value -- of which cell"),
       "stress_cells c, json_each(c.techniques) t"},
      records<PeakRate>(
          "peak_rates", "peak rates of devices",
          "number; hash of device, driver, shaders, host and name: a newer rate takes the place of the older")};
}

}  // namespace

std::string Table::sql() const {
  const bool isView = options == nullptr;
  std::string text;
  for (const Column& column : columns)
    text += (text.empty() ? "  " : ",\n  ") +
            (isView ? column.definition + " AS " + column.name : column.name + " " + column.definition);
  if (isView) return fmt::format("CREATE VIEW {} AS SELECT\n{}\nFROM {}", name, text, rest);
  return fmt::format("CREATE TABLE {} (\n{}{}{}\n) {}", name, text, rest.empty() ? "" : ",\n  ", rest,
                     options);
}

const std::vector<Table>& storeTables() {
  static const std::vector<Table> all = tables();
  return all;
}

std::string schemaSql() {
  std::string sql;
  for (const Table& table : storeTables()) sql += table.sql() + ";\n";
  return sql +
         "CREATE INDEX runs_by_scene ON runs (scene_name, pipeline_name);\n"
         "CREATE INDEX wanted_by_key ON wanted (key);\n";
}

std::string schemaMarkdown() {
  std::string text;
  for (const Table& table : storeTables()) {
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
