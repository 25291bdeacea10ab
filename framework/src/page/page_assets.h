// The page's style and script.
#pragma once

namespace lumivox::page {

extern const char* const kPageStyle;
extern const char* const kPageHelpers;  ///< lumivoxPage: the records of the block "data", colours, names
extern const char* const kPageScript;

}  // namespace lumivox::page
