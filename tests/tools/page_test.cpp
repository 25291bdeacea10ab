// Pages in a browser without a network: every plot is drawn, every slider and choice changes what is shown,
// no script fails, nothing is asked for from elsewhere. The check itself is tried on pages that are broken.
#include <algorithm>

#include "lumivox/page/stress_page.h"
#include "support/page_check.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Says why the test does not apply here; false: it does.
bool lacksBrowser() {
  if (Browser::program()) return false;
  skip("no chromium on the path");
  return true;
}

/// A page of which the check has nothing to say: a drawing, a slider that moves it, a table, a link.
constexpr const char* kGoodPage = R"html(<!doctype html>
<html><head><meta name="viewport" content="width=device-width"><title>A page</title></head>
<body><h1 id="top">A page</h1><canvas width="64" height="64" aria-label="a drawing"></canvas>
<input type="range" min="0" max="64" value="32" aria-label="how far">
<label>Colour <select><option>blue</option><option>red</option></select></label>
<table><tbody><tr><td>1</td></tr></tbody></table><a href="#top">up</a>
<script>
const canvas = document.querySelector("canvas"), slider = document.querySelector("input"), choice = document.querySelector("select");
const draw = () => {
  const context = canvas.getContext("2d");
  context.fillStyle = "white"; context.fillRect(0, 0, 64, 64);
  context.fillStyle = choice.value; context.fillRect(0, 0, slider.value, 64);
};
slider.addEventListener("input", draw);
choice.addEventListener("change", draw);
draw();
</script></body></html>
)html";

/// The good page with one piece in place of another.
PageFindings checkBroken(Browser& browser, const TemporaryDirectory& place, const std::string& from,
                         const std::string& to) {
  std::string page = kGoodPage;
  const std::size_t at = page.find(from);
  REQUIRE(at != std::string::npos);
  return checkPage(browser, place.write("broken.html", page.replace(at, from.size(), to)));
}

/// Direct light with two points in its sweep, quick enough for a test.
constexpr const char* kDirect =
    "pipeline \"Direct\" {\n  param samples 4 in 1..16\n  pass gbuffer direct_lighting.gbuffer { }\n"
    "  pass shadow direct_lighting.shadow_map { size 64  area_samples $samples }\n"
    "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n  output direct "
    "direct.radiance\n}\nsweep samples { samples [1 4] }\n";

}  // namespace

TEST_CASE("the check finds nothing wrong with a good page and something wrong with each broken one") {
  if (lacksBrowser()) return;
  const TemporaryDirectory place;
  Browser browser;
  const PageFindings good = checkPage(browser, place.write("good.html", kGoodPage));
  INFO(good.text());
  CHECK(good.problems.empty());
  CHECK(good.canvases == 1);
  CHECK(good.rows == 1);
  REQUIRE(good.controls.size() == 2);
  CHECK(good.controls[0].changed > 500);

  struct Break {
    const char *from, *to, *told;
  };
  for (const Break& one : {
           Break{"draw();\n</script>", "</script>", "it is blank"},
           Break{"draw();\n</script>", "draw(); nothing.at(all);\n</script>", "script: ReferenceError"},
           Break{"draw();\n</script>", "draw(); console.error('lost');\n</script>", "console.error"},
           Break{"draw();\n</script>", "draw(); Promise.reject(new Error('later'));\n</script>", "later"},
           Break{"draw();\n</script>", "draw(); fetch('http://example.org/x');\n</script>",
                 "elsewhere: http"},
           Break{"<h1", "<img src=\"https://example.org/a.png\"><h1", "load from elsewhere"},
           Break{"<h1", "<img src=\"nowhere.png\"><h1", "does not show"},
           Break{"\"input\", draw", "\"other\", draw", "how far: it changes nothing"},
           Break{"\"change\", draw", "\"other\", draw", "select: it changes nothing"},
           Break{"<tr><td>1</td></tr>", "", "it has no rows"},
           Break{"<td>1</td>", "<td>undefined</td>", "it says undefined"},
           Break{"#top", "#bottom", "leads nowhere"},
           Break{"#top", "images/none.png", "not there: images/none.png"},
           Break{"<h1", "<div style=\"width:900px\">wide</div><h1", "too wide for a phone"},
           Break{"<h1", "<div style=\"width:1900px\">wide</div><h1", "too wide for a desk"},
           Break{"<h1", "<div style=\"width:850px\">wide</div><h1", "too wide for a tablet"},
           Break{"<h1", "<div style=\"position:absolute;top:30px\">above</div><h1", "lie upon each other"},
           Break{"<h1", "<p style=\"width:60px;overflow:hidden;white-space:nowrap\">a long text</p><h1",
                 "is cut"},
           Break{"<h1",
                 "<figcaption style=\"width:60px;overflow-wrap:anywhere\">reference_of_all</figcaption><h1",
                 "of a caption is broken"},
           Break{"<h1", "<p style=\"color:#bbb\">pale</p><h1", "on a light page: “pale” has a contrast of"},
           Break{"<label>", "<span>", "no name for a screen reader"},
       }) {
    const PageFindings broken = checkBroken(browser, place, one.from, one.to);
    INFO(one.to << "\n" << broken.text());
    CHECK(broken.hasProblem(one.told));
  }
}

