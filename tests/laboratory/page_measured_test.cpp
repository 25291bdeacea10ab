// Tables that slow tests measure: what counts as changed, how they are kept, and how cards quote them.
#include <cmath>
#include <functional>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/page/measured_passages.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Contains;
using lumivox::test::Tells;

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

MeasuredTable errors() {
  MeasuredTable table;
  table.name = "technique.errors";
  table.test = "errors by \"voxels\", and rays";
  table.device = "a rasteriser";
  table.date = "2026-01-02";
  table.seconds = 61.4;
  table.columns = {{"light", 3, 0.02}, {"ratio", 2, 0.0, 0.1}, {"time", 1, 0.0, 0.5, true}};
  table.rows = {
      {"room, 32", {0.1234, 0.98, 2.0}}, {"room, 64", {0.1, 1.0, kNone}}, {"hall, 32", {0.5, 1.1, 3.0}}};
  return table;
}

std::vector<std::string> changed(const std::function<void(MeasuredTable&)>& change,
                                 const std::vector<std::string>& absent = {}) {
  MeasuredTable now = errors();
  change(now);
  return differences(errors(), now, absent);
}

}  // namespace

TEST_CASE("a figure is as before within margin and share of its column, and told with both numbers beyond") {
  CHECK(changed([](MeasuredTable&) {}).empty());
  CHECK(changed([](MeasuredTable& t) { t.rows[0].values[0] += 0.0199; }).empty());
  CHECK(changed([](MeasuredTable& t) { t.rows[0].values[0] -= 0.0199; }).empty());
  for (const double by : {0.0211, -0.0211}) {
    const auto found = changed([&](MeasuredTable& t) { t.rows[0].values[0] += by; });
    REQUIRE(found.size() == 1);
    CHECK_THAT(found[0], Tells("technique.errors", "room, 32", "light", "kept 0.123", 0.02));
  }
  CHECK(changed([](MeasuredTable& t) { t.rows[2].values[1] *= 1.09; }).empty());
  CHECK(changed([](MeasuredTable& t) { t.rows[2].values[1] *= 1.12; }).size() == 1);
  // What is no number stays none.
  CHECK(changed([](MeasuredTable& t) { t.rows[1].values[2] = 2.0; }).size() == 1);
  CHECK(changed([](MeasuredTable& t) { t.rows[0].values[0] = kNone; }).size() == 1);
}

TEST_CASE("times are compared on the device alone that they were kept on") {
  const auto slower = [](MeasuredTable& t) { t.rows[0].values[2] *= 3.0; };
  const auto elsewhere = [](MeasuredTable& t) { t.device = "another"; };
  CHECK(changed(slower).size() == 1);
  CHECK(changed([&](MeasuredTable& t) { slower(t), elsewhere(t); }).empty());
  CHECK(changed([&](MeasuredTable& t) { t.rows[0].values[0] = 1.0, elsewhere(t); }).size() == 1);
}

TEST_CASE("rows that only one of two tables has are told, but for those that cannot be measured here") {
  const auto shorter = [](MeasuredTable& t) { t.rows.pop_back(); };
  const auto longer = [](MeasuredTable& t) { t.rows.push_back({"vault", {1, 1, 1}}); };
  CHECK_THAT(changed(shorter).at(0), Tells("hall, 32", "not measured"));
  CHECK(changed(shorter, {"hall"}).empty());
  CHECK_THAT(changed(longer).at(0), Tells("vault", "not kept"));
  CHECK_THAT(changed([](MeasuredTable& t) { t.columns[1].name = "energy"; }).at(0), Tells("columns"));
}

TEST_CASE("measured tables are kept rounded, a line for each row, and read again") {
  const test::TemporaryDirectory directory;
  const std::string json = measuredTablesAsJson({errors(), errors()});
  CHECK_THAT(json, Contains("\n   [\"room, 32\",0.123,0.98,2.0],\n   [\"room, 64\",0.1,1.0,null],\n"));
  const auto file = directory.write("tables.json", json);
  const std::vector<MeasuredTable> read = readMeasuredTables(file);
  REQUIRE(read.size() == 2);
  CHECK(differences(read[0], errors()).empty());
  CHECK(read[0].test == errors().test);
  CHECK(read[0].seconds == 62.0);
  CHECK(read[0].columns[0].margin == 0.02);
  CHECK(read[0].columns[1].share == 0.1);
  CHECK(read[0].columns[2].ofTimes);
  CHECK(measuredTablesAsJson(read) == json);
  CHECK(readMeasuredTables(directory.write("none.json", measuredTablesAsJson({}))).empty());
  for (const char* text : {"", "[", "{}", "{\"version\": 2, \"tables\": []}", "{\"version\": 1}",
                           "{\"version\": 1, \"tables\": [{\"table\": 7}]}"})
    CHECK_THROWS_MATCHES(readMeasuredTables(directory.write("bad.json", text)), Error, Tells("bad.json"));
  std::string shorter = json;
  shorter.replace(shorter.find("0.123,"), 6, "");
  CHECK_THROWS_MATCHES(readMeasuredTables(directory.write("bad.json", shorter)), Error,
                       Tells("room, 32", 2, 3));
}

