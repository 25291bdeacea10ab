// Citations: every "Author Year" in code, texts and cards is in docs/references.bib.
#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>
#include <sstream>

#include "lumivox/base/file.h"
#include "support/support.h"

using namespace lumivox;
namespace fs = std::filesystem;

namespace {

struct Work {
  std::string key, year;
  std::vector<std::string> authors;  ///< last word of each family name, folded
  std::set<std::string> fields;
};

struct Citation {
  std::vector<std::string> authors;  ///< as written
  bool andOthers = false;            ///< "et al."
  std::string year;
  std::string text() const {
    std::string text;
    for (const std::string& author : authors) text += author + " ";
    return text + (andOthers ? "et al. " : "") + year;
  }
};

/// Small letters of English alone: ö, oe and o are one, since sources are written without accents.
std::string folded(const std::string& name) {
  static const std::vector<std::pair<std::string, std::string>> letters = {
      {"ä", "a"}, {"å", "a"}, {"Å", "a"},  {"á", "a"},  {"ć", "c"},  {"é", "e"}, {"É", "e"}, {"ö", "o"},
      {"ø", "o"}, {"ü", "u"}, {"ae", "a"}, {"oe", "o"}, {"ue", "u"}, {"{", ""},  {"}", ""}};
  std::string result = name;
  for (const auto& [from, to] : letters)
    for (std::size_t at = result.find(from); at != std::string::npos; at = result.find(from, at + to.size()))
      result.replace(at, from.size(), to);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::vector<std::string> split(const std::string& text, const std::string& by) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  for (std::size_t at = text.find(by); at != std::string::npos; at = text.find(by, from)) {
    parts.push_back(text.substr(from, at - from));
    from = at + by.size();
  }
  parts.push_back(text.substr(from));
  return parts;
}

/// Entries "@kind{key," with one field a line, "name = {value}".
std::vector<Work> worksOf(const std::string& bibliography) {
  std::vector<Work> works;
  std::istringstream lines(bibliography);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("@", 0) == 0) {
      const std::size_t open = line.find('{');
      works.push_back({line.substr(open + 1, line.find(',') - open - 1), {}, {}, {}});
    }
    const std::size_t equals = line.find(" = {"), close = line.rfind('}');
    if (works.empty() || line.rfind("  ", 0) != 0 || equals == std::string::npos || close <= equals) continue;
    const std::string field = line.substr(2, equals - 2), value = line.substr(equals + 4, close - equals - 4);
    works.back().fields.insert(field);
    if (field == "year") works.back().year = value;
    if (field != "author") continue;
    for (const std::string& author : split(value, " and ")) {
      const std::string family = author.substr(0, author.find(','));
      works.back().authors.push_back(folded(family.substr(family.rfind(' ') + 1)));
    }
  }
  return works;
}

/// The words of a text, its lines joined: marks of comments and of emphasis are no words. A quotation mark is
/// one, so that a title does not run into what follows, unless another follows it at once: a string that goes
/// on.
std::vector<std::string> wordsOf(const std::string& text) {
  std::string plain;
  for (const char c : text) {
    if (c == '"')
      plain += " \" ";
    else if (c != '*' && c != '_' && c != '`')
      plain += c;
  }
  std::vector<std::string> words;
  std::istringstream stream(plain);
  for (std::string word; stream >> word;) {
    if (word == "&amp;") word = "&";
    if (word == "\"" && !words.empty() && words.back() == "\"")
      words.pop_back();
    else if (word.find_first_not_of("/#%|") != std::string::npos)
      words.push_back(word);
  }
  return words;
}

/// "1978", "(1978)", "1978,", "1978)." but neither 1978.5 nor 1978-01-02 nor 1978x.
std::string yearOf(std::string word) {
  word.erase(0, word.find_first_not_of('('));
  if (word.size() < 4 ||
      !std::all_of(word.begin(), word.begin() + 4, [](unsigned char c) { return std::isdigit(c); }))
    return {};
  const std::string year = word.substr(0, 4), rest = word.substr(4);
  if (rest.find_first_not_of(".,;:)\\n") != std::string::npos || year < "1700" || year > "2099") return {};
  return year;
}

