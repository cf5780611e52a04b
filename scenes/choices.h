#pragma once

#include <string>

#include "laws/law.h"

/// Every choice a scene can make by a name, such as "elasto-viscoplastic".
namespace flowrest::scenes {

/// What an apparatus is judged by: how far material spreads from a middle or runs along a channel, what of it
/// has run out, how fast it flows, or which section a strand has.
enum class MainGauge { spread, front, discharge, velocity, section };
/// What is computed of a body: `half` and `quarter` are cut along its planes of symmetry.
enum class Dimension { axisymmetric, plane, half, quarter, full };
/// Which way the layers of a print are laid after the first: all alike, or to and fro.
enum class PrintDirection { same, alternating };
using Model = laws::Law;
enum class Scheme { quadratic_apic, linear_flip, paper };
enum class Precision { double_precision, single_precision };
enum class Seeding { lattice, jittered, gmsh };
/// How a fluid's stress is integrated in MPM: pointwise implicit (no viscous limit) or explicit (enforced).
enum class FluidUpdate { implicit_update, explicit_update };
/// How the volumetric part of the strain, and the pressure, are averaged.
enum class BBar { smooth, cell_average };
/// How a wall holds the material; only `no_slip` and `slip` are names, friction is given by its coefficient.
enum class Wall { no_slip, slip, friction };
/// Whose laws an OpenFOAM run takes: flowrest's rheology plug-in, OpenFOAM's own, or the former where it is
/// built.
enum class FoamLaws { best, plug_in, built_in };
/// How the stresses of concrete and air make that of a cell that holds both (plug-in only).
enum class FoamMixing { arithmetic, harmonic, mass_weighted, saturating };
/// Whose shear rate the law is given in such a cell (plug-in only).
enum class FoamStrainRate { mixture, concrete };
/// How much of a wall holds the concrete of a cell that it does not fill (plug-in only).
enum class FoamWetting { fraction, geometric };
/// How the parts that concrete has in two cells make that of the face between them (plug-in's solid only).
enum class FoamFaces { linear, harmonic };

/// The names used in scenes, on the command line and in run.json, such as "elasto-viscoplastic".
std::string to_string(Dimension);
std::string to_string(PrintDirection);
std::string to_string(Model);
std::string to_string(Scheme);
std::string to_string(Precision);
std::string to_string(Seeding);
std::string to_string(FluidUpdate);
std::string to_string(BBar);
std::string to_string(Wall);
std::string to_string(FoamLaws);
std::string to_string(FoamMixing);
std::string to_string(FoamStrainRate);
std::string to_string(FoamWetting);
std::string to_string(FoamFaces);

}  // namespace flowrest::scenes
