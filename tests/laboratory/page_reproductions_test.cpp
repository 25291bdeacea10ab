// Figures of papers as sheets and curves, and results that are kept and quoted, on made-up measurements.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/analysis/judge.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/page/contact_sheet.h"
#include "lumivox/page/reproduction_page.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Contains;
using lumivox::test::Tells;

namespace {

MeasuredRow row(const std::string& name, double published, double median) {
  MeasuredRow result;
  result.name = name;
  result.published = published;
  result.measured = TimingStatistics{median, median, median, median, median, 5};
  return result;
}

ShownPanel panel(const std::string& name, int width, int height, float radiance) {
  ShownPanel result;
  result.name = name;
  result.image = ImageBuffer(width, height, 3, radiance);
  result.meanLuminance = radiance;
  return result;
}

ReproducedResult aTable() {
  ReproducedResult result;
  result.published.id = "table-1";
  result.published.title = "A | B";
  result.published.paper = "nobody";
  result.published.differences = {"everything"};
  result.device.renderer = "none";
  result.rows = {row("a", 1.0, 2.0), row("b", 3.0, 6.6), row("c, d", 9.0, 100.0)};
  result.rows.push_back(row("half", 2.0, 4.0));
  result.rows.back().over = "a";
  MeasuredRow absent;
  absent.name = "absent";
  absent.published = 4.0;
  absent.whyNot = "it is not here";
  result.rows.push_back(absent);
  result.judged = judge(result.rows);
  result.command = "lumivox reproduce";
  return result;
}

ReproducedResult figure() {
  ReproducedResult result;
  result.published.id = "figure-2";
  result.published.title = "Growth";
  MeasuredCurve curve;
  curve.name = "volume";
  curve.over = "resolution";
  curve.growth = Growth::linear;
  for (const double x : {32.0, 64.0, 128.0}) {
    MeasuredPoint point;
    point.x = x;
    point.measured = TimingStatistics{x / 10.0, x / 11.0, x / 9.0, x / 12.0, x / 8.0, 7};
    curve.points.push_back(point);
  }
  curve.points.emplace_back().x = std::nan("");
  result.curves = {curve};
  result.judgedCurves = {judgeGrowth(curve)};
  result.panels = {panel("lit", 200, 100, 1.0f), ShownPanel{}};
  result.panels[1].name = "absent";
  result.panels[1].whyNot = "not built";
  result.panels[1].meanLuminance = std::nan("");
  return result;
}

/// How many pixels of a rectangle are as dark as letters.
int ink(const ImageBuffer& sheet, int left, int top, int width, int height) {
  int count = 0;
  for (int y = top; y < top + height; ++y)
    for (int x = left; x < left + width; ++x) count += sheet.at(x, y, 0) == 0.0f ? 1 : 0;
  return count;
}

}  // namespace

TEST_CASE("what is no radiance is shown as it is beside radiance that is exposed, and told without a unit") {
  ReproducedResult result = figure();
  result.published.columns = 2;
  result.panels = {panel("light", 200, 100, 0.02f), panel("openness", 200, 100, 0.5f)};
  result.panels[1].image = ImageBuffer(200, 100, 1, 0.5f);
  result.panels[1].radiance = false;
  result.exposure = 3.0;
  const ImageBuffer sheet = contactSheet(result);
  CHECK(sheet.at(100, 60, 0) == toneMapped(0.16f, kShownTone));
  for (int c = 0; c < 3; ++c) CHECK(sheet.at(206 + 100, 60, c) == 0.5f);
  const std::string text = reproductionsAsMarkdown({result});
  CHECK_THAT(text, Contains("Panel light, mean 0.02 W/(sr m²)"));
  CHECK_THAT(text, Contains("Panel openness, mean 0.5\n"));
  CHECK_THAT(text, Contains("Exposure of all panels of radiance: +3.00 EV"));
  const test::TemporaryDirectory directory;
  const std::vector<ReproducedResult> read =
      readReproductions(directory.write("kept.json", reproductionsAsJson({result})));
  CHECK(read.at(0).panels.at(0).radiance);
  CHECK_FALSE(read.at(0).panels.at(1).radiance);
}

