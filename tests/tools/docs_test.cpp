// The guides: what they quote stands in files that are built or tested, their links lead somewhere, and their
// commands exist.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "lumivox/base/file.h"
#include "lumivox/dsl/document.h"
#include "tools/cli_support.h"
#include "tools/guide.h"

namespace fs = std::filesystem;
using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Layout may differ: white space does not count, since a formatter may break a line wherever it likes.
std::string withoutLayout(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (std::isspace(static_cast<unsigned char>(c)) == 0) result += c;
  }
  return result;
}

std::vector<std::string> linksOf(const std::string& markdown) {
  std::vector<std::string> links;
  static const std::regex pattern("\\]\\(([^)#\\s]+)[^)]*\\)");
  for (std::sregex_iterator match(markdown.begin(), markdown.end(), pattern), end; match != end; ++match)
    if ((*match)[1].str().find("://") == std::string::npos) links.push_back((*match)[1]);
  return links;
}

/// The paper cards, and what the folders of a technique say of themselves: cards of its chapters, or
/// decisions.
std::vector<fs::path> cards() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(test::sourceDirectory() / "techniques"))
    if (entry.path().filename() == "README.md" &&
        entry.path().parent_path() != test::sourceDirectory() / "techniques")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

bool isBelowTechnique(const fs::path& card) {
  return card.parent_path().parent_path() != test::sourceDirectory() / "techniques";
}

/// Whether it is the card of a chapter, which the card of the technique lists.
bool isChapter(const fs::path& card) {
  if (!isBelowTechnique(card)) return false;
  const std::string folder = card.parent_path().filename().string();
  return contains(readFile(card.parent_path().parent_path() / "README.md"),
                  "\n| [" + folder + "](" + folder + "/README.md) | ");
}

/// A text without what stands from "<!-- reproduced", "<!-- measured", "<!-- published" or "<!-- results
/// store" to "<!-- end -->".
std::string withoutGenerated(std::string text) {
  static const std::string kEnd = "<!-- end -->";
  for (const std::string begin :
       {"<!-- reproduced ", "<!-- measured ", "<!-- published ", "<!-- results store"})
    for (std::size_t from = text.find(begin); from != std::string::npos; from = text.find(begin, from)) {
      const std::size_t end = text.find(kEnd, from);
      if (end == std::string::npos) break;
      text.erase(from, end + kEnd.size() - from);
    }
  return text;
}

/// A template as `lumivox new technique ambient` writes it out: the example of the guide.
std::string named(std::string text) {
  static const std::string nameInTemplates = "technique_name";
  for (std::size_t at = text.find(nameInTemplates); at != std::string::npos;
       at = text.find(nameInTemplates, at))
    text.replace(at, nameInTemplates.size(), "ambient");
  return text;
}

/// A file that a command in a guide names: of the tree; SCENES stands for its installed scenes; or of the
/// technique that the guide writes.
bool isThere(std::string file) {
  if (file.rfind("SCENES/", 0) == 0) file.replace(0, 6, "scenes");
  const std::string example = "ambient";
  std::string ofTemplate = file;
  if (const std::size_t at = ofTemplate.find(example); at != std::string::npos)
    ofTemplate.replace(at, example.size(), "technique_name");
  return fs::exists(test::sourceDirectory() / file) ||
         fs::exists(test::sourceDirectory() / "templates/technique" / ofTemplate);
}

/// The values of an enumeration of a header.
std::vector<std::string> valuesOf(const std::string& header, const std::string& enumeration) {
  std::smatch body;
  std::vector<std::string> values;
  if (!std::regex_search(header, body, std::regex("enum class " + enumeration + "[^{;]*\\{([^}]*)\\}")))
    return values;
  const std::string list = body[1];
  static const std::regex value("(\\w+)( = [^,]*)?(,|\\s*$)");
  for (std::sregex_iterator match(list.begin(), list.end(), value), end; match != end; ++match)
    values.push_back((*match)[1]);
  return values;
}