bool isName(const std::string& word) {
  const auto first = static_cast<unsigned char>(word.empty() ? '\0' : word.front());
  if (word.size() < 2 || (std::isupper(first) == 0 && first < 0x80)) return false;
  return std::all_of(word.begin(), word.end(),
                     [](unsigned char c) { return std::isalpha(c) || c == '-' || c == '\'' || c >= 0x80; });
}

std::vector<Citation> citationsOf(const std::string& text) {
  // Words before a number that is no year of a work.
  static const std::set<std::string> kNoNames = {"RFC",     "January",  "February", "March",  "April",
                                                 "May",     "June",     "July",     "August", "September",
                                                 "October", "November", "December"};
  const std::vector<std::string> words = wordsOf(text);
  std::vector<Citation> citations;
  for (std::size_t i = 1; i < words.size(); ++i) {
    Citation citation;
    citation.year = yearOf(words[i]);
    if (citation.year.empty()) continue;
    std::size_t at = i;  // one behind the last name
    const auto before = [&](std::size_t back) {
      if (at < back) return std::string();
      const std::string& word = words[at - back];
      const auto letter = std::find_if(
          word.begin(), word.end(), [](unsigned char c) { return std::isalnum(c) || c == '&' || c >= 0x80; });
      return std::string(letter, word.end());  // without brackets before it
    };
    const auto plain = [](std::string word) {
      if (!word.empty() && word.back() == ',') word.pop_back();
      return word;
    };
    if (plain(before(1)) == "al." && before(2) == "et") {
      citation.andOthers = true;
      at -= 2;
    }
    if (!isName(plain(before(1))) || kNoNames.count(plain(before(1))) != 0) continue;
    citation.authors.push_back(plain(before(1)));
    --at;
    // "A, B, C & D 1999", or commas alone; a particle such as "van" belongs to the name behind it.
    for (;;) {
      if (std::set<std::string>{"van", "de", "von"}.count(before(1)) != 0) --at;
      const bool joined = before(1) == "&" || before(1) == "and";
      const std::string name = joined ? before(2) : before(1);
      if ((!joined && (name.empty() || name.back() != ',')) || !isName(plain(name))) break;
      citation.authors.insert(citation.authors.begin(), plain(name));
      at -= joined ? 2 : 1;
    }
    citations.push_back(citation);
  }
  return citations;
}

bool isOf(const Citation& citation, const Work& work) {
  if (citation.year != work.year || citation.authors.empty()) return false;
  std::vector<std::string> names;
  for (const std::string& author : citation.authors) names.push_back(folded(author));
  return citation.andOthers ? names.size() == 1 && work.authors.size() >= 3 && names[0] == work.authors[0]
                            : names == work.authors;
}

std::vector<Work> bibliography() {
  return worksOf(readFile(test::sourceDirectory() / "docs/references.bib"));
}

/// All texts of the project that may cite.
std::vector<fs::path> citingFiles() {
  static const std::set<std::string> extensions = {
      ".cpp",  ".h",     ".md",       ".glsl",  ".comp",         ".vert", ".frag",
      ".geom", ".scene", ".pipeline", ".sweep", ".reproduction", ".json"};
  std::vector<fs::path> files;
  for (const char* file : {"README.md", "CONTRIBUTING.md", "CHANGELOG.md"})
    files.push_back(test::sourceDirectory() / file);
  for (const char* folder : {"framework", "laboratory", "shaders", "techniques", "templates", "examples",
                             "tools", "tests", "bench", "docs", "scenes"})
    for (const auto& entry : fs::recursive_directory_iterator(test::sourceDirectory() / folder))
      if (entry.is_regular_file() && extensions.count(entry.path().extension().string()) != 0 &&
          entry.path().filename() != "references_test.cpp")
        files.push_back(entry.path());
  return files;
}

}  // namespace

