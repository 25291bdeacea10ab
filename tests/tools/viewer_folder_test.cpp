// The folder from which libraries are opened that were changed while they are shown.
#include <sys/stat.h>
#include <unistd.h>

#include "tools/viewer_support.h"
#include "viewer/techniques.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::viewer;

namespace {

namespace fs = std::filesystem;

/// A folder of temporary files while it lives.
class Among {
 public:
  explicit Among(const Workplace& place)
      : path_(place.path() / "among"), temporary_("TMPDIR", path_.string()) {
    fs::create_directories(path_);
  }
  const fs::path& path() const { return path_; }
  std::vector<fs::path> entries() const {
    std::vector<fs::path> all;
    for (const auto& entry : fs::directory_iterator(path_)) all.push_back(entry.path());
    return all;
  }

 private:
  fs::path path_;
  Variable temporary_;
};

const fs::path& built() {
  static const fs::path folder = binaryDirectory() / "lib/techniques";
  return folder;
}

}  // namespace

TEST_CASE("changed libraries are opened from a folder that nobody could prepare or enter") {
  const Workplace place;
  const Among among(place);
  // What another user would prepare who knows the number of the process.
  const fs::path theirs = place.path() / "theirs";
  fs::create_directories(theirs);
  fs::create_directory_symlink(theirs, among.path() / ("lumivox_view_" + std::to_string(getpid())));
  {
    LiveTechniques live({built()}, [] {});
    CHECK(among.entries().size() == 1);  // none before it is needed
    live.use({"direct_lighting"});
    live.reload();
    CHECK(live.errors().empty());
    REQUIRE(live.directories().size() == 2);
    const fs::path folder = live.directories().front();
    CHECK(fs::exists(folder / "libdirect_lighting.so"));
    CHECK(folder.parent_path().parent_path() == among.path());
    struct stat is {};
    REQUIRE(lstat(folder.parent_path().c_str(), &is) == 0);
    CHECK(S_ISDIR(is.st_mode));
    CHECK(is.st_uid == geteuid());
    CHECK((is.st_mode & 0777) == 0700);
  }
  CHECK(fs::is_empty(theirs));
  CHECK(among.entries().size() == 1);
}

TEST_CASE(
    "no library is opened from a folder of temporary files in which others may exchange what lies there") {
  const Workplace place;
  const Among among(place);
  LiveTechniques live({built()}, [] {});
  live.use({"direct_lighting"});
  fs::permissions(among.path(), fs::perms::all);
  live.reload();
  CHECK(live.directories() == std::vector<fs::path>{built()});
  REQUIRE(live.errors().count("direct_lighting") == 1);
  CHECK(contains(live.errors().at("direct_lighting"), "others may exchange what lies there"));
  fs::permissions(among.path(), fs::perms::all | fs::perms::sticky_bit);
  live.reload();
  CHECK(live.errors().empty());
  CHECK(live.directories().size() == 2);
}

TEST_CASE("a folder that was taken away is no longer opened, whatever stands in its place") {
  const Workplace place;
  const Among among(place);
  LiveTechniques live({built()}, [] {});
  live.use({"direct_lighting", "voxelization"});
  live.reload();
  REQUIRE(live.directories().size() == 3);
  const fs::path folder = live.directories().front().parent_path();
  fs::rename(folder, place.path() / "taken");
  fs::create_directories(folder / "direct_lighting_1");
  fs::permissions(folder, fs::perms::owner_all);
  CHECK(live.update());
  CHECK(live.directories() == std::vector<fs::path>{built()});
  REQUIRE(live.errors().count("direct_lighting") == 1);
  CHECK(contains(live.errors().at("direct_lighting"), folder.string() + " is gone"));
  live.reload();
  CHECK(live.errors().empty());
  REQUIRE(live.directories().size() == 3);
  CHECK(live.directories().front().parent_path() != folder);
}

TEST_CASE("folders of processes that are gone are removed, and nothing that only looks like one") {
  const Workplace place;
  const Among among(place);
  const auto folder = [&](const char* name, fs::perms permissions) {
    const fs::path made = among.path() / name;
    fs::create_directories(made / "direct_lighting_1");
    fs::permissions(made, permissions);
    return made;
  };
  const fs::path left = folder("lumivox_view_abcdef", fs::perms::owner_all),
                 open = folder("lumivox_view_others", fs::perms::owner_all | fs::perms::others_read),
                 other = folder("lumivox_video_abc", fs::perms::owner_all);
  const fs::path target = place.path() / "target";
  fs::create_directories(target / "kept");
  fs::create_directory_symlink(target, among.path() / "lumivox_view_linked");
  LiveTechniques living({built()}, [] {});
  living.use({"direct_lighting"});
  living.reload();
  CHECK_FALSE(fs::exists(left));
  CHECK(fs::exists(open));
  CHECK(fs::exists(other));
  CHECK(fs::exists(target / "kept"));
  const LiveTechniques next({built()}, [] {});
  CHECK(fs::exists(living.directories().front()));
}