/// What a guide lists behind its mark `<!-- listed: NAME -->`: the words that the items of the list behind it
/// are about, those before the colon; without a list the texts in quotes of the paragraph.
std::set<std::string> listedIn(const std::string& guide, const std::string& name) {
  const std::string mark = "<!-- listed: " + name + " -->\n\n";
  std::string text = readFile(sourceDirectory() / "docs" / guide);
  INFO(guide << ": " << mark);
  REQUIRE(contains(text, mark));
  text.erase(0, text.find(mark) + mark.size());
  std::set<std::string> words;
  static const std::regex quoted("`\"([^\"]+)\"`"), item("\n- ([^:\n]*):"), word("`(\\w+)`");
  const std::string paragraph = text.substr(0, text.find("\n\n"));
  for (std::sregex_iterator match(paragraph.begin(), paragraph.end(), quoted), end; match != end; ++match)
    words.insert((*match)[1]);
  if (!words.empty()) return words;
  const std::size_t from = text.rfind("- ", 0) == 0 ? 0 : text.find("\n\n- ") + 2;
  const std::string list = "\n" + text.substr(from, text.find("\n\n", from) - from);
  for (std::sregex_iterator match(list.begin(), list.end(), item), end; match != end; ++match) {
    const std::string head = (*match)[1];
    for (std::sregex_iterator one(head.begin(), head.end(), word); one != end; ++one) words.insert((*one)[1]);
  }
  return words;
}

/// Where quotes of a language may come from.
std::string sourcesOf(const std::string& language) {
  static const std::vector<
      std::pair<std::set<std::string>, std::pair<std::set<std::string>, std::vector<std::string>>>>
      homes = {
          {{"scene"}, {{".scene"}, {"scenes", "docs/examples"}}},
          {{"pipeline"}, {{".pipeline"}, {"scenes", "docs/examples", "templates", "examples"}}},
          {{"sweep"}, {{".sweep"}, {"scenes"}}},
          {{"reproduction"}, {{".reproduction"}, {"scenes"}}},
          {{"cpp"}, {{".cpp", ".h"}, {"techniques", "framework/include", "tests", "templates", "examples"}}},
          {{"glsl"}, {{".glsl", ".vert", ".geom", ".frag", ".comp"}, {"shaders", "templates", "examples"}}},
          {{"cmake"}, {{".txt", ".cmake"}, {"techniques", "cmake", "templates"}}}};
  std::string all;
  for (const auto& [languages, where] : homes) {
    if (languages.count(language) == 0) continue;
    for (const std::string& folder : where.second)
      for (const auto& entry : fs::recursive_directory_iterator(test::sourceDirectory() / folder))
        if (entry.is_regular_file() && where.first.count(entry.path().extension().string()) != 0)
          all += withoutLayout(named(readFile(entry.path()))) + '\n';
  }
  return all;
}

}  // namespace

TEST_CASE("the reader of guides sees quotes, links and commands") {
  const std::string text =
      "a\n```cpp\nint  x;\n```\nb\n```sh\n./run render a  # why\nls\n```\nc `lumivox fmt --check A` `lumivox`\n";
  const auto quotes = quotesOf(text);
  REQUIRE(quotes.size() == 2);
  CHECK(quotes[0].language == "cpp");
  CHECK(withoutLayout(quotes[0].text) == "intx;");
  CHECK(quotes[1].line == 6);
  CHECK(commandLinesOf(text) == std::vector<std::string>{"./run render a", "ls"});
  const std::vector<NamedCommand> named = namedCommandsOf(text);
  REQUIRE(named.size() == 1);
  CHECK(named[0].command == "fmt");
  CHECK(named[0].options == std::vector<std::string>{"--check"});
  CHECK(linksOf("[a](b.md) [c](https://d.e) [f](g/h.md#i)") == std::vector<std::string>{"b.md", "g/h.md"});
}

