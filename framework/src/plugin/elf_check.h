// Checks the bytes of a library before the dynamic loader gets them: the loader crashes on some damaged
// files, and runs the code of every intact one.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lumivox {

/// Why these bytes are no complete shared library for this machine; empty when they are. The loader maps a
/// file by its headers alone, and a file that ends early then faults while it is read.
std::string sharedLibraryDefect(std::string_view bytes);

/// The contents of the first section of that name; nothing if the file has none or its section table is
/// damaged. Precondition: sharedLibraryDefect() found no defect.
std::optional<std::string_view> sectionOf(std::string_view bytes, std::string_view name);

}  // namespace lumivox
