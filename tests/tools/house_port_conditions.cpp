// Which inputs of techniques are read without a look at the members that say how: by the text of the sources,
// a call being followed into functions of the same technique and of the toolkit.
#include <fmt/format.h>

#include <algorithm>
#include <regex>

#include "tools/house_rules.h"

namespace lumivox::test::house {
namespace {

/// A function that takes a value, or an input, of the kind.
struct Reader {
  std::string folder;  ///< of its technique; empty: the toolkit's
  std::string name, parameter, body;
  std::set<std::string> members;  ///< that it looks at
};

/// A source of a technique, an example or the toolkit, without comments and contents of strings.
struct Code {
  std::string path, folder, text;
};

/// Of a C++ source of a technique, an example or a template: the folder of the technique, whichever chapter
/// the source lies in. Empty for others.
std::string techniqueFolder(const std::string& path) {
  static const std::regex pattern(
      "((?:(?:examples|templates)/\\w+/)?techniques/\\w+)/(?:\\w+/)*[^/]+\\.(?:cpp|h)");
  std::smatch match;
  return std::regex_match(path, match, pattern) ? match[1].str() : "";
}
bool isToolkit(const std::string& path) {
  return startsWith(path, "framework/src/toolkit/") || startsWith(path, "framework/include/lumivox/toolkit/");
}

/// Behind the bracket that closes the one at `open`; the end of the text where none does.
std::size_t behindClosing(const std::string& text, std::size_t open) {
  const char opening = text[open], closing = opening == '(' ? ')' : '}';
  int depth = 0;
  for (std::size_t i = open; i < text.size(); ++i) {
    depth += text[i] == opening ? 1 : text[i] == closing ? -1 : 0;
    if (depth == 0) return i + 1;
  }
  return text.size();
}

/// The words before an opening bracket: "gather" of "gather(".
std::string wordBefore(const std::string& text, std::size_t bracket) {
  std::size_t end = bracket;
  while (end > 0 && std::isspace(static_cast<unsigned char>(text[end - 1])) != 0) --end;
  std::size_t begin = end;
  while (begin > 0 &&
         (std::isalnum(static_cast<unsigned char>(text[begin - 1])) != 0 || text[begin - 1] == '_'))
    --begin;
  return text.substr(begin, end - begin);
}

/// Functions with a body that take a value or an input of the kind by reference.
std::vector<Reader> readersOf(const std::string& kind, const std::string& folder, const std::string& code) {
  std::vector<Reader> found;
  const std::regex taken("\\b(?:In<\\s*)?(?:\\w+::)*" + kind + "\\s*>?\\s*&\\s*(\\w+)");
  for (std::sregex_iterator match(code.begin(), code.end(), taken), end; match != end; ++match) {
    auto open = static_cast<std::size_t>(match->position());
    for (int depth = 0; open > 0 && depth <= 0;) {
      --open;
      depth += code[open] == '(' ? 1 : code[open] == ')' ? -1 : 0;
    }
    if (code[open] != '(') continue;
    const std::size_t behind = behindClosing(code, open), brace = code.find_first_of("{;", behind);
    if (brace == std::string::npos || code[brace] == ';') continue;
    std::size_t last = behindClosing(code, brace);
    // The members of a constructor come before its body.
    for (std::size_t next = code.find_first_not_of(" \n", last);
         next != std::string::npos && code[next] == '{'; next = code.find_first_not_of(" \n", last))
      last = behindClosing(code, next);
    found.push_back({folder, wordBefore(code, open), (*match)[1], code.substr(behind, last - behind), {}});
  }
  return found;
}

bool looksAt(const std::string& code, const std::string& value, const std::string& member) {
  return std::regex_search(code, std::regex("\\b" + value + "\\s*(?:\\.|->)\\s*" + member + "\\b"));
}
/// Whether a function is called with the value as one of its arguments.
bool passesOn(const std::string& code, const std::string& value, const std::string& function) {
  if (code.find(function) == std::string::npos) return false;
  const std::regex call("\\b" + function + "\\s*\\("), argument("[(,{]\\s*\\*?" + value + "\\s*[,)}]");
  for (std::sregex_iterator match(code.begin(), code.end(), call), end; match != end; ++match) {
    const auto open = static_cast<std::size_t>(match->position() + match->length()) - 1;
    if (std::regex_search(code.substr(open, behindClosing(code, open) - open), argument)) return true;
  }
  return false;
}

/// What code does with a value of the kind: itself, by the functions that it can see, and with copies of it.
std::set<std::string> membersSeen(const std::string& code, const std::string& value,
                                  const std::string& folder, const std::vector<Reader>& readers,
                                  const HeededKind& kind) {
  std::set<std::string> seen, names{value};
  const std::regex copied("\\b" + kind.name + "\\s+(?:[^;(]*,\\s*)?(\\w+)\\s*=\\s*\\*?" + value + "\\b");
  for (std::sregex_iterator match(code.begin(), code.end(), copied), end; match != end; ++match)
    names.insert((*match)[1]);
  for (const std::string& name : names) {
    for (const std::string& member : kind.members)
      if (looksAt(code, name, member)) seen.insert(member);
    for (const Reader& reader : readers)
      if ((reader.folder.empty() || reader.folder == folder) && passesOn(code, name, reader.name))
        seen.insert(reader.members.begin(), reader.members.end());
  }
  return seen;
}

/// All functions that take the kind, with what they look at: themselves, or by those that they call.
std::vector<Reader> allReaders(const std::vector<Code>& codes, const HeededKind& kind) {
  std::vector<Reader> readers;
  for (const Code& code : codes)
    for (Reader& reader : readersOf(kind.name, code.folder, code.text)) readers.push_back(std::move(reader));
  for (bool grows = true; grows;) {
    grows = false;
    for (Reader& reader : readers) {
      std::set<std::string> seen = membersSeen(reader.body, reader.parameter, reader.folder, readers, kind);
      seen.insert(reader.members.begin(), reader.members.end());
      grows = grows || seen.size() > reader.members.size();
      reader.members = std::move(seen);
    }
  }
  return readers;
}

/// The class around a place in a source, and those that are derived from it there; the whole of the code
/// where there is none.
std::string classAround(const std::string& code, std::size_t place) {
  static const std::regex head(
      "\\b(?:class|struct)\\s+(\\w+)(?:\\s+final)?\\s*(?::\\s*public\\s+(\\w+)\\s*)?\\{");
  std::string name, bodies;
  for (std::sregex_iterator match(code.begin(), code.end(), head), end; match != end; ++match) {
    const auto brace = static_cast<std::size_t>(match->position() + match->length()) - 1;
    const std::size_t last = behindClosing(code, brace);
    if (brace < place && place < last) {
      name = (*match)[1];
      bodies = code.substr(brace, last - brace);
    } else if (!name.empty() && (*match)[2] == name) {
      bodies += code.substr(brace, last - brace);
    }
  }
  return name.empty() ? code : bodies;
}

}  // namespace

Violations unheededMembers(const Sources& sources, const std::vector<HeededKind>& kinds,
                           const std::set<std::string>& passedOn) {
  std::vector<Code> codes;
  std::map<std::string, std::string> folders;  // all of the code of each
  for (const SourceFile& source : sources) {
    const std::string folder = techniqueFolder(source.path);
    if (folder.empty() && !isToolkit(source.path)) continue;
    codes.push_back({source.path, folder, withoutComments(source.text, Strings::blank)});
    folders[folder] += codes.back().text;
  }
  Violations found;
  std::set<std::string> notNeeded = passedOn;
  for (const HeededKind& kind : kinds) {
    const std::vector<Reader> readers = allReaders(codes, kind);
    const std::regex input("\\bIn<\\s*(?:\\w+::)*" + kind.name + "\\s*>\\s+(\\w+)\\s*[{;]");
    for (const Code& code : codes)
      for (std::sregex_iterator match(code.text.begin(), code.text.end(), input), end; match != end;
           ++match) {
        const auto place = static_cast<std::size_t>(match->position());
        const std::string name = (*match)[1];
        const std::string scope =
            endsWith(code.path, ".h") ? folders[code.folder] : classAround(code.text, place);
        std::set<std::string> unseen = kind.members;
        for (const std::string& member : membersSeen(scope, name, code.folder, readers, kind))
          unseen.erase(member);
        if (!unseen.empty() && passedOn.count(code.path + ": " + name) != 0) {
          notNeeded.erase(code.path + ": " + name);
          continue;
        }
        for (const std::string& member : unseen)
          found.push_back(fmt::format("{}:{}: input {} never looks at '{}' of its {}", code.path,
                                      lineOf(code.text, place), name, member, kind.name));
      }
  }
  for (const std::string& one : notNeeded) found.push_back(one + " heeds all; expected no exception for it");
  return found;
}

Violations unknownMembers(const Sources& sources, const std::vector<HeededKind>& kinds) {
  Violations found;
  for (const HeededKind& kind : kinds) {
    std::string body;
    const std::regex head("\\bstruct\\s+" + kind.name + "\\s*\\{");
    for (const SourceFile& source : sources) {
      if (!endsWith(source.path, ".h")) continue;
      const std::string code = withoutComments(source.text, Strings::blank);
      if (std::smatch match; std::regex_search(code, match, head)) {
        const auto brace = static_cast<std::size_t>(match.position() + match.length()) - 1;
        body += code.substr(brace, behindClosing(code, brace) - brace);  // others may have its name
      }
    }
    for (const std::string& member : kind.members)
      if (!std::regex_search(body, std::regex("[\\w>}]\\s+" + member + "\\s*[=;,{]")))
        found.push_back(fmt::format("{}: there is no member '{}'", kind.name, member));
  }
  return found;
}

}  // namespace lumivox::test::house
