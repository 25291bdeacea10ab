// compare on real EXR files, good and bad.
#include <cmath>
#include <limits>

#include "lumivox/base/image.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Two layers of 8 x 8 pixels with one value each.
void writeConstant(const std::filesystem::path& file, float direct, float indirect) {
  LayeredImage image;
  image.layers["direct"] = ImageBuffer(8, 8, 3, direct);
  image.layers["indirect_diffuse"] = ImageBuffer(8, 8, 3, indirect);
  writeExr(file, image);
}

nlohmann::json compareAsJson(const Workplace& place, const std::string& options) {
  const CommandResult result =
      ran("compare", place.file("a.exr"), place.file("b.exr"), "--json", Raw{options});
  return nlohmann::json::parse(result.output).at("layers");
}

}  // namespace

TEST_CASE("compare gives each common layer its own error") {
  const Workplace place;
  writeConstant(place.path() / "a.exr", 1.0f, 0.5f);
  writeConstant(place.path() / "b.exr", 0.75f, 0.5f);
  const auto layers = compareAsJson(place, "");
  REQUIRE(layers.size() == 2);
  // Constant images: the RMSE is the difference, the mean ratio the quotient.
  CHECK(layers[0]["layer"] == "direct");
  CHECK(layers[0]["rmse"]["value"].get<double>() == Approx(0.25));
  CHECK(layers[0]["mean_ratio"]["value"].get<double>() == Approx(1.0 / 0.75));
  CHECK(layers[1]["rmse"]["value"].get<double>() == 0.0);
  const CommandResult table = typed("compare", place.file("a.exr"), place.file("b.exr"));
  CHECK(contains(table.output, "indirect_diffuse"));
}

TEST_CASE("compare takes a chosen layer, or two layers of different names, and can be a gate") {
  const Workplace place;
  writeConstant(place.path() / "a.exr", 1.0f, 0.5f);
  writeConstant(place.path() / "b.exr", 0.75f, 0.5f);
  CHECK(compareAsJson(place, "--layer indirect_diffuse").size() == 1);
  const auto crossed = compareAsJson(place, "--layer direct=indirect_diffuse");
  CHECK(crossed[0]["rmse"]["value"].get<double>() == Approx(0.5));
  const std::string both = "'" + place.file("a.exr") + "' '" + place.file("b.exr") + "'";
  CHECK(typed("compare", Raw{both}, "--rmse-at-most 0.3").exitCode == 0);
  CHECK(typed("compare", Raw{both}, "--rmse-at-most 0.2").exitCode == 1);
  checkRefused(typed("compare", Raw{both}, "--layer indirekt_diffuse"), "did you mean 'indirect_diffuse'");
}

TEST_CASE("NaN and infinite pixels are counted and do not spread into the numbers") {
  const Workplace place;
  writeConstant(place.path() / "b.exr", 0.75f, 0.5f);
  LayeredImage image;
  image.layers["direct"] = ImageBuffer(8, 8, 3, 1.0f);
  image.layers["direct"].at(3, 4, 1) = std::numeric_limits<float>::quiet_NaN();
  image.layers["direct"].at(5, 6, 0) = std::numeric_limits<float>::infinity();
  writeExr(place.path() / "a.exr", image);
  const auto layers = compareAsJson(place, "");
  CHECK(layers[0]["non_finite_image"] == 2);
  CHECK(layers[0]["rmse"]["value"].get<double>() == Approx(0.25));
}

TEST_CASE("an image that is almost all NaN passes no limit, and compare says how many pixels it left out") {
  const Workplace place;
  writeConstant(place.path() / "b.exr", 0.5f, 0.5f);
  LayeredImage image;
  image.layers["direct"] = ImageBuffer(8, 8, 3, std::numeric_limits<float>::quiet_NaN());
  for (int c = 0; c < 3; ++c) image.layers["direct"].at(0, 0, c) = 0.5f;
  writeExr(place.path() / "a.exr", image);
  const CommandResult result =
      typed("compare", place.file("a.exr"), place.file("b.exr"), "--rmse-at-most", "0.1");
  CHECK(result.exitCode == 1);
  CHECK(contains(result.errors, "63 of 64 pixels"));
}

TEST_CASE("the variance layers of the reference become the uncertainties") {
  const Workplace place;
  writeConstant(place.path() / "a.exr", 1.0f, 0.5f);
  LayeredImage reference;
  reference.layers["direct"] = ImageBuffer(8, 8, 3, 0.75f);
  reference.layers["direct.variance"] = ImageBuffer(8, 8, 3, 0.01f);
  writeExr(place.path() / "b.exr", reference);
  const auto layers = compareAsJson(place, "");
  REQUIRE(layers.size() == 1);  // the variance itself is not compared
  CHECK(layers[0]["reference_noise"].get<double>() == Approx(0.1).epsilon(1e-5));
  CHECK(layers[0]["rmse"]["uncertainty"].get<double>() > 0.0);
}

TEST_CASE("compare refuses images of other sizes and files without a layer in common") {
  const Workplace place;
  LayeredImage small, other;
  small.layers["direct"] = ImageBuffer(4, 4, 3, 1.0f);
  other.layers["grid"] = ImageBuffer(8, 8, 3, 1.0f);
  writeExr(place.path() / "small.exr", small);
  writeExr(place.path() / "other.exr", other);
  writeConstant(place.path() / "a.exr", 1.0f, 0.5f);
  checkRefused(typed("compare", place.file("a.exr"), place.file("small.exr")), "4 x 4");
  checkRefused(typed("compare", place.file("a.exr"), place.file("other.exr")), "no layer in common");
}

TEST_CASE("compare says of a PNG that it holds no linear radiance, and what to give in its place") {
  const Workplace place;
  const CommandResult result = typed("compare", place.file("a.png"), place.file("b.png"));
  checkRefused(result, "no linear radiance");
  CHECK(contains(result.errors, "-o NAME.exr"));
}

TEST_CASE("an EXR that is missing, empty, cut short or something else gives one clear error") {
  const Workplace place;
  writeConstant(place.path() / "a.exr", 1.0f, 0.5f);
  const std::string whole = place.read("a.exr");
  place.write("empty.exr", "");
  place.write("cut.exr", whole.substr(0, whole.size() / 2));
  place.write("head.exr", whole.substr(0, 20));
  place.write("text.exr", "scene \"no image\" {}\n");
  for (const char* name : {"missing.exr", "empty.exr", "cut.exr", "head.exr", "text.exr"}) {
    INFO(name);
    checkRefused(typed("compare", place.file(name), place.file("a.exr")), name);
    checkRefused(typed("compare", place.file("a.exr"), place.file(name)), name);
  }
}