TEST_CASE(
    "the report draws all plots, its sliders and choices change what is shown, and it needs no network") {
  if (lacksBrowser()) return;
  const Workplace place;
  place.write("direct.pipeline", kDirect);
  const auto report = [&](const char* name, const auto&... words) {
    ran("report", place.scene(), words..., committedPipeline("voxel_cone_tracing"),
        "-q --set resolution=8 --resolution 24x24 --spp 16 --subpixels 1 --repeats 2 -o", place / name);
  };
  report("page.html", sourceDirectory() / "scenes/cornell_glossy.scene", "--voxels 4 --pipeline",
         place / "direct.pipeline");
  Browser browser;
  const PageFindings page = checkPage(browser, place.file("page.html"));
  INFO(page.text());
  CHECK(page.problems.empty());

  // Per scene a plot of error against time, and a frame with two images per component; none against recall,
  // which is 1 at all points. And the voxelizers.
  CHECK(page.charts == 4);
  CHECK(page.canvases > page.charts);
  // The first screen holds a plot and a row of images; what else there is is folded.
  CHECK(page.firstChartEnds < 900.0);
  CHECK(page.firstImageEnds < 900.0);
  CHECK(page.height < 3200.0);
  CHECK(page.tables > 10);
  CHECK(page.rows > 50);
  const auto sliders = std::count_if(page.controls.begin(), page.controls.end(),
                                     [](const PageFindings::Control& control) { return control.slider; });
  CHECK(sliders >= 5);
  for (const PageFindings::Control& control : page.controls) {
    INFO(control.name);
    // More than the line between the images moves: the image itself.
    if (control.slider) CHECK(control.changed > 2 * 24);
  }

  // The same page without its plots is found out.
  std::string broken = place.read("page.html");
  for (std::size_t at = broken.find("new Chart(canvas"); at != std::string::npos;
       at = broken.find("new Chart(canvas", at + 1))
    broken.replace(at, 9, "String");
  const PageFindings blank = checkPage(browser, place.write("blank.html", broken));
  CHECK(blank.charts == 0);
  CHECK(blank.hasProblem("it is blank"));

  // A brief page passes the same check.
  report("brief.html", "--brief --no-sweep --pipeline");
  const PageFindings small = checkPage(browser, place.file("brief.html"));
  INFO(small.text());
  CHECK(small.problems.empty());
  CHECK(small.height < 1600.0);
  CHECK(small.images < page.images);
}

TEST_CASE("the page of the voxelizers draws all plots and needs no network") {
  if (lacksBrowser()) return;
  const Workplace place;
  ran("voxels", place.scene(), "-q --resolution 4,8 --repeats 1 --scaling -o", place / "voxels");
  Browser browser;
  const PageFindings page = checkPage(browser, place.file("voxels/index.html"));
  INFO(page.text());
  CHECK(page.problems.empty());
  CHECK(page.charts == 3);
}

TEST_CASE("the matrix of the stress battery fits windows and paper in blocks, with every pipeline in it") {
  if (lacksBrowser()) return;
  const TemporaryDirectory place;
  std::vector<StressCell> cells;
  // As many pipelines of as many techniques as are committed, with names and numbers as long as theirs.
  for (int pipeline = 0; pipeline < 24; ++pipeline)
    for (const char* name : {"homogeneous_medium_dense", "gather.clearance_highest", "image_1x1"}) {
      StressCell cell;
      cell.family = "stiff_transport";
      cell.name = name;
      cell.technique = pipeline < 14 ? "voxelization" : pipeline < 20 ? "light_propagation_volumes" : "smoke";
      cell.pipeline = "light_propagation_volumes_" + std::to_string(pipeline) + ".pipeline";
      cell.outcome = pipeline % 3 == 0   ? StressOutcome::refused
                     : pipeline % 3 == 1 ? StressOutcome::diverges
                                         : StressOutcome::stable;
      cell.created = "2026-01-01 00:00:00 UTC";
      cell.device = "device";
      cell.measure = "RMSE";
      cell.value = {0.00123 * (pipeline + 1), 1e-5};
      cell.detail = "the light is bounded";
      cell.command = "lumivox stress";
      cells.push_back(cell);
    }
  Browser browser;
  const PageFindings page = checkPage(browser, writeStressPage(place.path(), cells, "lumivox stress"));
  INFO(page.text());
  CHECK(page.problems.empty());
  // The legend, three blocks in the widest window and the table of stable cells.
  CHECK(page.tables == 4);
}
