// Shader sources as authors write them: includes, and the declarations of `#pragma lumivox` lines.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/shader/pack.h"

namespace lumivox::shaderpack {

struct AxisDeclaration {
  shader::Axis axis;
  SourcePlace place;
};

/// `#pragma lumivox require EXPRESSION`: combinations for which it is false are not compiled.
struct Requirement {
  std::string expression;
  SourcePlace place;
};

/// An entry file with everything that it includes. `#line` directives in the text name the original files and
/// lines.
struct ExpandedSource {
  std::filesystem::path entry;
  std::string text;
  std::set<std::filesystem::path> files;
  std::vector<AxisDeclaration> axes;
  std::vector<Requirement> requirements;

  /// Where a global name is declared, found by a search of the text; the entry file if the search fails.
  SourcePlace placeOf(const std::string& identifier) const;
};

/// Expands `#include "name"`: found beside the including file, then in `includeRoots`. Throws Error with file
/// and line.
ExpandedSource expandSource(const std::filesystem::path& entry,
                            const std::vector<std::filesystem::path>& includeRoots);

/// Whether a combination of axis values is allowed.
using Constraint = std::function<bool(const std::vector<int>& values)>;

/// Expressions of || && == != ! ( ) over axis names, integers, words of an axis (right of == or != with that
/// axis) and the macros of words (LIGHT_SPOT). Throws Error with file and line.
Constraint parseConstraint(const Requirement& requirement, const std::vector<shader::Axis>& axes);

/// Macro of a word: axis LIGHT, word spot: "LIGHT_SPOT".
std::string wordMacro(const std::string& axis, const std::string& word);

}  // namespace lumivox::shaderpack
