// Opening technique libraries: those that fit, and every way of not fitting.
#include <cstdlib>
#include <fstream>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/plugin/technique.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace fs = std::filesystem;

namespace {

fs::path pluginDirectory(const std::string& name) {
  return binaryDirectory() / "tests/plugins" / name;
}
fs::path pluginFile(const std::string& name) {
  return pluginDirectory(name) / ("lib" + name + ".so");
}

/// Opens the plugin of that name in its own directory, which must fail; the reason.
std::string reasonFor(const std::string& name, const fs::path& directory) {
  const LogCapture log;
  TechniqueSet set({directory});
  CHECK(set.technique(name) == nullptr);
  REQUIRE(set.skipped().size() == 1);
  CHECK(set.skipped()[0].library == directory / ("lib" + name + ".so"));
  CHECK(set.opened().empty());
  CHECK_THAT(log.text(), Contains("skipped " + set.skipped()[0].library.string()));
  return set.skipped()[0].reason;
}
std::string reasonFor(const std::string& name) {
  return reasonFor(name, pluginDirectory(name));
}

/// A file under the name of a technique library.
std::string reasonForContent(const std::string& content) {
  const TemporaryDirectory directory;
  directory.write("libfake.so", content);
  return reasonFor("fake", directory.path());
}

}  // namespace

TEST_CASE("a technique library opens on first use and gives its passes") {
  TechniqueSet set({pluginDirectory("good")});
  CHECK(set.available() == std::vector<std::string>{"good"});
  CHECK(set.opened().empty());
  const Technique* technique = set.technique("good");
  REQUIRE(technique != nullptr);
  CHECK(set.opened() == std::vector<std::string>{"good"});
  CHECK(technique->name == "good");
  CHECK(technique->library == pluginFile("good"));
  CHECK(technique->meaning == "paints one value");
  CHECK(technique->paper == "no paper");
  CHECK(technique->hash == hashOf(readFile(pluginFile("good"))));
  CHECK(technique->shaders.technique.empty());
  REQUIRE(technique->find("paint") != nullptr);
  CHECK(technique->find("piant") == nullptr);
  const std::unique_ptr<Pass> pass = technique->find("paint")->make();
  REQUIRE(pass->outputs().size() == 1);
  CHECK(pass->outputs()[0]->name() == "radiance");
  CHECK(pass->outputs()[0]->kind().name == "Image");
  CHECK(pass->parameters()[0]->defaultText() == "1");
  CHECK(set.technique("good") == technique);
  CHECK(set.skipped().empty());
}

TEST_CASE("a library of another interface version is skipped before anything of it is called") {
  CHECK_THAT(reasonFor("wrong_version"), Contains("built for another Lumivox: the API version is " +
                                                  std::to_string(kTechniqueApiVersion + 1) + ", expected " +
                                                  std::to_string(kTechniqueApiVersion)));
}

TEST_CASE("a library of another compiler is skipped with both names") {
  CHECK_THAT(reasonFor("wrong_build"), Contains("the compiler is 'xxx") && Contains("expected 'gcc"));
}

TEST_CASE("a library that was compiled with other headers is skipped, with both hashes") {
  CHECK_THAT(reasonFor("stale_headers"), Contains("the hash of the public headers is '0123456789abcdef'") &&
                                             Contains(std::string("expected '") + kHeadersHash));
}

TEST_CASE("a program that is older than its library is told so before it does anything") {
  TechniqueVersionRecord program = techniqueVersionHere();
  CHECK_NOTHROW(requireLibraryOf(program));
  program.headers[0] = program.headers[0] == '0' ? '1' : '0';
  CHECK_THAT(messageOf<Error>([&] { requireLibraryOf(program); }),
             Contains("different sources") && Contains("the hash of the public headers is"));
  program = techniqueVersionHere();
  program.portsSize += 8;
  CHECK_THAT(messageOf<Error>([&] { requireLibraryOf(program); }), Contains("the size of the ports is"));
}

TEST_CASE("a shared library that is no technique is skipped with the symbol that it lacks") {
  CHECK(reasonFor("no_entry") == "the symbol lumivox_technique_version is missing");
}

TEST_CASE("a library that needs a function which nobody has is skipped with that function") {
  CHECK_THAT(reasonFor("unresolved"), Contains("functionThatNobodyWrote"));
}

TEST_CASE("a library that registers no pass is skipped") {
  CHECK(reasonFor("no_passes") == "it registers no pass");
}

TEST_CASE("a library that throws while it registers is skipped with its words") {
  CHECK(reasonFor("throwing") == "the table of directions is missing");
}

