// The files that a scene text names, and those of them that do not exist.
#pragma once

#include <string>
#include <vector>

#include "lumivox/dsl/document.h"
#include "scene/assets.h"
#include "scene/description.h"

namespace lumivox {

/// Loading for rendering ends at the first bad file; a check goes on to find all problems.
enum class Purpose { rendering, checking };

/// The model of a mesh, or those of its sequence in order.
std::vector<std::string> fileNames(const MeshText& mesh);

/// Whether the file of a mesh can be read although its block has findings.
bool namesOneFile(const MeshText& mesh);

/// Reports files that should be beside the text and are not; a check reports those that are nowhere.
void findMissingFiles(const dsl::Document& document, const SceneDescription& description,
                      const AssetSearch& assets, Purpose purpose, std::vector<Diagnostic>& findings);

}  // namespace lumivox
