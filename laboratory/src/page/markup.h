// Texts as parts of other texts.
#pragma once

#include <string>

namespace lumivox::page {

std::string escaped(const std::string& text);  ///< for HTML and SVG
std::string replaced(std::string text, const std::string& from, const std::string& to);
std::string base64(const std::string& bytes);  ///< RFC 4648, Sec. 4

}  // namespace lumivox::page
