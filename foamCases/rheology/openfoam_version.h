#pragma once

#include <dlfcn.h>
#include <sys/auxv.h>

#include <cstdint>

#include "fvcReconstruct.H"
#include "surfaceFields.H"
#include "volFields.H"

/// What differs between the builds and versions of OpenFOAM that the plug-in is compiled for: openfoam.com's
/// v1912, for which OPENFOAM is 1912, and later ones. All else that the plug-in uses is the same in them.
#if !defined(OPENFOAM) || OPENFOAM < 1912
#error "flowrest's plug-in is for OpenFOAM v1912 or later of openfoam.com; OPENFOAM is defined as its number"
#endif

namespace Foam {

/// How forces are taken from faces to cells: U = inv(sum n S) & sum n f.
using Reconstruct = tmp<volVectorField> (*)(const surfaceScalarField&);

/// The function by which the running solver itself does so, as its compiler made it; nullptr where the solver
/// keeps it to itself. It is found by its address: the linker takes the first that is loaded, and its name
/// differs from one version and precision to another.
inline Reconstruct reconstruct_of_solver() {
  const volatile Reconstruct first = &fvc::reconstruct<scalar>;
  Dl_info where{};
  if (dladdr(reinterpret_cast<void*>(first), &where) == 0) return nullptr;
  constexpr std::uintptr_t page = 4096;  // the headers of a program lie in its first one
  const std::uintptr_t headers = getauxval(AT_PHDR),
                       start = reinterpret_cast<std::uintptr_t>(where.dli_fbase);
  return headers >= start && headers - start < page ? first : nullptr;
}

}  // namespace Foam
