#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "foamCases/wedge_gauge.h"
#include "scenes/scene.h"

namespace flowrest::foam {

/// A slump's mesh as its gauges need it, be it a wedge or a quarter.
class SlumpMesh {
 public:
  virtual ~SlumpMesh() = default;
  virtual std::size_t cells() const = 0;
  virtual SlumpGauges gauge(const SlumpFields&, double density, bool slip) const = 0;
  /// Mean of a cell field over the concrete, by its volume.
  virtual double mean_over_concrete(const std::vector<double>& fraction,
                                    const std::vector<double>& field) const = 0;
};

/// @throws scenes::SceneError where the mesh cannot be laid out.
std::unique_ptr<SlumpMesh> slump_mesh(const scenes::Scene&);

}  // namespace flowrest::foam
