#include "results/store_schema.h"

#include <fmt/format.h>

#include <string_view>
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
  std::string rest;               ///< of a table: further constraints; of a view: what it is read from
  const char* options = nullptr;  ///< of a table; null: it is a view
};

/// Of a text "name definition -- about | name definition".
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

/// Adds the fields of T that are one value each, from the JSON object at `path` of `json`. Lists are views of
/// their own.
template <class T>
void addFields(Columns& columns, const std::string& json, const std::string& path, const char* suffix = "") {
  const bool isTable = json == "record";
  T record;
  fields(record, [&]<class M>(const Field& field, M&&) {
    using Member = std::remove_cvref_t<M>;
    [[maybe_unused]] const auto add = [&](const std::string& name, const std::string& at, const char* about) {
      const char* type = std::floating_point<Member>    ? "REAL"
                         : std::is_arithmetic_v<Member> ? "INTEGER"
                                                        : "TEXT";
      const std::string sql = fmt::format("json_extract({}, '{}.{}')", json, path, at);
      columns.push_back({name, isTable ? fmt::format("{} GENERATED ALWAYS AS ({}) VIRTUAL", type, sql) : sql,
                         about == nullptr ? "" : about});
    };
    if constexpr (std::same_as<Member, RunIdentity> || std::same_as<Member, RayHoles>) {
      addFields<Member>(columns, json, path + "." + field.name);
    } else if constexpr (std::same_as<Member, glm::ivec3>) {
      add("width", field.name + std::string("[0]"), nullptr);
      add("height", field.name + std::string("[1]"), nullptr);
      add("depth", field.name + std::string("[2]"), field.about);
    } else if constexpr (std::same_as<Member, double>) {
      add(field.column + std::string(suffix), field.name + std::string(suffix), field.about);
    } else if constexpr (std::is_arithmetic_v<Member> || std::same_as<Member, std::string> ||
                         std::same_as<Member, StressOutcome> || std::same_as<Member, Against<bool>>) {
      add(field.column, field.name, field.about);
    }
  });
}

/// The columns of `text` and the fields of T.
template <class T>
Columns with(std::string_view text, const char* json, const char* path = "$", const char* suffix = "") {
  Columns result = columns(text);
  addFields<T>(result, json, path, suffix);
  return result;
}

/// A table of records with the JSON that the command writes, too.
template <class T>
Table records(const char* name, const char* about, const std::string& key, const char* command) {
  Columns result = with<T>("id INTEGER PRIMARY KEY | key TEXT NOT NULL UNIQUE -- " + key, "record");
  result.push_back({"record", "TEXT NOT NULL", fmt::format("all of it as JSON, as `{}` writes it", command)});
  return {name, about, result, "", ""};
}

/// A view of what each run has a list of.
Table ofRuns(const char* name, const char* about, Columns columns, const char* list,
             const std::string& more = {}) {
  return {name, about, std::move(columns),
          fmt::format("runs r, json_each(r.record, '$.{}') l{}", list, more)};
}

const std::string kOfRun = "run INTEGER NOT NULL REFERENCES runs ON DELETE CASCADE";
const std::string kProcess =
    "machine TEXT NOT NULL | process INTEGER NOT NULL | started INTEGER NOT NULL | command TEXT NOT NULL";