TEST_CASE("what the guides quote stands word for word in files that are built or tested") {
  const std::set<std::string> quoted = {"scene", "pipeline", "sweep", "reproduction", "cpp", "glsl", "cmake"};
  for (const std::string& language : quoted) {
    const std::string sources = sourcesOf(language);
    for (const fs::path& guide : guides())
      for (const Quote& quote : quotesOf(readFile(guide))) {
        INFO(guide << ":" << quote.line << "\n" << quote.text);
        // Those in Python are run: cli_reading_results_test.
        CHECK((quoted.count(quote.language) != 0 || quote.language == "sh" || quote.language == "text" ||
               quote.language == "python"));
        if (quote.language == language) CHECK(sources.find(withoutLayout(quote.text)) != std::string::npos);
      }
  }
}

TEST_CASE("the links of guides and cards lead to files") {
  std::vector<fs::path> texts = guides();
  for (const fs::path& card : cards()) texts.push_back(card);
  for (const fs::path& guide : texts)
    for (const std::string& link : linksOf(readFile(guide))) {
      INFO(guide << " -> " << link);
      CHECK(fs::exists(guide.parent_path() / link));
    }
}

TEST_CASE("the files that the commands of the guides name are there") {
  for (const fs::path& guide : guides())
    for (const std::string& command : commandLinesOf(readFile(guide))) {
      static const std::regex file("[\\w./]+\\.(scene|pipeline|sweep|reproduction)\\b");
      for (std::sregex_iterator match(command.begin(), command.end(), file), end; match != end; ++match) {
        INFO(guide << ": " << match->str());
        CHECK((match->str().rfind("out/", 0) == 0 || isThere(match->str())));
      }
    }
}

TEST_CASE("commands and options that sentences of guides and cards name exist") {
  std::vector<fs::path> texts = guides();
  for (const fs::path& card : cards()) texts.push_back(card);
  std::map<std::string, std::string> help;
  std::size_t options = 0;
  for (const fs::path& text : texts)
    for (const NamedCommand& named : namedCommandsOf(readFile(text))) {
      const std::string command = named.program + " " + named.command;
      INFO(text << ": " << command);
      if (help.count(command) == 0) {
        const CommandResult result = runCommand("'" + (binaryDirectory() / "bin" / named.program).string() +
                                                "' " + named.command + " --help");
        CHECK(result.exitCode == 0);
        help[command] = result.output;
      }
      for (const std::string& option : named.options) {
        INFO(option);
        CHECK(contains(help[command], option));
        ++options;
      }
    }
  CHECK(help.size() > 10);
  CHECK(options > 10);
}

TEST_CASE("the house is a map of at most 120 lines, and names every folder that has decisions") {
  const fs::path house = sourceDirectory() / "docs/house.md";
  const std::string map = readFile(house);
  CHECK(std::count(map.begin(), map.end(), '\n') <= 120);
  std::set<fs::path> linked;
  for (const std::string& link : linksOf(map)) linked.insert((house.parent_path() / link).lexically_normal());
  std::size_t folders = 0;
  for (const fs::path& guide : guides()) {
    if (guide.filename() != "README.md" || guide.parent_path() == sourceDirectory()) continue;
    INFO(guide);
    CHECK(linked.count(guide) == 1);
    const std::string text = readFile(guide);
    if (guide.parent_path() != house.parent_path()) CHECK(std::count(text.begin(), text.end(), '\n') <= 70);
    ++folders;
  }
  CHECK(folders > 20);
}

TEST_CASE("the contents of the guides name every page") {
  const fs::path docs = sourceDirectory() / "docs";
  const std::string contents = readFile(docs / "README.md");
  std::size_t pages = 0;
  for (const auto& entry : fs::recursive_directory_iterator(docs)) {
    if (entry.path().extension() != ".md" || entry.path() == docs / "README.md") continue;
    INFO(entry.path());
    CHECK(contains(contents, "](" + entry.path().lexically_relative(docs).generic_string() + ") | "));
    ++pages;
  }
  CHECK(pages > 20);
}

