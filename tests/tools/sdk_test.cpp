// The installed files, used by somebody who has never seen the tree: a technique of one's own, outside of it.
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "lumivox/base/file.h"
#include "support/elf.h"
#include "tools/cli_support.h"
#include "tools/installation.h"

using namespace lumivox;
using namespace lumivox::test;
namespace fs = std::filesystem;

namespace {

/// Where a file names the source tree or the build folder. The names of sources in the assertions of programs
/// and libraries are no paths that are ever opened.
std::vector<std::string> mentionsOfTree(const fs::path& file) {
  const std::string text = readFile(file, kLargestLibraryFile);
  const bool isBinary = text.rfind(
                            "\x7f"
                            "ELF",
                            0) == 0;
  const std::string root = sourceDirectory().string();
  std::vector<std::string> found;
  for (std::size_t at = text.find(root); at != std::string::npos; at = text.find(root, at + 1)) {
    const std::string mention =
        text.substr(at, std::string_view(text).substr(at).find_first_of(std::string_view("\0\n\"' ;:)", 8)));
    const bool isSource = mention.size() > 4 && (mention.compare(mention.size() - 4, 4, ".cpp") == 0 ||
                                                 mention.compare(mention.size() - 2, 2, ".h") == 0);
    if (!isBinary || !isSource) found.push_back(mention);
  }
  return found;
}

}  // namespace

