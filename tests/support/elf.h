// Reads and changes sections of libraries' ELF files.
#pragma once

#include <elf.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace lumivox::test {

template <class Part>
Part partOf(const std::string& bytes, std::size_t offset) {
  Part part;
  std::memcpy(&part, bytes.data() + offset, sizeof(part));
  return part;
}
template <class Part>
void setPart(std::string& bytes, std::size_t offset, const Part& part) {
  std::memcpy(bytes.data() + offset, &part, sizeof(part));
}

/// The offset of a section's header in the bytes of a 64-bit ELF file. Throws if there is no section of that
/// name.
inline std::size_t headerOfSection(const std::string& bytes, const std::string& name) {
  const auto file = partOf<Elf64_Ehdr>(bytes, 0);
  const auto headerAt = [&](std::size_t i) { return file.e_shoff + i * sizeof(Elf64_Shdr); };
  const auto names = partOf<Elf64_Shdr>(bytes, headerAt(file.e_shstrndx));
  for (std::size_t i = 0; i < file.e_shnum; ++i)
    if (bytes.c_str() + names.sh_offset + partOf<Elf64_Shdr>(bytes, headerAt(i)).sh_name == name)
      return headerAt(i);
  throw std::runtime_error("no section " + name);
}

struct ElfSymbol {
  std::string name;
  Elf64_Sym entry{};
};

/// The symbols that the file exports, without those that it imports.
inline std::vector<ElfSymbol> exportedSymbols(const std::string& bytes) {
  const auto table = partOf<Elf64_Shdr>(bytes, headerOfSection(bytes, ".dynsym")),
             names = partOf<Elf64_Shdr>(bytes, headerOfSection(bytes, ".dynstr"));
  std::vector<ElfSymbol> symbols;
  for (std::size_t at = 0; at < table.sh_size; at += sizeof(Elf64_Sym)) {
    const auto entry = partOf<Elf64_Sym>(bytes, table.sh_offset + at);
    if (entry.st_shndx != SHN_UNDEF && ELF64_ST_BIND(entry.st_info) != STB_LOCAL)
      symbols.push_back({bytes.c_str() + names.sh_offset + entry.st_name, entry});
  }
  return symbols;
}

}  // namespace lumivox::test
