// Opening technique libraries: those that fit, and every way of not fitting.
#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <functional>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/plugin/technique.h"
#include "support/elf.h"
#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

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
  CHECK_THAT(log.text(), Tells("skipped " + set.skipped()[0].library.string()));
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

/// A copy of a library that ends the process when it is opened, with its record of versions changed.
std::string reasonForRecord(const std::function<void(TechniqueVersionRecord&)>& change) {
  std::string library = readFile(pluginFile("never_opened"));
  const auto section = partOf<Elf64_Shdr>(library, headerOfSection(library, LUMIVOX_VERSION_SECTION));
  REQUIRE(section.sh_size == sizeof(TechniqueVersionRecord));
  auto record = partOf<TechniqueVersionRecord>(library, section.sh_offset);
  CHECK(versionDifference(library.substr(section.sh_offset, section.sh_size)).empty());
  change(record);
  setPart(library, section.sh_offset, record);
  return reasonForContent(library);
}

/// The same with the section's header changed.
std::string reasonForSection(const std::function<void(std::string& file, Elf64_Shdr& section)>& change) {
  std::string library = readFile(pluginFile("never_opened"));
  const std::size_t header = headerOfSection(library, LUMIVOX_VERSION_SECTION);
  auto section = partOf<Elf64_Shdr>(library, header);
  change(library, section);
  setPart(library, header, section);
  return reasonForContent(library);
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

TEST_CASE("a library of another interface version, compiler or headers is never opened, and both are named") {
  using Record = TechniqueVersionRecord;
  const std::vector<std::pair<std::function<void(Record&)>, Tells>> changes{
      {[](Record& record) { ++record.apiVersion; },
       Tells("API version", kTechniqueApiVersion + 1, kTechniqueApiVersion)},
      {[](Record& record) { std::memcpy(record.headers, "0123456789abcdef", 16); },
       Tells("headers", "0123456789abcdef", kHeadersHash)},
      {[](Record& record) { record.sceneSize += 8; },
       Tells("size of Scene", sizeof(Scene) + 8, sizeof(Scene))},
      // Words that lack their end, or are no text, are told as far as they go.
      {[](Record& record) { std::memset(record.compiler, 'x', sizeof(record.compiler)); },
       Tells("compiler", std::string(64, 'x'), "'gcc")},
      {[](Record& record) { std::memcpy(record.headers, "a\x1b[31m\n", 8); }, Tells("headers", "'a?[31m?")}};
  for (const auto& [change, told] : changes) CHECK_THAT(reasonForRecord(change), told);
}

TEST_CASE("a version record that is absent or of another size is refused, not read beyond") {
  constexpr std::size_t kRest = sizeof(TechniqueVersionRecord);
  const std::vector<std::pair<std::function<void(Elf64_Shdr&)>, Tells>> changes{
      {[](Elf64_Shdr& section) { section.sh_name = 0; }, Tells("no version record", ".lumivox_version")},
      {[](Elf64_Shdr& section) { section.sh_size = 0; }, Tells("version record", "0 bytes", kRest)},
      {[](Elf64_Shdr& section) { section.sh_type = SHT_NOBITS; }, Tells("version record", "0 bytes", kRest)},
      // The section names bytes that the file does not have.
      {[](Elf64_Shdr& section) { section.sh_offset = ~0ull - 4; }, Tells("no version record")},
      {[](Elf64_Shdr& section) { section.sh_size = ~0ull; }, Tells("no version record")}};
  for (const auto& [change, told] : changes)
    CHECK_THAT(reasonForSection([&](std::string&, Elf64_Shdr& section) { change(section); }), told);
  for (const std::uint32_t size : {0u, 0xffffffffu})
    CHECK_THAT(reasonForRecord([&](TechniqueVersionRecord& record) { record.recordSize = size; }),
               Tells("version record", size, kRest));
  // Shorter and longer ones of other versions, at the end of the file.
  for (const std::uint32_t size : {3u, 8u, 12u, 40u, static_cast<std::uint32_t>(kRest + 24)}) {
    for (const std::uint32_t version : {kTechniqueApiVersion, kTechniqueApiVersion + 3}) {
      const std::string reason = reasonForSection([&](std::string& file, Elf64_Shdr& section) {
        std::string record(size, 'y');
        const std::uint32_t start[] = {size, version};
        std::memcpy(record.data(), start, std::min<std::size_t>(size, sizeof(start)));
        section.sh_offset = file.size();
        section.sh_size = size;
        file += record;
      });
      CHECK_THAT(reason, size < 8                          ? Tells("version record", "3 bytes", kRest)
                         : version != kTechniqueApiVersion ? Tells("API version", version)
                                                           : Tells("size of the version record", size));
    }
  }
}

TEST_CASE("a library whose table of sections is broken has no version record") {
  const std::string whole = readFile(pluginFile("never_opened"));
  for (void (*change)(Elf64_Ehdr&) : {+[](Elf64_Ehdr& header) { header.e_shnum = 0; },
                                      +[](Elf64_Ehdr& header) { header.e_shstrndx = 0xfff0; },
                                      +[](Elf64_Ehdr& header) { header.e_shstrndx = 0; },
                                      +[](Elf64_Ehdr& header) { header.e_shentsize = 8; },
                                      +[](Elf64_Ehdr& header) { header.e_shoff = 16; }}) {
    std::string library = whole;
    auto header = partOf<Elf64_Ehdr>(library, 0);
    change(header);
    setPart(library, 0, header);
    CHECK_THAT(reasonForContent(library), Tells("no version record"));
  }
}

TEST_CASE("a refused library of the same name changes nothing in the one that is accepted") {
  const LogCapture log;
  const TemporaryDirectory before;
  std::string other = readFile(pluginDirectory("shared_value_4") / "libshared_value.so");
  const auto section = partOf<Elf64_Shdr>(other, headerOfSection(other, LUMIVOX_VERSION_SECTION));
  other[section.sh_offset + offsetof(TechniqueVersionRecord, headers)] = 'x';
  before.write("libshared_value.so", other);
  const auto defaultOf = [](TechniqueSet& set) {
    const Technique* technique = set.technique("shared_value");
    REQUIRE(technique != nullptr);
    return technique->find("paint")->make()->parameters()[0]->defaultText();
  };
  TechniqueSet both({before.path(), pluginDirectory("shared_value_24")});
  CHECK(defaultOf(both) == "24");
  CHECK(both.skipped().size() == 1);
  CHECK_THAT(log.text(), Tells("skipped"));
  // Two that both fit keep their own: the window opens a changed library beside the one before it.
  TechniqueSet earlier({pluginDirectory("shared_value_4")}), later({pluginDirectory("shared_value_24")});
  CHECK(defaultOf(earlier) == "4");
  CHECK(defaultOf(later) == "24");
  CHECK(defaultOf(earlier) == "4");
}

TEST_CASE("strict refuses a library that would be skipped, each time it is asked for") {
  const TemporaryDirectory broken;
  broken.write("libgood.so", "no library");
  TechniqueSet set({broken.path(), pluginDirectory("good")}, true);
  for (int i = 0; i < 2; ++i)
    CHECK_THROWS_MATCHES(
        set.technique("good"), Error,
        Tells((broken.path() / "libgood.so").string() + ": not a shared library", "--strict"));
  CHECK(set.skipped().empty());
  TechniqueSet sound({pluginDirectory("good")}, true);
  CHECK(sound.technique("good") != nullptr);
  CHECK(sound.technique("absent") == nullptr);
}

TEST_CASE("technique libraries export their entry point alone, and nothing that a process would share") {
  const fs::path folder = binaryDirectory() / "lib/techniques";
  int seen = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".so") continue;
    ++seen;
    INFO(entry.path());
    const std::vector<ElfSymbol> symbols = exportedSymbols(readFile(entry.path(), kLargestLibraryFile));
    REQUIRE(symbols.size() == 1);
    CHECK(symbols[0].name == "lumivox_technique_register");
    CHECK(ELF64_ST_BIND(symbols[0].entry.st_info) == STB_GLOBAL);
  }
  CHECK(seen > 0);
  // What the reading above rests on: a library that hides nothing shows more.
  CHECK(
      exportedSymbols(readFile(pluginDirectory("shared_value_4") / "libshared_value.so", kLargestLibraryFile))
          .size() > 1);
  for (const char* library : {"liblumivox.so", "liblumivox_lab.so"}) {
    INFO(library);
    for (const ElfSymbol& symbol :
         exportedSymbols(readFile(binaryDirectory() / "lib" / library, kLargestLibraryFile)))
      if (ELF64_ST_BIND(symbol.entry.st_info) == STB_GNU_UNIQUE) FAIL_CHECK(symbol.name);
  }
}

