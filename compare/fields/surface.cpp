#include "compare/fields/surface.h"

#include <fmt/format.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkHDFReader.h>
#include <vtkImageData.h>
#include <vtkMassProperties.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSTLWriter.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

#include "compare/fields/states.h"
#include "compare/run_view.h"

namespace flowrest::compare::fields {

namespace fs = std::filesystem;
using runs::RunError;

namespace {

/// The share of the room that is filled, at points between which it is linear; the outermost ones are empty.
class Fraction {
 public:
  explicit Fraction(const Parcels& p) : step_(1.25 * p.spacing) {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto& of = a == 0 ? p.x : a == 1 ? p.y : p.z;
      auto [low, high] = std::minmax_element(of.begin(), of.end());
      double from = *low, to = *high;
      if ((a == 1 && (p.half || p.quarter)) || (a == 0 && p.quarter)) from = -to;
      // Points lie in the middle of cells, so that planes of symmetry and floors lie between two of them.
      first_[a] = static_cast<long>(std::floor(from / step_)) - margin;
      count_[a] = static_cast<long>(std::floor(to / step_)) + margin + 1 - first_[a];
    }
    floor_ = *std::min_element(p.z.begin(), p.z.end()) > -0.5 * step_;
    values_.assign(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]), 0.0);
    for (std::size_t i = 0; i < p.x.size(); ++i)
      for (const double x : {1.0, -1.0})
        for (const double y : {1.0, -1.0}) {
          if ((x < 0.0 && !p.quarter) || (y < 0.0 && !p.quarter && !p.half)) continue;
          add({x * p.x[i], y * p.y[i], p.z[i]}, p.volume[i] / (step_ * step_ * step_));
        }
    if (floor_) close_floor();
  }

  void fill(vtkImageData& image) const {
    image.SetDimensions(static_cast<int>(count_[0]), static_cast<int>(count_[1]),
                        static_cast<int>(count_[2]));
    image.SetSpacing(step_, step_, step_);
    image.SetOrigin((static_cast<double>(first_[0]) + 0.5) * step_,
                    (static_cast<double>(first_[1]) + 0.5) * step_,
                    (static_cast<double>(first_[2]) + 0.5) * step_);
    vtkNew<vtkFloatArray> array;
    array->SetNumberOfValues(static_cast<vtkIdType>(values_.size()));
    for (std::size_t i = 0; i < values_.size(); ++i)
      array->SetValue(static_cast<vtkIdType>(i), static_cast<float>(values_[i]));
    image.GetPointData()->SetScalars(array);
  }

 private:
  static constexpr long margin = 3;  ///< points around the particles: a spline's reach and an empty one

  double& at(long i, long j, long k) {
    return values_[static_cast<std::size_t>((i - first_[0]) +
                                            count_[0] * ((j - first_[1]) + count_[1] * (k - first_[2])))];
  }

  void add(const std::array<double, 3>& place, double share) {
    std::array<long, 3> cell{};
    std::array<std::array<double, 3>, 3> weight{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double in = place[a] / step_;
      cell[a] = static_cast<long>(std::floor(in));
      const double x = in - std::floor(in);
      weight[a] = {0.5 * (1.0 - x) * (1.0 - x), 0.75 - (x - 0.5) * (x - 0.5), 0.5 * x * x};
    }
    for (long i = 0; i < 3; ++i)
      for (long j = 0; j < 3; ++j)
        for (long k = 0; k < 3; ++k) {
          long up = cell[2] + k - 1;
          if (floor_ && up < 0) up = -1 - up;  // what fades through the floor stays above it
          at(cell[0] + i - 1, cell[1] + j - 1, up) += share * weight[0][static_cast<std::size_t>(i)] *
                                                      weight[1][static_cast<std::size_t>(j)] *
                                                      weight[2][static_cast<std::size_t>(k)];
        }
  }

  /// Half way between a point over the floor and its image below it lies the surface where the upper one is full.
  void close_floor() {
    for (long i = first_[0]; i < first_[0] + count_[0]; ++i)
      for (long j = first_[1]; j < first_[1] + count_[1]; ++j) {
        const double over = at(i, j, 0);
        at(i, j, -1) = over >= 0.5 ? 1.0 - over : 0.0;
      }
  }

  double step_;
  bool floor_ = false;
  std::array<long, 3> first_{}, count_{};
  std::vector<double> values_;  ///< x fastest
};

/// The last snapshot of a run in space; nothing where it has none.
std::optional<Parcels> parcels_of(const RunView& view) {
  if (view.solver != "mpm" || !is_solid(view)) return std::nullopt;
  const fs::path folder = view.run.directory / "particles";
  std::ifstream file(folder / "particles.hdf.series");
  const auto series = nlohmann::json::parse(file, nullptr, false);
  if (series.is_discarded() || !series.contains("files") || series["files"].empty()) return std::nullopt;
  vtkNew<vtkHDFReader> reader;
  const fs::path state = folder / series["files"].back().value("name", "");
  reader->SetFileName(state.c_str());
  reader->Update();
  auto* grid = vtkUnstructuredGrid::SafeDownCast(reader->GetOutput());
  auto* volume = grid ? grid->GetPointData()->GetArray("volume") : nullptr;
  if (!volume) throw RunError(fmt::format("{}: cannot be read as particles with a volume", state.string()));
  Parcels parcels;
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    double point[3];
    grid->GetPoint(i, point);
    parcels.x.push_back(point[0]);
    parcels.y.push_back(point[1]);
    parcels.z.push_back(point[2]);
    parcels.volume.push_back(volume->GetComponent(i, 0));
  }
  double largest = 0.0;
  for (const double v : parcels.volume) largest = std::max(largest, v);
  parcels.spacing = std::cbrt(largest);
  const std::string dimension = word(view.run.info, "/settings/geometry/dimension");
  parcels.half = dimension == "half";
  parcels.quarter = dimension == "quarter";
  return parcels;
}

/// A label as a file's name.
std::string name_of(const std::string& label) {
  std::string name;
  for (const char c : label) name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' ? c : '-';
  return name;
}

}  // namespace

double write_surface(const Parcels& parcels, const fs::path& stl) {
  if (parcels.x.empty() || !(parcels.spacing > 0.0))
    throw RunError(fmt::format("{}: there are no particles to draw a surface around", stl.string()));
  vtkNew<vtkImageData> image;
  Fraction(parcels).fill(*image);
  vtkNew<vtkFlyingEdges3D> surface;
  surface->SetInputData(image);
  surface->SetValue(0, 0.5);
  surface->ComputeNormalsOff();
  surface->Update();
  fs::create_directories(stl.parent_path().empty() ? "." : stl.parent_path());
  vtkNew<vtkSTLWriter> writer;
  writer->SetFileName(stl.c_str());
  writer->SetFileTypeToBinary();
  writer->SetInputConnection(surface->GetOutputPort());
  if (writer->Write() == 0 || !fs::exists(stl) || surface->GetOutput()->GetNumberOfPolys() == 0)
    throw RunError(fmt::format("{}: cannot be written as a surface", stl.string()));
  vtkNew<vtkMassProperties> mass;
  mass->SetInputConnection(surface->GetOutputPort());
  return mass->GetVolume();
}

std::vector<fs::path> write_surfaces(const Comparison& comparison, const fs::path& folder) {
  std::vector<fs::path> files;
  for (const RunView& view : comparison.runs)
    if (const auto parcels = parcels_of(view)) {
      files.push_back(folder / (name_of(view.label) + ".stl"));
      write_surface(*parcels, files.back());
    }
  return files;
}

}  // namespace flowrest::compare::fields
