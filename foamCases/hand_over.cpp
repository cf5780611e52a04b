#include "foamCases/hand_over.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <vector>

#include "foamCases/case_fields.h"
#include "foamCases/field_file.h"
#include "foamCases/quarter_grid.h"
#include "foamCases/wedge_grid.h"
#include "runs/earlier_run.h"
#include "runs/folder.h"
#include "runs/run_directory.h"
#include "runs/state_surface.h"

namespace flowrest::foam {

namespace fs = std::filesystem;
using runs::Carried;
using runs::DepthColumns;
using runs::MaterialState;
using scenes::Dimension;

namespace {

/// By how much a state may lie beside the time that is asked for, of the interval between states: interFoam
/// writes at the end of a step.
constexpr double beside_time = 0.1;

/// A slump's mesh as columns of cells; cell (column, row) has the index column + columns * row.
struct StateGrid {
  DepthColumns::Plan plan{};
  double width = 0.0;  ///< m, of a column
  int along_x = 0, along_y = 1;
  std::vector<double> heights;  ///< m, between the rows and at both ends

  explicit StateGrid(const scenes::Scene& scene) {
    if (scene.geometry.dimension == Dimension::quarter) {
      const QuarterGrid grid = quarter_grid(scene);
      plan = DepthColumns::Plan::squares;
      width = grid.width;
      along_x = along_y = grid.side;
      take_rows(grid);
    } else {
      const WedgeGrid grid = wedge_grid(scene);
      plan = DepthColumns::Plan::rings;
      width = grid.ring_width;
      along_x = grid.rings;
      take_rows(grid);
    }
  }

  std::size_t columns() const {
    return static_cast<std::size_t>(along_x) * static_cast<std::size_t>(along_y);
  }
  std::size_t rows() const { return heights.size() - 1; }
  std::size_t cells() const { return columns() * rows(); }
  std::size_t index(std::size_t column, std::size_t row) const { return column + columns() * row; }
  double west(std::size_t column) const {
    return static_cast<double>(column % static_cast<std::size_t>(along_x)) * width;
  }
  double south(std::size_t column) const {
    return static_cast<double>(column / static_cast<std::size_t>(along_x)) * width;
  }
  double area(std::size_t column) const {
    return DepthColumns::area(plan, west(column), west(column) + width, south(column), south(column) + width);
  }
  double row_height(std::size_t row) const { return heights[row + 1] - heights[row]; }
  /// Corners of a cell up to a height in it; a section has no width across.
  std::array<double, 3> low(std::size_t column, std::size_t row) const {
    return {west(column), plan == DepthColumns::Plan::squares ? south(column) : 0.0, heights[row]};
  }
  std::array<double, 3> high(std::size_t column, double height) const {
    return {west(column) + width, plan == DepthColumns::Plan::squares ? south(column) + width : 0.0, height};
  }

 private:
  void take_rows(const SlumpRows& rows) {
    heights.push_back(0.0);
    for (int row = 0; row < rows.rows(); ++row) heights.push_back(heights.back() + rows.row_height(row));
  }
};

/// A run of OpenFOAM and the states in its case.
class RecordedStates {
 public:
  explicit RecordedStates(const fs::path& directory)
      : run_(runs::read_earlier_run(directory, "foam")),
        fields_(directory / "case", CaseFields::ranks_in(directory / "case")) {
    if (!fs::is_directory(directory / "case")) return;
    for (const auto& [time, name] : fields_.times())
      if (fields_.holds(name, "alpha.concrete") && fields_.holds(name, "U") && is_kept(time, name))
        states_.emplace_back(time, name);
  }

  const scenes::Scene& scene() const { return run_.scene; }
  std::vector<double> times() const {
    std::vector<double> times;
    for (const auto& state : states_) times.push_back(state.first);
    return times;
  }
  double time(std::size_t which) const { return states_[which].first; }

  /// Empty where the case has no such field then.
  std::vector<double> read(std::size_t which, const char* field, std::size_t cells, int components) const {
    const std::string& name = states_[which].second;
    if (!fields_.holds(name, field)) return {};
    return fields_.read(name, field, cells, components);
  }

 private:
  /// Whether it is a state, and not what was written for a row of the history.
  bool is_kept(double time, const std::string& name) const {
    return time == 0.0 || fields_.holds(name, "p_rgh");
  }