TEST_CASE("a program that is older than its library is told so before it does anything") {
  TechniqueVersionRecord program = techniqueVersionHere();
  CHECK_NOTHROW(requireLibraryOf(program));
  program.headers[0] = program.headers[0] == '0' ? '1' : '0';
  CHECK_THROWS_MATCHES(requireLibraryOf(program), Error,
                       Tells("different sources", "the hash of the public headers is"));
  program = techniqueVersionHere();
  program.portsSize += 8;
  CHECK_THROWS_MATCHES(requireLibraryOf(program), Error, Tells("the size of the ports is"));
}

TEST_CASE("a shared library that is no technique, or cannot register, is skipped with what it lacks") {
  const auto [plugin, told] = GENERATE(table<const char*, Tells>({
      {"no_entry", Tells("no version record")},
      {"unresolved", Tells("undefined symbol", "_Z23functionThatNobodyWrotev")},
      {"no_passes", Tells("no pass")},
      {"throwing", Tells("the table of directions is missing")},
  }));
  CHECK_THAT(reasonFor(plugin), told);
}

TEST_CASE("what lies under a library's name and is none, or a damaged one, is skipped and never mapped") {
  const std::string whole = readFile(pluginFile("good"));
  const auto with = [&](std::size_t from, std::size_t to, char byte) {
    std::string changed = whole;
    std::fill(changed.begin() + static_cast<std::ptrdiff_t>(from),
              changed.begin() + static_cast<std::ptrdiff_t>(to), byte);
    return changed;
  };
  std::string unnamed = whole;
  for (std::size_t at = 0; (at = unnamed.find("lumivox_technique_register", at)) != std::string::npos; ++at)
    unnamed[at] = 'L';
  CHECK_THAT(reasonForContent(unnamed), Tells("lumivox_technique_register", "missing"));
  CHECK_THAT(reasonForContent("this is no library\n"), Tells("not a shared library"));
  CHECK_THAT(reasonForContent(""), Tells("empty"));
  CHECK_THAT(reasonForContent(with(18, 19, 3)), Tells("another kind of machine"));  // e_machine: Intel 80386
  CHECK_THAT(reasonForContent(with(40, 48, '\xff')), Tells("damaged"));             // e_shoff
  for (const std::size_t length : {std::size_t{5}, std::size_t{50}, std::size_t{100}, whole.size() / 4,
                                   whole.size() / 2, whole.size() - 1})
    CHECK_THAT(reasonForContent(whole.substr(0, length)), Tells("truncated"));
  const TemporaryDirectory directory;
  fs::create_directory(directory.path() / "libfake.so");
  CHECK_THAT(reasonFor("fake", directory.path()), Tells("libfake.so"));
}

