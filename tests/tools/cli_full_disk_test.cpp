// What a full disk leaves of a page that is written anew.
#include "tools/started.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// A shell script in which the folder of the pages is a file system of its own, of 4 MiB.
CommandResult onSmallDisk(const Place& place, const std::string& script) {
  place.write("script.sh", "set -e\nmount -t tmpfs -o size=4m none " + place.quoted("disk") + "\n" + script);
  return runCommand("unshare -rm sh " + place.quoted("script.sh"));
}

std::string reportWords(const Place& place, const std::string& pipeline, const std::string& seed) {
  std::string line = "'" + (binaryDirectory() / "bin/lumivox").string() + "'";
  for (const std::string& word :
       place.words("report", {pipeline}, {"--no-sweep", "--seed", seed, "-o", place.file("disk/page.html")}))
    line += " '" + word + "'";
  return line;
}

}  // namespace

TEST_CASE(
    "a report that meets a full disk leaves the old page, CSV and JSON, nothing beside them, and its points") {
  const Place place;
  std::filesystem::create_directory(place.path() / "disk");
  if (onSmallDisk(place, "true\n").exitCode != 0)
    return skip("this process may mount no file system of its own (unshare -rm, tmpfs)");
  // Room for the kept points, CSV and JSON, not for the page.
  const std::string out = place.quoted("out"), disk = place.quoted("disk");
  const CommandResult result =
      onSmallDisk(place, "cd " + disk + "\n" + reportWords(place, "fast", "1") +
                             " >/dev/null\nsha256sum page.* > " + place.quoted("before") +
                             "\nsize=$(stat -c %s page.html)\nfree=$(df -B1 --output=avail . | tail -1)\n" +
                             "head -c $((free - size)) /dev/zero > filler || true\nls -A > " +
                             place.quoted("names_before") + "\nstatus=0\n" + reportWords(place, "fast", "2") +
                             " >/dev/null 2> " + place.quoted("said") + " || status=$?\necho $status > " +
                             place.quoted("status") + "\nls -A > " + place.quoted("names_after") +
                             "\nsha256sum page.csv page.html page.json > " + place.quoted("after") +
                             "\nrm filler\n" + reportWords(place, "fast", "2") + " > " +
                             place.quoted("again") + "\nls -A > " + place.quoted("names_at_last") + "\n");
  INFO(result.output << result.errors << place.read("said"));
  REQUIRE(result.exitCode == 0);
  CHECK(place.read("status") == "2\n");
  CHECK(contains(place.read("said"), "page.html: cannot write: No space left on device"));
  CHECK(place.read("after") == place.read("before"));
  CHECK(place.read("names_after") == "filler\npage.csv\npage.html\npage.json\npage.unfinished.sqlite\n");
  CHECK(contains(place.read("again"), "1 of 1 points were taken up"));
  CHECK(place.read("names_at_last") == "page.csv\npage.html\npage.json\n");
}

TEST_CASE("a page larger than files may be leaves the old page, CSV and JSON") {
  const Place place;
  std::filesystem::create_directory(place.path() / "disk");
  REQUIRE(runCommand(reportWords(place, "fast", "1")).exitCode == 0);
  const std::string page = place.read("disk/page.html"), csv = place.read("disk/page.csv"),
                    json = place.read("disk/page.json");
  const std::uintmax_t blocks = page.size() / 1024;  // of sh; a page that is not complete is about as large
  const CommandResult limited = runCommand("sh -c 'trap \"\" XFSZ; ulimit -f " + std::to_string(blocks) +
                                           "; exec \"$@\"' sh " + reportWords(place, "fast", "2"));
  INFO(limited.errors);
  CHECK(limited.exitCode == 2);
  CHECK(contains(limited.errors, "page.html: cannot write: File too large"));
  CHECK(place.read("disk/page.html") == page);
  CHECK(place.read("disk/page.csv") == csv);
  CHECK(place.read("disk/page.json") == json);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(place.path() / "disk"))
    ++files;
  CHECK(files == 4);  // and the points that were measured
}
