#include "lumivox/pipeline/port.h"

#include <fmt/format.h>

#include "lumivox/base/error.h"

namespace lumivox {
namespace {

template <class Named>
const Named& find(const std::vector<Named>& all, const PortKind& kind, const char* what,
                  const std::string& name) {
  std::vector<std::string> names;
  for (const Named& one : all) {
    if (one.name == name) return one;
    names.push_back(one.name);
  }
  throw Error(fmt::format("port kind {} has no {} '{}'; expected one of its table: {}", kind.name, what, name,
                          fmt::join(names, ", ")));
}

}  // namespace

const PortResource& PortContents::resourceNamed(const std::string& name) const {
  return find(kind_->resources, *kind_, "resource", name);
}

void PortContents::texture(const std::string& name, const gpu::TextureRef& texture, FilledTexels filled) {
  const PortResource& what = resourceNamed(name);
  if (texture) resources_.push_back({&what, texture, nullptr, std::move(filled)});
}

void PortContents::buffer(const std::string& name, const gpu::BufferRef& buffer) {
  const PortResource& what = resourceNamed(name);
  if (buffer) resources_.push_back({&what, nullptr, buffer});
}

PortContents::Field& PortContents::field(const std::string& name, const VoxelBox& box, VoxelSource source,
                                         int level) {
  const PortField& what = find(kind_->fields, *kind_, "field", name);
  fields_.push_back({what.name, what.unit, &what, level, box, std::move(source)});
  return fields_.back();
}

}  // namespace lumivox
