// Binding a pipeline to its techniques: every mistake has a message of its own, and all are reported at once.
#include "lumivox/base/log.h"
#include "pipeline_toys.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace {

/// Reads an image of this frame and one of the frame before.
class Echo : public Toy {
 public:
  using Toy::Toy;
  In<Image> first{this, "first", Presence::optional, "of this frame"};
  In<Image> before{this, "before", Presence::history, "of the frame before"};
  Out<Image> sum{this, "sum", Contributes::direct};
  void run(PassContext& frame) override { sum = paint(frame, 1.0f); }
};

/// Two grids of which one has only its finest level, and a reader of all levels and of one component.
class Grids : public Toy {
 public:
  using Toy::Toy;
  Out<RadianceGrid> finest{this, "finest", "one level", Levels::finest};
  Out<RadianceGrid> whole{this, "whole", "all levels", Levels::all};
  Out<RadianceGrid> other{this, "other", "who knows"};
  Out<Image> direct{this, "direct", Contributes::direct};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse};
  Out<Image> share{this, "share", "no light"};
  void run(PassContext&) override {}
};
class Reader : public Toy {
 public:
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
class Words : public Toy {
 public:
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

void checkAccepted(const std::string& body) {
  TestTechniques techniques;
  addToys(techniques).add<Echo>("toy", "echo");
  CHECK_NOTHROW(checkPipeline(pipelineOf(body), techniques));
}

const char* const kGood =
    "pass voxels toy.voxels { resolution 16  width 30 cm  smooth on  layout dense }\n"
    "pass view toy.paint { value -2 }\n"
    "pass gather toy.gather { grid voxels  view view.radiance }\n"
    "output diffuse gather.diffuse\n";

}  // namespace

TEST_CASE("a pipeline whose ports and parameters fit is accepted") {
  checkAccepted(kGood);
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

TEST_CASE("a pass's name alone means its only output of the wanted kind") {
  checkAccepted(
      "pass voxels toy.voxels { }\npass gather toy.gather { grid voxels }\noutput o gather.diffuse");
  CHECK_THAT(findings("pass voxels toy.voxels { }\npass gather toy.gather { grid voxels }\npass s toy.add { "
                      "first gather }\noutput o s.sum"),
             Contains("test.pipeline:4:24: pass 'gather' has 2 outputs of kind Image; expected gather.PORT, "
                      "where PORT is one of "
                      "diffuse (Image), glossy (Image)"));
}

TEST_CASE("an unknown technique is named with those that there are") {
  CHECK_THAT(findings("pass a tpy.paint { }\noutput o a.x"),
             Contains("test.pipeline:2:8: unknown technique 'tpy'; expected toy; did you mean 'toy'?"));
}

TEST_CASE(
    "an unknown technique is told with the folders that were searched, and with the option that adds one") {
  class Foldered : public TestTechniques {
    std::vector<std::filesystem::path> folders() const override { return {"/mine", "/opt/plugins"}; }
  } techniques;
  const Pipeline pipeline = pipelineOf("pass a ambient.gather { }\noutput o a.x");
  CHECK_THAT(
      messageOf<DiagnosticsError>([&] { checkPipeline(pipeline, techniques); }),
      Contains(
          "unknown technique 'ambient': no libambient.so in /mine, /opt/plugins (--techniques FOLDER adds "
          "one); expected a technique, but no technique library was found"));
}

TEST_CASE("a technique that was skipped is named with the reason") {
  TestTechniques techniques;
  techniques.addSkipped("/plugins/libbroken.so", "the file is truncated");
  const Pipeline pipeline = pipelineOf("pass a broken.paint { }\noutput o a.x");
  CHECK_THAT(messageOf<DiagnosticsError>([&] { checkPipeline(pipeline, techniques); }),
             Contains("technique 'broken' was skipped: /plugins/libbroken.so: the file is truncated"));
}

TEST_CASE("an unknown pass of a technique is named with those that there are") {
  CHECK_THAT(
      findings("pass a toy.piant { }\noutput o a.x"),
      Contains(
          "test.pipeline:2:8: technique 'toy' has no pass 'piant'; expected one of paint, paint_camera") &&
          Contains("did you mean 'paint'?"));
}

TEST_CASE("a word that is neither input nor parameter of its pass is refused") {
  CHECK_THAT(findings("pass v toy.voxels { resolutoin 8 }\noutput o v.grid"),
             Contains("test.pipeline:2:21: toy.voxels has no input or parameter 'resolutoin'; expected one "
                      "of resolution, width, "
                      "smooth, layout; did you mean 'resolution'?"));
}

TEST_CASE("a port of the wrong kind is refused, naming both kinds") {
  CHECK_THAT(findings("pass a toy.paint { }\npass g toy.gather { grid a.radiance }\noutput o g.diffuse"),
             Contains("test.pipeline:3:26: output 'a.radiance' is of kind Image, but input 'grid' of pass "
                      "'g' takes RadianceGrid; "
                      "expected an output of kind RadianceGrid"));
}

TEST_CASE("an output of the pipeline that is no image is refused") {
  CHECK_THAT(findings("pass v toy.voxels { }\noutput o v.grid"),
             Contains("output 'v.grid' is of kind RadianceGrid, but output 'o' of the pipeline takes Image"));
}

TEST_CASE("a missing required input is refused, with the output that would fit") {
  CHECK_THAT(findings("pass v toy.voxels { }\npass g toy.gather { }\noutput o g.diffuse"),
             Contains("test.pipeline:3:6: pass 'g' lacks its required input 'grid'; expected grid PASS.PORT, "
                      "where the port is of kind "
                      "RadianceGrid; did you mean 'grid v.grid'?"));
}

TEST_CASE("an optional input may stay unconnected") {
  checkAccepted("pass a toy.paint { }\npass s toy.add { first a }\noutput o s.sum");
}

TEST_CASE("a connection that fits by its kind but gives wrong light is a warning with the output that fits") {
  CHECK(warnings("grid g.whole  diffuse g.diffuse  share g.share").empty());
  CHECK(warnings("grid g.other").empty());  // Nothing is known of its levels.
  CHECK_THAT(
      warnings("grid g.finest"),
      Contains(
          "test.pipeline:3:24: warning: output 'g.finest' fills only the finest level, but input 'grid' of "
          "pass 'r' reads all") &&
          Contains("did you mean 'g.whole'?") && !Contains("warning: test.pipeline"));
  CHECK_THAT(
      warnings("grid g.whole  diffuse g.direct"),
      Contains("output 'g.direct' holds direct, but input 'diffuse' of pass 'r' takes indirect_diffuse") &&
          Contains("did you mean 'g.diffuse'?"));
  CHECK_THAT(warnings("grid g.whole  diffuse g.share"),
             Contains("'g.share' holds no component of the image"));
  CHECK_THAT(warnings("grid g.whole  share g.diffuse"),
             Contains("'g.diffuse' holds indirect_diffuse") && Contains("takes no component of the image"));
}

TEST_CASE("a pass that is not there is told once, whoever reads it") {
  const std::string text =
      findings("pass a toy.add { first x.radiance }\npass b toy.add { first x.radiance }\noutput o a.sum");
  CHECK_THAT(text, Contains("test.pipeline:2:24: unknown pass 'x'") && !Contains("test.pipeline:3"));
}

TEST_CASE("a connection to an unknown pass is refused with the nearest") {
  CHECK_THAT(
      findings("pass paint toy.paint { }\npass s toy.add { first piant.radiance }\noutput o s.sum"),
      Contains("test.pipeline:3:24: unknown pass 'piant'; expected one of paint, s; did you mean 'paint'?"));
}

TEST_CASE("a connection to an unknown output of a pass is refused with the nearest") {
  CHECK_THAT(findings("pass a toy.paint { }\npass s toy.add { first a.radiace }\noutput o s.sum"),
             Contains("test.pipeline:3:24: pass 'a' has no output 'radiace'; expected radiance (Image); did "
                      "you mean 'radiance'?"));
}

TEST_CASE("an input that is given a number is refused") {
  CHECK_THAT(findings("pass s toy.add { first 5 }\noutput o s.sum"),
             Contains("input 'first' of pass 's' is connected to no output"));
}

TEST_CASE("a cycle between passes is refused, naming its passes in the order of the data") {
  const std::string text = findings(
      "pass a toy.add { first c.sum }\npass b toy.add { first a.sum }\npass c toy.add { first b.sum }\n"
      "pass after toy.add { first c.sum }\npass self toy.add { first self.sum }\noutput o after.sum");
  CHECK_THAT(text, Contains("test.pipeline:2:6: cyclic dependency: a -> b -> c -> a"));
  CHECK_THAT(text, Contains("test.pipeline:6:6: cyclic dependency: self -> self"));
  CHECK_THAT(text, !Contains("after ->"));
}

TEST_CASE("a cycle is accepted where it leads through the frame before, and nowhere else") {
  const std::string output = "output o b.sum";
  checkAccepted("pass a toy.echo { before b.sum }\npass b toy.add { first a.sum }\n" + output);
  checkAccepted("pass a toy.echo { before a.sum }\npass b toy.add { first a.sum }\n" + output);
  CHECK_THAT(
      findings("pass a toy.echo { first b.sum  before b.sum }\npass b toy.add { first a.sum }\n" + output),
      Contains("test.pipeline:2:6: cyclic dependency: a -> b -> a; expected an order in "
               "which they can run; only an input that is a history may lead back"));
  CHECK_THAT(findings("pass v toy.voxels { }\npass a toy.echo { before v.grid }\noutput o a.sum"),
             Contains("output 'v.grid' is of kind RadianceGrid, but input 'before' of pass 'a' takes Image"));
}

TEST_CASE("a parameter out of its range is refused with the range") {
  CHECK_THAT(findings("pass v toy.voxels { resolution 65 }\noutput o v.grid"),
             Contains("test.pipeline:2:32: parameter 'resolution' is 65, which does not fit; expected a "
                      "whole number in 1..64"));
  CHECK_THAT(findings("pass v toy.voxels { resolution 2.5 }\noutput o v.grid"),
             Contains("expected a whole number in 1..64"));
  CHECK_THAT(findings("pass v toy.voxels { width 1 cm }\noutput o v.grid"),
             Contains("parameter 'width' is 0.01, which does not fit; expected a number in 0.1..100 m"));
}

TEST_CASE("a parameter of the wrong type is refused with the right one") {
  CHECK_THAT(findings("pass v toy.voxels { resolution high }\noutput o v.grid"),
             Contains("expected a whole number in 1..64"));
  CHECK_THAT(findings("pass v toy.voxels { smooth 1 }\noutput o v.grid"), Contains("expected on or off"));
  CHECK_THAT(findings("pass v toy.voxels { layout sparce }\noutput o v.grid"),
             Contains("expected one of dense, sparse"));
  CHECK_THAT(findings("pass v toy.voxels { layout [dense] }\noutput o v.grid"),
             Contains("this is not a value for the parameter 'layout'; expected one of dense, sparse"));
}

TEST_CASE("a parameter in a unit of another dimension is refused") {
  CHECK_THAT(findings("pass v toy.voxels { width 3 s }\noutput o v.grid"),
             Contains("expected a number that measures length, not time"));
  CHECK_THAT(findings("pass v toy.voxels { resolution 3 m }\noutput o v.grid"),
             Contains("expected a number without a unit"));
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

TEST_CASE("an unknown parameter of the pipeline is refused with the nearest") {
  CHECK_THAT(findings("param size 8\npass v toy.voxels { resolution $sise }\npass w toy.voxels { resolution "
                      "$size }\noutput o v.grid"),
             Contains("test.pipeline:3:32: unknown parameter '$sise'; expected size; did you mean 'size'?"));
}

TEST_CASE("a default or sweep value that does not fit the pass's parameter is refused") {
  const std::string text = findings(
      "param size 99\npass v toy.voxels { resolution $size }\npass g toy.gather { grid v }\noutput o "
      "g.diffuse",
      "sweep big { size [16 128] }\n");
  CHECK_THAT(text,
             Contains("'$size' is 99, which does not fit 'resolution'; expected a whole number in 1..64"));
  CHECK_THAT(text, Contains("sweep 'big' sets 'size' to 128, which does not fit 'resolution'"));
}

TEST_CASE("a property given twice, or with two values, is refused") {
  CHECK_THAT(findings("pass v toy.voxels { resolution 8\nresolution 9 }\noutput o v.grid"),
             Contains("'resolution' is given twice"));
  CHECK_THAT(findings("pass v toy.voxels { resolution 8 9 }\noutput o v.grid"),
             Contains("'resolution' takes one value, not 2"));
}

TEST_CASE("a block inside a pass is refused") {
  CHECK_THAT(findings("pass v toy.voxels { inner { } }\noutput o v.grid"),
             Contains("a pass cannot contain blocks"));
}

TEST_CASE("parameters that contradict each other are refused in the pass's words") {
  CHECK_THAT(findings("pass v toy.voxels { smooth on  layout sparse }\noutput o v.grid"),
             Contains("the parameters of pass 'v' contradict each other: a sparse grid cannot be smooth"));
}

TEST_CASE("all binding errors of a pipeline are reported at once") {
  TestTechniques techniques;
  addToys(techniques).add<Echo>("toy", "echo");
  const Pipeline pipeline = pipelineOf(
      "pass a missing.pass { }\n"
      "pass v toy.voxels { resolution 1000  widht 2 }\n"
      "pass g toy.gather { grid a.anything  view v.grid }\n"
      "output o nobody.x");
  try {
    checkPipeline(pipeline, techniques);
    FAIL("accepted");
  } catch (const DiagnosticsError& error) {
    // Unknown technique, range, unknown word, wrong kind, unknown pass; nothing about a's ports, which nobody
    // knows.
    CHECK(error.diagnostics().size() == 5);
    for (const Diagnostic& finding : error.diagnostics()) {
      CHECK(finding.place.line > 0);
      CHECK_FALSE(finding.sourceLine.empty());
    }
  }
}

TEST_CASE("a setting given to a pipeline must exist and fit") {
  TestTechniques techniques;
  addToys(techniques).add<Echo>("toy", "echo");
  const std::unique_ptr<gpu::Device> device = deviceOrSkip();
  if (!device) return;
  const Scene scene = triangleScene();
  const Pipeline pipeline =
      pipelineOf("param value 1 in 0..5\npass a toy.paint { value $value }\noutput o a.radiance");
  RenderOptions options;
  options.parameters["value"].number = 7;
  CHECK_THAT(messageOf<Error>([&] { PipelineExecutor(*device, techniques, scene, pipeline, options); }),
             Contains("parameter 'value' of pipeline \"test\" is 7: it must be a number in 0..5"));
  options.parameters = {{"vaule", {}}};
  CHECK_THAT(messageOf<Error>([&] { PipelineExecutor(*device, techniques, scene, pipeline, options); }),
             Contains("has no parameter 'vaule'; expected value"));
  options.parameters.clear();
  options.wanted = {"p"};
  CHECK_THAT(messageOf<Error>([&] { PipelineExecutor(*device, techniques, scene, pipeline, options); }),
             Contains("has no output 'p'; expected o"));
}

TEST_CASE("a pipeline that makes no part of an image needs no output, and one that makes some does") {
  checkAccepted("pass voxels toy.voxels { }");
  CHECK_THAT(findings("pass voxels toy.voxels { }\npass gather toy.gather { grid voxels }"),
             Contains("test.pipeline:3:6: the pipeline has no output, so 'gather.diffuse' is "
                      "never shown; expected output NAME gather.diffuse"));
}
