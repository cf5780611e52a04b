#include "compare/fields/states.h"

#include <fmt/format.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkHDFReader.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkOpenFOAMReader.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>

#include "compare/apparatus/apparatus.h"
#include "compare/run_view.h"

namespace flowrest::compare::fields {

namespace fs = std::filesystem;
using runs::RunError;

namespace {

/// Names of the quantities that a page shows, and of the arrays they are read from.
constexpr std::pair<const char*, const char*> particle_arrays[] = {
    {"shear rate", "shear_rate"}, {"pressure", "pressure"}, {"flocculation", "flocculation"}};

/// Where an upright section lies across: on the plane of symmetry, which a half and a quarter are cut along.
double section_plane(const RunView& view, double lowest, double highest) {
  const std::string dimension = word(view.run.info, "/settings/geometry/dimension");
  const bool cut = dimension == "half" || dimension == "quarter" || view.apparatus->spreads();
  return cut ? std::clamp(0.0, lowest, highest) : 0.5 * (lowest + highest);
}

class Particles : public Recording {
 public:
  Particles(const RunView& view, const fs::path& folder, const Cut& cut) : view_(view), cut_(cut) {
    std::ifstream file(folder / "particles.hdf.series");
    const auto series = nlohmann::json::parse(file, nullptr, false);
    if (series.is_discarded() || !series.contains("files")) return;
    for (const auto& entry : series["files"]) {
      const fs::path state = folder / entry.value("name", "");
      if (!fs::is_regular_file(state)) continue;
      files_.push_back(state);
      times_.push_back(entry.value("time", 0.0));
    }
    const double cell = setting(view, "/mpm/cell").value_or(0.0);
    const double count = setting(view, "/mpm/particles_per_cell").value_or(1.0);
    spacing_ = cell * (is_solid(view_) ? 1.0 / std::cbrt(count) : 1.0 / std::sqrt(count));
  }

  State read(std::size_t index) override {
    vtkNew<vtkHDFReader> reader;
    reader->SetFileName(files_[index].c_str());
    reader->Update();
    auto* grid = vtkUnstructuredGrid::SafeDownCast(reader->GetOutput());
    if (!grid) throw RunError(fmt::format("{}: cannot be read as VTKHDF", files_[index].string()));
    double bounds[6];
    grid->GetBounds(bounds);
    const int normal = cut_.height ? 2 : 1, up = cut_.height ? 1 : 2;
    const double plane = cut_.height.value_or(section_plane(view_, bounds[2], bounds[3])),
                 reach = 0.6 * spacing_;
    std::vector<vtkIdType> kept;
    State state;
    state.time = times_[index];
    for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
      double point[3];
      grid->GetPoint(i, point);
      if (is_solid(view_) && std::abs(point[normal] - plane) > reach) continue;
      kept.push_back(i);
      state.x.push_back(point[0]);
      state.z.push_back(point[up]);
    }
    for (const auto& [name, array_name] : particle_arrays) {
      auto* array = grid->GetPointData()->GetArray(array_name);
      if (!array) continue;
      auto& values = state.values[name];
      for (const vtkIdType i : kept) values.push_back(array->GetComponent(i, 0));
    }
    return state;
  }

 private:
  const RunView& view_;
  Cut cut_;
  std::vector<fs::path> files_;
};

class FoamCase : public Recording {
 public:
  FoamCase(const RunView& view, const fs::path& file, const Cut& cut) : view_(view), cut_(cut) {
    reader_->SetFileName(file.c_str());
    reader_->CacheMeshOn();
    reader_->CreateCellToPointOff();
    reader_->DecomposePolyhedraOff();
    reader_->UpdateInformation();
    auto* times = reader_->GetTimeValues();
    for (vtkIdType i = 0; times && i < times->GetNumberOfTuples(); ++i) times_.push_back(times->GetValue(i));
    if (!times_.empty()) choose_cells(grid_at(0));
  }

  State read(std::size_t index) override {
    auto* grid = grid_at(index);
    State state;
    state.time = times_[index];
    state.cover = component(grid, "alpha.concrete", 0);
    if (state.cover.empty())
      throw RunError(fmt::format("{}: no field alpha.concrete", view_.run.directory.string()));
    const auto u = component(grid, "U", 0), w = component(grid, "U", 2);
    // A level section does not show how the velocity changes with height.
    if (!u.empty() && !cut_.height)
      state.values["shear rate"] = shear_rate(
          cells_, state.cover, u, w, word(view_.run.info, "/settings/geometry/dimension") == "axisymmetric",
          word(view_.run.info, "/settings/walls/base") != "slip");
    for (const auto& [name, array] : {std::pair{"pressure", "p"}, std::pair{"flocculation", "flocculation"}})
      if (auto values = component(grid, array, 0); !values.empty()) state.values[name] = std::move(values);
    return state;
  }

 private:
  vtkUnstructuredGrid* grid_at(std::size_t index) {
    reader_->UpdateTimeStep(times_[index]);
    auto* blocks = reader_->GetOutput();
    auto* grid = blocks && blocks->GetNumberOfBlocks() > 0
                     ? vtkUnstructuredGrid::SafeDownCast(blocks->GetBlock(0))
                     : nullptr;
    if (!grid)
      throw RunError(fmt::format("{}: cannot be read as an OpenFOAM case", view_.run.directory.string()));
    return grid;
  }

