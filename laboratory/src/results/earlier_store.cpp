#include "results/earlier_store.h"

#include <fmt/format.h>

#include <set>

#include "lumivox/base/error.h"
#include "results/record_rows.h"
#include "results/store_schema.h"

namespace lumivox::results {
namespace {

using Expressions = std::map<std::string, std::string>;

constexpr std::int64_t kLastTables = 8;  // the last schema with a table for each list of a run
constexpr std::int64_t kOldNames = 4;    // the last schema with truth, picture and ceiling

/// A JSON object with the fields of a record, from columns.
template <class T>
std::string objectOf(const Expressions& expressions) {
  std::string sql;
  T record;
  fields(record, [&]<class M>(const Field& field, M&&) {
    using Member = std::remove_cvref_t<M>;
    if (kIsDerived<Member> || std::same_as<Member, Metrics<T>>) return;
    const auto found = expressions.find(field.name);
    sql += fmt::format("{}'{}', {}", sql.empty() ? "" : ", ", field.name,
                       found == expressions.end() ? field.name : found->second);
  });
  return "json_object(" + sql + ")";
}

/// A subquery of the rows of a run.
std::string ofRun(const std::string& value, const std::string& table, const std::string& where = "1") {
  return fmt::format("(SELECT {} FROM {} WHERE run = r.id AND {})", value, table, where);
}

std::string listOfRun(const std::string& value, const std::string& columns, const std::string& table) {
  return fmt::format(
      "(SELECT json_group_array({}) FROM (SELECT {} FROM {} WHERE run = r.id ORDER BY position))", value,
      columns, table);
}

/// Adds a column for each number of each time of whole frames; `expression` takes the frame and the number.
template <class Expression>
void addTimes(Expressions& all, const Expression& expression) {
  TimingStatistics time;
  for (const std::string what : {"frame", "next_frame", "still_frame", "moved_frame"})
    fields(time, [&]<class M>(const Field& part, M&) {
      all[fmt::format("{}_ms_{}", what, part.name)] =
          expression(what, std::string(part.name) + (std::floating_point<M> ? "_ms" : ""));
    });
}

Expressions runsOfTables(std::int64_t schema) {
  const auto hash = [](const char* kind) {
    return ofRun("hash", "provenance", fmt::format("kind = '{}'", kind));
  };
  const auto named = [](const char* kind) {
    return fmt::format("coalesce({}, '')", ofRun("name", "provenance", fmt::format("kind = '{}'", kind)));
  };
  const auto passTime = [](const char* what) {
    return fmt::format(
        "json((SELECT json_object('median', median_ms, 'lower_quartile', lower_quartile_ms, 'upper_quartile', "
        "upper_quartile_ms, 'smallest', smallest_ms, 'largest', largest_ms, 'repeats', repeats) FROM timings "
        "WHERE run = r.id AND what = '{}' AND pass = name))",
        what);
  };
  const std::string work =
      schema < 3 ? "NULL"
                 : "json(" + ofRun("json_group_object(w.name, amount)", "work w", "pass = p.name") + ")";
  Expressions all{
      {"scene_hash", hash("scene")},
      {"pipeline_hash", hash("pipeline")},
      {"framework", hash("framework")},
      {"techniques", ofRun("json_group_object(name, hash)", "provenance", "kind = 'technique'")},
      {"kept", ofRun("json_group_array(name)", "provenance", "kind = 'kept'")},
      {"flicker_pairs", "CAST(" + named("flicker") + " AS INTEGER)"},
      {"display", named("display")},
      {"not_counted", named("not_counted")},
      {"parameters", ofRun("json_group_object(name, value)", "parameters")},
      {"peak_bytes", ofRun("bytes", "resources", "what = 'peak'")},
      {"health_findings", listOfRun("finding", "finding", "health")},
      {"notes", schema < 4 ? "'[]'" : listOfRun("note", "note", "notes")},
      {"passes",
       fmt::format(
           "(SELECT json_group_array(json_object('name', name, 'device_ms', {}, 'host_ms', {}, 'bytes', {}, 'work', {})) FROM (SELECT name "
           "FROM passes WHERE run = r.id ORDER BY position) p)",
           passTime("pass_device"), passTime("pass_host"),
           ofRun("bytes", "resources", "what = 'pass' AND pass = name"), work)}};
  Expressions errors;
  if (schema <= kOldNames) {
    all["reference_samples"] = "truth_samples";
    errors["reference"] = "truth";
  }
  if (schema < 4) errors["per_seed"] = "0";
  if (schema < 6) all["complete"] = "1";
  all["errors"] = listOfRun(objectOf<ComponentError>(errors), "*", "errors");
  all["voxels"] = "NULL";
  if (schema >= 7)
    all["voxels"] =
        ofRun(objectOf<GatheredVoxels>({{"resolution", "json_array(width, height, depth)"}}), "voxels");
  addTimes(all, [](const std::string& what, const std::string& number) {
    return ofRun(number, "timings", fmt::format("what = '{}'", what));
  });
  return all;
}

/// Expressions for the schemas that stored a run as JSON.
Expressions runsOfRecords() {
  const auto at = [](const std::string& path) { return fmt::format("json_extract(record, '$.{}')", path); };
  std::string passes = at("passes");
  for (const char* name : {"median", "lower_quartile", "upper_quartile", "smallest", "largest"})
    passes = fmt::format("replace({}, '\"{}_ms\":', '\"{}\":')", passes, name, name);
  for (const char* name : {"device", "host"})
    passes = fmt::format("replace({}, '\"{}\":', '\"{}_ms\":')", passes, name, name);
  Expressions all{{"techniques", at("identity.techniques")},
                  {"parameters", at("identity.parameters")},
                  {"kept", at("identity.kept")},
                  {"seed", "record -> '$.identity.seed'"},  // as text: it may exceed 2^63
                  {"health_findings", at("health")},
                  {"notes", at("notes")},
                  {"passes", passes},
                  {"errors", at("errors")},
                  {"voxels", fmt::format("json_patch({}, {})", at("voxels"), at("voxels.holes"))}};
  addTimes(all, [&](const std::string& what, const std::string& number) { return at(what + "." + number); });
  return all;
}

/// Up to schema 3, mean and standard error over the seeds were stored beside the RMSE of the first seed,
/// whose uncertainty is the reference's noise.
Shown metricsOfOldNames() {
  return {
      "main.metrics m LEFT JOIN main.metrics o ON m.name = 'rmse' AND o.name = 'rmse_over_seeds' AND o.run = "
      "m.run AND o.position = m.position WHERE m.name <> 'rmse_over_seeds'",
      {{"run", "m.run"},
       {"position", "m.position"},
       {"name",
        "CASE m.name WHEN 'non_finite_truth' THEN 'non_finite_reference' WHEN 'non_finite_picture' THEN "
        "'non_finite_image' ELSE m.name END"},
       {"value", "coalesce(o.value, m.value)"},
       {"uncertainty",
        "CASE WHEN o.name IS NULL THEN m.uncertainty ELSE sqrt(m.uncertainty * m.uncertainty + o.uncertainty * "
        "o.uncertainty) END"},
       {"of_nothing", "m.of_nothing"}}};
}

}  // namespace

void show(const Database& database, const std::string& table, const Shown& shown) {
  std::set<std::string> present;
  if (!shown.from.empty()) {
    Statement column(database, "SELECT name FROM pragma_table_xinfo(?, 'main')");
    const std::size_t from = shown.from.find('.') + 1;
    for (column.bind(shown.from.substr(from, shown.from.find(' ') - from)); column.step();)
      present.insert(column.text(0));
  }
  std::string columns;
  for (const Table& one : storeTables())
    for (const Column& column : one.columns) {
      if (one.name != table) continue;
      const auto expression = shown.expressions.find(column.name);
      const std::size_t standard = column.definition.find("DEFAULT ");
      columns += (columns.empty() ? "" : ", ") +
                 (!shown.from.empty() && expression != shown.expressions.end() ? expression->second
                  : present.count(column.name) > 0                             ? column.name
                  : standard != std::string::npos ? column.definition.substr(standard + 8)
                                                  : "NULL") +
                 " AS " + column.name;
    }
  database.execute(fmt::format("CREATE TEMP VIEW {} AS SELECT {} {}", table, columns,
                               shown.from.empty() ? "WHERE 0" : "FROM " + shown.from));
}

void showEarlierStore(const Database& database) {
  const std::string file = database.file().string();
  if (database.pragma("application_id") != kApplicationId)
    throw Error(fmt::format("{}: this is another kind of database; expected a results store", file));
  const std::int64_t schema = database.pragma("user_version");
  if (schema == kSchemaVersion)
    throw Error(fmt::format(
        "{}: it has the schema of this version; lumivox results merge copies what it holds", file));
  if (schema < 1 || schema > kSchemaVersion)
    throw Error(
        fmt::format("{}: it has schema {}; expected one from 1 to {}", file, schema, kSchemaVersion - 1));
  const bool isOld = schema <= kOldNames, hasTables = schema <= kLastTables;
  show(database, "runs", {"main.runs r", hasTables ? runsOfTables(schema) : runsOfRecords()});
  // If runs are JSON, metrics are too.
  show(database, "metrics", isOld ? metricsOfOldNames() : Shown{hasTables ? "main.metrics" : "", {}});
  Expressions images, cells, rates;
  if (isOld) {
    images["reference"] = "truth";
    cells["image"] = "picture";
    cells["family"] = "replace(family, 'picture_and_camera', 'image_and_camera')";
  }
  if (hasTables) rates = {{"id", "0"}, {"key", "''"}};
  cells["techniques"] =
      hasTables ? "(SELECT json_group_object(technique, hash) FROM stress_provenance WHERE cell = r.id)"
                : "json_extract(record, '$.techniques')";
  show(database, "images", {schema < 4 ? "" : isOld ? "main.pictures" : "main.images", images});
  show(database, "controls", {schema < 4 ? "" : "main.controls", {}});
  show(database, "stress_cells",
       {schema < 2 ? "" : "main.stress_cells r", schema < 2 ? Expressions() : cells});
  show(database, "peak_rates", {schema < 2 ? "" : isOld ? "main.ceilings" : "main.peak_rates", rates});
}

}  // namespace lumivox::results
