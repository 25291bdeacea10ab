// The printed form of a pass: values that parameters have in its paper, and the switch that sets them.
#include <algorithm>

#include "pipeline_toys.h"
#include "support/facts.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Prints three values, and leaves a fourth to the user.
struct Printed : Toy {
  using Toy::Toy;
  enum class Kernel { smooth, box };
  Param<Kernel> kernel{this, "kernel", Kernel::smooth, "of the filter", published(Kernel::box)};
  Param<int> taps{this, "taps", 9, within(1, 64), "of the filter", published(4)};
  Param<float> width{this, "width", 1.0f, within(0.0f, 8.0f), "m", "of the filter", published(0.5f)};
  Param<bool> clamps{this, "clamps", true, "below 0", published(false)};
  Param<int> rounds{this, "rounds", 1, within(1, 8), "of filtering"};
  Out<Image> image{this, "image", Contributes::direct};
  void run(PassContext& frame) override {
    image = paint(frame, static_cast<float>(taps) + 100.0f * static_cast<float>(kernel == Kernel::box) +
                             1000.0f * static_cast<float>(!clamps) + 0.25f * width);
  }
};
constexpr float kOurs = 9.0f + 0.25f, kTheirs = 4.0f + 100.0f + 1000.0f + 0.125f;

/// Differs in more than its parameters say.
struct Beyond : Toy {
  using Toy::Toy;
  Param<int> taps{this, "taps", 9, within(1, 64), "of the filter", published(4)};
  PublishedForm asPublished{this, "and with its slip"};
  Out<Image> image{this, "image", Contributes::direct};
  void run(PassContext& frame) override {
    image = paint(frame, static_cast<float>(taps) + (asPublished ? 1.0f : 0.0f));
  }
};

std::vector<std::string> namesOf(const Pass& pass) {
  std::vector<std::string> names;
  for (const ParamBase* parameter : pass.parameters()) names.push_back(parameter->name());
  return names;
}

/// The one value of the image of a pass with these words; `head` stands before it in the pipeline.
float valueWith(const std::string& words, const std::string& head = {}, const ParameterValues& values = {}) {
  Fixture f;
  f.techniques.add<Printed>("toy", "printed");
  RenderOptions options;
  options.width = options.height = 1;
  options.parameters = values;
  return f.executor(head + "pass p toy.printed { " + words + " }\noutput o p.image", options)
      .render(0.0)
      .outputs.at("o")
      .values()
      .front();
}

std::string refusalOf(const std::string& words) {
  return messageOf<DiagnosticsError>([&] { valueWith(words); });
}

}  // namespace

TEST_CASE("a pass with published values has the switch as_published, which tells them all") {
  std::vector<std::string> ran;
  const Printed pass(ran, "printed");
  CHECK(namesOf(pass) ==
        std::vector<std::string>{"kernel", "taps", "width", "clamps", "rounds", "as_published"});
  const ParamBase& form = *pass.parameters().back();
  CHECK(form.defaultText() == "off");
  CHECK(form.meaning() == "as printed: 'kernel box', 'taps 4', 'width 0.5 m', 'clamps off'");
  CHECK(pass.rounds.publishedText() == "");
}

TEST_CASE("a pass whose printed form is more than words declares the switch itself, and has one") {
  std::vector<std::string> ran;
  const Beyond pass(ran, "beyond");
  CHECK(namesOf(pass) == std::vector<std::string>{"taps", "as_published"});
  CHECK(pass.asPublished.meaning() == "as printed: 'taps 4', and with its slip");
}

TEST_CASE("as_published sets what the text does not state, and off leaves everything at its default") {
  CHECK(valueWith("") == kOurs);
  CHECK(valueWith("as_published off") == kOurs);
  CHECK(valueWith("as_published on") == kTheirs);
  CHECK(valueWith("as_published on  rounds 3") == kTheirs);
  CHECK(valueWith("as_published on  kernel box  taps 4") == kTheirs);
  CHECK(valueWith("kernel box") == kOurs + 100.0f);
}

TEST_CASE("as_published is refused beside another value, with both of them") {
  CHECK_THAT(
      refusalOf("as_published on  taps 5  kernel smooth"),
      Tells("p", "contradict", "as_published", "kernel box", "kernel smooth", "taps 4", "taps 5", "value"));
}

TEST_CASE("a pipeline's parameter overrides a printed form; its caller has the last word") {
  const std::string head = "param taps 9 in 1..64\nparam printed off\n";
  const std::string words = "taps $taps  as_published $printed";
  ParameterValue on;
  on.word = "on";
  CHECK(valueWith(words, head, {{"printed", on}}) == kTheirs);
  CHECK(valueWith(words, head) == kOurs);
  // What the text says gives way to a caller who wants the printed form.
  CHECK(valueWith(words + "  kernel smooth", head, {{"printed", on}}) == kTheirs);
  CHECK(valueWith(words + "  kernel smooth  rounds 2", head) == kOurs);
  ParameterValue five;
  five.number = 5;
  CHECK_THROWS_MATCHES(valueWith(words, head, {{"printed", on}, {"taps", five}}), DiagnosticsError,
                       Tells("taps 4", "taps 5"));
}

TEST_CASE("a pass alone takes its printed form on, and off again") {
  std::vector<std::string> ran;
  Printed pass(ran, "printed");
  ParamBase& form = *pass.parameters().back();
  REQUIRE(form.set("on").empty());
  CHECK(pass.applyPublished() == "");
  CHECK(pass.taps == 4);
  CHECK(pass.kernel == Printed::Kernel::box);
  CHECK_FALSE(pass.clamps);
  CHECK(pass.rounds == 1);
  REQUIRE(form.set("off").empty());
  CHECK(pass.applyPublished() == "");
  CHECK(pass.taps == 9);
  CHECK(pass.kernel == Printed::Kernel::smooth);
}
