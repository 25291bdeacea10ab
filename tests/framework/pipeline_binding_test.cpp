// Binding a pipeline to its techniques: every mistake has a message of its own, and all are reported at once.
#include "lumivox/base/log.h"
#include "pipeline_toys.h"
#include "support/facts.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace {

/// Reads an image of this frame and one of the frame before.
struct Echo : Toy {
  using Toy::Toy;
  In<Image> first{this, "first", Presence::optional, "of this frame"};
  In<Image> before{this, "before", Presence::history, "of the frame before"};
  Out<Image> sum{this, "sum", Contributes::direct};
  void run(PassContext& frame) override { sum = paint(frame, 1.0f); }
};

/// Two grids of which one has only its finest level, and a reader of all levels and of one component.
struct Grids : Toy {
  using Toy::Toy;
  Out<RadianceGrid> finest{this, "finest", "one level", Levels::finest};
  Out<RadianceGrid> whole{this, "whole", "all levels", Levels::all};
  Out<RadianceGrid> other{this, "other", "who knows"};
  Out<Image> direct{this, "direct", Contributes::direct};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse};
  Out<Image> share{this, "share", "no light"};
  void run(PassContext&) override {}
};
struct Reader : Toy {
  using Toy::Toy;
  In<RadianceGrid> grid{this, "grid", "all levels", Levels::all};
  In<Image> diffuse{this,    "diffuse",      Presence::optional,
                    "light", Needs::nothing, Contributes::indirectDiffuse};
  In<Image> share{this, "share", Presence::optional, "no light", Needs::nothing, Contributes::nothing};
  Out<Image> image{this, "image", Contributes::final};
  void run(PassContext&) override {}
};

/// Warnings of a pipeline whose reader has these inputs.
std::string warnings(const std::string& inputs) {
  TestTechniques techniques;
  techniques.add<Grids>("toy", "grids");
  techniques.add<Reader>("toy", "read");
  const LogCapture log;
  checkPipeline(pipelineOf("pass g toy.grids { }\npass r toy.read { " + inputs + " }\noutput o r.image"),
                techniques);
  return log.text();
}

/// Words as C++ has to write them, and as texts are to have them.
struct Words : Toy {
  using Toy::Toy;
  enum class Precision { float_, asPublished, half };
  Param<Precision> precision{this, "precision", Precision::asPublished, "of the sums"};
  Out<Image> image{this, "image", Contributes::direct};
  void run(PassContext& frame) override { image = paint(frame, 1.0f); }
};

/// Findings of a pipeline with this body, on the toys.
std::string findings(const std::string& body, const std::string& after = {}) {
  TestTechniques techniques;
  addToys(techniques).add<Echo>("toy", "echo");
  const Pipeline pipeline =
      Pipeline::parse("pipeline \"test\" {\n" + body + "\n}\n" + after, "test.pipeline");
  return messageOf<DiagnosticsError>([&] { checkPipeline(pipeline, techniques); });
}

}  // namespace

TEST_CASE("a pipeline whose ports and parameters fit is accepted") {
  const char* body = GENERATE(
      "pass voxels toy.voxels { resolution 16  width 30 cm  smooth on  layout dense }\npass view toy.paint { value -2 }\n"
      "pass gather toy.gather { grid voxels  view view.radiance }\noutput diffuse gather.diffuse",
      // A pass's name alone means its only output of the wanted kind.
      "pass voxels toy.voxels { }\npass gather toy.gather { grid voxels }\noutput o gather.diffuse",
      // An optional input may stay unconnected.
      "pass a toy.paint { }\npass s toy.add { first a }\noutput o s.sum",
      // A cycle leads through the frame before.
      "pass a toy.echo { before b.sum }\npass b toy.add { first a.sum }\noutput o b.sum",
      "pass a toy.echo { before a.sum }\npass b toy.add { first a.sum }\noutput o b.sum",
      // What makes no part of an image needs no output.
      "pass voxels toy.voxels { }");
  TestTechniques techniques;
  addToys(techniques).add<Echo>("toy", "echo");
  CHECK_NOTHROW(checkPipeline(pipelineOf(body), techniques));
}

