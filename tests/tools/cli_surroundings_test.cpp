// What the surroundings of the program withhold or do to it: libraries, memory, the end of its parent.
#include <fstream>

#include "base/process.h"
#include "tools/started.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

namespace fs = std::filesystem;

std::string quoted(const std::string& text) {
  return "'" + text + "'";
}

/// Processes whose parent is this one (proc(5): field 4 of stat, behind the name in brackets).
std::vector<int> childrenOf(int parent) {
  std::vector<int> children;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream stream(entry.path() / "stat");
    const std::string stat{std::istreambuf_iterator<char>(stream), {}};
    const std::size_t bracket = stat.rfind(')');
    if (bracket == std::string::npos) continue;
    if (std::atoi(stat.c_str() + std::min(stat.size(), bracket + 4)) == parent)
      children.push_back(std::stoi(name));
  }
  return children;
}

}  // namespace

TEST_CASE("without the libraries of OpenGL a sentence names what is missing and the package that has it") {
  const Workplace place;
  // An empty file under a library's name, which the dynamic loader finds first and refuses.
  const auto lacking = [&](const std::vector<std::string>& libraries) {
    const TemporaryDirectory folder;
    for (const std::string& library : libraries) folder.write(library, "");
    return runCommand("env LD_LIBRARY_PATH=" + quoted(folder.path().string()) + " " +
                      quoted((binaryDirectory() / "bin/lumivox").string()) + " render " +
                      quoted(place.scene()) + " " + quoted(committedPipeline("direct_lighting")) +
                      " -q --resolution 8x8 -o " + quoted(place.file("a.exr")));
  };
  const CommandResult egl = lacking({"libEGL.so.1"});
  checkRefused(egl, "no OpenGL: libEGL.so.1 (Debian package libegl1) cannot be opened: ");
  const CommandResult gl = lacking({"libGL.so.1", "libOpenGL.so.0"});
  checkRefused(gl,
               "no OpenGL: neither libOpenGL.so.0 (Debian package libopengl0) nor libGL.so.1 (libgl1) can be "
               "opened: ");
  CHECK(contains(gl.errors, "file too short"));
  CHECK_FALSE(place.has("a.exr"));
  // One of the two is enough.
  for (const char* library : {"libGL.so.1", "libOpenGL.so.0"}) {
    INFO(library);
    const CommandResult one = lacking({library});
    INFO(one.errors);
    CHECK(one.exitCode == 0);
  }
}

TEST_CASE("a limit on the address space refuses what does not fit, with what is needed and what is left") {
#if defined(__SANITIZE_ADDRESS__)
  return skip("the sanitizer needs all of the address space");
#endif
  if (runCommand("command -v prlimit").exitCode != 0) return skip("prlimit is not installed");
  const Workplace place;
  place.write("shadow.pipeline",
              "pipeline \"Shadow\" {\n  pass gbuffer direct_lighting.gbuffer { }\n"
              "  pass shadow direct_lighting.shadow_map { size 8192 }\n"
              "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n"
              "  output direct direct.radiance\n}\n");
  // Six faces of 8192 x 8192 texels of 4 bytes: 1.5 GiB.
  const auto within = [&](const std::string& bytes) {
    return runCommand("prlimit --as=" + bytes + " " + quoted((binaryDirectory() / "bin/lumivox").string()) +
                      " render -q --resolution 8x8 " + quoted(place.scene()) + " " +
                      quoted(place.file("shadow.pipeline")) + " -o " + quoted(place.file("a.exr")));
  };
  // 1.75 GiB, of which the program takes some 0.6 itself, with many processors more.
  const CommandResult tight = within("1879048192");
  checkRefused(tight, "needs 1.5 GiB, but only ");
  CHECK(contains(tight.errors, "iB of memory are left"));
  CHECK_FALSE(place.has("a.exr"));
}

TEST_CASE("ffmpeg ends with the program that started it, even when that is killed") {
  const Workplace place;
  // It reads nothing and would stay for minutes.
  place.write("bin/ffmpeg", "#!/bin/sh\necho $$ > " + quoted(place.file("number")) + ".new\nmv " +
                                quoted(place.file("number")) + ".new " + quoted(place.file("number")) +
                                "\nexec sleep 600\n");
  fs::permissions(place.path() / "bin/ffmpeg", fs::perms::owner_all);
  const std::string path = std::getenv("PATH");
  setenv("PATH", (place.file("bin") + ":" + path).c_str(), 1);
  Started render({"render", place.scene(), committedPipeline("direct_lighting"), "-q", "--resolution",
                  "512x512", "--frames", "0..20", "--video", place.file("v.mp4")});
  setenv("PATH", path.c_str(), 1);
  REQUIRE(becomes([&] { return place.has("number"); }));
  const int encoder = std::stoi(place.read("number"));
  REQUIRE(startOf(encoder) > 0);
  render.signalAfter(std::chrono::milliseconds(0), SIGKILL);
  render.wait();
  const bool ended = becomes([&] { return startOf(encoder) == 0; });
  CHECK(ended);
  if (!ended) kill(encoder, SIGKILL);
  CHECK_FALSE(place.has("v.mp4"));
}

TEST_CASE("workers of a battery that is killed end with it") {
  const Place place;
  place.write(
      "spin.pipeline",
      "pipeline \"Spin\" {\n  pass paint hostile.paint { deed spin }\n\n  output direct paint.radiance\n}\n");
  Started battery({"--techniques", Place::techniques(), "stress", "--quick", "--workers", "1", "--case",
                   "camera_on_surface", "--pipeline", place.file("spin.pipeline"), "--time-limit", "600s"});
  std::vector<int> workers;
  REQUIRE(becomes([&] { return !(workers = childrenOf(battery.process())).empty(); }));
  battery.signalAfter(std::chrono::milliseconds(0), SIGKILL);
  battery.wait();
  for (const int worker : workers) {
    const bool ended = becomes([&] { return startOf(worker) == 0; });
    CHECK(ended);
    if (!ended) kill(worker, SIGKILL);
  }
}