TEST_CASE("the README's table has every technique, every committed pipeline, and every table and figure") {
  const fs::path root = sourceDirectory();
  const std::string readme = readFile(root / "README.md");
  const std::size_t from = readme.find("\n## Techniques\n");
  REQUIRE(from != std::string::npos);
  const std::string section = readme.substr(from, readme.find("\n## ", from + 1) - from);
  for (const auto& entry : fs::directory_iterator(root / "techniques")) {
    if (!entry.is_directory()) continue;
    const std::string name = entry.path().filename().string();
    INFO(name);
    CHECK(contains(section, "| [" + name + "] | "));
    CHECK(contains(section, "\n[" + name + "]: techniques/" + name + "/README.md\n"));
  }
  std::set<std::string> pipelines, named;
  for (const auto& entry : fs::recursive_directory_iterator(root / "scenes/pipelines"))
    if (entry.path().extension() == ".pipeline") pipelines.insert(entry.path().stem().string());
  static const std::regex code("`([^`]+)`");
  // Numbers of a source's tables and figures, and what else is named: "gomes2015: tables 1, 3; memory".
  std::set<std::string> reproduced;
  std::istringstream lines(section);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| ", 0) != 0) continue;
    std::istringstream cells(line);
    std::string cell;
    for (int i = 0; i < 4; ++i) std::getline(cells, cell, '|');
    for (std::sregex_iterator one(cell.begin(), cell.end(), code), end; one != end; ++one)
      named.insert((*one)[1]);
    std::string source, kind;
    static const std::regex part("`(\\w+)`|(table|figure)s?|(\\d+)|([a-z]+(?: [a-z]+)*)");
    std::getline(cells, cell, '|');
    for (std::sregex_iterator one(cell.begin(), cell.end(), part), end; one != end; ++one) {
      if ((*one)[1].matched) source = (*one)[1];
      if ((*one)[2].matched) kind = (*one)[2];
      if ((*one)[3].matched) reproduced.insert(source + "-" + kind + "-" + one->str());
      if ((*one)[4].matched && !source.empty())
        reproduced.insert(source + "-" + std::regex_replace(one->str(), std::regex(" "), "-"));
    }
  }
  named.erase("scenes/pipelines");
  named.erase("scenes/pipelines/voxelizers");
  CHECK(named == pipelines);
  // A name such as gomes2015-table-3-here is of table 3.
  const CommandResult list =
      runCommand("'" + (binaryDirectory() / "bin/lumivox").string() + "' reproduce --list --json");
  REQUIRE(list.exitCode == 0);
  static const std::regex name("\"name\": ?\"([^\"]+)\"");
  std::set<std::string> used;
  for (std::sregex_iterator one(list.output.begin(), list.output.end(), name), end; one != end; ++one) {
    const std::string whole = (*one)[1];
    INFO(whole);
    const auto found = std::find_if(reproduced.begin(), reproduced.end(), [&](const std::string& written) {
      return whole == written || whole.rfind(written + "-", 0) == 0;
    });
    CHECK(found != reproduced.end());
    if (found != reproduced.end()) used.insert(*found);
  }
  CHECK(used == reproduced);
}

TEST_CASE("the project has one version: of its build, its newest changes and its citation") {
  const auto found = [](const char* file, const char* pattern) {
    const std::string text = readFile(sourceDirectory() / file);
    std::smatch match;
    INFO(file);
    REQUIRE(std::regex_search(text, match, std::regex(pattern)));
    return match[1].str();
  };
  const std::string version = found("CMakeLists.txt", "project\\(Lumivox VERSION ([\\d.]+) ");
  CHECK(found("CHANGELOG.md", "\n## \\[(\\d[\\d.]*)\\] - \\d{4}-\\d\\d-\\d\\d\n") == version);
  CHECK(found("CITATION.cff", "\nversion: ([\\d.]+)\n") == version);
  CHECK(found("CITATION.cff", "^cff-version: ([\\d.]+)\n") == "1.2.0");
}

