#pragma once

#include <cstddef>
#include <cstdint>

/// The shared shape of the data of wall contact: what WallContact (wall_contact.h) hands to the kernels that
/// relax its points (contact_sweeps.h).
namespace flowrest::mpm {

/// A surface point that nodes lie around. Vectors are node records without their first number: the fourth
/// component is zero, in two dimensions the third.
template <class T>
struct ContactPoint {
  T normal[4]{};         ///< out of the wall
  T wall_velocity[4]{};  ///< m/s
  T impulse[4]{};        ///< on the material in this step, kg m/s
  T friction{};          ///< coefficient, zero where the wall is smooth
  bool sticks = false;
  bool pressed = false, stuck = false;  ///< at the end of the step's contact
  bool folded = false;                  ///< a node's weight is a vector: its sign differs between components
  std::uint32_t first = 0, count = 0;   ///< of its entries
  std::uint32_t first_weight = 0;       ///< of their weights: folded ones are of four numbers
  T missing{};                          ///< sum of the weights of nodes that do not exist
  T mobility{};                         ///< velocity per impulse, 1/kg; zero where nothing touches the point
  T per_mobility{};
  T change{};  ///< of its velocity when it was relaxed last, squared, m2/s2
};

/// Points, their entries (what a point takes from a node) and the nodes they see.
template <class T>
struct ContactView {
  int dimension = 2;
  ContactPoint<T>* points = nullptr;
  const std::uint32_t* node = nullptr;  ///< by entry
  const T* weight = nullptr;            ///< of the shape functions
  T* effective = nullptr;               ///< weights of this step: less where the node is light
  T* response = nullptr;                ///< change of the node's velocity per impulse of the point, 1/kg
  T* velocity = nullptr;                ///< by node, four numbers, m/s
  const T* mass = nullptr;              ///< by node, kg
  const T* per_mass = nullptr;
};

/// How a point's impulse is corrected.
enum class Relaxation {
  lawful,     ///< to what its velocity asks for and its wall's contact allows
  as_before,  ///< pressed points stay on the wall, stuck ones stay stuck, the rest is left alone
};

/// One sweep over points.
template <class T>
struct Sweeping {
  Relaxation how = Relaxation::lawful;
  bool backwards = false;  ///< from the last point to the first
  T settled{};  ///< points whose velocity changed by no more when last asked are passed over, m2/s2
};

/// What an instruction set does for wall contact. Points are given by their indices.
template <class T>
struct ContactKernels {
  /// Finds a point's weights and mobility, of nodes that count less where they are lighter than `light_share`
  /// of the heaviest around the point.
  void (*weigh)(const ContactView<T>&, T light_share, const std::uint32_t* points,
                std::size_t count) = nullptr;
  /// Gives the points' impulses to the nodes.
  void (*push)(const ContactView<T>&, const std::uint32_t* points, std::size_t count) = nullptr;
  /// Corrects one point after the other; returns the square of the largest change of velocity, m2/s2.
  T(*sweep)
  (const ContactView<T>&, const Sweeping<T>&, const std::uint32_t* points, std::size_t count) = nullptr;
  /// Work that the impulses do at the points' velocities, J.
  double (*work)(const ContactView<T>&, const std::uint32_t* points, std::size_t count) = nullptr;
};

}  // namespace flowrest::mpm
