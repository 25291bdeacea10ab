// Techniques that are changed while they are shown, without a window.
#include <fstream>
#include <functional>

#include "lumivox/pipeline/pass.h"
#include "lumivox/plugin/loader.h"
#include "tools/started.h"
#include "viewer/techniques.h"
#include "viewer/watch.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::viewer;

namespace fs = std::filesystem;

TEST_CASE("a file that is replaced by one as long and as old is seen to be another") {
  const TemporaryDirectory folder;
  const fs::path file = folder.path() / "watched";
  const auto put = [&](std::string_view content) {
    const fs::path next = folder.path() / "next";
    std::ofstream(next) << content;
    fs::last_write_time(next, fs::file_time_type());
    fs::rename(next, file);
  };
  put("one");
  Watch watch;
  watch.set({file});
  CHECK(watch.changed().empty());
  put("two");
  CHECK(watch.changed() == std::vector{file});
  CHECK(watch.changed().empty());
  fs::remove(file);
  CHECK(watch.changed() == std::vector{file});
}

TEST_CASE(
    "a technique that is loaded anew has the values of its new library, and the one before it keeps its own") {
  const TemporaryDirectory folder;
  const fs::path library = folder.path() / "libshared_value.so";
  const auto put = [&](const char* value) {
    const fs::path built = binaryDirectory() / "tests/plugins" / (std::string("shared_value_") + value);
    fs::copy_file(built / library.filename(), folder.path() / "new.so");
    fs::rename(folder.path() / "new.so", library);  // as a linker's output is put in place
  };
  const auto defaultOf = [](TechniqueSet& set) {
    const Technique* technique = set.technique("shared_value");
    REQUIRE(technique != nullptr);
    return technique->find("paint")->make()->parameters()[0]->defaultText();
  };
  put("4");
  LiveTechniques live({folder.path()}, [] {});
  live.use({"shared_value"});
  TechniqueSet first(live.directories());
  CHECK(defaultOf(first) == "4");
  put("24");
  REQUIRE(becomes([&] { return live.update(); }));
  CHECK(live.errors().empty());
  TechniqueSet second(live.directories());
  CHECK(defaultOf(second) == "24");
  CHECK(defaultOf(first) == "4");
  put("4");
  live.reload();
  TechniqueSet third(live.directories());
  CHECK(defaultOf(third) == "4");
  CHECK(defaultOf(second) == "24");
}
