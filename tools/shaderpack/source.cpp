#include "source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "lumivox/base/file.h"

namespace lumivox::shaderpack {
namespace {

[[noreturn]] void fail(const SourcePlace& place, const std::string& what) {
  throw Error(fmt::format("{}: error: {}", place.text(), what));
}

bool isIdentifier(const std::string& text) {
  if (text.empty() || std::isdigit(static_cast<unsigned char>(text[0]))) return false;
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

bool isInteger(const std::string& text) {
  const std::size_t start = text[0] == '-' ? 1 : 0;
  return text.size() > start && text.size() < 10 &&
         std::all_of(text.begin() + static_cast<std::ptrdiff_t>(start), text.end(),
                     [](unsigned char c) { return std::isdigit(c); });
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// The line without comments, so that a directive inside a comment has no effect. `inBlock`: whether the line
/// begins within a block comment; updated for the next line.
std::string withoutComments(const std::string& line, bool& inBlock) {
  std::string kept;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const std::string_view two = std::string_view(line).substr(i, 2);
    if (inBlock) {
      if (two == "*/") {
        inBlock = false;
        ++i;
      }
    } else if (two == "/*") {
      inBlock = true;
      ++i;
    } else if (two == "//") {
      break;
    } else {
      kept += line[i];
    }
  }
  return kept;
}

/// `#  word rest` -> {word, rest}; an empty word for anything else.
std::pair<std::string, std::string> directive(const std::string& line) {
  const std::string text = trimmed(line);
  if (text.empty() || text[0] != '#') return {};
  const std::string body = trimmed(text.substr(1));
  const std::size_t end =
      std::find_if(body.begin(), body.end(), [](unsigned char c) { return !std::isalnum(c); }) - body.begin();
  return {body.substr(0, end), trimmed(body.substr(end))};
}

class Expander {
 public:
  Expander(ExpandedSource& result, const std::vector<std::filesystem::path>& roots)
      : result_(result), roots_(roots) {}

  void expand(const std::filesystem::path& file, bool isEntry) {
    result_.files.insert(file);
    open_.push_back(file);
    std::istringstream lines(readFile(file, kLimitBytes));
    std::string line;
    SourcePlace place{file.string(), 0, 0};
    bool inComment = false;
    emitLine(1, file);
    while (std::getline(lines, line)) {
      ++place.line;
      const auto [word, rest] = directive(withoutComments(line, inComment));
      if (word == "include") {
        include(rest, place);
        emitLine(place.line + 1, file);
        continue;
      }
      if (word == "if" || word == "ifdef" || word == "ifndef") ++conditionDepth_;
      if (word == "endif") --conditionDepth_;
      if (word == "version") {
        if (!isEntry)
          fail(place, "#version belongs in the entry file, or nowhere: 450 core is set for every shader");
        if (rest != "450" && rest != "450 core")
          fail(place, "expected #version 450 core, or no #version at all");
        line.clear();
      }
      if (word == "pragma" && rest.rfind("lumivox", 0) == 0) {
        pragma(trimmed(rest.substr(7)), place);
        line.clear();
      }
      result_.text += line;
      result_.text += '\n';
    }
    open_.pop_back();
  }

 private:
  static constexpr std::uint64_t kLimitBytes = 16 << 20;

  void emitLine(int line, const std::filesystem::path& file) {
    result_.text += fmt::format("#line {} \"{}\"\n", line, file.string());
  }

  void include(const std::string& argument, const SourcePlace& place) {
    if (argument.size() < 3 || argument.front() != '"' || argument.back() != '"')
      fail(place, "expected #include \"file\"");
    const std::string name = argument.substr(1, argument.size() - 2);
    std::vector<std::filesystem::path> candidates{open_.back().parent_path() / name};
    for (const auto& root : roots_) candidates.push_back(root / name);
    const auto found = std::find_if(candidates.begin(), candidates.end(),
                                    [](const auto& path) { return std::filesystem::is_regular_file(path); });
    if (found == candidates.end()) {
      std::string sought;
      for (const auto& path : candidates) sought += "\n  " + path.string();
      fail(place, fmt::format("cannot find \"{}\"; searched{}", name, sought));
    }
    const std::filesystem::path file = found->lexically_normal();
    // Every file is included once. Where the first #include stands inside a condition, a guard leaves that to
    // the preprocessor.
    if (std::find(open_.begin(), open_.end(), file) != open_.end() || certain_.contains(file)) return;
    if (conditionDepth_ == 0) certain_.insert(file);
    const auto [guard, isNew] = guards_.emplace(file, fmt::format("LUMIVOX_INCLUDED_{}", guards_.size()));
    result_.text += fmt::format("#ifndef {0}\n#define {0}\n", guard->second);
    expand(file, false);
    result_.text += "#endif\n";
  }

  void pragma(const std::string& text, const SourcePlace& place) {
    std::istringstream words(text);
    std::string what;
    words >> what;
    if (what == "axis") {
      axis(words, place);
    } else if (what == "require") {
      std::string expression;
      std::getline(words, expression);
      result_.requirements.push_back({trimmed(expression), place});
    } else {
      fail(place, fmt::format("unknown '#pragma lumivox {}'; expected axis or require", what));
    }
  }

  void axis(std::istringstream& words, const SourcePlace& place) {
    AxisDeclaration declaration{{}, place};
    shader::Axis& axis = declaration.axis;
    words >> axis.name;
    if (!isIdentifier(axis.name) ||
        axis.name.find_first_of("abcdefghijklmnopqrstuvwxyz") != std::string::npos) {
      fail(place,
           fmt::format(
               "'{}' is not a name for an axis; expected capitals, as in '#pragma lumivox axis TEXTURES 0 1'",
               axis.name));
    }
    for (std::string value; words >> value;) {
      if (std::find(axis.values.begin(), axis.values.end(), value) != axis.values.end()) {
        fail(place, fmt::format("axis {} has the value {} twice", axis.name, value));
      }
      axis.values.push_back(value);
    }
    if (axis.values.size() < 2) fail(place, fmt::format("axis {} needs at least two values", axis.name));
    if (std::all_of(axis.values.begin(), axis.values.end(), isInteger))
      return addAxis(std::move(declaration));
    axis.named = true;
    if (!std::all_of(axis.values.begin(), axis.values.end(), isIdentifier)) {
      fail(place, fmt::format("the values of axis {} must be either all integers or all words", axis.name));
    }
    addAxis(std::move(declaration));
  }

  void addAxis(AxisDeclaration declaration) {
    for (const AxisDeclaration& known : result_.axes) {
      if (known.axis.name != declaration.axis.name) continue;
      if (known.axis.values == declaration.axis.values) return;
      fail(declaration.place,
           fmt::format("axis {} has other values at {}", known.axis.name, known.place.text()));
    }
    result_.axes.push_back(std::move(declaration));
  }

  ExpandedSource& result_;
  const std::vector<std::filesystem::path>& roots_;
  std::vector<std::filesystem::path> open_;
  std::set<std::filesystem::path> certain_;  // included outside of all conditions
  std::map<std::filesystem::path, std::string> guards_;
  int conditionDepth_ = 0;
};

/// Recursive descent over a constraint; builds the function that evaluates it.
class ConstraintParser {
 public:
  ConstraintParser(const Requirement& requirement, const std::vector<shader::Axis>& axes)
      : requirement_(requirement), text_(requirement.expression), axes_(axes) {}

  Constraint parse() {
    const Value value = disjunction();
    skipSpace();
    if (at_ < text_.size()) unexpected("an operator");
    return [value](const std::vector<int>& values) { return value(values) != 0; };
  }

 private:
  using Value = std::function<int(const std::vector<int>&)>;

  [[noreturn]] void unexpected(const std::string& expected) const {
    fail(requirement_.place,
         fmt::format("in 'require {}': expected {} {}", text_, expected,
                     at_ < text_.size() ? "at '" + text_.substr(at_) + "'" : "at the end"));
  }
  void skipSpace() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  }
  bool accept(std::string_view token) {
    skipSpace();
    if (text_.compare(at_, token.size(), token) != 0) return false;
    at_ += token.size();
    return true;
  }

  Value disjunction() {
    Value left = conjunction();
    while (accept("||")) {
      Value right = conjunction();
      left = [left, right](const auto& v) { return static_cast<int>(left(v) != 0 || right(v) != 0); };
    }
    return left;
  }
  Value conjunction() {
    Value left = comparison();
    while (accept("&&")) {
      Value right = comparison();
      left = [left, right](const auto& v) { return static_cast<int>(left(v) != 0 && right(v) != 0); };
    }
    return left;
  }
  Value comparison() {
    lastAxis_ = nullptr;
    Value left = unary(nullptr);
    const shader::Axis* axis = lastAxis_;
    const bool equal = accept("==");
    if (!equal && !accept("!=")) return left;
    Value right = unary(axis);
    return [left, right, equal](const auto& v) { return static_cast<int>((left(v) == right(v)) == equal); };
  }
  Value unary(const shader::Axis* compared) {
    if (accept("(")) {
      Value inner = disjunction();
      if (!accept(")")) unexpected("')'");
      lastAxis_ = nullptr;
      return inner;
    }
    skipSpace();
    if (text_.compare(at_, 2, "!=") != 0 && accept("!")) {
      Value inner = unary(nullptr);
      lastAxis_ = nullptr;
      return [inner](const auto& v) { return static_cast<int>(inner(v) == 0); };
    }
    return atom(compared);
  }
  Value atom(const shader::Axis* compared) {
    skipSpace();
    const std::size_t start = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_'))
      ++at_;
    const std::string word = text_.substr(start, at_ - start);
    if (word.empty()) unexpected("an axis, a value or '('");
    if (isInteger(word)) return [number = std::stoi(word)](const auto&) { return number; };
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      if (axes_[i].name != word) continue;
      lastAxis_ = &axes_[i];
      return [i](const auto& v) { return v[i]; };
    }
    for (const shader::Axis& axis : axes_) {
      if (!axis.named) continue;
      for (std::size_t i = 0; i < axis.values.size(); ++i) {
        if (word == wordMacro(axis.name, axis.values[i]) || (&axis == compared && word == axis.values[i])) {
          return [number = static_cast<int>(i)](const auto&) { return number; };
        }
      }
    }
    std::vector<std::string> known;
    for (const shader::Axis& axis : axes_) known.push_back(axis.name);
    const std::string nearest = nearestWord(word, known);
    fail(requirement_.place,
         fmt::format("in 'require {}': '{}' is not an axis{}; the axes are {}", text_, word,
                     compared != nullptr ? " nor a value of " + compared->name : "", fmt::join(known, ", ")) +
             (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }

  const Requirement& requirement_;
  const std::string& text_;
  const std::vector<shader::Axis>& axes_;
  std::size_t at_ = 0;
  const shader::Axis* lastAxis_ = nullptr;
};

}  // namespace

SourcePlace ExpandedSource::placeOf(const std::string& identifier) const {
  const auto mentions = [&](const std::string& line) {
    const auto part = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
    for (std::size_t at = line.find(identifier); at != std::string::npos;
         at = line.find(identifier, at + 1)) {
      const std::size_t end = at + identifier.size();
      if ((at == 0 || !part(line[at - 1])) && (end == line.size() || !part(line[end]))) return true;
    }
    return false;
  };
  std::istringstream lines(text);
  SourcePlace here{entry.string(), 0, 0}, firstMention = here;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("#line ", 0) == 0) {
      const std::size_t quote = line.find('"');
      here = {line.substr(quote + 1, line.size() - quote - 2), std::stoi(line.substr(6)) - 1, 0};
      continue;
    }
    // The include guards add lines that the file does not have; the next #line corrects the count.
    ++here.line;
    if (!mentions(line)) continue;
    for (const char* word : {"uniform", "buffer", "layout", "constant_id"}) {
      if (line.find(word) != std::string::npos) return here;
    }
    if (firstMention.line == 0) firstMention = here;
  }
  return firstMention;
}

ExpandedSource expandSource(const std::filesystem::path& entry,
                            const std::vector<std::filesystem::path>& includeRoots) {
  ExpandedSource result;
  result.entry = entry;
  Expander(result, includeRoots).expand(entry, true);
  return result;
}

Constraint parseConstraint(const Requirement& requirement, const std::vector<shader::Axis>& axes) {
  return ConstraintParser(requirement, axes).parse();
}

std::string wordMacro(const std::string& axis, const std::string& word) {
  std::string macro = axis + "_";
  for (const unsigned char c : word) macro += static_cast<char>(std::toupper(c));
  return macro;
}

}  // namespace lumivox::shaderpack
