// Published values of parameters, as cards quote them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lumivox {

/// A parameter of a pass whose paper gives its value. All texts as in `lumivox describe`.
struct PublishedParameter {
  std::string technique, pass, name;
  std::string published, ours;  ///< the value in the paper; the default
};

/// Markdown with passages between `<!-- published table TECHNIQUE; PASS; ... -->` and `<!-- end -->` written
/// anew: a line for each parameter of these passes, or of all passes of the technique without one, with its
/// published value and its default. Passes that share all three share a line.
/// Error that names `file` and the line for a passage that is not closed, of an unknown kind, or whose
/// technique or pass has no published value.
std::string withPublishedPassages(const std::string& markdown, const std::filesystem::path& file,
                                  const std::vector<PublishedParameter>& parameters);

}  // namespace lumivox