TEST_CASE("one bad library does not keep the others from loading, of the same name in another folder too") {
  const LogCapture log;
  const TemporaryDirectory broken;
  broken.write("libgood.so", "no library");
  TechniqueSet set(
      {broken.path(), pluginDirectory("no_entry"), pluginDirectory("good"), pluginDirectory("no_passes")});
  CHECK(set.available() == std::vector<std::string>{"good", "no_entry", "no_passes"});
  // Asked again, it is neither opened nor reported again.
  for (int again = 0; again < 2; ++again) {
    CHECK(set.technique("no_entry") == nullptr);
    CHECK(set.technique("no_passes") == nullptr);
    REQUIRE(set.technique("good") != nullptr);
    CHECK(set.technique("good")->library == pluginFile("good"));
    CHECK(set.skipped().size() == 3);
  }
}

TEST_CASE("an absent technique is neither opened nor skipped, and no name leads out of the directories") {
  TechniqueSet set({pluginDirectory("no_entry"), "/no/such/directory"});
  CHECK(set.technique("absent") == nullptr);
  CHECK(set.technique("../good/libgood") == nullptr);
  CHECK(set.technique("") == nullptr);
  CHECK(set.skipped().empty());
}

TEST_CASE("the shader pack beside a library is read with it, and must be whole and its own") {
  const TemporaryDirectory directory;
  fs::copy_file(pluginFile("good"), directory.path() / "libgood.so");
  directory.write("good.shaderpack", "these are no shaders");
  CHECK_THAT(reasonFor("good", directory.path()), Tells("good.shaderpack"));
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
  CHECK_THAT(reasonFor("good", directory.path()), Tells("shaders", "another"));
}

TEST_CASE("techniques are sought where named, then in the environment, then beside the framework") {
  const TemporaryDirectory given, first, second;
  const std::string list = first.path().string() + "::" + second.path().string();
  CHECK(TechniqueSet::defaultDirectories().size() == 1);
  setenv("LUMIVOX_TECHNIQUES", list.c_str(), 1);
  const auto directories = TechniqueSet::defaultDirectories({given.path()});
  REQUIRE(directories.size() == 4);
  CHECK(directories[0] == given.path());
  CHECK(directories[1] == first.path());
  CHECK(directories[2] == second.path());
  CHECK(fs::weakly_canonical(directories[3]) == fs::weakly_canonical(binaryDirectory() / "lib/techniques"));
  CHECK_THROWS_MATCHES(TechniqueSet::defaultDirectories({"/no/such/directory"}), Error,
                       Tells("/no/such/directory"));
}
