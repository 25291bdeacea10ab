// Passages of cards and guides that are written from what is kept.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lumivox::page {

/// "ratios 004-table-3; isotropic, voxelization; isotropic, mipmap"
struct PassageRequest {
  std::string kind, id;
  std::vector<std::string> names;
};

/// Markdown with what stands between `<!-- WORD KIND ID; NAME; ... -->` and `<!-- end -->` written anew, but
/// in fenced blocks. Error that names the file and the line for a passage that is not closed, and for what
/// `write` throws.
std::string withPassages(const std::string& markdown, const std::filesystem::path& file,
                         const std::string& word,
                         const std::function<std::string(const PassageRequest&)>& write);

/// Throws that there is no such thing, which there are, and the nearest.
[[noreturn]] void refuse(const std::string& what, const std::string& name,
                         const std::vector<std::string>& known);
void requireNames(const PassageRequest& request, std::size_t least, std::size_t most, const char* expected);

/// The one of that name; Error with the known ones where there is none.
template <class Things, class Name>
const auto& found(const Things& things, const char* what, const std::string& wanted, const Name& name) {
  std::vector<std::string> known;
  for (const auto& one : things) {
    if (name(one) == wanted) return one;
    known.push_back(name(one));
  }
  refuse(what, wanted, known);
}

}  // namespace lumivox::page