TEST_CASE("the guide to techniques shows every file of the one that `lumivox new technique` writes, whole") {
  const fs::path root = test::sourceDirectory() / "templates/technique";
  std::set<std::string> quoted;
  for (const Quote& quote : quotesOf(readFile(test::sourceDirectory() / "docs/writing_a_technique.md")))
    quoted.insert(withoutLayout(quote.text));
  std::size_t shown = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    // Of the card it tells what belongs there; an image is no text.
    if (!entry.is_regular_file() || entry.path().extension() == ".md" || entry.path().extension() == ".png")
      continue;
    INFO(entry.path());
    CHECK(quoted.count(withoutLayout(named(readFile(entry.path())))) == 1);
    ++shown;
  }
  CHECK(shown == 5);
}

TEST_CASE(
    "lists of guides behind a mark are whole: what outputs contribute and need, units, stress families") {
  const fs::path headers = sourceDirectory() / "framework/include/lumivox/pipeline";
  const std::string guide = "writing_a_technique.md";
  const auto checkListed = [&](const std::string& name, const std::vector<std::string>& all,
                               std::size_t count) {
    INFO(name);
    CHECK(all.size() == count);
    CHECK(listedIn(guide, name) == std::set<std::string>(all.begin(), all.end()));
  };
  checkListed("Contributes", valuesOf(readFile(headers / "contributes.h"), "Contributes"), 7);
  checkListed("Needs", valuesOf(readFile(headers / "pass.h"), "Needs"), 11);
  // Base units: those in which a pass reads its parameters.
  const std::set<std::string> units = listedIn(guide, "units");
  CHECK(units.size() == 5);
  for (const std::string& unit : units) {
    INFO(unit);
    const auto known = std::find_if(dsl::knownUnits().begin(), dsl::knownUnits().end(),
                                    [&](const dsl::Unit& one) { return one.name == unit; });
    REQUIRE(known != dsl::knownUnits().end());
    CHECK(known->toBase == 1.0);
  }
  const CommandResult cases =
      runCommand("'" + (binaryDirectory() / "bin/lumivox").string() + "' stress --list --json");
  std::set<std::string> families;
  static const std::regex family("\"family\": ?\"(\\w+)\"");
  for (std::sregex_iterator one(cases.output.begin(), cases.output.end(), family), end; one != end; ++one)
    families.insert((*one)[1]);
  CHECK(families.size() == 9);
  CHECK(listedIn("stress.md", "families") == families);
}

