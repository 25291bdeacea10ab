// The work of a shader: operations by name, counted by a counter in every basic block of the SPIR-V, so that
// loops and branches count as often as they ran.
#pragma once

#include <map>
#include <string>

namespace lumivox {

/// Operations by name. One name counts one resource of the device (docs/commands.md, `lumivox device`):
/// - texture_samples_<d2|d3>_<format>_<nearest|linear|mips|shadow>: sampling and fetching
/// - image_reads_<d2|d3>_<format>, image_writes_..., image_atomics: image loads, stores and atomics
/// - buffer_reads, buffer_writes: bytes through storage buffers; buffer_reads_uniform: where neighbouring
///   invocations read the same address; buffer_atomics
/// - shared_accesses, shared_atomics: of the memory that a work group shares
/// - float_operations, integer_operations: additions, products, comparisons and the like, per component
/// - exponentials, sines, inverse_square_roots: with the functions that are made of them, per component
/// - fragments, triangles, vertices, work_groups, dispatches, draws
/// - upload_bytes, download_bytes, clear_bytes: through the device's own commands
using Work = std::map<std::string, double>;

/// Adds `more` to `sum`, name by name.
void add(Work& sum, const Work& more);

}  // namespace lumivox