  runs::EarlierRun run_;
  CaseFields fields_;
  std::vector<std::pair<double, std::string>> states_;
};

/// The concrete of every cell as a parcel, and its depth over the columns.
void take_cells(const StateGrid& grid, const RecordedStates& states, std::size_t which,
                MaterialState& state) {
  const auto field = [&](const char* name, int components) {
    auto values = states.read(which, name, grid.cells(), components);
    values.resize(grid.cells() * static_cast<std::size_t>(components), 0.0);
    return values;
  };
  const auto fraction = field("alpha.concrete", 1), velocity = field("U", 3), stress = field("stress", 6),
             flocculation = field("flocculation", 1);
  auto rate = states.read(which, "plasticShearRate", grid.cells(), 1);
  if (rate.empty()) rate = field("shearRate", 1);
  state.columns = {grid.plan, grid.width, grid.along_x, grid.along_y,
                   std::vector<double>(grid.columns(), 0.0)};
  for (std::size_t row = 0; row < grid.rows(); ++row)
    for (std::size_t column = 0; column < grid.columns(); ++column) {
      const std::size_t cell = grid.index(column, row);
      const double concrete = std::max(0.0, fraction[cell]);
      if (!(concrete > 0.0)) continue;
      state.columns.depth[column] += concrete * grid.row_height(row);
      runs::Parcel parcel;
      parcel.low = grid.low(column, row);
      parcel.high = grid.high(column, grid.heights[row + 1]);
      parcel.volume = concrete * grid.row_height(row) * grid.area(column);
      std::copy_n(&velocity[3 * cell], 3, parcel.velocity.begin());
      if (grid.plan == DepthColumns::Plan::rings) parcel.velocity[1] = 0.0;
      std::copy_n(&stress[6 * cell], 6, parcel.stress.begin());
      parcel.shear_rate = rate[cell];
      parcel.flocculation = flocculation[cell];
      state.parcels.push_back(parcel);
    }
}

/// What a case begins with, cell by cell.
struct InitialFields {
  std::vector<double> fraction;
  std::vector<Carried> carried;
};

/// How full every cell of a column is whose slips of equal width have these depths at rest.
void fill_column(const StateGrid& grid, std::size_t column, const runs::StateSurface& surface,
                 std::vector<double>& fraction) {
  constexpr int slips = 8;
  const int across = grid.plan == DepthColumns::Plan::squares ? slips : 1;
  const double slip = grid.width / slips, depth_across = grid.width / across;
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < slips; ++i) {
      const double west = grid.west(column) + i * slip, south = grid.south(column) + j * depth_across;
      const double area = DepthColumns::area(grid.plan, west, west + slip, south, south + depth_across);
      double left = surface.volume(west, west + slip, south, south + depth_across) / area;
      for (std::size_t row = 0; row < grid.rows() && left > 0.0; ++row) {
        const double taken = row + 1 < grid.rows() ? std::min(left, grid.row_height(row)) : left;
        fraction[grid.index(column, row)] += taken / grid.row_height(row) * (area / grid.area(column));
        left -= taken;
      }
    }
}

InitialFields fields_of(const scenes::Scene& scene, const MaterialState& state, const StateGrid& grid) {
  const runs::StateSurface surface(state.columns, 0.1 * scene.gauges.spread_depth);
  const runs::ParcelField parcels(state);
  InitialFields fields{std::vector<double>(grid.cells(), 0.0), std::vector<Carried>(grid.cells())};
  for (std::size_t column = 0; column < grid.columns(); ++column)
    fill_column(grid, column, surface, fields.fraction);
  runs::Received received;
  std::vector<std::size_t> cells;
  for (std::size_t row = 0; row < grid.rows(); ++row)
    for (std::size_t column = 0; column < grid.columns(); ++column) {
      const std::size_t cell = grid.index(column, row);
      double& fraction = fields.fraction[cell];
      if (!(fraction > 0.0)) continue;
      const double full = grid.heights[row] + std::min(1.0, fraction) * grid.row_height(row);
      cells.push_back(cell);
      received.mass.push_back(fraction * grid.row_height(row) * grid.area(column) * state.density);
      received.carried.push_back(parcels.in_box(grid.low(column, row), grid.high(column, full)));
    }
  conserve(state, received);
  for (std::size_t i = 0; i < cells.size(); ++i) fields.carried[cells[i]] = received.carried[i];
  return fields;
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A field's entry internalField.
template <std::size_t N, class Values>
std::string internal_field(const char* type, std::size_t cells, const Values& values) {
  std::string text = fmt::format("internalField   nonuniform List<{}>\n{}\n(\n", type, cells);
  for (std::size_t cell = 0; cell < cells; ++cell) {
    const std::array<double, N> numbers = values(cell);
    text += N == 1 ? fmt::format("{}\n", numbers[0]) : fmt::format("({})\n", fmt::join(numbers, " "));
  }
  return text + ")";
}

/// Replaces the internal field of a field's file.
void put_into(const fs::path& path, const std::string& internal) {
  std::string text = text_of(path);
  const auto begin = text.find("internalField"), end = text.find(';', begin);
  if (begin == std::string::npos || end == std::string::npos)
    throw runs::RunError(fmt::format("{}: it has no internalField to put a state into", path.string()));
  runs::write_atomically(path, text.replace(begin, end - begin, internal));
}

/// A field of the plug-in's, which a case has no file of before it is solved.
void write_field(const fs::path& path, const char* type, const char* dimensions, const std::string& internal,
                 const char* on_walls) {
  runs::write_atomically(
      path,
      fmt::format("FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {};\n    "
                  "object      {};\n}}\n\ndimensions      {};\n\n{};\n\nboundaryField\n{{\n    wedge      "
                  "   {{ type wedge; }}\n    empty         {{ type empty; }}\n    symmetryPlane {{ type "
                  "symmetryPlane; }}\n    \".*\"          {{ {} }}\n}}\n",
                  type, path.filename().string(), dimensions, internal, on_walls));
}

}  // namespace

MaterialState read_state(const std::string& from) {
  const runs::StateName name = runs::state_name(from);
  const RecordedStates states(name.run);
  const scenes::Scene& scene = states.scene();
  const std::size_t which =
      runs::recorded_time(name, states.times(), beside_time * scene.output.snapshot_interval);
  MaterialState state;
  state.from = from;
  state.solver = "foam";
  state.model = scenes::to_string(scene.material.model);
  state.run = fmt::format("{}, OpenFOAM {}", scene.name, state.model);
  state.kind = scenes::name_of(scene.geometry.apparatus);
  state.dimension = scene.geometry.dimension;
  state.time = states.time(which);
  state.density = scene.material.density;
  if (!runs::can_be_handed_over(scene)) return state;  // it is refused by what it is
  const StateGrid grid(scene);
  state.flocculates =
      scene.thixotropy && (state.time == 0.0 || !states.read(which, "flocculation", grid.cells(), 1).empty());
  try {
    take_cells(grid, states, which, state);
  } catch (const FieldError& error) {
    throw runs::RunError(fmt::format("--from {}: {}", from, error.what()));
  }
  if (scene.thixotropy && states.read(which, "flocculation", grid.cells(), 1).empty())
    for (runs::Parcel& parcel : state.parcels) parcel.flocculation = scene.thixotropy->initial_flocculation;
  return state;
}

std::string folder_of_time(double time) { return fmt::format("{:.8g}", time); }

void write_state(const scenes::Scene& scene, const MaterialState& state, const fs::path& case_directory) {
  const StateGrid grid(scene);
  const InitialFields fields = fields_of(scene, state, grid);
  const fs::path folder = case_directory / folder_of_time(state.time);
  if (folder != case_directory / "0") {
    fs::remove_all(folder);
    fs::rename(case_directory / "0", folder);
  }
  const std::size_t cells = grid.cells();
  const auto one = [&](auto member) {
    return internal_field<1>("scalar", cells,
                             [&](std::size_t c) { return std::array{fields.carried[c].*member}; });
  };
  put_into(folder / "alpha.concrete",
           internal_field<1>("scalar", cells, [&](std::size_t c) { return std::array{fields.fraction[c]}; }));
  put_into(folder / "U",
           internal_field<3>("vector", cells, [&](std::size_t c) { return fields.carried[c].velocity; }));
  if (laws::can_rest(scene.material.model)) {
    write_field(
        folder / "stress", "volSymmTensorField", "[1 -1 -2 0 0 0 0]",
        internal_field<6>("symmTensor", cells, [&](std::size_t c) { return fields.carried[c].stress; }),
        "type calculated; value uniform (0 0 0 0 0 0);");
    write_field(folder / "plasticShearRate", "volScalarField", "[0 0 -1 0 0 0 0]", one(&Carried::shear_rate),
                "type calculated; value uniform 0;");
  }
  if (scene.thixotropy)
    write_field(folder / "flocculation", "volScalarField", "[0 0 0 0 0 0 0]", one(&Carried::flocculation),
                "type zeroGradient;");
}

}  // namespace flowrest::foam