std::vector<Table> tables() {
  return {
      records<StoredRun>(
          "runs", "one row for each measured point",
          "number of the run in this store; what makes it unique, see above | complete INTEGER NOT NULL -- 0 where an unfinished batch has "
          "left errors, images and work of a point, but no times; such a run is no result",
          "results export --format json"),
      ofRuns("parameters", "all parameters of the pipeline, as `--set` reads them",
             columns("run r.id | name l.key | value l.value -- of which run; as text"),
             "identity.parameters"),
      {"provenance", "what a run was made from",
       columns(
           "run id | kind 'scene' | name scene | hash scene_hash -- kind: scene, pipeline, technique (library+shaders), framework; "
           "without a hash: flicker (over how many pairs of frames), kept (an output that stayed alive though no image needs it), display "
           "(an exposure or tone curve that was asked for), not_counted (why the work of the passes was not counted)"),
       "runs UNION ALL SELECT id, 'pipeline', pipeline, pipeline_hash FROM runs UNION ALL SELECT id, 'framework', 'lumivox', framework FROM "
       "runs UNION ALL SELECT id, 'flicker', flicker_pairs || ' pairs', '' FROM runs WHERE flicker_pairs > 0 UNION ALL SELECT id, "
       "'not_counted', not_counted, '' FROM runs WHERE not_counted <> '' UNION ALL SELECT id, 'display', display, '' FROM runs WHERE display "
       "<> '' UNION ALL SELECT r.id, 'kept', k.value, '' FROM runs r, json_each(r.record, '$.identity.kept') k UNION ALL SELECT r.id, "
       "'technique', t.key, t.value FROM runs r, json_each(r.record, '$.identity.techniques') t"},
      {"timings", "times of frames and passes, ms",
       with<TimingStatistics>(
           "run r.id | what CASE WHEN t.key IN ('device', 'host') THEN 'pass_' || t.key ELSE t.key END | pass "
           "coalesce(json_extract(r.record, t.path || '.name'), '') -- what: frame (all kept passes), next_frame (1/60 s later), still_frame "
           "(nothing moves), moved_frame (camera and lights have moved), pass_device, pass_host",
           "t.value", "$", "_ms"),
       "runs r, json_tree(r.record) t WHERE t.type = 'object' AND t.key IN ('frame', 'next_frame', 'still_frame', 'moved_frame', 'device', "
       "'host') AND json_extract(t.value, '$.repeats') > 0"},
      ofRuns(
          "passes", "in the order in which they ran",
          columns(
              "run r.id | position l.key | name json_extract(l.value, '$.name') -- of which run; from 0 on"),
          "passes", " WHERE json_extract(l.value, '$.ran') IS NULL"),
      {"resources", "memory",
       columns(
           "run id | what 'peak' | pass '' | bytes peak_bytes -- what: peak (of the whole frame, the scene included, whatever else is on "
           "the device), pass (taken by one pass)"),
       "runs UNION ALL SELECT r.id, 'pass', json_extract(p.value, '$.name'), json_extract(p.value, '$.bytes') FROM runs r, "
       "json_each(r.record, '$.passes') p WHERE json_extract(p.value, '$.bytes') IS NOT NULL"},
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
      ofRuns(
          "metrics", "the numbers of each error",
          with<NamedMetric>(
              "run r.id | position l.key | name m.key -- of that error: rmse, relative_mse, mean_ratio, bias, percentile95, ssim, "
              "flip, flip_ldr, rms_bias, rms_noise, flicker, exposure_ev (at which SSIM and LDR-FLIP were taken), noise_floor, "
              "non_finite_image, non_finite_reference (docs/metrics.md)",
              "m.value"),
          "errors", ", json_each(l.value, '$.metrics') m"),
      {"voxels",
       "one row for each run whose indirect light is gathered from voxels ([what they are](metrics.md#voxels-beside-errors))",
       with<GatheredVoxels>(
           "run r.id | recall json_extract(r.record, '$.voxels.recall') | precision json_extract(r.record, "
           "'$.voxels.precision') -- of which run; as in [the metrics](metrics.md#voxels)",
           "r.record", "$.voxels"),
       "runs r WHERE json_type(r.record, '$.voxels') = 'object'"},
      ofRuns("health", "NaN, infinite and negative values",
             columns("run r.id | position l.key | finding l.value -- one of a run"), "health"),
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
       columns("key TEXT PRIMARY KEY -- of the run | " + kProcess +
               " -- by which process: start and name space of its machine, number, start, command "
               "line | expires INTEGER NOT NULL -- until when, s since 1970"),
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
          "number of the cell; hash of all that it depends on: a newer cell with the same key takes the place of the older",
          "results export --stress --format json"),
      {"stress_provenance", "library+shaders of the techniques that the pipeline names",
       columns("cell c.id | technique t.key | hash t.value -- of which cell"),
       "stress_cells c, json_each(c.record, '$.techniques') t"},
      records<PeakRate>(
          "peak_rates", "peak rates of devices",
          "number; hash of device, driver, shaders, host and name: a newer rate takes the place of the older",
          "device --json")};
}

std::string sqlOf(const Table& table) {
  const bool isView = table.options == nullptr;
  std::string text;
  for (const Column& column : table.columns)
    text += (text.empty() ? "  " : ",\n  ") +
            (isView ? column.definition + " AS " + column.name : column.name + " " + column.definition);
  if (isView) return fmt::format("CREATE VIEW {} AS SELECT\n{}\nFROM {};\n", table.name, text, table.rest);
  const char* comma = table.rest.empty() ? "" : ",\n  ";
  return fmt::format("CREATE TABLE {} (\n{}{}{}\n) {};\n", table.name, text, comma, table.rest,
                     table.options);
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