TEST_CASE(
    "a technique made outside of the tree from what is installed is built, tested, rendered and measured",
    "[slow]") {
  const Installation installed;
  for (const auto& entry : fs::recursive_directory_iterator(installed.prefix())) {
    if (!entry.is_regular_file()) continue;
    INFO(entry.path());
    CHECK(mentionsOfTree(entry.path()).empty());
  }

  // Every committed technique is found, and nothing is skipped.
  const std::string techniques = installed.mustRun(installed.work(), "lumivox list techniques --json");
  for (const auto& entry : fs::directory_iterator(sourceDirectory() / "techniques"))
    if (entry.is_directory()) CHECK(contains(techniques, entry.path().filename().string()));
  CHECK_FALSE(contains(techniques, sourceDirectory().string()));
  CHECK(contains(installed.mustRun(installed.work(), "lumivox list scenes"), "Cornell box"));
  // The device's own shaders, and the reader of volume files, lie beside the libraries.
  installed.mustRun(installed.work(), "lumivox device --only dispatches --repeats 1");

  const fs::path share = installed.prefix() / "share";
  CHECK(contains(readFile(share / "man/man1/vdbexport.1"), "\\fB\\-\\-grid\\fR"));
  for (const auto& [file, part] : std::vector<std::pair<std::string, std::string>>{
           {"fish/vendor_completions.d/lumivox.fish", "-l keep-everything"},
           {"zsh/site-functions/_vdbexport", "#compdef vdbexport"},
           {"lumivox/editors/lumivox.tmLanguage.json", "source.lumivox"},
           {"lumivox/editors/vim/syntax/lumivox.vim", "syntax keyword lumivoxBlock camera"},
           {"lumivox/editors/vim/ftdetect/lumivox.vim", "*.scene,*.pipeline"}}) {
    INFO(file);
    CHECK(contains(readFile(share / file), part));
  }

  const std::string next = installed.mustRun(installed.work(), "lumivox new technique glow --in lab");
  CHECK(contains(next, "-DCMAKE_PREFIX_PATH=" + installed.prefix().string() + " "));
  CHECK_FALSE(contains(next, "ninja -C"));
  const fs::path lab = installed.work() / "lab";
  installed.mustRun(lab, "cmake -S . -B build -G Ninja -DCMAKE_PREFIX_PATH=" + installed.prefix().string() +
                             " && cmake --build build");
  CHECK(contains(installed.mustRun(lab, "ctest --test-dir build --output-on-failure"), "100% tests passed"));
  for (const char* file : {"build/CMakeCache.txt", "build/build.ninja"}) {
    INFO(file);
    CHECK(mentionsOfTree(lab / file).empty());
  }
  // As the tree's own, its library exports the entry point alone, and shares no variable with another one.
  const std::vector<ElfSymbol> symbols =
      exportedSymbols(readFile(lab / "build/lib/techniques/libglow.so", kLargestLibraryFile));
  REQUIRE(symbols.size() == 1);
  CHECK(symbols.front().name == "lumivox_technique_register");
  for (const char* option : {"-fno-gnu-unique", "-fvisibility=hidden", "-fvisibility-inlines-hidden"})
    CHECK(contains(readFile(lab / "build/build.ninja"), option));

  const std::string furnace = (installed.data() / "scenes/furnace.scene").string();
  const std::string more = " --techniques build/lib/techniques --resolution 16x16 ";
  installed.mustRun(lab, "lumivox check scenes/pipelines/glow.pipeline --techniques build/lib/techniques");
  installed.mustRun(lab, "lumivox render " + furnace + " scenes/pipelines/glow.pipeline -o glow.exr" + more);
  CHECK(fs::file_size(lab / "glow.exr") > 0);
  // In the furnace (albedo a = 0.5, emission 1) the light after one bounce is a^2, which light of radiance
  // a from all sides makes a surface reflect.
  installed.mustRun(lab,
                    "lumivox report " + furnace + " --pipeline scenes/pipelines/glow.pipeline" + more +
                        "--set radiance=0.5 --spp 64 --repeats 1 --seeds 1 --no-sweep -o page/index.html");
  const nlohmann::json page = nlohmann::json::parse(readFile(lab / "page/index.json"));
  bool isJudged = false;
  for (const nlohmann::json& error : page.at("scenes").at(0).at("points").at(0).at("errors"))
    if (error.at("output") == "indirect_diffuse" && error.at("against") == "bias") {
      isJudged = true;
      CHECK(error.at("metrics").at("rmse").at("value").get<double>() < 0.1 * 0.25);  // noise of the reference
    }
  CHECK(isJudged);

  // A second technique, with a kind of port that the framework does not have: the installed example.
  fs::copy(installed.data() / "examples/seen_voxels", lab, fs::copy_options::recursive);
  installed.mustRun(lab, "cmake --build build");
  CHECK(contains(installed.mustRun(lab, "ctest --test-dir build --output-on-failure"), "100% tests passed"));
  const std::string cornell = (installed.data() / "scenes/cornell.scene").string();
  installed.mustRun(lab, "lumivox render " + cornell + " scenes/pipelines/seen_voxels.pipeline --health" +
                             " --output shown -o shown.exr" + more);
  installed.mustRun(lab, "vdbexport " + cornell +
                             " scenes/pipelines/seen_voxels.pipeline --grid mark.voxels -o grid.vdb" + more);
  CHECK(contains(installed.mustRun(lab, "vdbexport --list grid.vdb"), "seen"));
  CHECK(contains(installed.mustRun(lab, "lumivox describe SeenVoxels --techniques build/lib/techniques"),
                 "voxels in which a surface is seen"));
  // A third one, which reads a kind of the framework.
  fs::copy(installed.data() / "examples/seen_light", lab, fs::copy_options::recursive);
  installed.mustRun(lab, "cmake --build build");
  CHECK(contains(installed.mustRun(lab, "ctest --test-dir build --output-on-failure"), "100% tests passed"));
  // Visible voxels touch the surface, and cover most of it, but not all.
  writeFileAtomically(lab / "scenes/pipelines/marked.pipeline",
                      "pipeline \"Seen voxels alone\" {\n  param resolution 32 in 8..512\n"
                      "  pass gbuffer direct_lighting.gbuffer { }\n"
                      "  pass mark seen_voxels.mark { gbuffer gbuffer  resolution $resolution }\n}\n");
  const nlohmann::json voxels = nlohmann::json::parse(installed.mustRun(
      lab, "lumivox voxels " + cornell + " --pipelines scenes/pipelines/marked.pipeline --resolution 16" +
               " --repeats 1 --json --techniques build/lib/techniques"));
  const nlohmann::json& measured = voxels.at("records").at(0);
  CHECK(measured.at("kind") == "SeenVoxels");
  CHECK(measured.at("precision").get<double>() > 0.99);
  CHECK(measured.at("recall").get<double>() > 0.6);
  CHECK(measured.at("recall").get<double>() < 0.95);

  // The technique is installed beside the others, and then found without being told where.
  installed.mustRun(lab, "cmake --install build --prefix " + installed.prefix().string());
  CHECK(contains(installed.mustRun(installed.work(), "lumivox list techniques"), "glow"));
}