TEST_CASE("each mistake in passes and their connections is told at its place, with what would fit") {
  const auto [body, told] = GENERATE(table<const char*, Tells>({
      {"pass a tpy.paint { }\noutput o a.x",
       Tells("test.pipeline:2:8", "technique", "tpy", "toy", "mean", "toy")},
      {"pass a toy.piant { }\noutput o a.x",
       Tells("test.pipeline:2:8", "toy", "piant", "paint, paint_camera", "mean", "paint")},
      {"pass v toy.voxels { resolutoin 8 }\noutput o v.grid",
       Tells("test.pipeline:2:21", "toy.voxels", "resolutoin", "resolution, width, smooth, layout", "mean",
             "resolution")},
      {"pass a toy.paint { }\npass g toy.gather { grid a.radiance }\noutput o g.diffuse",
       Tells("test.pipeline:3:26", "a.radiance", "Image", "grid", "g", "RadianceGrid")},
      {"pass v toy.voxels { }\noutput o v.grid", Tells("v.grid", "RadianceGrid", "o", "pipeline", "Image")},
      {"pass v toy.voxels { }\npass g toy.gather { }\noutput o g.diffuse",
       Tells("test.pipeline:3:6", "g", "lacks", "grid", "PASS.PORT", "RadianceGrid", "mean", "grid v.grid")},
      {"pass v toy.voxels { }\npass g toy.gather { grid v }\npass s toy.add { first g }\noutput o s.sum",
       Tells("test.pipeline:4:24", "g", 2, "Image", "g.PORT", "diffuse (Image), glossy (Image)")},
      {"pass paint toy.paint { }\npass s toy.add { first piant.radiance }\noutput o s.sum",
       Tells("test.pipeline:3:24", "pass", "piant", "paint, s", "mean", "paint")},
      {"pass a toy.paint { }\npass s toy.add { first a.radiace }\noutput o s.sum",
       Tells("test.pipeline:3:24", "a", "output", "radiace", "radiance (Image)", "mean", "radiance")},
      {"pass s toy.add { first 5 }\noutput o s.sum", Tells("first", "s", "no output")},
      {"pass v toy.voxels { }\npass a toy.echo { before v.grid }\noutput o a.sum",
       Tells("v.grid", "RadianceGrid", "before", "a", "Image")},
      {"pass voxels toy.voxels { }\npass gather toy.gather { grid voxels }",
       Tells("test.pipeline:3:6", "no output", "gather.diffuse", "output NAME gather.diffuse")},
  }));
  CAPTURE(body);
  CHECK_THAT(findings(body), told);
}

TEST_CASE("each mistake in a parameter of a pass is told with its range, kind or choices") {
  const auto [inside, told] = GENERATE(table<std::string, Tells>({
      {"resolution 65", Tells("test.pipeline:2:32", "resolution", 65, "whole", "1..64")},
      {"resolution 2.5", Tells("whole", "1..64")},
      {"resolution high", Tells("whole", "1..64")},
      {"resolution 3 m", Tells("without a unit")},
      {"resolution 8\nresolution 9", Tells("resolution", "twice")},
      {"resolution 8 9", Tells("resolution", "one value", 2)},
      {"resolution $sise }\npass w toy.voxels { resolution $size",
       Tells("test.pipeline:2:32", "$sise", "size", "mean", "size")},
      {"width 1 cm", Tells("width", 0.01, "0.1..100 m")},
      {"width 3 s", Tells("length", "time")},
      {"smooth 1", Tells("on or off")},
      {"layout sparce", Tells("dense, sparse")},
      {"layout [dense]", Tells("value", "layout", "dense, sparse")},
      {"inner { }", Tells("pass", "blocks")},
      {"smooth on  layout sparse", Tells("v", "contradict", "a sparse grid cannot be smooth")},
  }));
  CAPTURE(inside);
  CHECK_THAT(findings("pass v toy.voxels { " + inside + " }\nparam size 8\noutput o v.grid"), told);
}

TEST_CASE("the words of a parameter are its enumerators in snake case, without an underscore at the end") {
  std::vector<std::string> ran;
  Words words(ran, "words");
  CHECK(words.precision.choices() == std::vector<std::string>{"float", "as_published", "half"});
  CHECK(words.precision.defaultText() == "as_published");
  CHECK(words.precision.set("float").empty());
  CHECK(words.precision == Words::Precision::float_);
  CHECK(words.precision.set("asPublished") != "");
  CHECK(words.precision == Words::Precision::float_);
}

TEST_CASE("an unknown technique is told with the folders that were searched, a skipped one with the reason") {
  class Foldered : public TestTechniques {
    std::vector<std::filesystem::path> folders() const override { return {"/mine", "/opt/plugins"}; }
  } techniques;
  const auto checked = [&](const char* technique) {
    checkPipeline(pipelineOf(fmt::format("pass a {}.gather {{ }}\noutput o a.x", technique)), techniques);
  };
  CHECK_THROWS_MATCHES(checked("ambient"), DiagnosticsError,
                       Tells("ambient", "libambient.so", "/mine, /opt/plugins", "--techniques FOLDER"));
  techniques.addSkipped("/plugins/libbroken.so", "the file is truncated");
  CHECK_THROWS_MATCHES(checked("broken"), DiagnosticsError,
                       Tells("broken", "skipped", "/plugins/libbroken.so", "the file is truncated"));
}

