// What the bytes of a library's file say before the dynamic loader gets them: it does not survive every
// broken file, and runs the code of every whole one.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lumivox {

/// Why these bytes are no complete shared library for this machine; empty when they are. The loader maps a
/// file by its headers alone, and a file that ends early then faults while it is read.
std::string sharedLibraryDefect(std::string_view bytes);

/// The contents of the first section of that name; nothing where the file has none, or where its table of
/// sections is broken. Of a file without a defect (sharedLibraryDefect).
std::optional<std::string_view> sectionOf(std::string_view bytes, std::string_view name);

}  // namespace lumivox