TEST_CASE("the reader of citations knows one author, two, several, and what is none") {
  const auto one = [](const std::string& text) {
    const std::vector<Citation> found = citationsOf(text);
    return found.size() == 1 ? found.front().text() : std::to_string(found.size());
  };
  CHECK(one("see Williams 1978, Sec. 2") == "Williams 1978");
  CHECK(one("see Williams (1978).") == "Williams 1978");
  CHECK(one("// (Henyey &\n// Greenstein 1941) g") == "Henyey Greenstein 1941");
  CHECK(one("as Box and Muller 1958 do") == "Box Muller 1958");
  CHECK(one("Crassin et al. 2011: cones") == "Crassin et al. 2011");
  CHECK(one("(Kopf, Cohen, Lischinski & Uyttendaele 2007)") == "Kopf Cohen Lischinski Uyttendaele 2007");
  CHECK(one("*Wang, Bovik, Sheikh, Simoncelli 2004*") == "Wang Bovik Sheikh Simoncelli 2004");
  CHECK(one("Pham & van Vliet 2005") == "Pham Vliet 2005");
  CHECK(one("Andersson, Åström, Fairchild 2020") == "Andersson Åström Fairchild 2020");
  CHECK(one("\"Images\", and Turk & Levoy 1994") == "Turk Levoy 1994");
  CHECK(one("\"Turk & \"\n  \"Levoy 1994\"") == "Turk Levoy 1994");
  for (const char* none : {"on 2026-01-31", "RFC 1952", "May 2001", "x 1978", "\"Box Data\" (1998)",
                           "Phong 1978.5", "Fig 19780", "at 1978 m"})
    CHECK(one(none) == "0");
}

TEST_CASE("a citation is of a work by all authors, or by the first of three or more, and by the year") {
  const std::vector<Work> works = worksOf(
      "@article{a_2001,\n  author = {Akenine-Möller, Tomas},\n  year = {2001}\n}\n"
      "@article{b_2002,\n  author = {One, A. and van Two, B. and Three, C.},\n  year = {2002}\n}\n");
  REQUIRE(works.size() == 2);
  const auto cites = [&](const std::string& text, std::size_t work) {
    return isOf(citationsOf(text).at(0), works[work]);
  };
  CHECK(cites("Akenine-Möller 2001", 0));
  CHECK(cites("Akenine-Moeller 2001", 0));
  CHECK(cites("Akenine-Moller 2001", 0));
  CHECK_FALSE(cites("Akenine-Moller 2002", 0));
  CHECK(cites("One et al. 2002", 1));
  CHECK(cites("One, Two & Three 2002", 1));
  CHECK_FALSE(cites("One 2002", 1));
  CHECK_FALSE(cites("One & Two 2002", 1));
  CHECK_FALSE(cites("Two et al. 2002", 1));
  CHECK_FALSE(cites("Akenine-Moller et al. 2001", 0));
}

TEST_CASE("the bibliography says of every work who wrote it, when and where, once") {
  std::set<std::string> keys;
  std::set<std::pair<std::string, std::vector<std::string>>> works;
  for (const Work& work : bibliography()) {
    INFO(work.key);
    CHECK(keys.insert(work.key).second);
    CHECK(works.emplace(work.year, work.authors).second);
    for (const char* field : {"author", "title", "year"}) CHECK(work.fields.count(field) == 1);
    CHECK(std::any_of(work.fields.begin(), work.fields.end(), [](const std::string& field) {
      return std::set<std::string>{"journal",     "booktitle", "school",
                                   "institution", "publisher", "howpublished"}
                 .count(field) != 0;
    }));
  }
  CHECK(keys.size() >= 50);
}

TEST_CASE("every citation of code, texts and cards is in the bibliography, and every work there is cited") {
  const std::vector<Work> works = bibliography();
  std::set<std::string> cited;
  for (const fs::path& file : citingFiles())
    for (const Citation& citation : citationsOf(readFile(file))) {
      INFO(file << ": " << citation.text());
      const auto work =
          std::find_if(works.begin(), works.end(), [&](const Work& one) { return isOf(citation, one); });
      CHECK(work != works.end());
      if (work != works.end()) cited.insert(work->key);
    }
  for (const Work& work : works) {
    INFO(work.key << " is cited nowhere");
    CHECK(cited.count(work.key) == 1);
  }
}