  void choose_cells(vtkUnstructuredGrid* grid) {
    double all[6];
    grid->GetBounds(all);
    const int normal = cut_.height ? 4 : 2, up = cut_.height ? 2 : 4;
    const double plane =
        cut_.height.value_or(section_plane(view_, all[2], all[3])) + 1e-7 * (all[normal + 1] - all[normal]);
    for (vtkIdType i = 0; i < grid->GetNumberOfCells(); ++i) {
      double bounds[6];
      grid->GetCellBounds(i, bounds);
      if (bounds[normal] > plane || bounds[normal + 1] < plane) continue;
      ids_.push_back(i);
      cells_.west.push_back(bounds[0]);
      cells_.east.push_back(bounds[1]);
      cells_.bottom.push_back(bounds[up]);
      cells_.top.push_back(bounds[up + 1]);
    }
  }

  std::vector<double> component(vtkUnstructuredGrid* grid, const char* name, int which) const {
    std::vector<double> values;
    auto* array = grid->GetCellData()->GetArray(name);
    if (!array || array->GetNumberOfTuples() != grid->GetNumberOfCells()) return values;
    values.reserve(ids_.size());
    for (const vtkIdType id : ids_)
      values.push_back(array->GetComponent(id, std::min(which, array->GetNumberOfComponents() - 1)));
    return values;
  }

  const RunView& view_;
  Cut cut_;
  vtkNew<vtkOpenFOAMReader> reader_;
  std::vector<vtkIdType> ids_;
};

/// Numbers the distinct values of a list; equal up to a thousandth of the smallest step.
std::vector<std::size_t> numbered(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const double same = 1e-5 * (sorted.back() - sorted.front() + 1e-300);
  std::vector<double> distinct;
  for (const double v : sorted)
    if (distinct.empty() || v - distinct.back() > same) distinct.push_back(v);
  std::vector<std::size_t> numbers;
  for (const double v : values)
    numbers.push_back(static_cast<std::size_t>(std::lower_bound(distinct.begin(), distinct.end(), v - same) -
                                               distinct.begin()));
  return numbers;
}

/// The value on the face between two cells, by the concrete on its two sides; without any, the mean.
double face_value(double one, double other, double cover_one, double cover_other) {
  const double sum = cover_one + cover_other;
  return sum > 1e-6 ? (cover_one * one + cover_other * other) / sum : 0.5 * (one + other);
}

}  // namespace

std::vector<double> shear_rate(const Cells& cells, const std::vector<double>& cover,
                               const std::vector<double>& u, const std::vector<double>& w, bool radial,
                               bool no_slip) {
  if (cells.size() == 0) return {};
  const auto columns = numbered(cells.west), rows = numbered(cells.bottom);
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> at;
  for (std::size_t i = 0; i < cells.size(); ++i) at[{columns[i], rows[i]}] = i;
  const auto neighbour = [&](std::size_t i, int right, int up) -> std::optional<std::size_t> {
    const auto found =
        at.find({columns[i] + static_cast<std::size_t>(right), rows[i] + static_cast<std::size_t>(up)});
    return found == at.end() ? std::nullopt : std::optional(found->second);
  };
  std::vector<double> rates(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto on_face = [&](const std::vector<double>& v, int right, int up, double beyond) {
      const auto other = neighbour(i, right, up);
      return other ? face_value(v[i], v[*other], cover[i], cover[*other]) : beyond;
    };
    const double width = cells.east[i] - cells.west[i], height = cells.top[i] - cells.bottom[i];
    // On the axis nothing moves across; at the base a wall without slip holds what touches it.
    const double axis = radial && cells.west[i] < 1e-9 ? 0.0 : u[i];
    const bool base = rows[i] == 0;
    const double du_dx = (on_face(u, 1, 0, u[i]) - on_face(u, -1, 0, axis)) / width;
    const double du_dz = (on_face(u, 0, 1, u[i]) - on_face(u, 0, -1, base && no_slip ? 0.0 : u[i])) / height;
    const double dw_dx = (on_face(w, 1, 0, w[i]) - on_face(w, -1, 0, w[i])) / width;
    const double dw_dz = (on_face(w, 0, 1, w[i]) - on_face(w, 0, -1, base ? 0.0 : w[i])) / height;
    const double hoop = radial ? u[i] / (0.5 * (cells.west[i] + cells.east[i])) : 0.0;
    const double shear = du_dz + dw_dx;
    rates[i] = std::sqrt(2.0 * (du_dx * du_dx + dw_dz * dw_dz + hoop * hoop) + shear * shear);
  }
  return rates;
}

bool is_solid(const RunView& view) {
  const std::string dimension = word(view.run.info, "/settings/geometry/dimension");
  return dimension != "axisymmetric" && dimension != "plane";
}

std::unique_ptr<Recording> recording_of(const RunView& view, const Cut& cut) {
  if (cut.height && !is_solid(view)) return nullptr;
  // VTK complains on the terminal about every half-written file; what matters is said by the page.
  vtkObject::GlobalWarningDisplayOff();
  const fs::path& run = view.run.directory;
  std::unique_ptr<Recording> recording;
  if (fs::exists(run / "particles" / "particles.hdf.series"))
    recording = std::make_unique<Particles>(view, run / "particles", cut);
  else if (fs::exists(run / "case" / "case.foam"))
    recording = std::make_unique<FoamCase>(view, run / "case" / "case.foam", cut);
  return recording && !recording->times().empty() ? std::move(recording) : nullptr;
}

}  // namespace flowrest::compare::fields
