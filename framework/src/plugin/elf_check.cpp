#include "plugin/elf_check.h"

#include <elf.h>
#include <fmt/format.h>

#include <cstdint>
#include <cstring>

namespace lumivox {

namespace {

#if defined(__x86_64__)
constexpr Elf64_Half kMachine = EM_X86_64;
#elif defined(__aarch64__)
constexpr Elf64_Half kMachine = EM_AARCH64;
#else
#error "name this machine's ELF architecture here"
#endif

/// Whether [offset, offset + size) lies in the file; free of overflow.
bool inside(std::string_view bytes, std::uint64_t offset, std::uint64_t size) {
  return offset <= bytes.size() && size <= bytes.size() - offset;
}

/// The header of a section; nothing if it lies beyond the table or the file.
std::optional<Elf64_Shdr> sectionHeader(std::string_view bytes, const Elf64_Ehdr& file, std::uint64_t index) {
  const std::uint64_t offset = index * sizeof(Elf64_Shdr);
  if (index >= file.e_shnum || file.e_shentsize != sizeof(Elf64_Shdr) || !inside(bytes, file.e_shoff, 0) ||
      !inside(bytes, file.e_shoff + offset, sizeof(Elf64_Shdr)))
    return std::nullopt;
  Elf64_Shdr header;
  std::memcpy(&header, bytes.data() + file.e_shoff + offset, sizeof(header));
  return header;
}

/// The contents of a section; nothing if they lie outside of the file.
std::optional<std::string_view> contentsOf(std::string_view bytes, const Elf64_Shdr& section) {
  if (section.sh_type == SHT_NOBITS) return std::string_view();
  if (!inside(bytes, section.sh_offset, section.sh_size)) return std::nullopt;
  return bytes.substr(section.sh_offset, section.sh_size);
}

}  // namespace

std::string sharedLibraryDefect(std::string_view bytes) {
  if (bytes.empty()) return "the file is empty";
  if (bytes.size() < SELFMAG || std::memcmp(bytes.data(), ELFMAG, SELFMAG) != 0)
    return "not a shared library";
  Elf64_Ehdr header;
  if (bytes.size() < sizeof(header)) return "the file is truncated: its header is incomplete";
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_ident[EI_DATA] != ELFDATA2LSB ||
      header.e_machine != kMachine) {
    return "a shared library for another kind of machine";
  }
  if (header.e_type != ET_DYN || header.e_phentsize != sizeof(Elf64_Phdr)) return "not a shared library";
  const std::uint64_t programHeaders = std::uint64_t{header.e_phnum} * sizeof(Elf64_Phdr);
  if (!inside(bytes, header.e_phoff, programHeaders))
    return "the file is truncated: its program headers are incomplete";
  std::uint64_t needed = header.e_shoff + std::uint64_t{header.e_shnum} * header.e_shentsize;
  bool broken = needed < header.e_shoff;
  for (std::uint64_t i = 0; i < header.e_phnum; ++i) {
    Elf64_Phdr segment;
    std::memcpy(&segment, bytes.data() + header.e_phoff + i * sizeof(segment), sizeof(segment));
    const std::uint64_t end = segment.p_offset + segment.p_filesz;
    broken = broken || end < segment.p_offset;
    if (segment.p_type == PT_LOAD && end > needed) needed = end;
  }
  if (broken) return "the file is damaged: its headers name impossible sizes";
  if (needed > bytes.size()) {
    return fmt::format("the file is truncated: {} of {} bytes", bytes.size(), needed);
  }
  return {};
}

std::optional<std::string_view> sectionOf(std::string_view bytes, std::string_view name) {
  Elf64_Ehdr file;
  if (bytes.size() < sizeof(file)) return std::nullopt;
  std::memcpy(&file, bytes.data(), sizeof(file));
  const auto namesHeader = sectionHeader(bytes, file, file.e_shstrndx);
  const auto names = namesHeader ? contentsOf(bytes, *namesHeader) : std::nullopt;
  if (!names) return std::nullopt;
  for (std::uint64_t i = 0; i < file.e_shnum; ++i) {
    const auto section = sectionHeader(bytes, file, i);
    if (!section || section->sh_name >= names->size()) continue;
    const std::string_view rest = names->substr(section->sh_name);
    if (rest.substr(0, rest.find('\0')) == name) return contentsOf(bytes, *section);
  }
  return std::nullopt;
}

}  // namespace lumivox