TEST_CASE("a paper card begins with an image of the technique and its three headline deviations") {
  std::vector<fs::path> cards;
  for (const char* folder : {"techniques", "templates/technique/techniques"})
    for (const auto& entry : fs::directory_iterator(test::sourceDirectory() / folder))
      if (entry.is_directory()) cards.push_back(entry.path() / "README.md");
  REQUIRE(cards.size() >= 7);
  for (const fs::path& card : cards) {
    INFO(card);
    const std::string text = readFile(card), top = text.substr(0, text.find("\n\n", text.find("\n1. ")));
    std::smatch image;
    REQUIRE(std::regex_search(top, image,
                              std::regex("^# \\w+\n\n!\\[[^\\]]+\\]\\(([^)]+\\.png)\\)\n\n"
                                         "(?:(?:[^\n1][^\n]*\n)+\n)?1\\. \\*\\*")));
    REQUIRE(fs::exists(card.parent_path() / image[1].str()));
    CHECK(fs::file_size(card.parent_path() / image[1].str()) < 60'000);
    for (const char* number : {"\n1. **", "\n2. **", "\n3. **"}) CHECK(top.find(number) != std::string::npos);
    CHECK(top.find("\n4. ") == std::string::npos);
    // And says what of its sources is not built.
    CHECK(contains(text, "\n## Not built\n\n- "));
  }
}

TEST_CASE("a paper card has at most 2,000 words besides what is generated, and its drawing of how it works") {
  std::size_t chapters = 0;
  for (const fs::path& card : cards()) {
    INFO(card);
    const std::string text = readFile(card);
    std::istringstream words(withoutGenerated(text));
    CHECK(std::distance(std::istream_iterator<std::string>(words), {}) <= 2000);
    if (isBelowTechnique(card) && !isChapter(card)) continue;
    for (const char* heading :
         {"How it works", "When to take it, when not", "Passes", "Published and ours", "Measured"})
      CHECK(contains(text, "\n## " + std::string(heading) + "\n"));
    if (isChapter(card)) {  // the whole has the drawing
      CHECK(contains(text, "](../README.md)"));
      ++chapters;
      continue;
    }
    CHECK(contains(text, "](how_it_works.svg)"));
    const fs::path drawing = card.parent_path() / "how_it_works.svg";
    REQUIRE(fs::exists(drawing));
    CHECK(fs::file_size(drawing) < 12'000);
    CHECK(contains(readFile(drawing), "<title>"));
  }
  CHECK(chapters >= 5);
}

TEST_CASE("the cards of a technique have every published value of its parameters in a generated table") {
  // As `lumivox describe --markdown` prints them: "#### technique.pass", then a row for each parameter.
  std::istringstream reference(readFile(sourceDirectory() / "docs/reference.md"));
  static const std::regex heading("^#### (\\w+)\\.\\w+$"),
      row("^\\| `(\\w+)` \\| parameter \\| [^|]* \\| ([^|]+) \\| .*");
  std::string text;
  std::size_t values = 0;
  for (std::string line; std::getline(reference, line);) {
    std::smatch match;
    if (std::regex_match(line, match, heading)) {
      text.clear();
      for (const fs::path& card : cards())
        if (contains(card.string(), "/techniques/" + match[1].str() + "/")) text += readFile(card);
    } else if (std::regex_match(line, match, row)) {
      INFO(line);
      CHECK(contains(text, "<!-- published table "));
      CHECK(contains(text, "\n| `" + match[1].str() + "` | " + match[2].str() + " | "));
      ++values;
    }
  }
  CHECK(values > 30);
}

TEST_CASE("what leaving out and standing still save is told apart, each of the times beside it") {
  const std::string figures = readFile(sourceDirectory() / "docs/benchmarks/software_rasteriser.md");
  static const std::regex row(
      "\\| ([\\d.]+) ms \\| ([\\d.]+) ms \\| (\\d+) % \\| ([\\d.]+) ms \\| (\\d+) % \\|");
  int rows = 0;
  for (std::sregex_iterator match(figures.begin(), figures.end(), row), end; match != end; ++match, ++rows) {
    INFO(match->str());
    const auto number = [&](std::size_t i) { return std::stod((*match)[i]); };
    // As PruningRecord::savedShare() and standingShare().
    CHECK(number(3) == std::round(100.0 * (1.0 - number(2) / number(1))));
    CHECK(number(5) == std::round(100.0 * (1.0 - number(4) / number(2))));
  }
  CHECK(rows == 2);
}

TEST_CASE("no line of a guide or card is longer than 140 characters, but for what is generated") {
  constexpr std::size_t kLongest = 140;
  std::vector<fs::path> texts = guides();
  for (const fs::path& card : cards()) texts.push_back(card);
  for (const auto& entry : fs::directory_iterator(test::sourceDirectory() / "templates/technique/techniques"))
    texts.push_back(entry.path() / "README.md");
  for (const fs::path& file : texts) {
    if (file.filename() == "reference.md") continue;  // lumivox describe --markdown
    // Without the text that lumivox reproduce --cards writes between its marks.
    const std::string text = withoutGenerated(readFile(file));
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      // Characters, not bytes.
      const auto length =
          std::count_if(line.begin(), line.end(), [](unsigned char c) { return (c & 0xC0) != 0x80; });
      INFO(file << ": " << line);
      CHECK(static_cast<std::size_t>(length) <= kLongest);
    }
  }
}
