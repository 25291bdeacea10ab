// Tables of slow tests, as cards and guides quote them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lumivox/results/measured_table.h"

namespace lumivox {

/// Markdown with passages between `<!-- measured KIND NAME; ... -->` and `<!-- end -->` that are written from
/// kept tables:
///     table NAME; BEGINNING; ...    the rows whose names begin with one of these; all of them without one
///     across NAME; SCENE; ...       rows called "SCENE, REST": a line for each REST, a column for each SCENE
///     value NAME; ROW; COLUMN       one figure, within a sentence
/// The first two take a name "of COLUMN, COLUMN" too, for these columns alone.
/// Error that names `file` and the line for a passage that is not closed, of an unknown kind, or whose table,
/// row or column is not there.
std::string withMeasuredPassages(const std::string& markdown, const std::filesystem::path& file,
                                 const std::vector<MeasuredTable>& tables);

}  // namespace lumivox