TEST_CASE("a sheet shows all panels under one exposure, side by side, each with its name below") {
  ReproducedResult result;
  result.published.id = "sheet";
  result.published.title = "t";
  result.published.columns = 2;
  result.panels = {panel("bright", 200, 100, 2.0f), panel("dim", 200, 100, 0.5f),
                   panel("half of the size", 100, 50, 1.0f), ShownPanel{}};
  result.panels[3].name = "absent";
  result.panels[3].whyNot = "directional voxels are not implemented";
  result.exposure = -2.0;
  const ImageBuffer sheet = contactSheet(result);
  // Two columns of 200 pixels with margins of 6; a line of title, then panels of 100 and a line of 16 with
  // two margins each.
  REQUIRE(sheet.width() == 2 * 206 + 6);
  REQUIRE(sheet.height() == 16 + 6 + 2 * (100 + 16 + 12));
  const int first = 28, second = first + 128;
  for (const int x : {6, 205}) {
    CHECK(sheet.at(x, first, 0) == toneMapped(0.5f, kShownTone));
    CHECK(sheet.at(x, first + 99, 2) == toneMapped(0.5f, kShownTone));
    CHECK(sheet.at(x + 206, first, 1) == toneMapped(0.125f, kShownTone));
    // An image of half the size fills the same place.
    CHECK(sheet.at(x, second + 99, 0) == toneMapped(0.25f, kShownTone));
  }
  CHECK(sheet.at(5, first, 0) == 1.0f);
  CHECK(ink(sheet, 6, 0, 400, 20) > 0);
  for (const int left : {6, 212})
    for (const int top : {first, second}) CHECK(ink(sheet, left, top + 100, 200, 16) > 0);
  // Why there is none stands in the place of the image; names differ.
  CHECK(ink(sheet, 212, second, 200, 100) > 0);
  CHECK(ink(sheet, 6, first, 200, 100) == 0);
  CHECK(ink(sheet, 6, second + 100, 200, 16) > ink(sheet, 6, first + 100, 200, 16));
  result.panels.clear();
  CHECK_THROWS_AS(contactSheet(result), Error);
}

TEST_CASE("names of any bytes are written on a sheet, long ones in several lines") {
  ReproducedResult result;
  result.panels = {panel("\xC3\xA9t\xC3\xA9 \x01 128\xC2\xB3 \xFF", 160, 20, 1.0f)};
  const int height = contactSheet(result).height();
  result.panels[0].name = std::string(60, 'w') + " " + std::string(60, 'w') + " and more";
  CHECK(contactSheet(result).height() > height + 16);
}

TEST_CASE("curves come as rows of numbers and as a drawing with a line of slope one") {
  const std::string csv = curvesAsCsv(figure());
  CHECK_THAT(csv, Contains("\"volume\",resolution,64,time,ms,6.4,5.81818182,7.11111111,7,\"\"\n"));
  CHECK_THAT(csv, Contains("\"volume\",resolution,,time,ms,,,,0,\"\"\n"));
  ReproducedResult harmful = figure();
  harmful.curves[0].name = "<script>";
  const std::string svg = curvesAsSvg(harmful);
  CHECK_THAT(svg, Contains("&lt;script&gt;") && !Contains("<script>"));
  CHECK_THAT(svg, Contains("resolution^1.00") && Contains("reproduced"));
  CHECK(svg.find("nan") == std::string::npos);
  std::size_t circles = 0;
  for (std::size_t at = 0; (at = svg.find("<circle", at)) != std::string::npos; ++at) ++circles;
  CHECK(circles == 3);
  CHECK_THAT(svg, Contains("stroke-dasharray"));
  for (MeasuredPoint& point : harmful.curves[0].points) point.measured.reset();
  CHECK_THAT(curvesAsSvg(harmful), Contains("nothing was measured"));
}