TEST_CASE("the Debian package names its dependencies and holds programs, headers, guides and techniques",
          "[slow]") {
  if (runCommand("command -v dpkg-deb && command -v dpkg-shlibdeps").exitCode != 0)
    return skip("dpkg and dpkg-dev are not installed");
  const TemporaryDirectory work;
  const CommandResult packed =
      runCommand("cpack -G DEB --config " + quoted(binaryDirectory() / "CPackConfig.cmake") + " -B " +
                 quoted(work.path()));
  INFO(packed.output << packed.errors);
  REQUIRE(packed.exitCode == 0);
  fs::path package;
  for (const auto& entry : fs::directory_iterator(work.path()))
    if (entry.path().extension() == ".deb") package = entry.path();
  REQUIRE_FALSE(package.empty());

  const CommandResult information = runCommand("dpkg --info " + quoted(package));
  REQUIRE(information.exitCode == 0);
  const std::size_t from = information.output.find(" Depends: ");
  REQUIRE(from != std::string::npos);
  const std::string depends = information.output.substr(from, information.output.find('\n', from) - from);
  for (const char* dependency : {"libc6", "libepoxy0", "libembree3-3", "libopenvdb", "libsqlite3-0", "libfmt",
                                 "libegl1", "libgl1,", "libopengl0", "libgl1-mesa-dri", "libjs-chart.js"}) {
    INFO(depends << "\nlacks " << dependency);
    CHECK(contains(depends, dependency));
  }
  const std::string recommends = information.output.substr(information.output.find(" Recommends: "));
  for (const char* tool : {"g++", "cmake", "ninja-build", "libglm-dev", "catch2"})
    CHECK(contains(recommends, tool));

  const std::string content = runCommand("dpkg-deb --contents " + quoted(package)).output;
  for (const char* file :
       {"./usr/bin/lumivox\n", "./usr/bin/vdbexport\n", "./usr/bin/shaderpack\n",
        "./usr/lib/lumivox/liblumivox.so\n", "./usr/lib/lumivox/techniques/libdirect_lighting.so\n",
        "./usr/lib/lumivox/techniques/direct_lighting.shaderpack\n",
        "./usr/include/lumivox/plugin/technique.h\n", "./usr/share/lumivox/cmake/LumivoxConfig.cmake\n",
        "./usr/share/lumivox/shaders/common/brdf.glsl\n", "./usr/share/lumivox/scenes/cornell.scene\n",
        "./usr/lib/lumivox/shaders/toolkit.shaderpack\n", "./usr/share/lumivox/shaders/toolkit/slots.glsl\n",
        "./usr/share/lumivox/docs/writing_a_technique.md\n",
        "./usr/share/lumivox/examples/seen_voxels/techniques/seen_voxels/seen_voxels.h\n",
        "./usr/share/man/man1/lumivox.1", "./usr/share/bash-completion/completions/lumivox\n"}) {
    INFO(file);
    CHECK(contains(content, file));
  }
  CHECK_FALSE(contains(content, binaryDirectory().string().substr(1)));
}