TEST_CASE("a connection that fits by its kind but gives wrong light is a warning with the output that fits") {
  const auto [inputs, told] = GENERATE(table<const char*, Tells>({
      {"grid g.finest",
       Tells("test.pipeline:3:24", "warning", "g.finest", "finest", "grid", "r", "all", "mean", "g.whole")},
      {"grid g.whole  diffuse g.direct",
       Tells("g.direct", "direct", "diffuse", "r", "indirect_diffuse", "mean", "g.diffuse")},
      {"grid g.whole  diffuse g.share", Tells("g.share", "no component")},
      {"grid g.whole  share g.diffuse", Tells("g.diffuse", "indirect_diffuse", "no component")},
  }));
  const std::string text = warnings(inputs);
  CHECK_THAT(text, told);
  CHECK(text.find("warning") == text.rfind("warning"));
  CHECK(warnings("grid g.whole  diffuse g.diffuse  share g.share").empty());
  CHECK(warnings("grid g.other").empty());  // Nothing is known of its levels.
}

TEST_CASE("a pass that is not there is told once, whoever reads it") {
  CHECK_THAT(
      findings("pass a toy.add { first x.radiance }\npass b toy.add { first x.radiance }\noutput o a.sum"),
      Tells("test.pipeline:2:24", "pass", "x") && !Tells("test.pipeline:3"));
}

TEST_CASE("a cycle between passes is refused, naming its passes in the order of the data") {
  const std::string text = findings(
      "pass a toy.add { first c.sum }\npass b toy.add { first a.sum }\npass c toy.add { first b.sum }\n"
      "pass after toy.add { first c.sum }\npass self toy.add { first self.sum }\noutput o after.sum");
  CHECK_THAT(text,
             Tells("test.pipeline:2:6", "cyclic", "a -> b -> c -> a", "test.pipeline:6:6", "self -> self") &&
                 !Tells("after ->"));
  // Through the frame before it may lead, and nowhere else.
  CHECK_THAT(
      findings(
          "pass a toy.echo { first b.sum  before b.sum }\npass b toy.add { first a.sum }\noutput o b.sum"),
      Tells("test.pipeline:2:6", "cyclic", "a -> b -> a", "history"));
}

TEST_CASE("a pass whose parameter has an unknown unit, or one that is no base unit, is refused") {
  struct Measured : Pass {
    explicit Measured(const char* unit) : length(this, "length", 1.0f, within(0.0f, 2.0f), unit, "") {}
    Param<float> length;
    void run(PassContext&) override {}
  };
  CHECK_NOTHROW(Measured("m"));
  CHECK_NOTHROW(Measured("/m"));
  for (const char* wrong : {"furlong", "cm"})
    CHECK_THROWS_WITH(Measured(wrong), Contains("parameter 'length'") && Contains(wrong) &&
                                           Contains("expected one of m, s, rad"));
}

TEST_CASE("a default or sweep value that does not fit the pass's parameter is refused") {
  CHECK_THAT(findings("param size 99\npass v toy.voxels { resolution $size }\npass g toy.gather { grid v }\n"
                      "output o g.diffuse",
                      "sweep big { size [16 128] }\n"),
             Tells("$size", 99, "resolution", "1..64") && Tells("big", "size", 128, "resolution"));
}

TEST_CASE("all binding errors of a pipeline are reported at once") {
  TestTechniques techniques;
  addToys(techniques);
  try {
    checkPipeline(pipelineOf("pass a missing.pass { }\npass v toy.voxels { resolution 1000  widht 2 }\n"
                             "pass g toy.gather { grid a.anything  view v.grid }\noutput o nobody.x"),
                  techniques);
    FAIL("accepted");
  } catch (const DiagnosticsError& error) {
    // Unknown technique, range, unknown word, wrong kind, unknown pass; nothing about a's ports, which nobody
    // knows.
    CHECK(error.diagnostics().size() == 5);
    for (const Diagnostic& finding : error.diagnostics())
      CHECK((finding.place.line > 0 && !finding.sourceLine.empty()));
  }
}

TEST_CASE("a setting given to a pipeline must exist and fit") {
  Fixture f;
  const auto refused = [&](const RenderOptions& options) {
    return messageOf<Error>([&] {
      f.executor("param value 1 in 0..5\npass a toy.paint { value $value }\noutput o a.radiance", options);
    });
  };
  RenderOptions beyond, unknown, unwanted;
  beyond.parameters["value"].number = 7;
  unknown.parameters["vaule"] = {};
  unwanted.wanted = {"p"};
  CHECK_THAT(refused(beyond), Tells("value", "test", 7, "0..5"));
  CHECK_THAT(refused(unknown), Tells("vaule", "value"));
  CHECK_THAT(refused(unwanted), Tells("output", "p", "o"));
}