TEST_CASE("results are read as they were kept, and judged anew") {
  const test::TemporaryDirectory directory;
  const std::string json = reproductionsAsJson({figure(), aTable()});
  const auto file = directory.write("kept.json", json);
  const std::vector<ReproducedResult> read = judged(readReproductions(file));
  REQUIRE(read.size() == 2);
  CHECK(reproductionsAsJson(read) == json);
  CHECK(reproductionsAsMarkdown(read) == reproductionsAsMarkdown({figure(), aTable()}));
  CHECK(read[1].judged.rows[1].verdict == Verdict::reproduced);
  CHECK(read[1].judged.rows[2].verdict == Verdict::notReproduced);
  CHECK(read[0].judgedCurves[0].verdict == Verdict::reproduced);
  // A verdict that somebody wrote into the file counts for nothing.
  std::string forged = json;
  forged.replace(forged.find("\"verdict\": \"not reproduced\""), 27, "\"verdict\": \"reproduced\"");
  CHECK(reproductionsAsJson(judged(readReproductions(directory.write("forged.json", forged)))) == json);
}

TEST_CASE("a file that keeps no results is refused with its name and the place") {
  const test::TemporaryDirectory directory;
  const auto refuse = [&](const std::string& text, const Tells& told) {
    CHECK_THROWS_MATCHES(readReproductions(directory.write("bad.json", text)), Error, told);
  };
  const auto changed = [](std::string json, std::size_t at, std::size_t length, const char* by) {
    return json.replace(at, length, by);
  };
  for (const char* text : {"", "[", "{}", "{\"version\": 1}", "[]", "7"}) refuse(text, Tells("bad.json"));
  refuse("{\"version\": 2, \"results\": []}", Tells("bad.json", "expected 1"));
  const std::string both = reproductionsAsJson({figure(), aTable()}), one = reproductionsAsJson({aTable()});
  refuse(changed(both, both.rfind("\"measures\": \"time\""), 18, "\"measures\": \"mood\""),
         Tells("results[1]", "mood"));
  refuse(changed(one, one.find("\"published\": 1.0"), 16, "\"published\": \"1\""), Tells("results[0]"));
}

TEST_CASE("a passage of a card is written from the kept results, and what stands around it stays") {
  const std::vector<ReproducedResult> results{aTable(), figure()};
  const auto written = [&](const std::string& text) {
    return withReproducedPassages(text, "card.md", results);
  };
  CHECK(written("nothing here") == "nothing here");
  const std::string ratios = "x <!-- reproduced ratios table-1; a; b -->1 : 99<!-- end --> y\n";
  CHECK(
      written(ratios) ==
      "x <!-- reproduced ratios table-1; a; b -->a : b = 1 : 3.3, published 1 : 3: *reproduced*; the whole table "
      "*not reproduced*<!-- end --> y\n");
  // An example of how a passage is written is none.
  const std::string shown = "```text\n<!-- reproduced table nothing --> ...\n```\n";
  CHECK(written(shown + ratios) == shown + written(ratios));
  // Again, and nothing changes.
  CHECK(written(written(ratios)) == written(ratios));
  // Ratios are to the first row that is named: 100 / 6.6 for 9 / 3.
  CHECK_THAT(
      written("<!-- reproduced ratios table-1; b; c, d; absent --><!-- end -->"),
      Contains(
          "-->b : c, d : absent = 1 : 15.2 : -, published 1 : 3 : 1.33: *not reproduced*, *not comparable* (it is not "
          "here); the whole table"));
  // What all names share, at their beginning or at their end, stands once.
  ReproducedResult shared = aTable();
  shared.rows[0].name = "room, 64, time";
  shared.rows[1].name = "room, 128, time";
  shared.rows[2].name = "room, 64, memory";
  const auto ofShared = [&](const std::string& names) {
    return withReproducedPassages("<!-- reproduced ratios table-1; " + names + " --><!-- end -->", "card.md",
                                  {shared});
  };
  CHECK_THAT(ofShared("room, 64, time; room, 128, time"), Contains("-->64 : 128 (room, time) = 1 : 3.3, "));
  CHECK_THAT(ofShared("room, 64, time; room, 64, memory"), Contains("-->time : memory (room, 64) = 1 : "));
  CHECK_THAT(ofShared("room, 64, time; half"), Contains("-->room, 64, time; half = "));
  // A row with a divisor of its own is no part of a chain.
  CHECK_THAT(written("<!-- reproduced ratios table-1; half --><!-- end -->"),
             Contains("-->half = 2, published 2: *reproduced*"));
  CHECK_THAT(written("<!-- reproduced curve figure-2; volume --><!-- end -->"),
             Contains("-->resolution^1.00") && Contains("(published: linear), reproduced<"));
  // By the name that people know it by, too.
  ReproducedResult cited = aTable();
  cited.published.id = "004-table-1";
  cited.published.paper = "Lensing and Broll 2013, Table 1";
  for (const char* name : {"004-table-1", "lensing2013-table-1"})
    CHECK_THAT(
        withReproducedPassages("<!-- reproduced ratios " + std::string(name) + "; a; b --><!-- end -->",
                               "card.md", {cited}),
        Contains("-->a : b = 1 : 3.3, "));
  const std::string whole = written("<!-- reproduced table table-1 -->\nold\n<!-- end -->\nafter");
  CHECK_THAT(whole, Contains("| c, d | 9 ms | 100 [100, 100] ms | 9 | 50 | not reproduced |\n"));
  CHECK_THAT(whole, !Contains("| absent |") && !Contains("old") && Contains("Not reproduced: ") &&
                        Contains("\n\n<!-- end -->\nafter"));
}

