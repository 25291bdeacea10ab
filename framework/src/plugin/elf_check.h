// Whether a file can be handed to the dynamic loader, which does not survive every broken file.
#pragma once

#include <string>
#include <string_view>

namespace lumivox {

/// Why these bytes are no complete shared library for this machine; empty when they are. The loader maps a
/// file by its headers alone, and a file that ends early then faults while it is read.
std::string sharedLibraryDefect(std::string_view bytes);

}  // namespace lumivox