TEST_CASE("a text file, an empty file and a directory under a library's name are skipped") {
  CHECK(reasonForContent("this is no library\n") == "not a shared library");
  CHECK(reasonForContent("") == "the file is empty");
  const TemporaryDirectory directory;
  fs::create_directory(directory.path() / "libfake.so");
  CHECK_THAT(reasonFor("fake", directory.path()), Contains("libfake.so"));
}

TEST_CASE("a library that is cut off anywhere is skipped, never mapped") {
  const std::string whole = readFile(pluginFile("good"));
  for (const std::size_t length : {std::size_t{5}, std::size_t{50}, std::size_t{100}, whole.size() / 4,
                                   whole.size() / 2, whole.size() - 1}) {
    CHECK_THAT(reasonForContent(whole.substr(0, length)), Contains("truncated"));
  }
}

TEST_CASE("a library whose headers are damaged is skipped") {
  std::string other = readFile(pluginFile("good"));
  other[18] = 3;  // e_machine: Intel 80386
  CHECK(reasonForContent(other) == "a shared library for another kind of machine");
  std::string huge = readFile(pluginFile("good"));
  for (std::size_t i = 40; i < 48; ++i) huge[i] = '\xff';  // e_shoff
  CHECK_THAT(reasonForContent(huge), Contains("damaged"));
}

TEST_CASE("one bad library does not keep the others from loading") {
  const LogCapture log;
  TechniqueSet set({pluginDirectory("no_entry"), pluginDirectory("good"), pluginDirectory("wrong_version")});
  CHECK(set.available() == std::vector<std::string>{"good", "no_entry", "wrong_version"});
  CHECK(set.technique("no_entry") == nullptr);
  CHECK(set.technique("wrong_version") == nullptr);
  CHECK(set.technique("good") != nullptr);
  CHECK(set.skipped().size() == 2);
  // Asked again, it is neither opened nor reported again.
  CHECK(set.technique("no_entry") == nullptr);
  CHECK(set.skipped().size() == 2);
}

TEST_CASE("a technique is taken from the first directory where it fits") {
  const LogCapture log;
  const TemporaryDirectory broken;
  broken.write("libgood.so", "no library");
  TechniqueSet set({broken.path(), pluginDirectory("good")});
  REQUIRE(set.technique("good") != nullptr);
  CHECK(set.technique("good")->library == pluginFile("good"));
  CHECK(set.skipped().size() == 1);
}

TEST_CASE("an absent technique is neither opened nor skipped, and no name leads out of the directories") {
  TechniqueSet set({pluginDirectory("no_entry"), "/no/such/directory"});
  CHECK(set.technique("absent") == nullptr);
  CHECK(set.technique("../good/libgood") == nullptr);
  CHECK(set.technique("") == nullptr);
  CHECK(set.skipped().empty());
}

TEST_CASE("a damaged shader pack beside a library skips the technique, naming the pack") {
  const TemporaryDirectory directory;
  fs::copy_file(pluginFile("good"), directory.path() / "libgood.so");
  directory.write("good.shaderpack", "these are no shaders");
  CHECK_THAT(reasonFor("good", directory.path()), Contains("good.shaderpack"));
}

TEST_CASE("the shader pack beside a library is read with it, and must be its own") {
  const TemporaryDirectory directory;
  fs::copy_file(pluginFile("good"), directory.path() / "libgood.so");
  shader::ShaderPack pack;
  pack.technique = "good";
  shader::writeShaderPack(directory.path() / "good.shaderpack", pack);
  {
    TechniqueSet set({directory.path()});
    REQUIRE(set.technique("good") != nullptr);
    CHECK(set.technique("good")->shaders.technique == "good");
  }
  pack.technique = "another";
  shader::writeShaderPack(directory.path() / "good.shaderpack", pack);
  CHECK_THAT(reasonFor("good", directory.path()), Contains("contains the shaders of 'another'"));
}

TEST_CASE(
    "techniques are sought where they were named, then where the environment says, then beside the "
    "framework") {
  const TemporaryDirectory given, first, second;
  const std::string list = first.path().string() + "::" + second.path().string();
  setenv("LUMIVOX_TECHNIQUES", list.c_str(), 1);
  const auto directories = TechniqueSet::defaultDirectories({given.path()});
  unsetenv("LUMIVOX_TECHNIQUES");
  REQUIRE(directories.size() == 4);
  CHECK(directories[0] == given.path());
  CHECK(directories[1] == first.path());
  CHECK(directories[2] == second.path());
  CHECK(fs::weakly_canonical(directories[3]) == fs::weakly_canonical(binaryDirectory() / "lib/techniques"));
  CHECK(TechniqueSet::defaultDirectories().size() == 1);
}

TEST_CASE("a directory that was named for techniques must exist") {
  CHECK_THAT(messageOf<Error>([] { TechniqueSet::defaultDirectories({"/no/such/directory"}); }),
             Contains("/no/such/directory: no such directory"));
}