TEST_CASE("a passage that cannot be written is refused at its line") {
  const auto [passage, told] = GENERATE(table<const char*, Tells>({
      {"<!-- reproduced table table-1 -->", Tells("card.md:2", "no end")},
      {"<!-- reproduced table table-1", Tells("card.md:2")},
      {"<!-- reproduced table table-1 --> <!-- reproduced table table-1 --><!-- end -->", Tells("no end")},
      {"\n<!-- reproduced table table-2 --><!-- end -->", Tells("card.md:3", "mean", "table-1")},
      {"<!-- reproduced ratios table-1; a; bb --><!-- end -->", Tells("no row", "bb")},
      {"<!-- reproduced ratios table-1 --><!-- end -->", Tells("ROW")},
      {"<!-- reproduced curve figure-2; volumes --><!-- end -->", Tells("volume")},
      {"<!-- reproduced curve table-1; volume --><!-- end -->", Tells("no curve")},
      {"<!-- reproduced tables table-1 --><!-- end -->", Tells("mean", "table")},
      {"<!-- reproduced table table-1; a --><!-- end -->", Tells("table ID")},
  }));
  CAPTURE(passage);
  CHECK_THROWS_MATCHES(
      withReproducedPassages(std::string("one\n") + passage, "card.md", {aTable(), figure()}), Error, told);
}

TEST_CASE("kept results that no longer fit their text are told apart") {
  const ReproducedResult kept = aTable();
  PublishedResult text = kept.published;
  for (const MeasuredRow& row : kept.rows) {
    PublishedRow& one = text.rows.emplace_back();
    one.name = row.name;
    one.published = row.published;
    one.over = row.over;
    one.absent = row.whyNot;
  }
  CHECK(staleReproductions({kept}, {text}).empty());
  const auto stale = [&](const auto& change) {
    PublishedResult changed = text;
    change(changed);
    const std::vector<std::string> found = staleReproductions({kept}, {changed});
    return found.size() == 1 ? found[0] : fmt::format("{} findings", found.size());
  };
  CHECK_THAT(stale([](auto& t) { t.rows[1].published = 3.5; }), Tells("b", 3.5));
  CHECK_THAT(stale([](auto& t) { t.rows[1].name = "bb"; }), Tells("bb"));
  CHECK_THAT(stale([](auto& t) { t.rows.pop_back(); }), Tells("5 rows"));
  CHECK_THAT(stale([](auto& t) { t.rows[0].absent = "gone"; }), Tells("a", "absent"));
  CHECK_THAT(stale([](auto& t) { t.rows[1].substitute = "another"; }), Tells("substitute"));
  CHECK_THAT(stale([](auto& t) { t.differences = {"nothing"}; }), Tells("differences"));
  CHECK_THAT(stale([](auto& t) { t.panels.emplace_back(); }), Tells("panels"));
  CHECK_THAT(stale([](auto& t) { t.curves.emplace_back(); }), Tells("curves"));
  CHECK_THAT(staleReproductions({}, {text})[0], Tells("table-1", "recorded"));
  CHECK_THAT(staleReproductions({kept}, {})[0], Tells("table-1", "text"));
}
