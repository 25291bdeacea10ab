// The window from its start to its end: as somebody types it, and as something else ends it.
#include <algorithm>

#include "tools/started.h"
#include "tools/viewer_support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

namespace fs = std::filesystem;

/// Where pixels of one hue lie.
struct Hue {
  double share = 0.0, x = 0.0;  ///< of all pixels; their middle, in pixels
};

/// Pixels that have more of one channel than of the others, and are no black.
Hue hueOf(const ImageBuffer& image, int channel) {
  Hue hue;
  double count = 0.0, sum = 0.0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const float value = image.at(x, y, channel);
      const float others = std::max(image.at(x, y, (channel + 1) % 3), image.at(x, y, (channel + 2) % 3));
      if (value < 0.15f || value < 1.5f * others) continue;
      count += 1.0;
      sum += x;
    }
  hue.share = count / (image.width() * image.height());
  hue.x = count > 0.0 ? sum / count : 0.0;
  return hue;
}

std::vector<fs::path> foldersOfViewers(const fs::path& among) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(among))
    if (entry.path().filename().string().starts_with("lumivox_view_")) found.push_back(entry.path());
  return found;
}

/// A window that has taken its libraries anew, so that it has files among the temporary ones.
class WindowWithFiles {
 public:
  explicit WindowWithFiles(const Workplace& place, const std::string& done)
      : script_(place.write("stay.view", "view \"stays\" {\n wait frame\n reload on\n wait frame\n record " +
                                             quotedFile(place, done) + "\n}\n")),
        window_({"view", place.scene(), committedPipeline("direct_lighting"), "--resolution", "8x8",
                 "--script", script_.string()},
                place.file("errors")) {
    REQUIRE(becomes([&] { return place.has(done); }));
  }
  int endedBy(int signal) {
    window_.signalAfter(std::chrono::milliseconds(0), signal);
    return window_.wait();
  }

 private:
  fs::path script_;
  Started window_;
};

}  // namespace

TEST_CASE(
    "`lumivox view SCENE`, as the README types it, shows the scene on the screen and ends as it is told") {
  if (!canShowWindows()) return;
  const Workplace place;
  const Variable state("XDG_STATE_HOME", place.file("state"));
  Started window({"view", (sourceDirectory() / "scenes/cornell.scene").string()}, place.file("errors"));
  // The box: looking in, its red wall is on the left, its green one on the right.
  Hue red, green;
  const bool shown = becomes([&] {
    const ImageBuffer screen = display().seen();
    red = hueOf(screen, 0);
    green = hueOf(screen, 1);
    return red.share > 0.002 && green.share > 0.002;
  });
  INFO(place.read("errors") << "red " << red.share << " at " << red.x << ", green " << green.share << " at "
                            << green.x);
  CHECK(shown);
  CHECK(red.x + 200.0 < green.x);
  window.signalAfter(std::chrono::milliseconds(0), SIGTERM);
  const int status = window.wait();
  CHECK((WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM));
  CHECK(contains(place.read("state/lumivox/layout.view"), "panel look"));  // as when somebody closes it
}