TEST_CASE("cards quote measured tables whole, in part, with scenes side by side, and single figures") {
  const auto written = [](const std::string& text) {
    return withMeasuredPassages(text, "card.md", {errors()});
  };
  CHECK(written("nothing") == "nothing");
  CHECK(written("a <!-- measured value technique.errors; room, 64; ratio -->9<!-- end --> b") ==
        "a <!-- measured value technique.errors; room, 64; ratio -->1.00<!-- end --> b");
  CHECK(
      written("<!-- measured table technique.errors; room -->\nold\n<!-- end -->") ==
      "<!-- measured table technique.errors; room -->\n\n| | light | ratio | time |\n| --- | --- | --- | --- |\n"
      "| room, 32 | 0.123 | 0.98 | 2.0 |\n| room, 64 | 0.100 | 1.00 | |\n\n<!-- end -->");
  CHECK_THAT(written("<!-- measured table technique.errors --><!-- end -->"),
             Contains("| hall, 32 | 0.500 |"));
  const std::string across = written("<!-- measured across technique.errors; room; hall --><!-- end -->");
  CHECK_THAT(across, Contains("| | room: light, ratio, time | hall: light, ratio, time |\n") &&
                         Contains("| 32 | 0.123, 0.98, 2.0 | 0.500, 1.10, 3.0 |\n") &&
                         Contains("| 64 | 0.100, 1.00 | |\n"));
  CHECK(written(across) == across);
  CHECK_THAT(written("<!-- measured across technique.errors; of time, light; room; hall --><!-- end -->"),
             Contains("| | room: time, light | hall: time, light |\n") &&
                 Contains("| 32 | 2.0, 0.123 | 3.0, 0.500 |\n"));
  CHECK_THAT(written("<!-- measured table technique.errors; of ratio; hall --><!-- end -->"),
             Contains("\n\n| | ratio |\n| --- | --- |\n| hall, 32 | 1.10 |\n\n"));
  // Within an item of a list a table stays in it.
  const std::string item =
      written("- an item:\n\n  <!-- measured table technique.errors; hall -->x<!-- end -->\n- b");
  CHECK_THAT(item, Contains(" -->\n\n  | | light | ratio | time |\n  | --- |") &&
                       Contains("\n  | hall, 32 | 0.500 | 1.10 | 3.0 |\n\n  <!-- end -->\n- b"));
  CHECK(written(item) == item);
  // Passages of the other kind stay as they are.
  const std::string other = "<!-- reproduced table x -->\n<!-- end -->";
  CHECK(written(other) == other);
}

TEST_CASE("a passage of a measured table that cannot be written is refused at its line") {
  const auto [passage, told] = GENERATE(table<const char*, Tells>({
      {"table technique.error -->", Tells("card.md:2", "mean", "technique.errors")},
      {"table technique.errors; cave -->", Tells("cave")},
      {"across technique.errors; roo -->", Tells("roo, ")},
      {"across technique.errors -->", Tells("BEGINNING")},
      {"across technique.errors; of light, rato; room -->", Tells("ratio")},
      {"value technique.errors; room, 64; rato -->", Tells("ratio")},
      {"value technique.errors; room, 65; ratio -->", Tells("room, 64")},
      {"value technique.errors; room, 64 -->", Tells("COLUMN")},
      {"values technique.errors -->", Tells("mean", "value")},
  }));
  CAPTURE(passage);
  const auto write = [](const std::string& text) {
    withMeasuredPassages("one\n<!-- measured " + text, "card.md", {errors()});
  };
  CHECK_THROWS_MATCHES(write(std::string(passage) + "<!-- end -->"), Error, told);
  CHECK_THROWS_MATCHES(write("table technique.errors -->"), Error, Tells("no end"));
}
