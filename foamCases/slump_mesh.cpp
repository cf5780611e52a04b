#include "foamCases/slump_mesh.h"

#include <utility>

#include "foamCases/quarter_grid.h"
#include "foamCases/wedge_grid.h"

namespace flowrest::foam {

namespace {

template <class Grid>
class MeshOf : public SlumpMesh {
 public:
  explicit MeshOf(Grid grid) : grid_(std::move(grid)) {}
  std::size_t cells() const override { return grid_.cells(); }
  SlumpGauges gauge(const SlumpFields& fields, double density, bool slip) const override {
    return gauge_slump(grid_, fields, density, slip);
  }
  double mean_over_concrete(const std::vector<double>& fraction,
                            const std::vector<double>& field) const override {
    return foam::mean_over_concrete(grid_, fraction, field);
  }

 private:
  Grid grid_;
};

}  // namespace

std::unique_ptr<SlumpMesh> slump_mesh(const scenes::Scene& scene) {
  if (scene.geometry.dimension == scenes::Dimension::quarter)
    return std::make_unique<MeshOf<QuarterGrid>>(quarter_grid(scene));
  return std::make_unique<MeshOf<WedgeGrid>>(wedge_grid(scene));
}

}  // namespace flowrest::foam