TEST_CASE(
    "`lumivox view` takes options before and behind its name, and says of wrong words what others say") {
  const Workplace place;
  const auto view = [](const std::string& before, const std::string& behind) {
    return runCommand("env -u DISPLAY -u WAYLAND_DISPLAY '" + (binaryDirectory() / "bin/lumivox").string() +
                      "' " + before + " view " + behind);
  };
  const std::string scene = "'" + place.scene() + "'",
                    texts = scene + " '" + committedPipeline("direct_lighting") + "'";
  fs::create_directories(place.path() / "view");
  // All of these come as far as the display, which is not there.
  for (const auto& [before, behind] : std::vector<std::pair<std::string, std::string>>{
           {"", texts},
           {"", "--resolution 8x8 " + texts + " --camera main --time 300ms"},
           {"", "-- " + texts},
           {"--quiet", texts + " --window 300x200 --fps-limit 30"},
           {"--assets '" + place.file("view") + "' --device software", texts},
           {"--device view --assets '" + place.file("view") + "'", "--verbose " + texts}}) {
    const CommandResult result = view(before, behind);
    INFO(before << " view " << behind << "\n" << result.errors);
    CHECK(result.exitCode == 2);
    CHECK(contains(result.errors, "there is no display to open a window on"));
    CHECK(contains(result.errors, "`lumivox render` makes images without one"));
    CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') <= 2);  // a sentence and no more
  }
  CHECK(contains(view("", "--resolutoin 8x8 " + texts).errors, "did you mean '--resolution'"));
  CHECK(contains(view("", "").errors, "SCENE is required"));
  CHECK(contains(view("", scene + " --seed 1.5").errors, "--seed '1.5': expected a whole number"));
  CHECK(contains(view("", scene + " --window 0x0").errors, "--window '0x0': expected WIDTHxHEIGHT"));
  const fs::path unfit = place.write("unfit/libdirect_lighting.so", "no library");
  const CommandResult strict = view("--strict --techniques '" + unfit.parent_path().string() + "'", texts);
  INFO(strict.errors);
  CHECK(strict.exitCode == 2);
  CHECK(contains(unwrapped(strict.errors), unfit.string() + ": not a shared library"));
  CHECK(contains(unwrapped(strict.errors), "refused under --strict"));
  CHECK_FALSE(contains(strict.errors, "there is no display"));
  // One list of options for both programs.
  const std::string help = typed("view --help").output,
                    ofWindow =
                        runCommand("'" + (binaryDirectory() / "bin/lumivox-view").string() + "' --help")
                            .output;
  for (const char* option :
       {"--script", "--layout", "--window", "--fps-limit", "--set", "--camera", "PIPELINE"}) {
    INFO(option);
    CHECK(contains(help, option));
    CHECK(contains(ofWindow, option));
  }
}

TEST_CASE("the seed of the command line is that of the frames") {
  const Workplace place;
  viewer::SessionOptions options;
  options.scene = place.scene();
  options.pipelines = {committedPipeline("direct_lighting")};
  options.techniques = {binaryDirectory() / "lib/techniques"};
  options.seed = 77;
  viewer::Session session(options, [] {});
  CHECK(session.state().seed == 77);
}

TEST_CASE(
    "a window that a signal ends leaves no files among the temporary ones, and is seen to be ended by it") {
  if (!canShowWindows()) return;
  const Workplace place;
  const fs::path among = place.path() / "among";
  fs::create_directories(among);
  const Variable temporary("TMPDIR", among.string());
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    INFO("signal " << signal);
    WindowWithFiles window(place, "done_" + std::to_string(signal));
    const std::vector<fs::path> folders = foldersOfViewers(among);
    REQUIRE(folders.size() == 1);
    CHECK((fs::status(folders.front()).permissions() & fs::perms::all) == fs::perms::owner_all);
    const int status = window.endedBy(signal);
    CHECK((WIFSIGNALED(status) && WTERMSIG(status) == signal));
    CHECK(foldersOfViewers(among).empty());
  }
}

TEST_CASE("what a window left that was killed is removed by the next one, and that of a living one is not") {
  if (!canShowWindows()) return;
  const Workplace place;
  const fs::path among = place.path() / "among";
  fs::create_directories(among);
  const Variable temporary("TMPDIR", among.string());
  WindowWithFiles killed(place, "killed");
  const std::vector<fs::path> left = foldersOfViewers(among);
  REQUIRE(left.size() == 1);
  killed.endedBy(SIGKILL);
  REQUIRE(fs::exists(left.front()));
  WindowWithFiles first(place, "first");
  CHECK_FALSE(fs::exists(left.front()));
  const std::vector<fs::path> ofFirst = foldersOfViewers(among);
  REQUIRE(ofFirst.size() == 1);
  WindowWithFiles second(place, "second");
  CHECK(fs::exists(ofFirst.front()));
  CHECK(foldersOfViewers(among).size() == 2);
  second.endedBy(SIGTERM);
  first.endedBy(SIGTERM);
  CHECK(foldersOfViewers(among).empty());
}
